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
  section.read("adjustable", rule.adjustable);
  const auto writable = [&](const std::string& name) { return profile.find(name)->writable; };
  const bool can_be = rule.times.size() == 2 && rule.over.size() == 1 && writable(rule.times[1]) &&
                      writable(rule.over[0]);
  if (rule.adjustable && !can_be) {
    section.problem(
        "`adjustable` needs two objects in `times`, the encoder's and one that can be "
        "written, and one in `over` that can be written");
  }
  section.finish();
}

void readParameterNames(const yaml::Value& value, DriveProfile& profile) {
  drive::ParameterNames& names = profile.parameter_names;
  yaml::Section section(value);
  if (section.require("prefix", "what the names begin with, such as H")) {
    section.read("prefix", names.prefix);
  }
  if (const auto groups = section.get("groups")) {
    names.hexadecimal = groups->oneOf({"decimal", "hexadecimal"}).value_or(0) == 1;
  }
  section.require("index", "of group 0, such as 0x2000");
  section.readInteger("index", names.index, 0x1000, 0xFFFF);
  section.readInteger("subindex", names.subindex, 0, 0xFF);
  section.require("last_group", "the highest group, a number");
  section.readInteger("last_group", names.last_group, 0, 0xFF);
  if (names.index + names.last_group > 0xFFFF) section.problem("the last group lies beyond FFFFh");
  readParameterNumbers(section, profile);
  section.finish();
}

namespace {

const ObjectSpec* readWritable(const yaml::Value& value, const DriveProfile& profile) {
  const ObjectSpec* object = readSetting(value, profile);
  if (object == nullptr || object->writable) return object;
  value.problem("`" + object->name + "` cannot be written");
  return nullptr;
}

/// A bit rate is a key.
std::optional<std::uint32_t> bitRate(const std::string& key, const yaml::Value& entry) {
  const auto rate = yaml::parseInteger(key);
  if (rate && *rate >= 1000 && *rate <= 1000000) return static_cast<std::uint32_t>(*rate);
  entry.problem("`" + key + "` is no bit rate of CAN, in bit/s");
  return {};
}

void readBusSetting(const yaml::Value& value, const DriveProfile& profile,
                    canopen::BusSetting& setting) {
  yaml::Section section(value);
  const auto name = section.require("object", "what holds it, by name");
  const ObjectSpec* object = name ? readWritable(*name, profile) : nullptr;
  if (object != nullptr) setting.object = object->name;
  if (const auto counts = section.get("counts")) {
    const auto word = counts->oneOf({"at_once", "after_reset", "after_power_cycle"});
    if (word) setting.counts = static_cast<canopen::BusSetting::Counts>(*word);
  }
  if (const auto numbers = section.get("numbers")) {
    yaml::Section rates(*numbers);
    for (const auto& [key, entry] : rates.entries()) {
      const auto rate = bitRate(key, entry);
      const auto number = entry.integer(0, 0xFFFF);
      if (rate && number) setting.numbers[*rate] = *number;
    }
    rates.finish();
  }
  section.finish();
}

void readSamplePoints(const yaml::Value& value, canopen::BusSettings& settings) {
  yaml::Section rates(value);
  for (const auto& [key, entry] : rates.entries()) {
    const auto rate = bitRate(key, entry);
    for (const yaml::Value& item : entry.list()) {
      const auto point = item.number({0.5, 0.95, false});
      if (rate && point) settings.sample_points[*rate].push_back(*point);
    }
  }
  rates.finish();
}

}  // namespace

void readBusSettings(const yaml::Value& value, const DriveProfile& profile,
                     canopen::BusSettings& settings) {
  yaml::Section section(value);
  if (const auto node = section.get("node_id")) readBusSetting(*node, profile, settings.node_id);
  if (const auto rate = section.get("bit_rate")) {
    readBusSetting(*rate, profile, settings.bit_rate);
    if (settings.bit_rate.numbers.empty()) {
      rate->problem("needs `numbers`, bit/s to what the object says then");
    }
  }
  if (const auto memory = section.get("memory")) {
    yaml::Section of_memory(*memory);
    const auto name = of_memory.require("object", "what lets writes stay without power");
    const ObjectSpec* object = name ? readWritable(*name, profile) : nullptr;
    if (object != nullptr) settings.memory = object->name;
    of_memory.readInteger("on", settings.memory_on, 0, 0xFFFF);
    of_memory.readInteger("off", settings.memory_off, 0, 0xFFFF);
    of_memory.finish();
  }
  section.read("saved_apart", settings.saved_apart);
  if (const auto points = section.get("sample_points")) readSamplePoints(*points, settings);
  section.finish();
}

void readToldTime(yaml::Section& timing, const DriveProfile& profile, const ToldTime& told) {
  const yaml::Range range{0.0, 60.0, false};
  const auto value = timing.get(told.key);
  if (!value || !value->isMap()) return readDuration(timing, told.key, range, told.time);
  yaml::Section section(*value);
  const auto name = section.require("object", "what holds the time that the brake needs");
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  if (object != nullptr && object->quantity != Quantity::time) {
    name->problem("`" + object->name + "` does not measure a time; see its `quantity`");
  } else if (object != nullptr) {
    told.object = object->name;
  }
  section.require("at_most", "the longest that it may say, s");
  readDuration(section, "at_most", range, told.time);
  section.finish();
}

}  // namespace cia402::config
