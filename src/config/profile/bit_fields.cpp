// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `bit_fields`: numbers that share an object, in words.
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using drive::BitField;

/// A number, or [first, last].
void readBits(yaml::Section& section, BitField& field) {
  const auto value = section.require("bits", "a number, or [first, last]");
  if (!value) return;
  std::vector<yaml::Value> ends = value->isList() ? value->list() : std::vector{*value};
  if (ends.empty() || ends.size() > 2) return value->problem("is a number, or [first, last]");
  const auto low = ends.front().integer(0, 63), high = ends.back().integer(0, 63);
  if (!low || !high) return;
  if (*low > *high) return value->problem("its first bit lies above its last");
  field.low = static_cast<unsigned>(*low);
  field.high = static_cast<unsigned>(*high);
}

void readFieldWords(const yaml::Value& value, BitField& field) {
  yaml::Section section(value);
  for (const auto& [key, text] : section.entries()) {
    const auto number = yaml::parseInteger(key);
    if (!number || *number < 0) {
      text.problem("`" + key + "` is no number of these bits");
    } else if (const auto word = text.text()) {
      field.words[static_cast<std::uint64_t>(*number)] = *word;
    }
  }
  section.finish();
}

}  // namespace

void readBitFields(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [name, list] : section.entries()) {
    drive::BitFields& fields = profile.bit_fields[name];
    for (const yaml::Value& entry : list.list()) {
      BitField field;
      yaml::Section part(entry);
      if (part.require("name", "what these bits say")) part.read("name", field.name);
      readBits(part, field);
      if (const auto words = part.get("words")) readFieldWords(*words, field);
      part.finish();
      fields.push_back(field);
    }
  }
  section.finish();
}

}  // namespace cia402::config
