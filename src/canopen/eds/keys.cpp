// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/keys.h"

#include "canopen/eds/value.h"

namespace cia402::canopen {

const EdsSection* EdsKeys::require(const EdsText& text, const char* name) {
  const EdsSection* section = text.find(nameKey(name));
  if (section == nullptr) {
    problems_.warning(text.lastLine(), std::string("section [") + name + "] is missing");
  }
  return section;
}

std::optional<std::uint64_t> EdsKeys::numberOf(const EdsKey& key, std::uint64_t highest) {
  const std::optional<EdsNumber> number = parseEdsNumber(key.value);
  if (!number) {
    problems_.error(key.line, key.name + "=" + quoteEds(key.value) + " is no whole number");
    return {};
  }
  if ((number->negative && number->magnitude != 0) || number->magnitude > highest) {
    problems_.error(
        key.line, key.name + "=" + quoteEds(key.value) + " is not 0 to " + std::to_string(highest));
    return {};
  }
  if (!number->note.empty()) problems_.warning(key.line, key.name + ": " + number->note);
  return number->magnitude;
}

std::optional<std::uint64_t> EdsKeys::number(const EdsSection& section, const char* key,
                                             std::uint64_t highest) {
  const EdsKey* found = section.given(key);
  return found == nullptr ? std::nullopt : numberOf(*found, highest);
}

std::uint64_t EdsKeys::numberOr0(const EdsSection& section, const char* key,
                                 std::uint64_t highest) {
  return number(section, key, highest).value_or(0);
}

}  // namespace cia402::canopen
