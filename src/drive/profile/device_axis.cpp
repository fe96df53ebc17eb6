// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Several axes in one device (CiA 402-2).
#include "drive/profile/profile.h"

namespace cia402::drive {
namespace {

constexpr ObjectRange kOfFirstAxis{{kFirstAxis, 0}, {kFirstAxis + kAxisSize - 1, 0xFF}};

/// Those that are told by index: names stay.
void shift(std::vector<NamedWrite>& writes, std::uint16_t offset) {
  for (NamedWrite& write : writes) {
    auto id = fieldbus::parseObjectAddress(write.object);
    if (!id || !kOfFirstAxis.holds(*id)) continue;
    id->index = static_cast<std::uint16_t>(id->index + offset);
    write.object = fieldbus::toString(*id);
  }
}

}  // namespace

std::optional<unsigned> axisOf(ObjectId id) {
  if (id.index < kFirstAxis || id.index >= kFirstAxis + kDeviceAxes * kAxisSize) return {};
  return (id.index - unsigned{kFirstAxis}) / kAxisSize;
}

DriveProfile ofDeviceAxis(DriveProfile profile, unsigned axis) {
  const auto offset = static_cast<std::uint16_t>(kAxisSize * axis);
  profile.offset = offset;
  for (ObjectSpec& object : profile.objects) {
    if (kOfFirstAxis.holds(object.id)) object.id = profile.own(object.id);
  }
  profile.encodings.shift(kOfFirstAxis, offset);
  profile.doubtful.shift(kOfFirstAxis, offset);
  profile.coordinates.shift(kOfFirstAxis, offset);
  shift(profile.startup, offset);
  shift(profile.before_enable, offset);
  shift(profile.homing.writes, offset);
  for (ModeSpec& mode : profile.modes) shift(mode.entry_writes, offset);
  return profile;
}

}  // namespace cia402::drive
