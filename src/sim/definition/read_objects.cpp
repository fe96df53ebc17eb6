// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_objects.h"

#include <algorithm>

#include "fieldbus/object.h"
#include "yaml/reader.h"

namespace cia402::sim {
namespace {

const std::vector<std::pair<const char*, Encoding>> kEncodings = {
    {"integer", Encoding::integer},
    {"float32", Encoding::float32},
    {"bfloat16", Encoding::bfloat16},
    {"scaled_unsigned", Encoding::scaled_unsigned},
    {"scaled_signed", Encoding::scaled_signed}};
constexpr const char* kQuantities[] = {"none",   "position", "velocity", "acceleration",
                                       "torque", "current",  "time",     "motor_speed"};
static_assert(sizeof(kQuantities) / sizeof(kQuantities[0]) == kQuantityCount, "a name for each");

const std::vector<std::pair<const char*, UnitScale::Per>> kPer = {
    {"counts", UnitScale::Per::count},
    {"encoder", UnitScale::Per::encoder},
    {"gear", UnitScale::Per::gear}};

/// A number, or the word for what of a turn it is.
void readUnit(DefinitionReader& reader, const std::string& key, UnitScale& out) {
  if (!reader.has(key)) return;
  const YAML::Node value = reader.node(key);
  const auto word = std::find_if(kPer.begin(), kPer.end(), [&](const auto& pair) {
    return value.IsScalar() && value.Scalar() == pair.first;
  });
  out = {word == kPer.end() ? UnitScale::Per::unit : word->second, 1.0};
  if (word == kPer.end()) reader.read(key, out.factor, 1e-9, 1e12);
}

}  // namespace

void readEncoding(DefinitionReader& reader, DriveDefinition& out) {
  reader.read("encoding", out.encoding, kEncodings);
}

void readUnits(DefinitionReader& reader, DriveDefinition& out) {
  for (std::size_t i = 1; i < kQuantityCount; ++i) readUnit(reader, kQuantities[i], out.units[i]);
}

void readPolarity(DefinitionReader& reader, DriveDefinition& out) {
  for (std::size_t i = 1; i < kQuantityCount; ++i) {
    if (!reader.has(kQuantities[i])) continue;
    std::int64_t bit = 0;
    reader.read(kQuantities[i], bit, 0, 31);
    out.polarity[i] = std::int64_t{1} << bit;
  }
}

void readUnitsOf(DefinitionReader& reader, DriveDefinition& out) {
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    const RoleInfo& info = roleInfo(static_cast<Role>(i));
    if (info.quantity == Quantity::none || !reader.has(info.name)) continue;
    readUnit(reader, info.name, out.units_of[info.role]);
  }
}

void readObjects(DefinitionReader& reader, DriveDefinition& out) {
  reader.each("objects", [&](const std::string& key, const yaml::Value& entry) {
    const YAML::Node& value = entry.node();
    const auto role = findRole(key);
    const auto object = value.IsScalar() ? fieldbus::parseObjectId(value.Scalar()) : std::nullopt;
    if (!role) return reader.problem("objects", "'" + key + "' is no role of an object");
    if (!object) return reader.problem("objects", key + ": must be an object like \"6041:00\"");
    out.objects[*role] = *object;
  });
  reader.each("encodings", [&](const std::string& key, const yaml::Value& entry) {
    const YAML::Node& value = entry.node();
    const auto object = fieldbus::parseObjectId(key);
    if (!object) return reader.problem("encodings", "'" + key + "' is no object like \"6071:00\"");
    const auto word = std::find_if(kEncodings.begin(), kEncodings.end(), [&](const auto& pair) {
      return value.IsScalar() && value.Scalar() == pair.first;
    });
    if (word == kEncodings.end()) return reader.problem("encodings", key + ": unknown encoding");
    out.encodings[*object] = word->second;
  });
}

void readMemory(DefinitionReader& reader, MemoryDefinition& out) {
  const auto one = [&](const char* key, std::optional<fieldbus::ObjectId>& object) {
    std::string text;
    reader.read(key, text);
    if (text.empty()) return;
    object = fieldbus::parseObjectId(text);
    if (!object) reader.problem(key, "must be an object like \"2003:01\"");
  };
  const auto numbers = [&](const char* key, std::map<fieldbus::ObjectId, std::int64_t>& objects) {
    reader.each(key, [&](const std::string& name, const yaml::Value& value) {
      const auto object = fieldbus::parseObjectId(name);
      const auto number = value.integer(0, 0xFFFFFFFF);
      if (!object) reader.problem(key, "'" + name + "' is no object like \"2003:01\"");
      if (object && number) objects[*object] = *number;
    });
  };
  one("keeps", out.keeps);
  numbers("reset", out.reset);
  numbers("factory", out.factory);
  numbers("silent_unless", out.silent_unless);
}

// Objects of the drive that the file extends, if any, go and come one by one.
void readDictionary(DefinitionReader& reader, bool extends, DriveDefinition& out) {
  if (reader.has("without")) {
    for (const YAML::Node& item : reader.node("without")) {
      const auto index = item.IsScalar() ? yaml::parseInteger(item.Scalar()) : std::nullopt;
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

}  // namespace cia402::sim
