// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/compact.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "canopen/eds/value.h"

namespace cia402::canopen {
namespace {

constexpr unsigned kPdos = 512;
constexpr unsigned kMappedObjects = 64;

DictionaryEntry pdoEntry(ObjectId id, std::string name, DataType type) {
  DictionaryEntry entry;
  entry.id = id;
  entry.name = std::move(name);
  entry.type = type;
  return entry;
}

void readCompactList(DictionaryObject& object, const EdsSection& section, char what,
                     EdsEntryReader& entries, EdsKeys& keys, EdsProblems& problems) {
  std::size_t found = 0;
  for (const auto& [position, key] : section.keys) {
    if (position == "nrofentries") continue;
    const auto subindex = parseEdsNumber(position);
    const auto entry = subindex && subindex->magnitude < 0xFF && !subindex->negative
                           ? object.entries.find(static_cast<std::uint8_t>(subindex->magnitude))
                           : object.entries.end();
    if (entry == object.entries.end()) {
      problems.error(key.line, quoteEds(key.name) + " in [" + section.name +
                                   "] is no sub-index of the object");
      continue;
    }
    if (key.value.empty()) continue;
    ++found;
    if (what == 'n') entry->second.name = key.value;
    if (what == 'd') entry->second.denotation = key.value;
    if (what == 'v') entry->second.value = entries.readValue(&key, entry->second.type);
  }
  const EdsKey* count = section.given("nrofentries");
  if (count == nullptr) {
    problems.warning(section.line, "[" + section.name + "] has no NrOfEntries");
  } else if (keys.numberOf(*count, 0xFF).value_or(found) != found) {
    problems.warning(count->line, "[" + section.name + "] has " + std::to_string(found) +
                                      (found == 1 ? " entry" : " entries") +
                                      ", not NrOfEntries=" + count->value);
  }
}

void addParameters(ObjectDictionary& dictionary, std::uint16_t index, unsigned pdo,
                   std::uint8_t subindices) {
  static constexpr struct {
    const char* name;
    DataType type;
  } kEntries[] = {{"COB-ID", DataType::uint32},       {"Transmission type", DataType::uint8},
                  {"Inhibit time", DataType::uint16}, {"Reserved", DataType::uint8},
                  {"Event timer", DataType::uint16},  {"SYNC start value", DataType::uint8}};
  if (dictionary.objects().count(index) != 0) return;
  DictionaryObject object;
  object.index = index;
  object.code = ObjectCode::record;
  object.name = std::string(index >= 0x1800 ? "TPDO" : "RPDO") + " communication parameter " +
                std::to_string(pdo + 1);
  std::uint8_t highest = 0;
  for (std::size_t i = 0; i < std::size(kEntries); ++i) {
    if ((unsigned{subindices} >> i & 1U) == 0) continue;
    highest = static_cast<std::uint8_t>(i + 1);
    object.entries[highest] = pdoEntry({index, highest}, kEntries[i].name, kEntries[i].type);
  }
  object.entries[0] = edsCountEntry(index, "Highest sub-index supported", highest);
  dictionary.set(std::move(object));
}

void addMapping(ObjectDictionary& dictionary, std::uint16_t index, unsigned pdo) {
  if (dictionary.objects().count(index) != 0) return;
  DictionaryObject object;
  object.index = index;
  object.code = ObjectCode::record;
  object.name = std::string(index >= 0x1A00 ? "TPDO" : "RPDO") + " mapping parameter " +
                std::to_string(pdo + 1);
  object.entries[0] = edsCountEntry(index, "Number of mapped objects", 0);
  object.entries[0].access = Access::rw;
  for (std::uint8_t i = 1; i <= kMappedObjects; ++i) {
    object.entries[i] =
        pdoEntry({index, i}, "Mapped object " + std::to_string(i), DataType::uint32);
  }
  dictionary.set(std::move(object));
}

// NrOfRXPDO and NrOfTXPDO count all PDOs; those that the file describes are taken off.
void addPdos(ObjectDictionary& dictionary, std::uint16_t parameters, std::uint16_t mappings,
             unsigned wanted, std::uint8_t subindices) {
  const auto& objects = dictionary.objects();
  const auto described = [&](unsigned n) {
    return objects.count(static_cast<std::uint16_t>(parameters + n)) != 0 ||
           objects.count(static_cast<std::uint16_t>(mappings + n)) != 0;
  };
  unsigned explicit_count = 0;
  for (unsigned n = 0; n < kPdos; ++n) explicit_count += described(n) ? 1 : 0;
  unsigned left = wanted - std::min(wanted, explicit_count);
  for (unsigned n = 0; n < kPdos; ++n) {
    if (!described(n) && left == 0) continue;
    if (!described(n)) --left;
    addParameters(dictionary, static_cast<std::uint16_t>(parameters + n), n, subindices);
    addMapping(dictionary, static_cast<std::uint16_t>(mappings + n), n);
  }
}

}  // namespace

DictionaryEntry edsCountEntry(std::uint16_t index, const char* name, std::uint8_t count) {
  DictionaryEntry entry;
  entry.id = {index, 0};
  entry.name = name;
  entry.type = DataType::uint8;
  entry.access = Access::ro;
  entry.default_value = ObjectValue{count};
  return entry;
}

void readEdsCompactLists(const EdsSections& sections, EdsEntryReader& entries, EdsKeys& keys,
                         EdsProblems& problems, ObjectDictionary& dictionary) {
  for (const auto& [key, section] : sections.compactLists()) {
    const auto object = dictionary.objects().find(key.first);
    if (object != dictionary.objects().end()) {
      readCompactList(object->second, *section, key.second, entries, keys, problems);
    } else {
      problems.error(section->line, "[" + section->name + "] belongs to no object");
    }
  }
}

void addEdsCompactPdos(const EdsInfo& info, ObjectDictionary& dictionary) {
  if (info.compact_pdo == 0) return;
  addPdos(dictionary, 0x1400, 0x1600, info.rpdo_count, info.compact_pdo);
  addPdos(dictionary, 0x1800, 0x1A00, info.tpdo_count, info.compact_pdo);
}

}  // namespace cia402::canopen
