// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "config/drive_family.h"

namespace cia402::config {

/// The beginning of a profile file, as far as a position mode; objects and modes may follow.
inline const char* const kLeastDrive = R"(name: tested
units: {position: count, velocity: count/s, time: {unit: s, scale: 0.001}}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int8}
  mode_display: {object: "6061:00", type: int8, access: ro}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: rpdo}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo})";

/// All that a profile file says, whomever it concerns.
struct WholeProfile : drive::DriveProfile, canopen::DeviceProfile {
  WholeProfile() = default;
  WholeProfile(DriveFamily family)  // NOLINT: means the same
      : DriveProfile(std::move(family.drive)), DeviceProfile(std::move(family.device)) {}
};

}  // namespace cia402::config
