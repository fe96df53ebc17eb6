// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/reader.h"

namespace cia402::canopen {
namespace {

/// What a section describes, by its name.
struct SectionName {
  enum class Kind : std::uint8_t { object, entry, compact_list, known, unknown };
  Kind kind = Kind::unknown;
  ObjectId id;
  char list = ' ';            ///< 'n'ame, 'v'alue, 'd'enotation
  const char* odd = nullptr;  ///< what stands before one of its numbers and should not
};

std::optional<unsigned> hexNumber(std::string_view text, std::size_t digits) {
  if (text.empty() || text.size() > digits) return {};
  const auto number = parseEdsNumber("0x" + std::string(text));
  if (!number) return {};
  return static_cast<unsigned>(number->magnitude);
}

bool startsWith(std::string_view text, std::string_view begin) {
  return text.substr(0, begin.size()) == begin;
}

// Sections without objects; those of modular devices and tools are not read.
bool isKnown(std::string_view key) {
  for (const char* known :
       {"fileinfo", "deviceinfo", "devicecomissioning", "devicecommissioning", "dummyusage",
        "comments", "mandatoryobjects", "optionalobjects", "manufacturerobjects",
        "supportedmodules", "connectedmodules", "dynamicchannels", "tools", "standarddatatypes",
        "reserveddatatypes", "objectlinks", "filetypeinfo"}) {
    if (key == known) return true;
  }
  if (startsWith(key, "tool") && parseEdsNumber(key.substr(4))) return true;
  const std::size_t after = key.find_first_not_of("0123456789", 1);
  return key[0] == 'm' && after != 1 && after != std::string_view::npos;  // [M1FixedObjects] ...
}

// "1018", "1018sub1", "1018Name"; odd: "0x1018", "1018sub0x1".
SectionName parseName(std::string_view key) {
  SectionName name;
  if (isKnown(key)) {
    name.kind = SectionName::Kind::known;
    return name;
  }
  if (startsWith(key, "0x")) {
    key.remove_prefix(2);
    name.odd = "0x";
  }
  const std::size_t sub = key.find("sub");
  std::string_view index = key.substr(0, sub);
  auto kind = SectionName::Kind::object;
  if (sub != std::string_view::npos) {
    std::string_view digits = key.substr(sub + 3);
    for (const std::string_view odd : {"0x", "index"}) {
      if (!startsWith(digits, odd)) continue;
      digits.remove_prefix(odd.size());
      name.odd = odd.data();
      break;
    }
    const auto number = hexNumber(digits, 2);
    if (!number) return name;
    name.id.subindex = static_cast<std::uint8_t>(*number);
    kind = SectionName::Kind::entry;
  }
  for (const char* list : {"name", "value", "denotation", "objectlinks"}) {
    const std::string_view word(list);
    if (key.size() <= word.size() || key.substr(key.size() - word.size()) != word) continue;
    index = key.substr(0, key.size() - word.size());
    name.list = word[0];
    kind = word[0] == 'o' ? SectionName::Kind::known : SectionName::Kind::compact_list;
  }
  const auto number = hexNumber(index, 4);
  if (!number) return name;
  name.id.index = static_cast<std::uint16_t>(*number);
  name.kind = kind;
  return name;
}

}  // namespace

void EdsReader::sortSections() {
  for (const auto& [key, section] : text_.sections()) {
    const SectionName name = parseName(key);
    bool fresh = true;
    switch (name.kind) {
      case SectionName::Kind::object:
        fresh = objects_.emplace(name.id.index, &section).second;
        break;
      case SectionName::Kind::entry:
        fresh = sub_sections_[name.id.index].emplace(name.id.subindex, &section).second;
        break;
      case SectionName::Kind::compact_list:
        fresh = compact_lists_.emplace(std::make_pair(name.id.index, name.list), &section).second;
        break;
      case SectionName::Kind::known:
        break;
      case SectionName::Kind::unknown:
        problems_.warning(section.line, "unknown section [" + section.name + "] is not read");
        break;
    }
    if (!fresh) {
      problems_.error(section.line, "[" + section.name + "] describes " + toString(name.id) +
                                        " a second time and is not read");
    } else if (name.odd != nullptr) {
      problems_.warning(section.line,
                        "[" + section.name + "] should have its numbers without " + name.odd);
    }
  }
}

bool EdsReader::hasRoom(unsigned line) {
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

void EdsReader::readObjects() {
  for (const auto& [index, section] : objects_) readObject(index, *section);
}

ObjectCode EdsReader::readCode(const EdsSection& section, bool has_entries) {
  const ObjectCode guess = has_entries ? ObjectCode::record : ObjectCode::variable;
  const EdsKey* key = section.given("objecttype");
  if (key == nullptr) {  // CiA 306: then it is a VAR
    if (has_entries) {
      problems_.warning(section.line, "[" + section.name + "] has no ObjectType; read as RECORD");
    }
    return guess;
  }
  const auto code = numberOf(*key, 0xFFFF);
  if (!code) return guess;
  if (*code == 2 || (*code >= 5 && *code <= 9)) return static_cast<ObjectCode>(*code);
  problems_.error(key->line,
                  "ObjectType=" + key->value + " is unknown; read as " + toString(guess));
  return guess;
}

void EdsReader::readObject(std::uint16_t index, const EdsSection& section) {
  const bool has_entries = sub_sections_.count(index) != 0;
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
  const auto compact = static_cast<unsigned>(numberOr0(section, "compactsubobj", 254));
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
    object.entries[0] = readEntry(section, {index, 0}, object.code);
    object.entries[0].name = object.name;
  }
  if (!full_ || !object.entries.empty()) eds_.dictionary.set(std::move(object));
}

void EdsReader::readEntries(DictionaryObject& object, const EdsSection* section) {
  const auto subs = sub_sections_.find(object.index);
  const std::size_t found = subs == sub_sections_.end() ? 0 : subs->second.size();
  if (found != 0) {
    for (const auto& [subindex, sub] : subs->second) {
      if (!hasRoom(sub->line)) return;
      object.entries[subindex] = readEntry(*sub, {object.index, subindex}, ObjectCode::variable);
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
  } else if (numberOf(*count, 0xFFFF).value_or(found) != found) {
    problems_.warning(count->line, "[" + section->name + "] has " + std::to_string(found) +
                                       (found == 1 ? " sub-index" : " sub-indices") +
                                       ", not SubNumber=" + count->value);
  }
}

// Sub-indices whose object has no section of its own.
void EdsReader::adoptOrphans() {
  for (const auto& [index, subs] : sub_sections_) {
    if (objects_.count(index) != 0 || full_) continue;
    const std::string text = toString(ObjectId{index, 0}).substr(0, 4);
    problems_.warning(subs.begin()->second->line,
                      "[" + subs.begin()->second->name + "] has no section [" + text + "]");
    DictionaryObject object;
    object.index = index;
    object.name = text;
    object.code = ObjectCode::record;
    readEntries(object, nullptr);
    eds_.dictionary.set(std::move(object));
  }
}

}  // namespace cia402::canopen
