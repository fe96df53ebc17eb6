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

void readAfterPower(const yaml::Value& value, DriveProfile& profile) {
  for (const yaml::Value& entry : value.list()) {
    const auto text = entry.text();
    const auto range = text ? drive::parseObjectRange(*text) : std::nullopt;
    if (text && !range) {
      entry.problem("`" + *text + "` is no range of objects such as \"2001\" or \"2001:02-11\"");
    }
    if (range) profile.after_power.add(*range, true);
  }
}

void readDoubtful(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const auto range = drive::parseObjectRange(key);
    if (!range) {
      entry.problem("`" + key + "` is no range of objects such as \"2004:03\" or \"2002:01-0C\"");
    }
    const auto text = entry.text();
    if (range && text) profile.doubtful.add(*range, *text);
  }
  section.finish();
}

}  // namespace cia402::config
