// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/object_dictionary.h"

#include <utility>

namespace cia402::fieldbus {
namespace {

constexpr std::pair<std::uint16_t, DataType> kTypeCodes[] = {
    {0x0001, DataType::boolean},         {0x0002, DataType::int8},
    {0x0003, DataType::int16},           {0x0004, DataType::int32},
    {0x0005, DataType::uint8},           {0x0006, DataType::uint16},
    {0x0007, DataType::uint32},          {0x0008, DataType::real32},
    {0x0009, DataType::visible_string},  {0x000A, DataType::octet_string},
    {0x000B, DataType::unicode_string},  {0x000C, DataType::time_of_day},
    {0x000D, DataType::time_difference}, {0x000F, DataType::domain},
    {0x0010, DataType::int24},           {0x0011, DataType::real64},
    {0x0012, DataType::int40},           {0x0013, DataType::int48},
    {0x0014, DataType::int56},           {0x0015, DataType::int64},
    {0x0016, DataType::uint24},          {0x0018, DataType::uint40},
    {0x0019, DataType::uint48},          {0x001A, DataType::uint56},
    {0x001B, DataType::uint64},
};

constexpr std::size_t kMostCandidates = 4;

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

}  // namespace

const char* toString(ObjectCode code) {
  switch (code) {
    case ObjectCode::domain:
      return "DOMAIN";
    case ObjectCode::deftype:
      return "DEFTYPE";
    case ObjectCode::defstruct:
      return "DEFSTRUCT";
    case ObjectCode::variable:
      return "VAR";
    case ObjectCode::array:
      return "ARRAY";
    case ObjectCode::record:
      return "RECORD";
  }
  return "?";
}

const char* toString(Access access) {
  static constexpr const char* kWords[] = {"ro", "wo", "rw", "rwr", "rww", "const"};
  return kWords[static_cast<std::size_t>(access)];
}

std::uint16_t dataTypeCode(DataType type) {
  for (const auto& [code, candidate] : kTypeCodes) {
    if (candidate == type) return code;
  }
  return 0x000F;
}

std::optional<DataType> dataTypeOfCode(std::uint16_t code) {
  for (const auto& [candidate, type] : kTypeCodes) {
    if (candidate == code) return type;
  }
  return {};
}

std::string nameKey(std::string_view name) {
  std::string key;
  for (char c : name) {
    if (c == ' ' || c == '\t') continue;
    key += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return key;
}

DictionaryObject& ObjectDictionary::set(DictionaryObject object) {
  DictionaryObject& place = objects_[object.index];
  place = std::move(object);
  return place;
}

std::size_t ObjectDictionary::size() const {
  std::size_t count = 0;
  for (const auto& [index, object] : objects_) count += object.entries.size();
  return count;
}

const DictionaryEntry* ObjectDictionary::find(ObjectId id) const {
  const auto object = objects_.find(id.index);
  if (object == objects_.end()) return nullptr;
  const auto entry = object->second.entries.find(id.subindex);
  return entry == object->second.entries.end() ? nullptr : &entry->second;
}

Result<const DictionaryEntry*> ObjectDictionary::find(std::string_view name) const {
  const std::string key = nameKey(name);
  std::vector<const DictionaryEntry*> full, part;
  if (!key.empty()) {
    for (const auto& [index, object] : objects_) {
      const std::string prefix = nameKey(object.name) + "/";
      const bool single = object.code == ObjectCode::variable || object.code == ObjectCode::domain;
      for (const auto& [subindex, entry] : object.entries) {
        const std::string own = nameKey(entry.name);
        const bool same =
            own == key || (!entry.denotation.empty() && nameKey(entry.denotation) == key);
        if (single ? same : prefix + own == key) {
          full.push_back(&entry);
        } else if (same) {
          part.push_back(&entry);
        }
      }
    }
  }
  const auto& found = full.empty() ? part : full;
  if (found.size() == 1) return found.front();
  if (found.empty()) return Error{"there is no object " + quoted(name)};
  std::string candidates;
  for (std::size_t i = 0; i < found.size() && i < kMostCandidates; ++i) {
    candidates += (i == 0 ? "" : ", ") + toString(found[i]->id);
  }
  if (found.size() > kMostCandidates) candidates += ", ...";
  return Error{std::to_string(found.size()) + " objects are called " + quoted(name) + " (" +
               candidates + "); name it by its index"};
}

std::string ObjectDictionary::fullName(const DictionaryEntry& entry) const {
  const auto object = objects_.find(entry.id.index);
  if (object == objects_.end() || object->second.code == ObjectCode::variable ||
      object->second.code == ObjectCode::domain) {
    return entry.name;
  }
  return object->second.name + "/" + entry.name;
}

}  // namespace cia402::fieldbus
