// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/dictionary/template.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "common/text.h"
#include "sim/dictionary/axis_objects.h"
#include "sim/dictionary/macros.h"
#include "sim/dictionary/reader.h"
#include "sim/dictionary/value.h"

namespace cia402::sim {

namespace {

constexpr std::size_t kWithoutDefault = 6;
constexpr std::size_t kWithDefault = 7;
constexpr std::size_t kWithRange = 9;

}  // namespace

void DictionaryReader::problem(const YAML::Node& where, const std::string& what) {
  problems_.push_back("line " + std::to_string(where.Mark().line + 1) + ": " + what);
}

void DictionaryReader::add(const YAML::Node& where, Entry entry, bool add_node_id) {
  if (!seen_.insert(entry.id).second) {
    return problem(where, hexId(entry.id) + " is there twice");
  }
  checkEntry(where, entry, add_node_id);
  template_.rows_.push_back({std::move(entry), add_node_id});
}

void DictionaryReader::checkEntry(const YAML::Node& where, const Entry& entry, bool add_node_id) {
  if (entry.rpdo && entry.access != Access::rw && entry.access != Access::wo) {
    problem(where, hexId(entry.id) + " cannot be written and so not be mapped into an RPDO");
  }
  if (entry.tpdo && entry.access == Access::wo) {
    problem(where, hexId(entry.id) + " cannot be read and so not be mapped into a TPDO");
  }
  if (widthBits(entry.type) == 0 && (entry.rpdo || entry.tpdo)) {
    problem(where, hexId(entry.id) + " has no fixed length and cannot be mapped");
  }
  if (entry.low && entry.high && *entry.low > *entry.high) {
    problem(where, hexId(entry.id) + ": the lowest value is above the highest");
  } else if (!add_node_id && widthBits(entry.type) != 0 && !inRange(entry)) {
    problem(where, hexId(entry.id) + ": the default is outside the lowest and highest value");
  }
}

void DictionaryReader::readObject(const YAML::Node& row) {
  if (row.size() != kWithoutDefault && row.size() != kWithDefault && row.size() != kWithRange) {
    return problem(row,
                   "an object has 6, 7 or 9 fields (index, sub-index, name, type, access, PDO, "
                   "default, lowest, highest), here are " +
                       std::to_string(row.size()));
  }
  Entry entry;
  bool sound = readIndex(row[0], entry.id.index);
  sound = readSubindex(row[1], entry.id.subindex) && sound;
  entry.name = row[2].IsScalar() ? row[2].Scalar() : "";
  sound = readType(row[3], entry.type) && sound;
  sound = readAccess(row[4], entry.access) && sound;
  sound = readPdo(row[5], entry) && sound;
  bool add_node_id = false;
  if (sound && row.size() >= kWithDefault) sound = readDefault(row[6], entry, add_node_id);
  if (sound && row.size() == kWithRange) {
    sound = readLimit(row[7], entry.type, entry.low);
    sound = readLimit(row[8], entry.type, entry.high) && sound;
  }
  if (sound) add(row, std::move(entry), add_node_id);
}

void DictionaryReader::readItem(const YAML::Node& item) {
  if (item.IsSequence()) return readObject(item);
  if (!item.IsMap()) return problem(item, "expected an object [index, ...] or a macro");
  for (const auto& macro : item) {
    const std::string name = macro.first.as<std::string>("");
    if (!macro.second.IsMap()) {
      problem(macro.first, "macro '" + name + "' needs {key: value, ...}");
    } else if (name == "array") {
      readArrayMacro(*this, macro.second);
    } else if (name == "rpdos") {
      readPdoMacro(*this, macro.second, true);
    } else if (name == "tpdos") {
      readPdoMacro(*this, macro.second, false);
    } else {
      problem(macro.first, "unknown macro '" + name + "' (known: array, rpdos, tpdos)");
    }
  }
}

bool DictionaryReader::readIndex(const YAML::Node& node, std::uint16_t& index) {
  const auto value = parseInteger(node);
  if (!value || *value < 0 || *value > 0xFFFF) {
    problem(node, "an index is a number from 0x0000 to 0xFFFF, not '" + textOf(node) + "'");
    return false;
  }
  index = static_cast<std::uint16_t>(*value);
  return true;
}

bool DictionaryReader::readSubindex(const YAML::Node& node, std::uint8_t& subindex) {
  const auto value = parseInteger(node);
  if (!value || *value < 0 || *value > 0xFF) {
    problem(node, "a sub-index is a number from 0 to 0xFF, not '" + textOf(node) + "'");
    return false;
  }
  subindex = static_cast<std::uint8_t>(*value);
  return true;
}

bool DictionaryReader::readType(const YAML::Node& node, DataType& type) {
  const auto known = fieldbus::parseDataType(textOf(node));
  if (!known) {
    problem(node, "unknown type '" + textOf(node) +
                      "' (boolean, int8 to int64, uint8 to uint64, "
                      "real32, real64, visible_string, octet_string, domain)");
    return false;
  }
  type = *known;
  return true;
}

bool DictionaryReader::readAccess(const YAML::Node& node, Access& access) {
  const std::string text = textOf(node);
  if (text == "ro")
    access = Access::ro;
  else if (text == "wo")
    access = Access::wo;
  else if (text == "rw")
    access = Access::rw;
  else if (text == "const")
    access = Access::constant;
  else {
    problem(node, "access is ro, wo, rw or const, not '" + text + "'");
    return false;
  }
  return true;
}

bool DictionaryReader::readPdo(const YAML::Node& node, Entry& entry) {
  const std::string text = textOf(node);
  if (text != "-" && text != "r" && text != "t" && text != "rt" && text != "tr") {
    problem(node, "PDO is r, t, rt or -, not '" + text + "'");
    return false;
  }
  entry.rpdo = text.find('r') != std::string::npos;
  entry.tpdo = text.find('t') != std::string::npos;
  return true;
}

bool DictionaryReader::readDefault(const YAML::Node& node, Entry& entry, bool& add_node_id) {
  const Result<DefaultValue> value = parseDefault(node, entry.type);
  if (!value.ok()) {
    problem(node, hexId(entry.id) + ": " + value.error().message);
    return false;
  }
  entry.number = value->number;
  entry.bytes = value->bytes;
  add_node_id = value->add_node_id;
  return true;
}

bool DictionaryReader::readLimit(const YAML::Node& node, DataType type,
                                 std::optional<std::int64_t>& limit) {
  const auto value = parseInteger(node);
  if (!value || !fits(*value, type)) {
    problem(node, "a lowest or highest value is an integer that fits the type, not '" +
                      textOf(node) + "'");
    return false;
  }
  limit = *value;
  return true;
}

Result<DictionaryTemplate> DictionaryReader::finish() && {
  if (!problems_.empty()) return Error{joined(problems_, "\n")};
  return std::move(template_);
}

Result<DictionaryTemplate> DictionaryTemplate::parse(const YAML::Node& list) {
  DictionaryReader reader;
  if (!list.IsSequence()) {
    reader.problem(list, "an object dictionary is a list of objects and macros");
  } else {
    for (const auto& item : list) reader.readItem(item);
  }
  return std::move(reader).finish();
}

void DictionaryTemplate::add(const DictionaryTemplate& other) {
  rows_.insert(rows_.end(), other.rows_.begin(), other.rows_.end());
}

bool DictionaryTemplate::remove(std::uint16_t index) {
  const auto first = std::remove_if(
      rows_.begin(), rows_.end(), [index](const Row& row) { return row.entry.id.index == index; });
  const bool found = first != rows_.end();
  rows_.erase(first, rows_.end());
  return found;
}

std::vector<ObjectId> DictionaryTemplate::nodeIdObjects() const {
  std::vector<ObjectId> found;
  for (const Row& row : rows_) {
    if (row.add_node_id) found.push_back(row.entry.id);
  }
  return found;
}

ObjectDictionary DictionaryTemplate::build(canopen::NodeId node, unsigned axes) const {
  ObjectDictionary dictionary;
  for (unsigned axis = 1; axis < axes; ++axis) {
    for (const Row& row : rows_) {
      Entry entry = row.entry;
      entry.id = ofAxis(row.entry.id, axis);
      if (!(entry.id == row.entry.id)) dictionary.add(std::move(entry));
    }
  }
  for (const Row& row : rows_) {
    Entry entry = row.entry;
    if (row.add_node_id) entry.number += node;
    dictionary.add(std::move(entry));
  }
  return dictionary;
}

}  // namespace cia402::sim
