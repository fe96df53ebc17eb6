// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_faults.h"

#include <algorithm>

#include "sim/definition/read_state_machine.h"
#include "yaml/reader.h"

namespace cia402::sim {
namespace {

constexpr double kForeverS = 1e6;

std::optional<fieldbus::ObjectId> readObject(DefinitionReader& reader, const std::string& key) {
  std::string text;
  reader.read(key, text);
  const auto object = fieldbus::parseObjectId(text);
  if (!object) reader.problem(key, "must be an object like \"200E:01\"");
  return object;
}

/// A ramp, or by which object one is chosen.
void readReaction(DefinitionReader& reader, FaultDefinition& fault) {
  if (!reader.has("reaction")) return;
  if (!reader.node("reaction").IsMap()) {
    Ramp ramp = Ramp::coast;
    reader.read("reaction", ramp, rampWords());
    fault.reaction = ramp;
    return;
  }
  FaultDefinition::ReactionBy by;
  reader.section("reaction", [&](DefinitionReader& r) {
    by.object = readObject(r, "object").value_or(by.object);
    r.each("values", [&](const std::string& number, const yaml::Value& value) {
      const auto option = yaml::parseInteger(number);
      std::vector<std::string> words;
      for (const auto& word : rampWords()) words.emplace_back(word.first);
      const auto index = value.oneOf(words);
      if (!option) return value.problem("'" + number + "' is no number of the object");
      if (index) by.ramps[*option] = rampWords()[*index].second;
    });
  });
  fault.reaction_by = by;
}

}  // namespace

void readFault(const std::string& name, const yaml::Value& from, DriveDefinition& out) {
  DefinitionReader reader(from);
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
      const auto byte = yaml::parseInteger(bytes[i].IsScalar() ? bytes[i].Scalar() : "");
      if (byte && *byte >= 0 && *byte <= 255)
        fault.vendor[i] = static_cast<std::uint8_t>(*byte);
      else
        reader.problem("vendor", "must be a list of up to five bytes");
    }
  }
  reader.read("details", fault.details, 0, 0xFFFFFFFF);
  if (reader.has("word")) fault.word = readObject(reader, "word");
  reader.read("resettable", fault.resettable);
  if (reader.has("reset_by")) {
    fault.reset_by = readObject(reader, "reset_by");
    fault.resettable = false;
  }
  reader.read("warning", fault.warning);
  reader.read("holds", fault.holds);
  if (fault.holds && !fault.warning) reader.problem("holds", "is for warnings");
  reader.read("voltage_lost", fault.voltage_lost);
  reader.read("ends_by_itself", fault.ends_by_itself);
  double seconds = 0.0;
  reader.read("persists_for", seconds, 0.0, kForeverS);
  fault.persists = fromSeconds(seconds);
  readReaction(reader, fault);
  const auto known = std::find_if(out.faults.begin(), out.faults.end(),
                                  [&](const auto& other) { return other.name == name; });
  known == out.faults.end() ? out.faults.push_back(fault) : void(*known = fault);
}

void readFaultRecord(const yaml::Value& from, DriveDefinition& out) {
  DefinitionReader reader(from);
  FaultRecordObjects record;
  record.code = readObject(reader, "code").value_or(record.code);
  reader.each("copies", [&](const std::string& text, const yaml::Value& value) {
    const auto source = fieldbus::parseObjectId(text);
    const auto place = value.text();
    const auto target = place ? fieldbus::parseObjectId(*place) : std::nullopt;
    if (!source || !target) return value.problem("must be objects like \"6064:00\": \"200A:1E\"");
    record.copies[*source] = *target;
  });
  out.fault_records.push_back(record);
}

void readObstacle(const std::string& name, const yaml::Value& from, DriveDefinition& out) {
  DefinitionReader reader(from);
  ObstacleDefinition obstacle;
  obstacle.name = name;
  reader.read("voltage", obstacle.voltage);
  reader.read("remote", obstacle.remote);
  reader.read("reason", obstacle.reason, 0, 0xFFFFFFFF);
  std::int64_t inputs = 0;
  reader.read("inputs", inputs, 0, 0xFFFFFFFF);
  obstacle.inputs = static_cast<std::uint32_t>(inputs);
  out.obstacles.push_back(obstacle);
}

}  // namespace cia402::sim
