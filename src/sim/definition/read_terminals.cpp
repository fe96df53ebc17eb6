// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_terminals.h"

#include <iterator>
#include <string>
#include <utility>

#include "yaml/reader.h"

namespace cia402::sim {
namespace {

constexpr std::pair<const char*, InputFunction> kInputFunctions[] = {
    {"negative_limit", InputFunction::negative_limit},
    {"positive_limit", InputFunction::positive_limit},
    {"home_switch", InputFunction::home_switch},
    {"fault_reset", InputFunction::fault_reset},
    {"set_home", InputFunction::set_home},
    {"clear_history", InputFunction::clear_history},
    {"emergency_stop", InputFunction::emergency_stop},
    {"motor_enable", InputFunction::motor_enable},
    {"pause", InputFunction::pause},
    {"step", InputFunction::step}};

std::optional<fieldbus::ObjectId> terminalObjectOf(const yaml::Value& value) {
  const auto text = value.text();
  const auto object = text ? fieldbus::parseObjectId(*text) : std::nullopt;
  if (!object) value.problem("must be an object like \"2003:01\"");
  return object;
}

void readInputPairs(DefinitionReader& reader, const char* key, bool with_logic,
                    std::vector<TerminalsDefinition::Input>& out) {
  if (reader.has(key)) out.clear();
  reader.list(key, [&](const yaml::Value& item) {
    const std::vector<yaml::Value> pair = item.list();
    const bool fits = with_logic ? pair.size() == 2 || pair.size() == 3 : pair.size() == 1;
    if (!fits) {
      return item.problem(with_logic
                              ? "must be the objects of function and logic"
                              : "must be the object of the function, as there is `inversion`");
    }
    const auto function = terminalObjectOf(pair[0]);
    const auto logic = terminalObjectOf(pair[with_logic ? 1 : 0]);
    std::optional<fieldbus::ObjectId> is_output;
    if (pair.size() == 3) is_output = terminalObjectOf(pair[2]);
    if (function && logic) out.push_back({*function, *logic, is_output});
  });
}

void readTerminalObject(DefinitionReader& reader, const char* key,
                        std::optional<fieldbus::ObjectId>& out) {
  std::string text;
  if (!reader.has(key)) return;
  reader.read(key, text);
  out = fieldbus::parseObjectId(text);
  if (!out) reader.problem(key, "must be an object like \"2017:02\"");
}

constexpr std::pair<const char*, OutputFunction> kOutputFunctions[] = {
    {"alarm", OutputFunction::alarm},
    {"reached", OutputFunction::reached},
    {"holding", OutputFunction::holding},
    {"turning", OutputFunction::turning}};

}  // namespace

void readOutputs(DefinitionReader& reader, DriveDefinition& out) {
  reader.read("commanded_output", out.outputs.commanded, 0, 65535);
  std::int64_t first = out.outputs.first;
  reader.read("first_output", first, 0, 27);
  out.outputs.first = static_cast<unsigned>(first);
  if (reader.has("output_functions")) out.outputs.functions.clear();
  reader.section("output_functions", [&](DefinitionReader& functions) {
    for (const auto& [word, function] : kOutputFunctions) {
      std::int64_t number = 0;
      if (!functions.has(word)) continue;
      functions.read(word, number, 0, 65535);
      out.outputs.functions[number] = function;
    }
  });
}

void readTerminals(DefinitionReader& reader, TerminalsDefinition& out) {
  readTerminalObject(reader, "inversion", out.inversion);
  readInputPairs(reader, "inputs", !out.inversion, out.with_terminal);
  readInputPairs(reader, "virtual", true, out.without);
  readTerminalObject(reader, "virtual_levels", out.levels);
  readTerminalObject(reader, "virtual_enabled", out.enabled);
  readTerminalObject(reader, "virtual_seen", out.seen);
  std::int64_t first = out.first_bit;
  reader.read("first_bit", first, 0, 31);
  out.first_bit = static_cast<unsigned>(first);
  if (reader.has("bits")) out.bits.clear();
  reader.list("bits", [&](const yaml::Value& item) {
    out.bits.push_back(static_cast<unsigned>(item.integer(0, 31).value_or(0)));
  });
  if (reader.has("normally_closed")) out.normally_closed = 0;
  reader.list("normally_closed", [&](const yaml::Value& item) {
    out.normally_closed |= 1U << item.integer(0, 31).value_or(0);
  });
  reader.section("functions", [&](DefinitionReader& functions) {
    for (const auto& [word, function] : kInputFunctions) {
      std::int64_t number = 0;
      if (!functions.has(word)) continue;
      functions.read(word, number, 1, 65535);
      for (auto known = out.functions.begin(); known != out.functions.end();) {
        known = known->second == function ? out.functions.erase(known) : std::next(known);
      }
      out.functions[number] = function;
    }
  });
}

}  // namespace cia402::sim
