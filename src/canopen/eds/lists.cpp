// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/reader.h"

// [MandatoryObjects], [OptionalObjects] and [ManufacturerObjects]: what objects the device is said
// to have. What is described but not listed is taken over all the same.
namespace cia402::canopen {

void EdsReader::readLists() {
  std::set<std::uint16_t> listed;
  readList("MandatoryObjects", listed);
  readList("OptionalObjects", listed);
  readList("ManufacturerObjects", listed);
  checkListed(listed);
}

void EdsReader::readList(const char* name, std::set<std::uint16_t>& listed) {
  const EdsSection* section = require(name);
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
    const auto index = key.value.empty() ? std::nullopt : numberOf(key, 0xFFFF);
    if (key.value.empty()) {
      problems_.error(key.line, key.name + "= in [" + section->name + "] names no object");
    }
    if (!index) continue;
    const ObjectId id{static_cast<std::uint16_t>(*index), 0};
    const std::string text = toString(id).substr(0, 4) + "h";
    if (!listed.insert(id.index).second) {
      problems_.warning(key.line, "object " + text + " is listed twice");
    } else if (eds_.dictionary.objects().count(id.index) == 0 && !full_) {
      problems_.error(key.line, "object " + text + " is listed, but there is no section [" +
                                    text.substr(0, 4) + "]");
    }
  }
  const EdsKey* count = section->given("supportedobjects");
  if (count == nullptr) {
    problems_.warning(section->line, "[" + section->name + "] has no SupportedObjects");
  } else if (numberOf(*count, 0xFFFF).value_or(found) != found) {
    problems_.warning(count->line, "[" + section->name + "] lists " + std::to_string(found) +
                                       (found == 1 ? " object, not " : " objects, not ") +
                                       count->value);
  }
}

void EdsReader::checkListed(const std::set<std::uint16_t>& listed) {
  for (const auto& [index, section] : objects_) {
    // Data types (below 1000h) describe others and stand in no list.
    if (index < 0x1000 || listed.count(index) != 0) continue;
    problems_.warning(section->line, "[" + section->name + "] stands in none of the three lists");
  }
  for (const std::uint16_t index :
       {std::uint16_t{0x1000}, std::uint16_t{0x1001}, std::uint16_t{0x1018}}) {
    if (eds_.dictionary.objects().count(index) != 0 || listed.count(index) != 0 || full_) continue;
    problems_.warning(
        text_.lastLine(),
        "the mandatory object " + toString(ObjectId{index, 0}).substr(0, 4) + "h is missing");
  }
}

}  // namespace cia402::canopen
