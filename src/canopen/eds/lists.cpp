// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/lists.h"

#include <cstdint>
#include <set>
#include <string>

#include "canopen/eds/value.h"

namespace cia402::canopen {
namespace {

class ListCheck {
 public:
  ListCheck(const EdsText& text, EdsKeys& keys, EdsProblems& problems,
            const ObjectDictionary& dictionary, bool full)
      : text_(text), keys_(keys), problems_(problems), dictionary_(dictionary), full_(full) {}
  /// One of the three lists.
  void read(const char* name);
  /// All of them with what is there.
  void compare(const EdsSections& sections) const;

 private:
  const EdsText& text_;
  EdsKeys& keys_;
  EdsProblems& problems_;
  const ObjectDictionary& dictionary_;
  bool full_;
  std::set<std::uint16_t> listed_;
};

void ListCheck::read(const char* name) {
  const EdsSection* section = keys_.require(text_, name);
  if (section == nullptr) return;
  std::size_t found = 0;
  for (const auto& [position, key] : section->keys) {
    if (position == "supportedobjects") continue;
    if (!parseEdsNumber(position)) {
      problems_.warning(key.line, quoteEds(key.name) + " in [" + section->name +
                                      "] is no position like 1=0x1000");
      continue;
    }
    ++found;
    const auto index = key.value.empty() ? std::nullopt : keys_.numberOf(key, 0xFFFF);
    if (key.value.empty()) {
      problems_.error(key.line, key.name + "= in [" + section->name + "] names no object");
    }
    if (!index) continue;
    const ObjectId id{static_cast<std::uint16_t>(*index), 0};
    const std::string text = toString(id).substr(0, 4) + "h";
    if (!listed_.insert(id.index).second) {
      problems_.warning(key.line, "object " + text + " is listed twice");
    } else if (dictionary_.objects().count(id.index) == 0 && !full_) {
      problems_.error(key.line, "object " + text + " is listed, but there is no section [" +
                                    text.substr(0, 4) + "]");
    }
  }
  const EdsKey* count = section->given("supportedobjects");
  if (count == nullptr) {
    problems_.warning(section->line, "[" + section->name + "] has no SupportedObjects");
  } else if (keys_.numberOf(*count, 0xFFFF).value_or(found) != found) {
    problems_.warning(count->line, "[" + section->name + "] lists " + std::to_string(found) +
                                       (found == 1 ? " object, not " : " objects, not ") +
                                       count->value);
  }
}

void ListCheck::compare(const EdsSections& sections) const {
  for (const auto& [index, section] : sections.objects()) {
    // Data types (below 1000h) describe others and stand in no list.
    if (index < 0x1000 || listed_.count(index) != 0) continue;
    problems_.warning(section->line, "[" + section->name + "] stands in none of the three lists");
  }
  for (const std::uint16_t index :
       {std::uint16_t{0x1000}, std::uint16_t{0x1001}, std::uint16_t{0x1018}}) {
    if (dictionary_.objects().count(index) != 0 || listed_.count(index) != 0 || full_) continue;
    problems_.warning(
        text_.lastLine(),
        "the mandatory object " + toString(ObjectId{index, 0}).substr(0, 4) + "h is missing");
  }
}

}  // namespace

void checkEdsLists(const EdsText& text, const EdsSections& sections, EdsKeys& keys,
                   EdsProblems& problems, const ObjectDictionary& dictionary, bool full) {
  ListCheck check(text, keys, problems, dictionary, full);
  check.read("MandatoryObjects");
  check.read("OptionalObjects");
  check.read("ManufacturerObjects");
  check.compare(sections);
}

}  // namespace cia402::canopen
