// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_absolute_encoder.h"

#include "yaml/reader.h"

namespace cia402::sim {
namespace {

using EncoderObject = std::optional<fieldbus::ObjectId>;

EncoderObject encoderObjectOf(const yaml::Value& value) {
  const auto text = value.text();
  const EncoderObject object = text ? fieldbus::parseObjectId(*text) : std::nullopt;
  if (!object) value.problem("must be an object like \"200B:22\"");
  return object;
}

void readEncoderObject(DefinitionReader& reader, const char* key, EncoderObject& out) {
  if (!reader.has(key)) return;
  std::string text;
  reader.read(key, text);
  out = fieldbus::parseObjectId(text);
  if (!out) reader.problem(key, "must be an object like \"200B:22\"");
}

void readWide(DefinitionReader& reader, const char* key, AbsoluteEncoderDefinition::Wide& out) {
  std::vector<EncoderObject> objects;
  reader.list(key, [&](const yaml::Value& item) { objects.push_back(encoderObjectOf(item)); });
  if (objects.size() == 2) {
    out = {objects[0], objects[1]};
  } else if (!objects.empty()) {
    reader.problem(key, "must be two objects, like [\"200B:27\", \"200B:28\"]");
  }
}

}  // namespace

void readAbsoluteEncoder(DefinitionReader& reader, AbsoluteEncoderDefinition& out) {
  reader.read("counts", out.counts, 1, 4294967295);
  readEncoderObject(reader, "system", out.system);
  if (reader.has("kinds")) out.kinds.clear();
  reader.list("kinds", [&](const yaml::Value& item) {
    const auto index = item.oneOf({"absolute", "single_turn", "incremental"});
    if (index) out.kinds.push_back(static_cast<EncoderKind>(*index));
  });
  readEncoderObject(reader, "turns", out.turns);
  readEncoderObject(reader, "single_turn", out.single_turn);
  readWide(reader, "encoder", out.encoder);
  readWide(reader, "mechanical", out.mechanical);
  readWide(reader, "rotary", out.rotary);
  readEncoderObject(reader, "rotary_units", out.rotary_units);
  readWide(reader, "load_counts", out.load_counts);
  readWide(reader, "load_gear", out.load_gear);
  readEncoderObject(reader, "overflows", out.overflows);
  readEncoderObject(reader, "overflow_masked", out.overflow_masked);
  readEncoderObject(reader, "reset", out.reset);
  reader.read("battery_fault", out.battery_fault);
}

}  // namespace cia402::sim
