// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drive/axis/config.h"
#include "drive/axis/signals.h"
#include "fieldbus/device.h"

namespace cia402::drive {

/// A value that is sent in the cycle.
struct OutputObject {
  const ObjectSpec* spec = nullptr;
  fieldbus::Slot slot = fieldbus::kNoSlot;
  bool mapped() const { return slot != fieldbus::kNoSlot; }
};

/// A mode of the profile with its target resolved.
struct ModeChannel {
  const ModeSpec* spec = nullptr;
  OutputObject target;
  Conversion conversion;
  /// An object beside the target: what is added to a demand of the drive, or its speed.
  struct Offset {
    OutputObject output;
    Conversion conversion;
  };
  Offset velocity_offset, torque_offset;  ///< where the axis feeds forward by them
  /// Those that go with each set-point (SetPointStream).
  Offset set_point_speed, set_point_deceleration;
  bool copies_position = false;  ///< target has the very coding of the actual position
  std::string refusal;           ///< why the mode cannot be used; empty: it can
};

/// Where everything that an axis needs is in the process image, worked out once.
struct AxisObjects {
  /// @throws std::invalid_argument if controlword, statusword or actual position are not mapped.
  AxisObjects(const AxisConfig& config, fieldbus::Device& device);

  Signals signals;
  OutputObject controlword, mode;
  std::vector<ModeChannel> modes;

  const ModeChannel* channel(const std::string& mode_name) const;
  const ModeChannel* channelOfValue(int mode_value) const;
  /// The profile's homing mode, nullptr if it has none.
  const ModeChannel* homingChannel() const;
};

}  // namespace cia402::drive
