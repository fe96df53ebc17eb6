// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/profile/parts.h"

namespace cia402::config {

void readCoordinates(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const ObjectSpec* object = profile.find(key);
    std::optional<drive::ObjectRange> range = drive::parseObjectRange(key);
    if (object != nullptr) range = drive::ObjectRange{object->id, object->id};
    if (!range) {
      entry.problem("`" + key +
                    "` is neither an object of the profile nor a range such as \"607C\" "
                    "or \"2002:01-0C\"");
    }
    const auto index = entry.oneOf(
        {"none", "set_position", "home", "restore_parameters", "configuration", "calibration"});
    if (range && index) profile.coordinates.add(*range, static_cast<CoordinateMark>(*index));
  }
  section.finish();
}

}  // namespace cia402::config
