// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/dictionary/macros.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "sim/device/cob_id.h"
#include "sim/device/pdo_parameters.h"
#include "sim/dictionary/value.h"

namespace cia402::sim {

namespace {

constexpr std::int64_t kMaxPdos = 512;
constexpr std::int64_t kMaxMapped = 64;

bool checkKeys(DictionaryReader& reader, const YAML::Node& macro,
               std::initializer_list<const char*> known) {
  bool sound = true;
  for (const auto& item : macro) {
    const std::string key = textOf(item.first);
    const auto same = [&](const char* name) { return key == name; };
    if (std::any_of(known.begin(), known.end(), same)) continue;
    reader.problem(item.first, "unknown key '" + key + "'");
    sound = false;
  }
  return sound;
}

// An integer key in a range; `missing` where the key is absent (needed if `missing` is negative).
bool readCount(DictionaryReader& reader, const YAML::Node& macro, const char* key,
               std::int64_t missing, std::int64_t highest, std::int64_t& count) {
  count = missing;
  const YAML::Node node = macro[key];
  if (!node && missing >= 0) return true;
  const auto value = node ? parseInteger(node) : std::nullopt;
  if (value && *value >= 0 && *value <= highest) {
    count = *value;
    return true;
  }
  reader.problem(node ? node : macro, std::string("'") + key + "' must be a number from 0 to " +
                                          std::to_string(highest));
  return false;
}

// The value of a key for the PDO or entry at `place`: the key's one value, or that of its list.
YAML::Node pick(const YAML::Node& macro, const char* key, std::size_t place) {
  const YAML::Node node = macro[key];
  return node && node.IsSequence() ? node[place] : node;
}

bool checkListSizes(DictionaryReader& reader, const YAML::Node& macro,
                    std::initializer_list<const char*> keys, std::int64_t count) {
  bool sound = true;
  for (const char* key : keys) {
    const YAML::Node node = macro[key];
    if (!node || !node.IsSequence() || node.size() == static_cast<std::size_t>(count)) continue;
    reader.problem(node, std::string("'") + key + "' needs " + std::to_string(count) +
                             " values, one for each, or a single value for all");
    sound = false;
  }
  return sound;
}

Entry plainEntry(std::uint16_t index, std::uint8_t subindex, const char* name, DataType type,
                 Access access, std::uint64_t number) {
  Entry entry;
  entry.id = {index, subindex};
  entry.name = name;
  entry.type = type;
  entry.access = access;
  entry.number = number;
  return entry;
}

struct PdoMacro {
  DictionaryReader& reader;
  const YAML::Node& macro;
  bool receive;
  std::int64_t entries = 8;
  std::uint16_t first = 0;  ///< number of the first one, counted from 0

  void addCobId(std::uint16_t index, std::uint16_t place) const;
  void addParameter(std::uint16_t index, std::uint16_t place, std::uint8_t sub, const char* name,
                    const char* key, DataType type) const;
  void addCommunication(std::uint16_t place) const;
  void addMapping(std::uint16_t place) const;
};

bool flag(DictionaryReader& reader, const YAML::Node& node, bool missing) {
  if (!node) return missing;
  bool value = missing;
  if (!YAML::convert<bool>::decode(node, value)) {
    reader.problem(node, "expected true or false, not '" + textOf(node) + "'");
  }
  return value;
}

// The predefined connection set knows the COB-IDs of the first four PDOs (CiA 301, 7.3.5).
void PdoMacro::addCobId(std::uint16_t index, std::uint16_t place) const {
  Entry entry = plainEntry(index, pdo_sub::kCobId, "cob_id", DataType::uint32, Access::rw, 0);
  const unsigned number = first + place;
  bool add_node_id = number < 4;
  bool valid = number < 4;
  if (add_node_id) entry.number = (receive ? 0x200U : 0x180U) + 0x100U * number;
  if (const YAML::Node node = pick(macro, "cob_ids", place)) {
    if (!reader.readDefault(node, entry, add_node_id)) return;
    valid = true;
  }
  valid = flag(reader, pick(macro, "valid", place), valid) && valid;
  if (!valid) entry.number |= kCobIdInvalid;
  if (!receive && !flag(reader, pick(macro, "rtr", place), true)) entry.number |= kCobIdNoRtr;
  reader.add(macro, std::move(entry), add_node_id);
}

void PdoMacro::addParameter(std::uint16_t index, std::uint16_t place, std::uint8_t sub,
                            const char* name, const char* key, DataType type) const {
  Entry entry = plainEntry(index, sub, name, type, Access::rw, 0);
  const YAML::Node node = pick(macro, key, place);
  if (!node && sub != pdo_sub::kType) return;
  if (!node) entry.number = 255;
  bool add_node_id = false;
  if (node && !reader.readDefault(node, entry, add_node_id)) return;
  reader.add(macro, std::move(entry), add_node_id);
}

void PdoMacro::addCommunication(std::uint16_t place) const {
  const auto index = static_cast<std::uint16_t>((receive ? 0x1400U : 0x1800U) + first + place);
  std::uint64_t highest = 2;
  if (macro["inhibit_times"]) highest = 3;
  if (macro["event_timers"]) highest = 5;
  if (macro["sync_starts"]) highest = 6;
  reader.add(macro,
             plainEntry(index, 0, "highest_subindex", DataType::uint8, Access::constant, highest),
             false);
  addCobId(index, place);
  addParameter(index, place, pdo_sub::kType, "transmission_type", "types", DataType::uint8);
  addParameter(index, place, pdo_sub::kInhibitTime, "inhibit_time", "inhibit_times",
               DataType::uint16);
  addParameter(index, place, pdo_sub::kEventTimer, "event_timer", "event_timers", DataType::uint16);
  addParameter(index, place, pdo_sub::kSyncStart, "sync_start_value", "sync_starts",
               DataType::uint8);
}

void PdoMacro::addMapping(std::uint16_t place) const {
  const auto index = static_cast<std::uint16_t>((receive ? 0x1600U : 0x1A00U) + first + place);
  const YAML::Node maps = macro["maps"];
  const YAML::Node map = maps && place < maps.size() ? maps[place] : YAML::Node();
  if (map.IsDefined() && !map.IsNull() && !map.IsSequence()) {
    return reader.problem(map, "a map is a list of values such as 0x60410010");
  }
  const std::size_t mapped = map.IsSequence() ? map.size() : 0;
  if (mapped > static_cast<std::size_t>(entries)) {
    return reader.problem(map, "more objects than 'entries' allows");
  }
  reader.add(macro, plainEntry(index, 0, "mapped_objects", DataType::uint8, Access::rw, mapped),
             false);
  for (std::size_t i = 0; i < static_cast<std::size_t>(entries); ++i) {
    Entry entry = plainEntry(index, static_cast<std::uint8_t>(i + 1), "mapped_object",
                             DataType::uint32, Access::rw, 0);
    bool add_node_id = false;
    if (i < mapped && !reader.readDefault(map[i], entry, add_node_id)) continue;
    reader.add(macro, std::move(entry), add_node_id);
  }
}

}  // namespace

void readArrayMacro(DictionaryReader& reader, const YAML::Node& macro) {
  bool sound = checkKeys(reader, macro,
                         {"index", "name", "count", "type", "access", "pdo", "default", "low",
                          "high", "count_access", "count_default"});
  Entry entry;
  std::int64_t count = 0;
  sound = readCount(reader, macro, "count", -1, 0xFE, count) && sound;
  for (const char* key : {"index", "type"}) {
    if (macro[key]) continue;
    reader.problem(macro, std::string("'") + key + "' is missing");
    sound = false;
  }
  if (!sound || !checkListSizes(reader, macro, {"default"}, count)) return;
  sound = reader.readIndex(macro["index"], entry.id.index);
  sound = reader.readType(macro["type"], entry.type) && sound;
  if (macro["access"]) sound = reader.readAccess(macro["access"], entry.access) && sound;
  if (macro["pdo"]) sound = reader.readPdo(macro["pdo"], entry) && sound;
  if (macro["low"]) sound = reader.readLimit(macro["low"], entry.type, entry.low) && sound;
  if (macro["high"]) sound = reader.readLimit(macro["high"], entry.type, entry.high) && sound;
  if (macro["name"]) entry.name = textOf(macro["name"]);

  Entry first = plainEntry(entry.id.index, 0, "highest_subindex", DataType::uint8, Access::constant,
                           static_cast<std::uint64_t>(count));
  if (macro["count_access"])
    sound = reader.readAccess(macro["count_access"], first.access) && sound;
  bool add_node_id = false;
  if (const YAML::Node node = macro["count_default"]) {
    sound = reader.readDefault(node, first, add_node_id) && sound;
  }
  if (!sound) return;
  reader.add(macro, std::move(first), add_node_id);
  for (std::int64_t place = 0; place < count; ++place) {
    Entry item = entry;
    item.id.subindex = static_cast<std::uint8_t>(place + 1);
    add_node_id = false;
    const YAML::Node node = pick(macro, "default", static_cast<std::size_t>(place));
    if (node && !reader.readDefault(node, item, add_node_id)) return;
    reader.add(macro, std::move(item), add_node_id);
  }
}

void readPdoMacro(DictionaryReader& reader, const YAML::Node& macro, bool receive) {
  bool sound = receive ? checkKeys(reader, macro,
                                   {"first", "count", "cob_ids", "valid", "types", "event_timers",
                                    "entries", "maps"})
                       : checkKeys(reader, macro,
                                   {"first", "count", "cob_ids", "valid", "types", "inhibit_times",
                                    "event_timers", "sync_starts", "rtr", "entries", "maps"});
  PdoMacro pdo{reader, macro, receive};
  std::int64_t count = 0;
  std::int64_t first = 1;
  sound = readCount(reader, macro, "first", 1, kMaxPdos, first) && sound;
  if (first == 0) {
    reader.problem(macro["first"], "'first' is the number of a PDO, from 1 on");
    sound = false;
  }
  sound = readCount(reader, macro, "count", -1, kMaxPdos - std::max<std::int64_t>(first - 1, 0),
                    count) &&
          sound;
  pdo.first = static_cast<std::uint16_t>(std::max<std::int64_t>(first - 1, 0));
  sound = readCount(reader, macro, "entries", 8, kMaxMapped, pdo.entries) && sound;
  if (const YAML::Node maps = macro["maps"]) {
    if (!maps.IsSequence() || maps.size() > static_cast<std::size_t>(count)) {
      reader.problem(maps, "'maps' is a list with at most one list for each PDO");
      sound = false;
    }
  }
  if (!sound) return;
  if (!checkListSizes(
          reader, macro,
          {"cob_ids", "valid", "types", "inhibit_times", "event_timers", "sync_starts", "rtr"},
          count)) {
    return;
  }
  for (std::int64_t place = 0; place < count; ++place) {
    pdo.addCommunication(static_cast<std::uint16_t>(place));
    pdo.addMapping(static_cast<std::uint16_t>(place));
  }
}

}  // namespace cia402::sim
