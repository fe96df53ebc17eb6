// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Reads the file of a simulated drive (docs/simulated_drives.md).
#include <yaml-cpp/yaml.h>

#include "sim/definition/drive_definition.h"
#include "sim/definition/read_absolute_encoder.h"
#include "sim/definition/read_communication.h"
#include "sim/definition/read_faults.h"
#include "sim/definition/read_homing.h"
#include "sim/definition/read_modes.h"
#include "sim/definition/read_objects.h"
#include "sim/definition/read_own_bus.h"
#include "sim/definition/read_quirks.h"
#include "sim/definition/read_state_machine.h"
#include "sim/definition/read_terminals.h"
#include "sim/definition/reader.h"
#include "sim/dictionary/axis_objects.h"
#include "yaml/reader.h"

namespace cia402::sim {
namespace {

constexpr int kDeepestExtension = 4;

void readMotor(DefinitionReader& reader, MotorParameters& out) {
  reader.read("rated_acceleration", out.rated_acceleration, 1e-3, 1e6);
  reader.read("max_torque", out.max_torque, 0.01, 100.0);
  reader.read("max_speed", out.max_speed, 1e-3, 1e6);
  reader.read("friction", out.friction, 0.0, 10.0);
  reader.read("viscous_friction", out.viscous_friction, 0.0, 1e3);
  reader.read("dynamic_brake", out.dynamic_brake, 0.0, 100.0);
}

void readMotors(DefinitionReader& reader, DriveDefinition& out) {
  for (MotorParameters& motor : out.motors) {
    reader.section("motor", [&](DefinitionReader& r) { readMotor(r, motor); });
  }
}

/// A number of axes that are alike, or a list of what their motors differ in.
void readAxes(DefinitionReader& reader, DriveDefinition& out) {
  if (!reader.has("axes")) return;
  const YAML::Node list = reader.node("axes");
  auto count = static_cast<std::int64_t>(list.IsSequence() ? list.size() : 0);
  if (!list.IsSequence()) reader.read("axes", count, 1, kMostAxes);
  if (count < 1 || count > kMostAxes) {
    return reader.problem("axes", "must be a number of axes from 1 to 8 or a list of them");
  }
  out.motors.resize(static_cast<std::size_t>(count), out.motors.front());
  if (!list.IsSequence()) return;
  auto motor = out.motors.begin();
  reader.list("axes", [&](const yaml::Value& element) {
    DefinitionReader axis(element);
    axis.section("motor", [&](DefinitionReader& r) { readMotor(r, *motor); });
    ++motor;
  });
}

/// What means something to one axis must be there for each.
void checkAxes(DefinitionReader& reader, const DriveDefinition& definition) {
  if (definition.axisCount() == 1) return;
  for (const auto& [role, object] : definition.objects) {
    if (!(ofAxis(object, 1) == object)) continue;
    reader.problem("objects", std::string(roleInfo(role).name) +
                                  ": a drive with several axes must have it in 6000h to 67FFh");
  }
}

void readDefinition(DefinitionReader& reader, bool extends, DriveDefinition& out) {
  std::string description;
  reader.read("name", out.name);
  reader.read("description", description);
  readDictionary(reader, extends, out);
  if (!extends) applyStandardOptions(out);
  reader.section("communication",
                 [&](DefinitionReader& r) { readCommunication(r, out.communication); });
  reader.section("units", [&](DefinitionReader& r) { readUnits(r, out); });
  reader.section("units_of", [&](DefinitionReader& r) { readUnitsOf(r, out); });
  readEncoding(reader, out);
  readObjects(reader, out);
  reader.section("polarity", [&](DefinitionReader& r) { readPolarity(r, out); });
  readMotors(reader, out);
  readAxes(reader, out);
  reader.read<bool>("encoder", out.absolute_encoder, {{"absolute", true}, {"incremental", false}});
  reader.read("positions_wrap", out.positions_wrap);
  reader.each("modes", [&](const std::string& number, const yaml::Value& value) {
    readMode(number, value, reader, out);
  });
  reader.section("own_bus", [&](DefinitionReader& r) { readOwnBus(r, out.own.bus); });
  reader.section("effective", [&](DefinitionReader& r) { readEffects(r, out.own.effects); });
  readClamped(reader, out.dictionary, out.own.clamped);
  reader.section("maker_states", [&](DefinitionReader& r) { readMakerStates(r, out.own.states); });
  readMonitors(reader, out.own.monitors);
  readAtAlarm(reader, out.own.monitors);
  reader.section("counters", [&](DefinitionReader& r) { readCounters(r, out.own.monitors); });
  reader.read("full_pulse_width", out.own.full_pulse_width, 0.0, 1000.0);
  reader.section("memory", [&](DefinitionReader& r) { readMemory(r, out.memory); });
  reader.section("state_machine", [&](DefinitionReader& r) { readStateMachine(r, out); });
  reader.section("s_curve", [&](DefinitionReader& r) {
    r.read("number", out.s_curve.number, -32768, 32767);
    r.read("time", out.s_curve.time, 0.0, 10.0);
  });
  reader.section("quirks", [&](DefinitionReader& r) { readQuirks(r, out.quirks); });
  reader.section("homing", [&](DefinitionReader& r) { readHoming(r, out.homing); });
  reader.section("absolute_encoder",
                 [&](DefinitionReader& r) { readAbsoluteEncoder(r, out.absolute); });
  reader.section("terminals", [&](DefinitionReader& r) { readTerminals(r, out.terminals); });
  reader.section("touch_probe", [&](DefinitionReader& r) {
    r.read<ProbeForgets>("forgets", out.probe_forgets,
                         {{"disarmed", ProbeForgets::disarmed},
                          {"armed", ProbeForgets::armed},
                          {"never", ProbeForgets::never}});
  });
  reader.section("float_traps", [&](DefinitionReader& r) {
    r.read("non_finite", out.float_traps.non_finite);
    r.read("negative_zero", out.float_traps.negative_zero);
  });
  reader.each("faults", [&](const std::string& name, const yaml::Value& value) {
    readFault(name, value, out);
  });
  if (reader.has("fault_records")) out.fault_records.clear();
  reader.list("fault_records", [&](const yaml::Value& value) { readFaultRecord(value, out); });
  readOutputs(reader, out);
  reader.each("obstacles", [&](const std::string& name, const yaml::Value& value) {
    readObstacle(name, value, out);
  });
  checkAxes(reader, out);
}

std::string nameOf(const std::string& path) { return path.substr(path.rfind('/') + 1); }

// The drive that the file extends lies beside it.
void readFile(const std::string& path, int depth, DriveDefinition& out, Problems& problems) {
  try {
    const YAML::Node file = yaml::parseFile(path);
    DefinitionReader reader(yaml::Value(file, "", problems, nameOf(path)));
    std::string base;
    reader.read("extends", base);
    if (!base.empty() && depth == kDeepestExtension) {
      return reader.problem("extends", "is too deep: do the files extend each other?");
    }
    if (!base.empty()) {
      Problems of_base;
      readFile(path.substr(0, path.rfind('/') + 1) + base + ".yaml", depth + 1, out, of_base);
      for (const Problem& problem : of_base.list()) {
        reader.problem("extends", problem.path + ": " + problem.message);
      }
    }
    readDefinition(reader, !base.empty(), out);
  } catch (const YAML::Exception& error) {
    problems.add(path, error.what());
  }
}

}  // namespace

Result<std::shared_ptr<const DriveDefinition>> loadDriveDefinition(const std::string& path,
                                                                   const YAML::Node& changes) {
  Problems problems;
  auto definition = std::make_shared<DriveDefinition>();
  readFile(path, 0, *definition, problems);
  if (problems.empty() && changes.IsMap()) {
    DefinitionReader reader(yaml::Value(changes, "with", problems));
    readDefinition(reader, true, *definition);
  }
  if (problems.empty()) return std::shared_ptr<const DriveDefinition>(std::move(definition));
  std::string text = path + ": the simulated drive's definition has problems:\n" + problems.text();
  text.pop_back();  // the end of the last line
  return Error{text};
}

Result<std::shared_ptr<const DriveDefinition>> loadDriveDefinition(const std::string& path) {
  return loadDriveDefinition(path, YAML::Node());
}

}  // namespace cia402::sim
