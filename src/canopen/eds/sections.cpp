// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/sections.h"

#include <optional>
#include <string>
#include <string_view>

#include "canopen/eds/value.h"

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

EdsSections::EdsSections(const EdsText& text, EdsProblems& problems) {
  for (const auto& [key, section] : text.sections()) {
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
        problems.warning(section.line, "unknown section [" + section.name + "] is not read");
        break;
    }
    if (!fresh) {
      problems.error(section.line, "[" + section.name + "] describes " + toString(name.id) +
                                       " a second time and is not read");
    } else if (name.odd != nullptr) {
      problems.warning(section.line,
                       "[" + section.name + "] should have its numbers without " + name.odd);
    }
  }
}

const EdsSections::SubSections* EdsSections::subSectionsOf(std::uint16_t index) const {
  const auto found = sub_sections_.find(index);
  return found == sub_sections_.end() ? nullptr : &found->second;
}

}  // namespace cia402::canopen
