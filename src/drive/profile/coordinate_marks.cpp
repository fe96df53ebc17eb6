// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Which objects shift the drive's coordinates or hold its calibration.
#include "drive/profile/profile.h"

namespace cia402::drive {
namespace {

struct StandardMark {
  ObjectId first, last;
  CoordinateMark mark;
};

// CiA 301, 7.5.2.14 (1011h), and CiA 402-2 for the first axis of a device.
constexpr StandardMark kStandard[] = {
    {{0x1011, 1}, {0x1011, 0x7F}, CoordinateMark::restore_parameters},
    {{0x6062, 0}, {0x6064, 0xFF}, CoordinateMark::set_position},  // where it can be written: preset
    {{0x607B, 0}, {0x607B, 0xFF}, CoordinateMark::configuration},  // position range limit: wraps
    {{0x607C, 0}, {0x607C, 0xFF}, CoordinateMark::home},
    {{0x607E, 0}, {0x607E, 0xFF}, CoordinateMark::configuration},  // polarity
    {{0x6089, 0}, {0x6097, 0xFF}, CoordinateMark::configuration},  // units, resolutions, factors
    {{0x60A8, 0}, {0x60AB, 0xFF}, CoordinateMark::configuration},  // SI units
    {{0x60E6, 0}, {0x60E6, 0xFF}, CoordinateMark::configuration},  // of further encoders
    {{0x60E8, 0}, {0x60EE, 0xFF}, CoordinateMark::configuration},
};

}  // namespace

CoordinateMark standardMark(ObjectId id) {
  if (const auto axis = axisOf(id)) {  // further axes repeat those of the first
    id.index = static_cast<std::uint16_t>(id.index - *axis * kAxisSize);
  }
  for (const StandardMark& row : kStandard) {
    if (!(id < row.first) && !(row.last < id)) return row.mark;
  }
  return CoordinateMark::none;
}

}  // namespace cia402::drive
