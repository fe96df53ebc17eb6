// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What of a drive is looked at while it works: `statusword_needs`, `watches`, `fault_reads`,
// `boot_reads`.
#include <algorithm>

#include "config/profile/parts.h"

namespace cia402::config {
namespace {

void readText(yaml::Section& section, std::string& text, std::string& remedy) {
  if (section.require("text", "what it means otherwise")) section.read("text", text);
  if (section.require("remedy", "what to do then")) section.read("remedy", remedy);
}

void readNeed(const yaml::Value& entry, DriveProfile& profile) {
  yaml::Section section(entry);
  drive::StatusNeed need;
  const auto bit = section.require("bit", "7 to 15, of the statusword");
  const auto number = bit ? bit->integer(7, 15) : std::nullopt;
  need.bit = static_cast<unsigned>(number.value_or(9));
  if (const auto is = section.require("is", "0 or 1, what it must be")) {
    need.set = is->integer(0, 1).value_or(1) == 1;
  }
  if (const auto when = section.get("when")) {
    need.in_operation = when->oneOf({"always", "enabled"}) == 1U;
  }
  readText(section, need.text, need.remedy);
  section.finish();
  if (number) profile.supervision.needs.push_back(need);
}

void readWatch(const yaml::Value& entry, DriveProfile& profile) {
  yaml::Section section(entry);
  drive::ValueWatch watch;
  const auto name = section.require("object", "what is watched, by name");
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  const auto within = section.require("within", "[lowest, highest], in the units of its quantity");
  const auto ends = within ? within->numbers(2) : std::nullopt;
  readText(section, watch.text, watch.remedy);
  section.finish();
  if (object == nullptr || !ends) return;
  watch.object = object->name;
  watch.low = ends->front();
  watch.high = ends->back();
  if (object->quantity == Quantity::none) {
    name->problem("`" + object->name + "` measures nothing; see its `quantity`");
  } else if (watch.low > watch.high) {
    within->problem("its lowest number is above its highest");
  } else {
    profile.supervision.watches.push_back(watch);
  }
}

void readFaultRead(const yaml::Value& entry, DriveProfile& profile) {
  const auto text = entry.text();
  if (!text) return;
  if (!fieldbus::parseObjectAddress(*text)) {
    const ObjectSpec* object = readSetting(entry, profile);
    if (object == nullptr) return;
  }
  profile.supervision.fault_reads.push_back(*text);
}

}  // namespace

void readSupervision(yaml::Section& section, DriveProfile& profile) {
  if (const auto needs = section.get("statusword_needs")) {
    for (const yaml::Value& entry : needs->list()) readNeed(entry, profile);
  }
  if (const auto watches = section.get("watches")) {
    for (const yaml::Value& entry : watches->list()) readWatch(entry, profile);
  }
  if (const auto reads = section.get("fault_reads")) {
    for (const yaml::Value& entry : reads->list()) readFaultRead(entry, profile);
  }
  if (const auto reads = section.get("boot_reads")) {
    for (const yaml::Value& entry : reads->list()) {
      const ObjectSpec* object = readSetting(entry, profile);
      if (object != nullptr) profile.supervision.boot_reads.push_back(object->name);
    }
  }
}

}  // namespace cia402::config
