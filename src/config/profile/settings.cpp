// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a drive must be set to, and how long its brake takes.
#include "config/profile/parts.h"
#include "drive/profile/object_value.h"

namespace cia402::config {
const ObjectSpec* readSetting(const yaml::Value& value, const DriveProfile& profile) {
  const auto text = value.text();
  if (!text) return nullptr;
  const ObjectSpec* object = profile.find(*text);
  if (object == nullptr) {
    value.problem("the profile has no object `" + *text + "`" +
                  yaml::suggestion(*text, drive::objectNames(profile)));
    return nullptr;
  }
  const bool whole =
      fieldbus::sizeBits(object->type) != 0 && !drive::holdsFloat(object->type, object->encoding);
  if (object->readable && whole) return object;
  value.problem("`" + *text + "` is no whole number that the drive lets be read");
  return nullptr;
}

std::vector<std::string> readSettings(const yaml::Value& list, const DriveProfile& profile) {
  std::vector<std::string> names;
  for (const yaml::Value& entry : list.list()) {
    if (const ObjectSpec* object = readSetting(entry, profile)) names.push_back(object->name);
  }
  return names;
}

void readCountsRule(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  drive::CountsRule& rule = profile.counts_rule;
  if (const auto times = section.require("times", "objects whose product is taken")) {
    rule.times = readSettings(*times, profile);
  }
  if (const auto over = section.get("over")) rule.over = readSettings(*over, profile);
  section.finish();
}

void readBrakeRelease(yaml::Section& timing, DriveProfile& profile) {
  const yaml::Range range{0.0, 60.0, false};
  const auto value = timing.get("brake_release");
  if (!value || !value->isMap()) {
    return readDuration(timing, "brake_release", range, profile.timing.brake_release);
  }
  yaml::Section section(*value);
  const auto name = section.require("object", "what holds the time that the brake needs");
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  if (object != nullptr && object->quantity != Quantity::time) {
    name->problem("`" + object->name + "` does not measure a time; see its `quantity`");
  } else if (object != nullptr) {
    profile.timing.brake_object = object->name;
  }
  section.require("at_most", "the longest that it may say, s");
  readDuration(section, "at_most", range, profile.timing.brake_release);
  section.finish();
}

}  // namespace cia402::config
