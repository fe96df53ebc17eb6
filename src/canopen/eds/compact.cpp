// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <utility>

#include "canopen/eds/reader.h"

// What CiA 306 lets a file leave out: sub-indices of an array that are all alike (CompactSubObj),
// and PDO parameters (CompactPDO).
namespace cia402::canopen {
namespace {

constexpr unsigned kPdos = 512;
constexpr unsigned kMappedObjects = 64;

DictionaryEntry countEntry(std::uint16_t index, const char* name, std::uint8_t count) {
  DictionaryEntry entry;
  entry.id = {index, 0};
  entry.name = name;
  entry.type = DataType::uint8;
  entry.access = Access::ro;
  entry.default_value = ObjectValue{count};
  return entry;
}

DictionaryEntry pdoEntry(ObjectId id, std::string name, DataType type) {
  DictionaryEntry entry;
  entry.id = id;
  entry.name = std::move(name);
  entry.type = type;
  return entry;
}

}  // namespace

void EdsReader::expandCompact(DictionaryObject& object, const EdsSection& section, unsigned count) {
  if (!hasRoom(section.line)) return;
  object.entries[0] = countEntry(object.index, "NrOfObjects", static_cast<std::uint8_t>(count));
  object.entries[0].line = section.line;
  const EdsKey* sub_number = section.given("subnumber");
  if (sub_number != nullptr && numberOf(*sub_number, 0xFFFF).value_or(0) != 0) {
    problems_.warning(sub_number->line,
                      "[" + section.name + "] has both SubNumber and CompactSubObj");
  }
  const DictionaryEntry model = readEntry(section, {object.index, 0}, ObjectCode::variable);
  for (unsigned i = 1; i <= count && hasRoom(section.line); ++i) {
    DictionaryEntry& entry = object.entries[static_cast<std::uint8_t>(i)];
    entry = model;
    entry.id.subindex = static_cast<std::uint8_t>(i);
    entry.name = object.name + std::to_string(i);
    entry.denotation.clear();
  }
}

void EdsReader::readCompactLists() {
  for (const auto& [key, section] : compact_lists_) {
    const auto object = eds_.dictionary.objects().find(key.first);
    if (object != eds_.dictionary.objects().end()) {
      readCompactList(object->second, *section, key.second);
    } else {
      problems_.error(section->line, "[" + section->name + "] belongs to no object");
    }
  }
}

void EdsReader::readCompactList(DictionaryObject& object, const EdsSection& section, char what) {
  std::size_t found = 0;
  for (const auto& [position, key] : section.keys) {
    if (position == "nrofentries") continue;
    const auto subindex = parseEdsNumber(position);
    const auto entry = subindex && subindex->magnitude < 0xFF && !subindex->negative
                           ? object.entries.find(static_cast<std::uint8_t>(subindex->magnitude))
                           : object.entries.end();
    if (entry == object.entries.end()) {
      problems_.error(key.line, quoteEds(key.name) + " in [" + section.name +
                                    "] is no sub-index of the object");
      continue;
    }
    if (key.value.empty()) continue;
    ++found;
    if (what == 'n') entry->second.name = key.value;
    if (what == 'd') entry->second.denotation = key.value;
    if (what == 'v') entry->second.value = readValue(&key, entry->second.type);
  }
  const EdsKey* count = section.given("nrofentries");
  if (count == nullptr) {
    problems_.warning(section.line, "[" + section.name + "] has no NrOfEntries");
  } else if (numberOf(*count, 0xFF).value_or(found) != found) {
    problems_.warning(count->line, "[" + section.name + "] has " + std::to_string(found) +
                                       (found == 1 ? " entry" : " entries") +
                                       ", not NrOfEntries=" + count->value);
  }
}

void EdsReader::addCompactPdos() {
  if (eds_.info.compact_pdo == 0) return;
  addCompactPdos(0x1400, 0x1600, eds_.info.rpdo_count);
  addCompactPdos(0x1800, 0x1A00, eds_.info.tpdo_count);
}

// NrOfRXPDO and NrOfTXPDO count all PDOs; those that the file describes are taken off.
void EdsReader::addCompactPdos(std::uint16_t parameters, std::uint16_t mappings, unsigned wanted) {
  const auto& objects = eds_.dictionary.objects();
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
    addCompactParameters(static_cast<std::uint16_t>(parameters + n), n);
    addCompactMapping(static_cast<std::uint16_t>(mappings + n), n);
  }
}

void EdsReader::addCompactParameters(std::uint16_t index, unsigned pdo) {
  static constexpr struct {
    const char* name;
    DataType type;
  } kEntries[] = {{"COB-ID", DataType::uint32},       {"Transmission type", DataType::uint8},
                  {"Inhibit time", DataType::uint16}, {"Reserved", DataType::uint8},
                  {"Event timer", DataType::uint16},  {"SYNC start value", DataType::uint8}};
  if (eds_.dictionary.objects().count(index) != 0) return;
  DictionaryObject object;
  object.index = index;
  object.code = ObjectCode::record;
  object.name = std::string(index >= 0x1800 ? "TPDO" : "RPDO") + " communication parameter " +
                std::to_string(pdo + 1);
  std::uint8_t highest = 0;
  for (std::size_t i = 0; i < std::size(kEntries); ++i) {
    if ((eds_.info.compact_pdo >> i & 1U) == 0) continue;
    highest = static_cast<std::uint8_t>(i + 1);
    object.entries[highest] = pdoEntry({index, highest}, kEntries[i].name, kEntries[i].type);
  }
  object.entries[0] = countEntry(index, "Highest sub-index supported", highest);
  eds_.dictionary.set(std::move(object));
}

void EdsReader::addCompactMapping(std::uint16_t index, unsigned pdo) {
  if (eds_.dictionary.objects().count(index) != 0) return;
  DictionaryObject object;
  object.index = index;
  object.code = ObjectCode::record;
  object.name = std::string(index >= 0x1A00 ? "TPDO" : "RPDO") + " mapping parameter " +
                std::to_string(pdo + 1);
  object.entries[0] = countEntry(index, "Number of mapped objects", 0);
  object.entries[0].access = Access::rw;
  for (std::uint8_t i = 1; i <= kMappedObjects; ++i) {
    object.entries[i] =
        pdoEntry({index, i}, "Mapped object " + std::to_string(i), DataType::uint32);
  }
  eds_.dictionary.set(std::move(object));
}

}  // namespace cia402::canopen
