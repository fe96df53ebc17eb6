// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How a drive keeps its parameters, and which of them there are.
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

/// An object that can be written; the number in `key` must be one that it takes.
std::string readSwitch(yaml::Section& section, const char* what, const DriveProfile& profile) {
  const auto name = section.require("object", what);
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  if (object == nullptr) return {};
  if (object->writable) return object->name;
  name->problem("`" + object->name + "` cannot be written");
  return {};
}

void readMemory(const yaml::Value& value, const DriveProfile& profile,
                drive::ParameterRecipes::Memory& memory) {
  yaml::Section section(value);
  memory.object = readSwitch(section, "what lets writes stay without power", profile);
  section.readInteger("on", memory.on, 0, 0xFFFF);
  section.readInteger("off", memory.off, 0, 0xFFFF);
  section.finish();
}

void readRestore(const yaml::Value& value, const DriveProfile& profile,
                 drive::ParameterRecipes::Restore& restore) {
  yaml::Section section(value);
  restore.object = readSwitch(section, "what brings the factory's values back", profile);
  section.readInteger("value", restore.value, 0, 0xFFFF);
  section.read("then", restore.then);
  section.finish();
}

}  // namespace

void readParameters(const yaml::Value& value, DriveProfile& profile) {
  drive::ParameterRecipes& recipes = profile.parameters.recipes;
  yaml::Section section(value);
  readSubindices(section, "save", profile.parameters.save);
  readSubindices(section, "restore", profile.parameters.restore);
  readDuration(section, "timeout", yaml::Range{0.001, 600.0, false}, profile.parameters.timeout);
  section.read("power_cycle_after_save", profile.parameters.power_cycle_after_save);
  if (const auto memory = section.get("save_by")) readMemory(*memory, profile, recipes.memory);
  if (const auto by = section.get("restore_by")) readRestore(*by, profile, recipes.restore);
  if (const auto list = section.get("commands")) recipes.commands = readSettings(*list, profile);
  if (const auto list = section.get("load_last")) recipes.load_last = readSettings(*list, profile);
  section.finish();
}

void readParameterNumbers(yaml::Section& section, DriveProfile& profile) {
  const auto range = [&](const yaml::Value& entry) {
    const auto text = entry.text();
    const auto read = text ? drive::parseObjectRange(*text) : std::nullopt;
    if (text && !read) entry.problem("`" + *text + "` is no range of objects such as 2001:02-11");
    return read;
  };
  drive::ParameterNames& names = profile.parameter_names;
  section.read("whole", names.whole);
  if (const auto list = section.get("signed")) {
    for (const yaml::Value& entry : list->list()) {
      if (const auto read = range(entry)) names.with_sign.add(*read, true);
    }
  }
  const auto steps = section.get("steps");
  if (!steps) return;
  yaml::Section by_step(*steps);
  for (const auto& [key, list] : by_step.entries()) {
    unsigned decimals = 0;
    if (key.size() > 2 && key.compare(0, 2, "0.") == 0 && key.back() == '1' &&
        key.find_first_not_of('0', 2) == key.size() - 1) {
      decimals = static_cast<unsigned>(key.size() - 2);
    } else {
      list.problem("`" + key + "` is no step such as 0.1 or 0.001");
    }
    for (const yaml::Value& entry : list.list()) {
      if (const auto read = range(entry)) names.decimals.add(*read, decimals);
    }
  }
  by_step.finish();
}

}  // namespace cia402::config
