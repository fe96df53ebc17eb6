// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <sstream>

#include "profile_parts.h"

namespace cia402::drive {
namespace {

void readIdentity(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("identity");
  if (!value) return;
  YamlSection section(*value);
  section.readInteger("device_type", profile.device_type, 0, 0xFFFFFFFF);
  section.readInteger("vendor_id", profile.vendor_id, 0, 0xFFFFFFFF);
  section.readInteger("product_code", profile.product_code, 0, 0xFFFFFFFF);
  section.finish();
}

void readPdoRules(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("pdo_rules");
  if (!value) return;
  YamlSection section(*value);
  if (section.readInteger("max_pdos", profile.max_rpdos, 1, 16)) {
    profile.max_tpdos = profile.max_rpdos;
  }
  section.readInteger("max_rpdos", profile.max_rpdos, 1, 16);
  section.readInteger("max_tpdos", profile.max_tpdos, 1, 16);
  section.readInteger("max_entries", profile.max_pdo_entries, 1, 64);
  if (section.readInteger("fixed_entries", profile.fixed_pdo_entries, 1, 64)) {
    profile.max_pdo_entries = std::min(profile.max_pdo_entries, profile.fixed_pdo_entries);
  }
  section.read("map_count_may_be_read_only", profile.pdo_map_count_may_be_read_only);
  if (const auto cob_ids = section.get("cob_ids")) {
    profile.cob_ids_of_drive = cob_ids->oneOf({"predefined", "drive"}).value_or(0) == 1;
  }
  section.read("rpdo_deadline", profile.rpdo_deadline);
  section.read("type_255_by_timer", profile.type_255_by_timer);
  if (const auto fixed = section.get("fixed")) {  // every default of CiA 402 has the controlword
    profile.fixed_pdos = readPdos(*fixed, profile, Sharing::allowed);
  }
  section.finish();
}

void readSync(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("sync");
  if (!value) return;
  YamlSection section(*value);
  section.read("counter_object", profile.has_sync_counter_object);
  section.read("period_object", profile.has_sync_period_object);
  const auto counter = section.get("counter");
  const auto overflow = counter ? counter->integer(0, 240) : std::nullopt;
  if (overflow == 1) counter->problem("1 is no counter; use 0 (none) or 2 to 240");
  if (overflow) profile.sync_counter = static_cast<std::uint8_t>(*overflow);
  if (overflow && !profile.has_sync_counter_object) {
    counter->problem("a counter needs the object 1019h, but `counter_object` is false");
  }
  double step = toSeconds(profile.sync_period_step);
  section.read("period_step", step, Range{1e-6, 1.0, false});
  profile.sync_period_step = fromSeconds(step);
  section.finish();
}

void readHeartbeat(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("heartbeat");
  if (!value) return;
  YamlSection section(*value);
  section.read("producer", profile.heartbeat_supported);
  section.read("consumer", profile.heartbeat_consumer_supported);
  section.read("node_guarding", profile.node_guarding_supported);
  section.finish();
}

void readDuration(YamlSection& section, const std::string& key, Range range, Duration& target) {
  double seconds = toSeconds(target);
  if (section.read(key, seconds, range)) target = fromSeconds(seconds);
}

void readTiming(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("timing");
  if (!value) return;
  const Range deadline{0.001, 600.0, false};
  YamlSection section(*value);
  readDuration(section, "boot", deadline, profile.timing.boot);
  readDuration(section, "state_change", deadline, profile.timing.state_change);
  readDuration(section, "mode_change", deadline, profile.timing.mode_change);
  readDuration(section, "brake_release", Range{0.0, 60.0, false}, profile.timing.brake_release);
  readDuration(section, "sdo", deadline, profile.timing.sdo);
  section.readInteger("sdo_retries", profile.timing.sdo_retries, 0, 10);
  section.finish();
}

void readParameters(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("parameters");
  if (!value) return;
  YamlSection section(*value);
  readSubindices(section, "save", profile.parameters.save);
  readSubindices(section, "restore", profile.parameters.restore);
  readDuration(section, "timeout", Range{0.001, 600.0, false}, profile.parameters.timeout);
  section.read("power_cycle_after_save", profile.parameters.power_cycle_after_save);
  section.finish();
}

void readQuickStop(YamlSection& section, DriveProfile& profile) {
  const auto value = section.get("quick_stop_holds");
  if (!value) return;
  for (const YamlValue& entry : value->list()) {
    const auto option = entry.integer(-32768, 32767);
    if (option) profile.quick_stop_holds.push_back(static_cast<int>(*option));
  }
}

// Objects that the axis uses by their fixed names whatever the mode.
void checkFixedObjects(const YamlSection& section, const DriveProfile& profile) {
  struct Fixed {
    const char* name;
    bool rpdo, tpdo;
  };
  constexpr Fixed kFixed[] = {
      {"controlword", true, false},        {"statusword", false, true},
      {"mode_of_operation", false, false}, {"mode_display", false, false},
      {"position_actual", false, true},
  };
  for (const Fixed& fixed : kFixed) {
    const ObjectSpec* object = profile.find(fixed.name);
    if (object == nullptr) {
      section.problem("objects/" + std::string(fixed.name) + " is missing; every axis needs it");
    } else if (canopen::sizeBits(object->type) == 0) {
      section.problem("objects/" + std::string(fixed.name) + " must be a number");
    } else if ((fixed.rpdo && !object->rpdo) || (fixed.tpdo && !object->tpdo)) {
      section.problem("objects/" + std::string(fixed.name) + " must be mappable into " +
                      (fixed.rpdo ? "an RPDO" : "a TPDO"));
    }
  }
  for (const char* word : {"controlword", "statusword"}) {
    const ObjectSpec* object = profile.find(word);
    if (object != nullptr && object->type != DataType::uint16) {
      section.problem("objects/" + std::string(word) + " must be a uint16");
    }
  }
}

void readModeChangeWord(const YamlValue& value, ModeChange& change) {
  const auto index = value.oneOf({"any", "disabled"});
  change.needs_disabling = index && *index == 1;
}

// profile_velocity: {cyclic_position: profile_position, cyclic_torque: disabled}
void readDetours(const YamlValue& value, ModeChange& change) {
  YamlSection section(value);
  for (const auto& [from, entry] : section.entries()) {
    YamlSection targets(entry);
    for (const auto& [to, through] : targets.entries()) {
      const auto text = through.text();
      if (!text) continue;
      const std::string between = *text == "disabled" ? "" : canonicalModeName(*text);
      change.detours.push_back({canonicalModeName(from), canonicalModeName(to), between});
    }
    targets.finish();
  }
  section.finish();
}

void readModeChange(YamlSection& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("mode_change");
  if (!value) return;
  ModeChange& change = profile.mode_change;
  if (!value->isMap()) return readModeChangeWord(*value, change);
  YamlSection section(*value);
  if (const auto when = section.get("when")) readModeChangeWord(*when, change);
  if (const auto shown = section.get("shown")) {
    change.shown_when_enabled = shown->oneOf({"always", "enabled"}).value_or(0) == 1;
  }
  if (const auto again = section.get("again")) {
    const auto index = again->oneOf({"never", "same", "through_zero"});
    if (index) change.again = static_cast<ModeChange::Again>(*index);
  }
  section.read("while_halted", change.while_halted);
  if (const auto detours = section.get("detours")) readDetours(*detours, change);
  section.finish();
}

// The modes are known only once they are read.
void checkDetours(const YamlSection& section, const DriveProfile& profile) {
  for (const ModeChange::Detour& detour : profile.mode_change.detours) {
    for (const std::string& name : {detour.from, detour.to, detour.through}) {
      if (name.empty() || profile.mode(name) != nullptr) continue;
      section.problem("mode_change/detours: there is no mode `" + name + "`");
    }
    if (detour.through.empty() && profile.mode_change.again == ModeChange::Again::same) {
      section.problem("mode_change/detours: " + detour.from + " to " + detour.to +
                      " is to go by disabling, but the drive forgets what it is told while "
                      "disabled (again: same); name a mode to go through instead of `disabled`");
    }
  }
}

void checkStopModes(YamlSection& section, const DriveProfile& profile) {
  for (const ModeSpec& mode : profile.modes) {
    if (mode.stop_mode.empty()) continue;
    const std::string at = "modes/" + mode.name + "/stop_mode: ";
    const ModeSpec* brake = profile.mode(mode.stop_mode);
    if (brake == nullptr) {
      section.problem(at + "there is no mode `" + mode.stop_mode + "`");
    } else if (brake->kind != ControlKind::velocity || !brake->cyclic) {
      section.problem(at + "`" + brake->name +
                      "` follows no stream of velocities, so that the "
                      "axis could not be led to rest in it");
    } else if (profile.mode_change.needs_disabling ||
               profile.mode_change.detour(mode.name, brake->name) != nullptr) {
      section.problem(at + "the drive does not go into `" + brake->name +
                      "` while enabled (mode_change); write `stop: quick_stop`");
    }
  }
}

void readBehaviour(YamlSection& section, DriveProfile& profile) {
  section.read("output_shaft", profile.output_shaft);
  section.read("halt_supported", profile.halt_supported);
  section.read("warning_stops", profile.warning_stops);
  readModeChange(section, profile);
  section.readInteger("fault_reset_tries", profile.fault_reset_tries, 1, 20);
  readDuration(section, "fault_reset_nmt_stop", Range{0.0, 10.0, false},
               profile.fault_reset_nmt_stop);
  section.read("fault_reset_clears_history", profile.fault_reset_clears_history);
  section.read("nmt_reset_node", profile.nmt_reset_node);
  readQuickStop(section, profile);
  readSync(section, profile);
  readHeartbeat(section, profile);
  readTiming(section, profile);
  readParameters(section, profile);
}

DriveProfile readProfile(const YamlValue& root) {
  DriveProfile profile;
  YamlSection section(root);
  if (section.require("name", "the file's name without .yaml")) section.read("name", profile.name);
  section.read("description", profile.description);
  readIdentity(section, profile);
  if (const auto units = section.require("units", "how the drive counts")) {
    readUnits(*units, profile);
  }
  if (const auto encodings = section.get("encodings")) readEncodings(*encodings, profile);
  if (const auto objects = section.require("objects", "the drive's objects by name")) {
    readObjects(*objects, profile);
    checkFixedObjects(section, profile);
  }
  if (const auto marks = section.get("coordinates")) readCoordinates(*marks, profile);
  readBehaviour(section, profile);
  if (const auto modes = section.require("modes", "at least one mode")) readModes(*modes, profile);
  checkDetours(section, profile);
  checkStopModes(section, profile);
  if (const auto homing = section.get("homing")) readHoming(*homing, profile);
  if (const auto writes = section.get("startup")) {
    profile.startup = readWrites(*writes, profile, WriteList::boot);
  }
  if (const auto writes = section.get("before_enable")) {
    profile.before_enable = readWrites(*writes, profile, WriteList::running);
  }
  readPdoRules(section, profile);
  if (const auto pdos = section.get("pdos")) profile.pdos = readPdos(*pdos, profile);
  if (const auto names = section.get("default_modes")) {
    profile.default_modes = readModeNames(*names, profile);
  }
  if (const auto names = section.get("feedback")) {
    profile.feedback = readFeedbackNames(*names, profile);
  }
  if (const auto names = section.get("feedback_if_room")) {
    profile.feedback_if_room = readFeedbackNames(*names, profile);
  }
  if (const auto errors = section.get("errors")) readErrors(*errors, profile);
  section.finish();
  return profile;
}

}  // namespace

void readSubindices(YamlSection& section, const std::string& key,
                    std::vector<std::uint8_t>& subindices) {
  const auto value = section.get(key);
  if (!value) return;
  std::vector<std::uint8_t> read;
  for (const YamlValue& entry : value->list()) {
    const auto subindex = entry.integer(1, 127);
    if (subindex) read.push_back(static_cast<std::uint8_t>(*subindex));
  }
  if (read.empty()) {
    value->problem(
        "must be a list of sub-indices: 1 all parameters, 2 communication, 3 "
        "application, 4 and more the maker's");
  } else {
    subindices = std::move(read);
  }
}

DriveProfile parseDriveProfile(const std::string& text, const std::string& source,
                               Problems& problems) {
  YAML::Node root;
  try {
    root = parseYaml(text);
  } catch (const YAML::Exception& error) {
    problems.add(source + ":" + std::to_string(error.mark.line + 1), "is no YAML: " + error.msg);
    return {};
  }
  if (!root.IsMap()) {
    problems.add(source,
                 "is no drive profile: it must be a mapping with name, units, objects "
                 "and modes");
    return {};
  }
  return readProfile(YamlValue(root, "", problems, source));
}

DriveProfile loadDriveProfile(const std::string& path, Problems& problems) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) {
    problems.add(path, "cannot be read");
    return {};
  }
  return parseDriveProfile(text.str(), path, problems);
}

}  // namespace cia402::drive
