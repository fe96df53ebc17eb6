// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

// Where the objects of the axes of one device lie (CiA 402-2, multiple axes): 6000h-67FFh are those
// of axis 0, 6800h-6FFFh those of axis 1, and so on up to 9FFFh.

inline constexpr std::uint16_t kFirstAxisObject = 0x6000;
inline constexpr std::uint16_t kObjectsPerAxis = 0x800;
inline constexpr unsigned kMostAxes = 8;

/// The axis that an object belongs to in a device of so many axes, and 0 for the device's own.
constexpr unsigned axisOf(ObjectId id, unsigned axes) {
  const bool in_range = id.index >= kFirstAxisObject &&
                        id.index < kFirstAxisObject + std::uint32_t{axes} * kObjectsPerAxis;
  return in_range ? (id.index - std::uint32_t{kFirstAxisObject}) / kObjectsPerAxis : 0;
}

/// The object of axis 0 with the same meaning; objects of the device stay as they are.
constexpr ObjectId ofFirstAxis(ObjectId id, unsigned axes) {
  return {static_cast<std::uint16_t>(id.index - axisOf(id, axes) * kObjectsPerAxis), id.subindex};
}

/// The object of another axis that means the same as `id` of axis 0. Objects outside 6000h-67FFh
/// are the device's own and stay as they are.
constexpr ObjectId ofAxis(ObjectId id, unsigned axis) {
  const bool of_axis =
      id.index >= kFirstAxisObject && id.index < kFirstAxisObject + kObjectsPerAxis;
  const unsigned offset = of_axis ? axis * kObjectsPerAxis : 0;
  return {static_cast<std::uint16_t>(id.index + offset), id.subindex};
}

}  // namespace cia402::sim
