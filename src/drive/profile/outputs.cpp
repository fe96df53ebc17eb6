// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/outputs.h"

#include <algorithm>

namespace cia402::drive {

namespace {

bool isSetpoint(const DriveProfile& profile, const std::string& object) {
  if (object == "controlword" || object == "mode_of_operation") return true;
  return std::any_of(profile.modes.begin(), profile.modes.end(), [&](const ModeSpec& mode) {
    return mode.target == object || mode.offsets.velocity == object ||
           mode.offsets.torque == object ||
           (mode.set_point_stream && mode.set_point_stream->sends(object));
  });
}

/// Before the mode is entered, and held in the cycle from then on.
bool isEntered(const ModeSpec& mode, const std::string& object) {
  const auto& writes = mode.entry_writes;
  return std::any_of(writes.begin(), writes.end(),
                     [&](const NamedWrite& write) { return write.object == object; });
}

}  // namespace

bool isSetByAxis(const DriveProfile& profile, const std::string& object) {
  return isSetpoint(profile, object) ||
         std::any_of(profile.modes.begin(), profile.modes.end(),
                     [&](const ModeSpec& mode) { return isEntered(mode, object); });
}

bool isSetByPeople(const DriveProfile& profile, const std::string& object) {
  const auto holds = [&](const auto& named) { return named.second.value.object == object; };
  return !isSetByAxis(profile, object) &&
         std::any_of(profile.outputs.begin(), profile.outputs.end(), holds);
}

bool isKept(const DriveProfile& profile, const std::vector<std::string>& modes,
            const std::string& object) {
  if (isSetpoint(profile, object) || isSetByPeople(profile, object)) return false;
  return std::none_of(modes.begin(), modes.end(), [&](const std::string& name) {
    const ModeSpec* mode = profile.mode(name);
    return mode != nullptr && isEntered(*mode, object);
  });
}

}  // namespace cia402::drive
