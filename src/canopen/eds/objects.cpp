// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/objects.h"

#include <string>
#include <utility>

#include "canopen/eds/compact.h"

namespace cia402::canopen {

bool EdsObjectReader::hasRoom(unsigned line) {
  if (entries_ < kMostEdsEntries) {
    ++entries_;
    return true;
  }
  if (!full_) {
    problems_.error(
        line, "more than " + std::to_string(kMostEdsEntries) + " entries; the rest is not read");
  }
  full_ = true;
  return false;
}

void EdsObjectReader::read() {
  for (const auto& [index, section] : sections_.objects()) readObject(index, *section);
  adoptOrphans();
}

ObjectCode EdsObjectReader::readCode(const EdsSection& section, bool has_entries) {
  const ObjectCode guess = has_entries ? ObjectCode::record : ObjectCode::variable;
  const EdsKey* key = section.given("objecttype");
  if (key == nullptr) {  // CiA 306: then it is a VAR
    if (has_entries) {
      problems_.warning(section.line, "[" + section.name + "] has no ObjectType; read as RECORD");
    }
    return guess;
  }
  const auto code = keys_.numberOf(*key, 0xFFFF);
  if (!code) return guess;
  if (*code == 2 || (*code >= 5 && *code <= 9)) return static_cast<ObjectCode>(*code);
  problems_.error(key->line,
                  "ObjectType=" + key->value + " is unknown; read as " + toString(guess));
  return guess;
}

void EdsObjectReader::readObject(std::uint16_t index, const EdsSection& section) {
  const bool has_entries = sections_.subSectionsOf(index) != nullptr;
  DictionaryObject object;
  object.index = index;
  object.code = readCode(section, has_entries);
  const EdsKey* name = section.given("parametername");
  if (name == nullptr) {
    problems_.warning(section.line, "[" + section.name + "] has no ParameterName");
  }
  object.name = name != nullptr ? name->value : toString(ObjectId{index, 0}).substr(0, 4);
  const bool structured = object.code == ObjectCode::array || object.code == ObjectCode::record ||
                          object.code == ObjectCode::defstruct;
  if (!structured && has_entries) {
    problems_.warning(section.line, "[" + section.name + "] is a " + toString(object.code) +
                                        ", but has sub-indices; read as RECORD");
    object.code = ObjectCode::record;
  }
  const auto compact = static_cast<unsigned>(keys_.numberOr0(section, "compactsubobj", 254));
  if (compact > 0 && !has_entries) {
    if (!structured) object.code = ObjectCode::array;
    expandCompact(object, section, compact);
  } else if (structured || has_entries) {
    if (compact > 0) {
      problems_.warning(section.line, "[" + section.name +
                                          "] has both CompactSubObj and sections "
                                          "for its sub-indices; the sections are read");
    }
    readEntries(object, &section);
  } else if (hasRoom(section.line)) {
    object.entries[0] = entry_reader_.read(section, {index, 0}, object.code);
    object.entries[0].name = object.name;
  }
  if (!full_ || !object.entries.empty()) dictionary_.set(std::move(object));
}

void EdsObjectReader::readEntries(DictionaryObject& object, const EdsSection* section) {
  const EdsSections::SubSections* subs = sections_.subSectionsOf(object.index);
  const std::size_t found = subs == nullptr ? 0 : subs->size();
  if (found != 0) {
    for (const auto& [subindex, sub] : *subs) {
      if (!hasRoom(sub->line)) return;
      object.entries[subindex] =
          entry_reader_.read(*sub, {object.index, subindex}, ObjectCode::variable);
    }
  }
  if (section == nullptr) return;
  if (found == 0) {
    problems_.error(section->line, "[" + section->name + "] is " +
                                       (object.code == ObjectCode::array ? "an " : "a ") +
                                       toString(object.code) + ", but no sub-index is described");
    return;
  }
  if (object.entries.count(0) == 0) {
    problems_.warning(section->line, "[" + section->name + "] has no sub-index 0");
  }
  const EdsKey* count = section->given("subnumber");
  if (count == nullptr) {
    problems_.warning(section->line, "[" + section->name + "] has no SubNumber");
  } else if (keys_.numberOf(*count, 0xFFFF).value_or(found) != found) {
    problems_.warning(count->line, "[" + section->name + "] has " + std::to_string(found) +
                                       (found == 1 ? " sub-index" : " sub-indices") +
                                       ", not SubNumber=" + count->value);
  }
}

// Sub-indices whose object has no section of its own.
void EdsObjectReader::adoptOrphans() {
  for (const auto& [index, subs] : sections_.subSections()) {
    if (sections_.objects().count(index) != 0 || full_) continue;
    const std::string text = toString(ObjectId{index, 0}).substr(0, 4);
    problems_.warning(subs.begin()->second->line,
                      "[" + subs.begin()->second->name + "] has no section [" + text + "]");
    DictionaryObject object;
    object.index = index;
    object.name = text;
    object.code = ObjectCode::record;
    readEntries(object, nullptr);
    dictionary_.set(std::move(object));
  }
}

/// Sub-indices of an array that are all alike, described once (CompactSubObj).
void EdsObjectReader::expandCompact(DictionaryObject& object, const EdsSection& section,
                                    unsigned count) {
  if (!hasRoom(section.line)) return;
  object.entries[0] = edsCountEntry(object.index, "NrOfObjects", static_cast<std::uint8_t>(count));
  object.entries[0].line = section.line;
  const EdsKey* sub_number = section.given("subnumber");
  if (sub_number != nullptr && keys_.numberOf(*sub_number, 0xFFFF).value_or(0) != 0) {
    problems_.warning(sub_number->line,
                      "[" + section.name + "] has both SubNumber and CompactSubObj");
  }
  const DictionaryEntry model =
      entry_reader_.read(section, {object.index, 0}, ObjectCode::variable);
  for (unsigned i = 1; i <= count && hasRoom(section.line); ++i) {
    DictionaryEntry& entry = object.entries[static_cast<std::uint8_t>(i)];
    entry = model;
    entry.id.subindex = static_cast<std::uint8_t>(i);
    entry.name = object.name + std::to_string(i);
    entry.denotation.clear();
  }
}

}  // namespace cia402::canopen
