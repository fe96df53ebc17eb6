// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <sstream>

#include "config/drive_family.h"
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

/// Those that the driver waits for; 0, 1 and 13 come by themselves.
void readTransitions(const yaml::Value& value, yaml::Range range, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const auto number = yaml::parseInteger(key);
    if (!number || *number < 2 || *number > 16 || *number == 13) {
      entry.problem(
          "a transition of CiA 402 that is waited for is a number from 2 to 16 without 13, "
          "not `" +
          key + "`");
      continue;
    }
    readDuration(section, key, range, profile.timing.transitions[static_cast<int>(*number)]);
  }
  section.finish();
}

/// Where the maker keeps past errors.
void readMemories(yaml::Section& section, DriveProfile& profile) {
  if (const auto memory = section.get("alarm_memory")) readAlarmMemory(*memory, profile);
  if (const auto memory = section.get("fault_memory")) readFaultMemory(*memory, profile);
}

void readTiming(yaml::Section& section, DriveProfile& profile) {
  const yaml::Range deadline{0.001, 600.0, false};
  readDuration(section, "state_change", deadline, profile.timing.state_change);
  if (const auto value = section.get("transitions")) readTransitions(*value, deadline, profile);
  readDuration(section, "mode_change", deadline, profile.timing.mode_change);
  drive::DriveProfile::Timing& timing = profile.timing;
  readToldTime(section, profile, {"brake_release", timing.brake_release, timing.brake_object});
  readToldTime(section, profile, {"power_off", timing.power_off, timing.power_object});
}

void readQuickStop(yaml::Section& section, DriveProfile& profile) {
  const auto value = section.get("quick_stop_holds");
  if (!value) return;
  for (const yaml::Value& entry : value->list()) {
    const auto option = entry.integer(-32768, 32767);
    if (option) profile.quick_stop_holds.push_back(static_cast<int>(*option));
  }
}

/// Bits that CiA 402-2 leaves to the maker, or that makers use otherwise; the others are the state,
/// or belong to modes.
void readStatusWords(yaml::Section& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("statusword");
  if (!value) return;
  yaml::Section section(*value);
  for (const auto& [key, entry] : section.entries()) {
    const auto bit = yaml::parseInteger(key);
    const bool open = bit && (*bit == 7 || *bit == 8 || (*bit >= 10 && *bit <= 15));
    if (!open) {
      entry.problem("names bits 7, 8 and 10 to 15, not `" + key + "`: the others are the state");
      continue;
    }
    const auto word = entry.text();
    if (!word) continue;
    const auto index = static_cast<std::size_t>(*bit);
    const bool none = *bit == 7 && *word == "none";
    if (none) profile.has_warning_bit = false;
    profile.status_words[index] = none ? "bit 7" : *word;
  }
  section.finish();
}

// Objects that the axis uses by their fixed names whatever the mode.
void checkFixedObjects(const yaml::Section& section, const DriveProfile& profile) {
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
    } else if (fieldbus::sizeBits(object->type) == 0) {
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

void readModeChangeWord(const yaml::Value& value, ModeChange& change) {
  const auto index = value.oneOf({"any", "disabled"});
  change.needs_disabling = index && *index == 1;
}

// profile_velocity: {cyclic_position: profile_position, cyclic_torque: disabled}
void readDetours(const yaml::Value& value, ModeChange& change) {
  yaml::Section section(value);
  for (const auto& [from, entry] : section.entries()) {
    yaml::Section targets(entry);
    for (const auto& [to, through] : targets.entries()) {
      const auto text = through.text();
      if (!text) continue;
      const std::string between = *text == "disabled" ? "" : drive::canonicalModeName(*text);
      change.detours.push_back(
          {drive::canonicalModeName(from), drive::canonicalModeName(to), between});
    }
    targets.finish();
  }
  section.finish();
}

void readModeChange(yaml::Section& profile_section, DriveProfile& profile) {
  const auto value = profile_section.get("mode_change");
  if (!value) return;
  ModeChange& change = profile.mode_change;
  if (!value->isMap()) return readModeChangeWord(*value, change);
  yaml::Section section(*value);
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
void checkDetours(const yaml::Section& section, const DriveProfile& profile) {
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

void checkStopModes(yaml::Section& section, const DriveProfile& profile) {
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

/// The maker's bits of the statusword.
void readHomedBit(yaml::Section& section, DriveProfile& profile) {
  const auto value = section.get("homed_bit");
  const auto bit = value ? value->integer(7, 15) : std::nullopt;
  if (bit) profile.homed_bit = static_cast<int>(*bit);
}

/// The name of an object that can be written; else a problem and an empty name.
std::string readWritableName(const yaml::Value& value, const DriveProfile& profile) {
  const auto name = value.text();
  const ObjectSpec* object = name ? profile.find(*name) : nullptr;
  if (object != nullptr && object->writable && fieldbus::sizeBits(object->type) != 0) return *name;
  if (name) {
    value.problem("the profile has no object `" + *name + "` that is a number and can be written" +
                  yaml::suggestion(*name, drive::objectNames(profile)));
  }
  return {};
}

void readBehaviour(yaml::Section& section, DriveProfile& profile) {
  readHomedBit(section, profile);
  if (const auto way = section.get("disable_by")) profile.disabling = readDisabling(*way);
  section.read("output_shaft", profile.output_shaft);
  section.read("halt_supported", profile.halt_supported);
  section.read("warning_stops", profile.warning_stops);
  profile.fault_reaction = readFaultReaction(section, "fault_reaction");
  readStatusWords(section, profile);
  readModeChange(section, profile);
  section.readInteger("fault_reset_tries", profile.fault_reset.tries, 1, 20);
  readDuration(section, "fault_reset_nmt_stop", yaml::Range{0.0, 10.0, false},
               profile.fault_reset.pause);
  section.read("fault_reset_clears_history", profile.fault_reset.clears_history);
  if (const auto object = section.get("fault_reset_object")) {
    profile.fault_reset.object = readWritableName(*object, profile);
  }
  section.read("reads_back", profile.reads_back);
  section.read("absent_settings_pass", profile.absent_settings_pass);
  readQuickStop(section, profile);
  if (const auto value = section.get("parameters")) readParameters(*value, profile);
}

/// Numbers that the drive lets be read, each once.
void readSignals(const yaml::Value& value, DriveProfile& profile) {
  for (const yaml::Value& entry : value.list()) {
    const auto name = entry.text();
    if (!name) continue;
    const ObjectSpec* object = profile.find(*name);
    const auto& known = profile.signals;
    if (object == nullptr) {
      entry.problem("the profile has no object `" + *name + "`" +
                    yaml::suggestion(*name, drive::objectNames(profile)));
    } else if (!object->readable || fieldbus::sizeBits(object->type) == 0) {
      entry.problem("`" + *name + "` is no number that the drive lets be read");
    } else if (std::find(known.begin(), known.end(), *name) != known.end()) {
      entry.problem("`" + *name + "` is given twice");
    } else {
      profile.signals.push_back(*name);
    }
  }
}

void readDrive(yaml::Section& section, yaml::Section& timing, DriveProfile& profile) {
  if (section.require("name", "the file's name without .yaml")) section.read("name", profile.name);
  section.read("description", profile.description);
  if (const auto units = section.require("units", "how the drive counts")) {
    readUnits(*units, profile);
  }
  if (const auto encodings = section.get("encodings")) readEncodings(*encodings, profile);
  if (const auto fields = section.get("bit_fields")) readBitFields(*fields, profile);
  if (const auto objects = section.require("objects", "the drive's objects by name")) {
    readObjects(*objects, profile);
    checkFixedObjects(section, profile);
  }
  if (const auto marks = section.get("coordinates")) readCoordinates(*marks, profile);
  if (const auto doubtful = section.get("doubtful")) readDoubtful(*doubtful, profile);
  if (const auto list = section.get("counts_after_power")) readAfterPower(*list, profile);
  readBehaviour(section, profile);
  readTiming(timing, profile);
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
  if (const auto list = section.get("checks")) readChecks(*list, profile);
  if (const auto systems = section.get("unit_systems")) readUnitSystems(*systems, profile);
  if (const auto list = section.get("may_be_cut"))
    profile.may_be_cut = readSettings(*list, profile);
  readSupervision(section, profile);
  if (const auto rule = section.get("counts_rule")) readCountsRule(*rule, profile);
  const auto setting = [&](const char* key, std::string& name) {
    const auto value = section.get(key);
    const ObjectSpec* object = value ? readSetting(*value, profile) : nullptr;
    if (object != nullptr) name = object->name;
  };
  setting("rated_torque", profile.rated_torque);
  setting("not_ready_reason", profile.not_ready_reason);
  if (const auto names = section.get("parameter_names")) readParameterNames(*names, profile);
  if (const auto names = section.get("default_modes")) {
    profile.default_modes = readModeNames(*names, profile);
  }
  if (const auto names = section.get("feedback")) {
    profile.feedback = readFeedbackNames(*names, profile);
  }
  if (const auto names = section.get("feedback_if_room")) {
    profile.feedback_if_room = readFeedbackNames(*names, profile);
  }
  if (const auto names = section.get("signals")) readSignals(*names, profile);
  if (const auto outputs = section.get("outputs")) readDigitalOutputs(*outputs, profile);
  if (const auto inputs = section.get("inputs")) readDigitalInputs(*inputs, profile);
  if (const auto probes = section.get("touch_probe")) readTouchProbes(*probes, profile);
  if (const auto errors = section.get("errors")) readErrors(*errors, profile);
  section.readInteger("error_bits", profile.error_bits, 0, 0xFFFF);
  if (const auto warnings = section.get("warnings")) readWarnings(*warnings, profile);
  if (const auto details = section.get("error_details")) readErrorDetails(*details, profile);
  readMemories(section, profile);
}

DriveFamily readFamily(const yaml::Value& root) {
  DriveFamily family;
  yaml::Section section(root);
  const yaml::Value none(YAML::Node(YAML::NodeType::Map), "timing", root.problems(), root.source());
  yaml::Section timing(section.get("timing").value_or(none));
  readDrive(section, timing, family.drive);
  readDevice(section, timing, family.drive, family.device);
  if (const auto settings = section.get("bus_settings")) {
    readBusSettings(*settings, family.drive, family.device.bus_settings);
  }
  timing.finish();
  section.finish();
  return family;
}

}  // namespace

void readSubindices(yaml::Section& section, const std::string& key,
                    std::vector<std::uint8_t>& subindices) {
  const auto value = section.get(key);
  if (!value) return;
  std::vector<std::uint8_t> read;
  for (const yaml::Value& entry : value->list()) {
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

DriveFamily parseDriveFamily(const std::string& text, const std::string& source,
                             Problems& problems) {
  YAML::Node root;
  try {
    root = yaml::parse(text);
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
  return readFamily(yaml::Value(root, "", problems, source));
}

DriveFamily loadDriveFamily(const std::string& path, Problems& problems) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) {
    problems.add(path, "cannot be read");
    return {};
  }
  return parseDriveFamily(text.str(), path, problems);
}

}  // namespace cia402::config
