// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "drive/profile/conversion.h"
#include "drive/profile/profile.h"
#include "fieldbus/process_image.h"

namespace cia402::drive {

/// What the driver itself reads of a drive, each under one name whatever a profile calls it.
enum class SignalId : std::uint8_t {
  statusword,       ///< 6041h
  position,         ///< 6064h
  velocity,         ///< 606Ch
  effort,           ///< 6077h
  following_error,  ///< 60F4h
  mode_display,     ///< 6061h
  error_code,       ///< 603Fh
  digital_inputs,   ///< 60FDh
};
inline constexpr std::size_t kSignalIds = 8;

/// A value that the drive tells: by its process image where it is mapped, else it may be asked for.
struct Signal {
  const ObjectSpec* spec = nullptr;  ///< nullptr: the drive has no such object
  fieldbus::Slot slot = fieldbus::kNoSlot;
  /// What the process image holds of it where it is mapped, else what is asked for without end;
  /// never nullptr, nothing where neither brings it.
  const fieldbus::ProcessValue* value = &fieldbus::kNoValue;
  /// What was asked for beside the cycle, whether it is mapped or not; never nullptr.
  const fieldbus::ProcessValue* asked = &fieldbus::kNoValue;
  Conversion conversion;
  int polled = -1;  ///< its number in the AxisPoller; -1: it is not asked for
  bool mapped() const { return slot != fieldbus::kNoSlot; }
};

}  // namespace cia402::drive
