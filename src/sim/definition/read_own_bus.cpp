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

/// @return nothing, and a problem, for what is neither an object nor a stretch.
std::vector<fieldbus::ObjectId> readStretch(DefinitionReader& reader, const char* key,
                                            const yaml::Value& value) {
  const auto text = value.text();
  if (!text) return {};
  auto objects = parseStretch(*text);
  if (objects.empty()) {
    reader.problem(key, "'" + *text + "' is no object like \"2003:01\", nor \"2003:01-0C\"");
  }
  return objects;
}

/// `bits`: the first and the last one.
void readBits(DefinitionReader& reader, MonitorDefinition& out) {
  std::vector<std::int64_t> ends;
  reader.list("bits",
              [&](const yaml::Value& value) { ends.push_back(value.integer(0, 63).value_or(0)); });
  if (ends.empty()) return;
  if (ends.size() != 2 || ends[0] > ends[1]) {
    return reader.problem("bits", "must be the first and the last one, like [16, 20]");
  }
  out.first_bit = static_cast<unsigned>(ends[0]);
  out.bits = static_cast<unsigned>(ends[1] - ends[0] + 1);
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
  for (const auto& [key, effect] :
       {std::pair("power", Effect::power), {"stop", Effect::stop}, {"never", Effect::never}}) {
    reader.list(key, [&, effect = effect, key = key](const yaml::Value& value) {
      const auto objects = readStretch(reader, key, value);
      const bool of_axis = !objects.empty() && objects.back().index >= kFirstAxisObject;
      if (of_axis && effect != Effect::never) {
        reader.problem(key,
                       "'" + *value.text() + "' is an object of an axis, which counts at once");
      }
      for (const fieldbus::ObjectId id : objects) out[id] = effect;
    });
  }
}

void readMonitors(DefinitionReader& reader, MonitorsDefinition& out) {
  using Shows = MonitorDefinition::Shows;
  static const std::vector<std::pair<const char*, Shows>> kShows = {
      {"speed", Shows::speed},    {"torque", Shows::torque}, {"load", Shows::load},
      {"angle", Shows::angle},    {"time", Shows::time},     {"total_time", Shows::total_time},
      {"outputs", Shows::outputs}};
  reader.each("monitors", [&](const std::string& key, const yaml::Value& value) {
    const auto id = fieldbus::parseObjectId(key);
    if (!id) return reader.problem("monitors", "'" + key + "' is no object like \"200B:1B\"");
    MonitorDefinition monitor;
    if (value.node().IsMap()) {
      DefinitionReader row(value);
      row.read("shows", monitor.shows, kShows);
      row.read("scale", monitor.scale, -1e9, 1e9);
      readObject(row, "object", monitor.object);
      readObject(row, "less", monitor.less);
      readObject(row, "periods", monitor.periods);
      if (monitor.object) monitor.shows = Shows::object;
      readBits(row, monitor);
    } else if (const std::string text = value.text().value_or(""); text.find(':') < text.size()) {
      monitor.shows = Shows::object;
      monitor.object = fieldbus::parseObjectId(text);
      if (!monitor.object) value.problem("must be a number, or an object like \"6064:00\"");
    } else {
      monitor.scale = value.number({-1e9, 1e9, false}).value_or(0.0);
    }
    out.shown[*id] = monitor;
  });
}

void readAtAlarm(DefinitionReader& reader, MonitorsDefinition& out) {
  reader.each("at_alarm", [&](const std::string& key, const yaml::Value& value) {
    const auto shows = fieldbus::parseObjectId(key);
    const auto shown = fieldbus::parseObjectId(value.text().value_or(""));
    if (!shows || !shown) {
      return reader.problem("at_alarm", "'" + key +
                                            "' and its value must be objects, like "
                                            "\"200B:26\": \"200B:01\"");
    }
    out.at_alarm.emplace_back(*shows, *shown);
  });
}

void readCounters(DefinitionReader& reader, MonitorsDefinition& out) {
  readObject(reader, "nmt_length", out.nmt_length);
  readObject(reader, "nmt_command", out.nmt_command);
  readObject(reader, "heartbeat_length", out.heartbeat_length);
}

void readClamped(DefinitionReader& reader, const DictionaryTemplate& dictionary,
                 std::vector<fieldbus::ObjectId>& out) {
  constexpr const char* kKey = "clamped";
  const ObjectDictionary built = dictionary.build(canopen::NodeId(1));
  reader.list(kKey, [&](const yaml::Value& value) {
    for (const fieldbus::ObjectId id : readStretch(reader, kKey, value)) {
      const Entry* entry = built.find(id);
      if (entry == nullptr || !(entry->low || entry->high)) {
        reader.problem(kKey, fieldbus::toString(id) + " is not in `dictionary` with a range");
      }
      out.push_back(id);
    }
  });
}

}  // namespace cia402::sim
