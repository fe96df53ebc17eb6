// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "can/frame.h"
#include "fieldbus/emergency.h"

namespace cia402::canopen {

using fieldbus::Emergency;

/// Takes an emergency out of its frame. Frames that are shorter than the standard wants are taken
/// as far as they go. @return nothing if there is not even an error code.
std::optional<Emergency> decodeEmergency(const can::Frame& frame, Time stamp);

}  // namespace cia402::canopen
