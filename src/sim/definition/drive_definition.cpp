// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/drive_definition.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <limits>

#include "cia402_driver/yaml/reader.h"
#include "sim/definition/read_communication.h"
#include "sim/definition/read_quirks.h"
#include "sim/definition/reader.h"
#include "sim/drive/homing_sequence.h"

namespace cia402::sim {
namespace {

using Reader = DefinitionReader;

constexpr double kForeverS = 1e6;
constexpr int kDeepestExtension = 4;

const std::vector<std::pair<const char*, Encoding>> kEncodings = {
    {"integer", Encoding::integer},
    {"float32", Encoding::float32},
    {"bfloat16", Encoding::bfloat16},
    {"scaled_unsigned", Encoding::scaled_unsigned},
    {"scaled_signed", Encoding::scaled_signed}};
const std::vector<std::pair<const char*, Ramp>> kRamps = {{"coast", Ramp::coast},
                                                          {"slow_down", Ramp::slow_down},
                                                          {"quick_stop", Ramp::quick_stop},
                                                          {"limit", Ramp::limit}};
const std::vector<std::pair<const char*, ModeBehaviour>> kBehaviours = {
    {"hold", ModeBehaviour::hold},
    {"profile_position", ModeBehaviour::profile_position},
    {"profile_velocity", ModeBehaviour::profile_velocity},
    {"profile_torque", ModeBehaviour::profile_torque},
    {"homing", ModeBehaviour::homing},
    {"cyclic_position", ModeBehaviour::cyclic_position},
    {"cyclic_velocity", ModeBehaviour::cyclic_velocity},
    {"cyclic_torque", ModeBehaviour::cyclic_torque}};
const std::vector<std::pair<const char*, Bit12>> kBit12 = {
    {"none", Bit12::none},
    {"acknowledge", Bit12::acknowledge},
    {"zero_speed", Bit12::zero_speed},
    {"follows", Bit12::follows},
    {"homing_attained", Bit12::homing_attained}};
const std::vector<std::pair<const char*, Bit13>> kBit13 = {
    {"none", Bit13::none},
    {"following_error", Bit13::following_error},
    {"homing_error", Bit13::homing_error}};
const std::vector<std::pair<const char*, ConnectionLoss>> kConnectionLoss = {
    {"none", ConnectionLoss::none},
    {"fault", ConnectionLoss::fault},
    {"disable_voltage", ConnectionLoss::disable_voltage},
    {"quick_stop", ConnectionLoss::quick_stop}};
constexpr const char* kQuantities[] = {"none",   "position", "velocity", "acceleration",
                                       "torque", "current",  "time",     "motor_speed"};
static_assert(sizeof(kQuantities) / sizeof(kQuantities[0]) == kQuantityCount, "a name for each");

std::optional<std::int64_t> integerOf(const std::string& text) {
  std::int64_t value = 0;
  if (!YAML::convert<std::int64_t>::decode(YAML::Node(text), value)) return std::nullopt;
  return value;
}

void readUnits(Reader& reader, DriveDefinition& out) {
  for (std::size_t i = 1; i < kQuantityCount; ++i) {
    if (!reader.has(kQuantities[i])) continue;
    UnitScale& unit = out.units[i];
    if (reader.node(kQuantities[i]).IsScalar() &&
        reader.node(kQuantities[i]).Scalar() == "counts") {
      unit = {true, 1.0};
    } else {
      unit.per_count = false;
      reader.read(kQuantities[i], unit.factor, 1e-9, 1e12);
    }
  }
}

void readObjects(Reader& reader, DriveDefinition& out) {
  reader.each("objects", [&](const std::string& key, const YAML::Node& value) {
    const auto role = findRole(key);
    const auto object = value.IsScalar() ? fieldbus::parseObjectId(value.Scalar()) : std::nullopt;
    if (!role) return reader.problem("objects", "'" + key + "' is no role of an object");
    if (!object) return reader.problem("objects", key + ": must be an object like \"6041:00\"");
    out.objects[*role] = *object;
  });
  reader.each("encodings", [&](const std::string& key, const YAML::Node& value) {
    const auto object = fieldbus::parseObjectId(key);
    if (!object) return reader.problem("encodings", "'" + key + "' is no object like \"6071:00\"");
    const auto word = std::find_if(kEncodings.begin(), kEncodings.end(), [&](const auto& pair) {
      return value.IsScalar() && value.Scalar() == pair.first;
    });
    if (word == kEncodings.end()) return reader.problem("encodings", key + ": unknown encoding");
    out.encodings[*object] = word->second;
  });
}

void readNodeId(Reader& reader, DriveDefinition& out) {
  std::string text;
  reader.read("node_id", text);
  if (text.empty()) return;
  out.node_id = fieldbus::parseObjectId(text);
  if (!out.node_id) reader.problem("node_id", "must be an object like \"2003:01\"");
}

void readMotor(Reader& reader, MotorParameters& out) {
  reader.read("rated_acceleration", out.rated_acceleration, 1e-3, 1e6);
  reader.read("max_torque", out.max_torque, 0.01, 100.0);
  reader.read("max_speed", out.max_speed, 1e-3, 1e6);
  reader.read("friction", out.friction, 0.0, 10.0);
  reader.read("viscous_friction", out.viscous_friction, 0.0, 1e3);
}

std::optional<Role> readRole(Reader& reader, const std::string& key) {
  if (!reader.has(key)) return std::nullopt;
  std::string text;
  reader.read(key, text);
  const auto role = findRole(text);
  if (!role) reader.problem(key, "'" + text + "' is no role of an object");
  return role;
}

// What the standard gives bits 12 and 13 in a mode, unless the file says otherwise.
void applyStandardBits(ModeDefinition& mode) {
  switch (mode.behaviour) {
    case ModeBehaviour::profile_position:
      mode.bit_12 = Bit12::acknowledge;
      mode.bit_13 = Bit13::following_error;
      mode.velocity = Role::profile_velocity;
      break;
    case ModeBehaviour::profile_velocity:
      mode.bit_12 = Bit12::zero_speed;
      break;
    case ModeBehaviour::cyclic_position:
      mode.bit_12 = Bit12::follows;
      mode.bit_13 = Bit13::following_error;
      break;
    case ModeBehaviour::cyclic_velocity:
    case ModeBehaviour::cyclic_torque:
      mode.bit_12 = Bit12::follows;
      break;
    case ModeBehaviour::homing:
      mode.bit_12 = Bit12::homing_attained;
      mode.bit_13 = Bit13::homing_error;
      break;
    default:
      break;
  }
}

void readMode(const std::string& number, const YAML::Node& node, Reader& parent,
              DriveDefinition& out) {
  Reader reader(node, parent.pathOf("modes." + number), parent.problems());
  ModeDefinition mode;
  const auto value = integerOf(number);
  if (!value) parent.problem("modes", "'" + number + "' is no mode number");
  mode.number = value.value_or(0);
  if (!reader.has("behaviour")) reader.problem("behaviour", "is missing");
  reader.read("behaviour", mode.behaviour, kBehaviours);
  applyStandardBits(mode);
  reader.read("handshake", mode.handshake);
  reader.read("bit_12", mode.bit_12, kBit12);
  reader.read("bit_13", mode.bit_13, kBit13);
  reader.read("target_reached", mode.target_reached);
  if (reader.has("velocity") && reader.node("velocity").Scalar() == "none") {
    mode.velocity.reset();
  } else if (reader.has("velocity")) {
    mode.velocity = readRole(reader, "velocity");
  }
  mode.torque = readRole(reader, "torque");
  const auto known = std::find_if(out.modes.begin(), out.modes.end(),
                                  [&](const auto& other) { return other.number == mode.number; });
  known == out.modes.end() ? out.modes.push_back(mode) : void(*known = mode);
}

void readOptionTable(Reader& parent, const std::string& key, OptionTable& out) {
  parent.section(key, [&](Reader& reader) {
    out.options.clear();
    reader.read("default", out.fallback, -32768, 32767);
    reader.each("values", [&](const std::string& number, const YAML::Node& node) {
      Reader row(node, reader.pathOf("values." + number), reader.problems());
      StopOption option;
      const auto value = integerOf(number);
      if (!value) reader.problem("values", "'" + number + "' is no option code");
      row.read("ramp", option.ramp, kRamps);
      row.read("hold", option.hold);
      out.options[value.value_or(0)] = option;
    });
  });
}

// CiA 402-2, tables of 605Ah to 605Eh.
void applyStandardOptions(DriveDefinition& out) {
  const StopOption coast{Ramp::coast, false};
  const StopOption slow{Ramp::slow_down, false};
  const StopOption quick{Ramp::quick_stop, false};
  const StopOption limit{Ramp::limit, false};
  out.quick_stop = {2,
                    {{0, coast},
                     {1, slow},
                     {2, quick},
                     {3, limit},
                     {4, limit},
                     {5, {Ramp::slow_down, true}},
                     {6, {Ramp::quick_stop, true}},
                     {7, {Ramp::limit, true}},
                     {8, {Ramp::limit, true}}}};
  out.shutdown = {0, {{0, coast}, {1, slow}}};
  out.disable_operation = {1, {{0, coast}, {1, slow}}};
  out.halt_option = {1, {{1, slow}, {2, quick}, {3, limit}, {4, limit}}};
  out.fault_reaction = {2, {{0, coast}, {1, slow}, {2, quick}, {3, limit}, {4, limit}}};
}

void readStateMachine(Reader& reader, DriveDefinition& out) {
  reader.read("initialisation", out.initialisation);
  reader.read("enable_in_one_step", out.enable_in_one_step);
  reader.read("direct_enable", out.direct_enable);
  reader.read("stores_while_enabled", out.stores_while_enabled);
  reader.read("mode_change_while_enabled", out.mode_change_while_enabled);
  reader.read("resume_quick_stop_while_moving", out.resume_quick_stop_while_moving);
  reader.read("halt", out.halt);
  reader.read("internal_limit_bit", out.internal_limit_bit);
  reader.read("warning_stops", out.warning_stops);
  reader.read("following_error_is_fault", out.following_error_is_fault);
  reader.read("limit_switch_is_fault", out.limit_switch_is_fault);
  reader.read("master_lost", out.master_lost, kConnectionLoss);
  reader.read("stops_outside_operational", out.stops_outside_operational);
  reader.read("interpolates_over_sync_period", out.follows_sync_period);
  readOptionTable(reader, "quick_stop", out.quick_stop);
  readOptionTable(reader, "shutdown", out.shutdown);
  readOptionTable(reader, "disable_operation", out.disable_operation);
  readOptionTable(reader, "halt_option", out.halt_option);
  readOptionTable(reader, "fault_reaction", out.fault_reaction);
  if (!reader.has("locked_while_enabled")) return;
  out.locked_while_enabled.clear();
  for (const YAML::Node& item : reader.node("locked_while_enabled")) {
    const auto object = item.IsScalar() ? fieldbus::parseObjectId(item.Scalar()) : std::nullopt;
    if (object)
      out.locked_while_enabled.push_back(*object);
    else
      reader.problem("locked_while_enabled", "must be a list of objects like \"6083:00\"");
  }
}

void readHoming(Reader& reader, DriveDefinition& out) {
  reader.read<bool>("home_offset", out.home_offset_is_zero_shift,
                    {{"position_at_home", false}, {"shift_of_zero", true}});
  reader.read("returns_to_home", out.homing_returns);
  if (!reader.has("methods")) return;
  out.homing_methods.clear();
  for (const YAML::Node& item : reader.node("methods")) {
    const auto number = item.IsScalar() ? integerOf(item.Scalar()) : std::nullopt;
    if (number && findHomingMethod(*number) != nullptr)
      out.homing_methods.push_back(*number);
    else
      reader.problem("methods", "must be a list of methods 1..14, 17..30, 33, 34, 35, 37");
  }
}

void readFault(const std::string& name, const YAML::Node& node, Reader& parent,
               DriveDefinition& out) {
  Reader reader(node, parent.pathOf("faults." + name), parent.problems());
  FaultDefinition fault;
  fault.name = name;
  std::int64_t number = 0;
  if (!reader.has("code")) reader.problem("code", "is missing");
  reader.read("code", number, 1, 0xFFFF);
  fault.code = static_cast<std::uint16_t>(number);
  number = fault.error_register;
  reader.read("register", number, 0, 0xFF);
  fault.error_register = static_cast<std::uint8_t>(number);
  if (reader.has("vendor")) {
    const YAML::Node bytes = reader.node("vendor");
    for (std::size_t i = 0; bytes.IsSequence() && i < std::min<std::size_t>(5, bytes.size()); ++i) {
      const auto byte = integerOf(bytes[i].IsScalar() ? bytes[i].Scalar() : "");
      if (byte && *byte >= 0 && *byte <= 255)
        fault.vendor[i] = static_cast<std::uint8_t>(*byte);
      else
        reader.problem("vendor", "must be a list of up to five bytes");
    }
  }
  reader.read("resettable", fault.resettable);
  reader.read("warning", fault.warning);
  reader.read("voltage_lost", fault.voltage_lost);
  double seconds = 0.0;
  reader.read("persists_for", seconds, 0.0, kForeverS);
  fault.persists = fromSeconds(seconds);
  Ramp reaction = Ramp::coast;
  if (reader.has("reaction")) {
    reader.read("reaction", reaction, kRamps);
    fault.reaction = reaction;
  }
  const auto known = std::find_if(out.faults.begin(), out.faults.end(),
                                  [&](const auto& other) { return other.name == name; });
  known == out.faults.end() ? out.faults.push_back(fault) : void(*known = fault);
}

// Objects of the drive that the file extends, if any, go and come one by one.
void readDictionary(Reader& reader, bool extends, DriveDefinition& out) {
  if (reader.has("without")) {
    for (const YAML::Node& item : reader.node("without")) {
      const auto index = item.IsScalar() ? integerOf(item.Scalar()) : std::nullopt;
      if (!index || *index < 0 || *index > 0xFFFF ||
          !out.dictionary.remove(static_cast<std::uint16_t>(*index))) {
        reader.problem("without",
                       "must be a list of objects of the drive that is extended, "
                       "such as 0x1017");
      }
    }
  }
  if (!reader.has("dictionary")) {
    if (!extends) reader.problem("dictionary", "is missing: the list of the drive's objects");
    return;
  }
  auto dictionary = DictionaryTemplate::parse(reader.node("dictionary"));
  if (dictionary.ok())
    out.dictionary.add(dictionary.value());
  else
    reader.problem("dictionary", dictionary.error().message);
}

void readDefinition(Reader& reader, bool extends, DriveDefinition& out) {
  std::string description;
  reader.read("name", out.name);
  reader.read("description", description);
  readDictionary(reader, extends, out);
  if (!extends) applyStandardOptions(out);
  reader.section("communication", [&](Reader& r) { readCommunication(r, out.communication); });
  reader.section("units", [&](Reader& r) { readUnits(r, out); });
  reader.read("encoding", out.encoding, kEncodings);
  readObjects(reader, out);
  reader.section("motor", [&](Reader& r) { readMotor(r, out.motor); });
  reader.read<bool>("encoder", out.absolute_encoder, {{"absolute", true}, {"incremental", false}});
  reader.read("positions_wrap", out.positions_wrap);
  reader.each("modes", [&](const std::string& number, const YAML::Node& node) {
    readMode(number, node, reader, out);
  });
  readNodeId(reader, out);
  reader.section("state_machine", [&](Reader& r) { readStateMachine(r, out); });
  reader.section("quirks", [&](Reader& r) { readQuirks(r, out.quirks); });
  reader.section("homing", [&](Reader& r) { readHoming(r, out); });
  reader.section("float_traps", [&](Reader& r) {
    r.read("non_finite", out.traps_non_finite);
    r.read("negative_zero", out.traps_negative_zero);
  });
  reader.each("faults", [&](const std::string& name, const YAML::Node& node) {
    readFault(name, node, reader, out);
  });
}

// The drive that the file extends lies beside it.
void readFile(const std::string& path, int depth, DriveDefinition& out, ProblemTexts& problems) {
  try {
    const YAML::Node file = yaml::parseFile(path);
    Reader reader(file, "", problems);
    std::string base;
    reader.read("extends", base);
    if (!base.empty() && depth == kDeepestExtension) {
      return reader.problem("extends", "is too deep: do the files extend each other?");
    }
    if (!base.empty()) {
      ProblemTexts of_base;
      readFile(path.substr(0, path.rfind('/') + 1) + base + ".yaml", depth + 1, out, of_base);
      for (const std::string& problem : of_base) reader.problem("extends", base + ": " + problem);
    }
    readDefinition(reader, !base.empty(), out);
  } catch (const YAML::Exception& error) {
    problems.push_back(path + ": " + error.what());
  }
}

}  // namespace

const FaultDefinition* DriveDefinition::fault(const std::string& fault_name) const {
  const auto found = std::find_if(faults.begin(), faults.end(),
                                  [&](const FaultDefinition& f) { return f.name == fault_name; });
  return found == faults.end() ? nullptr : &*found;
}

const ModeDefinition* DriveDefinition::mode(std::int64_t number) const {
  const auto found = std::find_if(modes.begin(), modes.end(),
                                  [number](const ModeDefinition& m) { return m.number == number; });
  return found == modes.end() ? nullptr : &*found;
}

Result<std::shared_ptr<const DriveDefinition>> loadDriveDefinition(const std::string& path,
                                                                   const YAML::Node& changes) {
  ProblemTexts problems;
  auto definition = std::make_shared<DriveDefinition>();
  readFile(path, 0, *definition, problems);
  if (problems.empty() && changes.IsMap()) {
    Reader reader(changes, "with", problems);
    readDefinition(reader, true, *definition);
  }
  if (problems.empty()) return std::shared_ptr<const DriveDefinition>(std::move(definition));
  std::string text = path + ": the simulated drive's definition has problems:";
  for (const std::string& problem : problems) text += "\n  " + problem;
  return Error{text};
}

Result<std::shared_ptr<const DriveDefinition>> loadDriveDefinition(const std::string& path) {
  return loadDriveDefinition(path, YAML::Node());
}

}  // namespace cia402::sim
