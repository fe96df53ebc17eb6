// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canopen/device_profile.h"
#include "common/problems.h"
#include "drive/profile/profile.h"

namespace cia402::config {

/// A drive family as its file in config/drives/ tells it: the drive, and the device that it is on
/// the bus.
struct DriveFamily {
  drive::DriveProfile drive;
  canopen::DeviceProfile device;
};

/// Reads config/drives/<name>.yaml. Every problem is added with "file:line" paths; the family is
/// only valid if none was added.
DriveFamily loadDriveFamily(const std::string& path, Problems& problems);
/// The same from text (tests). @param source name for messages.
DriveFamily parseDriveFamily(const std::string& text, const std::string& source,
                             Problems& problems);

}  // namespace cia402::config
