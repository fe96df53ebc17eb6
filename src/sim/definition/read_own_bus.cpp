// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_own_bus.h"

#include <string>
#include <utility>
#include <vector>

#include "sim/dictionary/axis_objects.h"

namespace cia402::sim {
namespace {

/// @return nothing for what is neither an object nor a stretch.
std::vector<fieldbus::ObjectId> parseStretch(const std::string& text) {
  std::vector<fieldbus::ObjectId> objects;
  const std::size_t dash = text.find('-');
  const auto first = fieldbus::parseObjectId(text.substr(0, dash));
  if (!first) return objects;
  auto last = first;
  if (dash != std::string::npos) {
    last = fieldbus::parseObjectId(text.substr(0, text.find(':')) + ":" + text.substr(dash + 1));
  }
  if (!last) return objects;
  for (unsigned sub = first->subindex; sub <= last->subindex; ++sub) {
    objects.push_back({first->index, static_cast<std::uint8_t>(sub)});
  }
  return objects;
}

void readObject(DefinitionReader& reader, const char* key, std::optional<fieldbus::ObjectId>& out) {
  std::string text;
  reader.read(key, text);
  if (text.empty()) return;
  out = fieldbus::parseObjectId(text);
  if (!out) reader.problem(key, "must be an object like \"2003:01\"");
}

}  // namespace

void readMakerStates(DefinitionReader& reader, MakerStates& out) {
  readObject(reader, "object", out.object);
  const std::pair<const char*, std::int64_t*> numbers[] = {{"not_ready", &out.not_ready},
                                                           {"ready", &out.ready},
                                                           {"running", &out.running},
                                                           {"fault", &out.fault}};
  for (const auto& [key, number] : numbers) reader.read(key, *number, 0, 0xFFFF);
}

void readOwnBus(DefinitionReader& reader, OwnBusDefinition& out) {
  readObject(reader, "node_id", out.node_id);
  readObject(reader, "bit_rate", out.bit_rate);
  reader.read("at_once", out.at_once);
  reader.each("rates", [&](const std::string& key, const yaml::Value& value) {
    const auto number = yaml::parseInteger(key);
    const auto rate = value.integer(1, 1'000'000);
    if (!number || *number < 0) reader.problem("rates", "'" + key + "' is no number of the object");
    if (number && *number >= 0 && rate) {
      out.rates[static_cast<std::uint64_t>(*number)] = static_cast<std::uint32_t>(*rate);
    }
  });
  if (out.bit_rate && out.rates.empty()) {
    reader.problem("rates", "is missing: the numbers of `bit_rate`, each with its bit/s");
  }
}

void readEffects(DefinitionReader& reader, Effects& out) {
  for (const auto& [key, effect] : {std::pair("power", Effect::power), {"stop", Effect::stop}}) {
    reader.list(key, [&, effect = effect, key = key](const yaml::Value& value) {
      const auto text = value.text();
      const auto objects = text ? parseStretch(*text) : std::vector<fieldbus::ObjectId>();
      if (text && objects.empty()) {
        reader.problem(key, "'" + *text + "' is no object like \"2003:01\", nor \"2003:01-0C\"");
      }
      if (!objects.empty() && objects.back().index >= kFirstAxisObject) {
        reader.problem(key, "'" + *text + "' is an object of an axis, which counts at once");
      }
      for (const fieldbus::ObjectId id : objects) out[id] = effect;
    });
  }
}

}  // namespace cia402::sim
