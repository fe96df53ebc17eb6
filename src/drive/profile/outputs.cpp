// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/outputs.h"

#include <algorithm>

namespace cia402::drive {

bool isSetByAxis(const DriveProfile& profile, const std::string& object) {
  if (object == "controlword" || object == "mode_of_operation") return true;
  return std::any_of(profile.modes.begin(), profile.modes.end(), [&](const ModeSpec& mode) {
    const auto& writes = mode.entry_writes;
    return mode.target == object || mode.offsets.velocity == object ||
           mode.offsets.torque == object ||
           (mode.set_point_stream && mode.set_point_stream->sends(object)) ||
           std::any_of(writes.begin(), writes.end(),
                       [&](const NamedWrite& write) { return write.object == object; });
  });
}

bool isSetByPeople(const DriveProfile& profile, const std::string& object) {
  const auto holds = [&](const auto& named) { return named.second.value.object == object; };
  return !isSetByAxis(profile, object) &&
         std::any_of(profile.outputs.begin(), profile.outputs.end(), holds);
}

}  // namespace cia402::drive
