// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "config/drive_family.h"

namespace cia402::config {

/// All that a profile file says, whomever it concerns.
struct WholeProfile : drive::DriveProfile, canopen::DeviceProfile {
  WholeProfile() = default;
  WholeProfile(DriveFamily family)  // NOLINT: means the same
      : DriveProfile(std::move(family.drive)), DeviceProfile(std::move(family.device)) {}
};

}  // namespace cia402::config
