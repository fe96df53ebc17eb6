// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/reader.h"

namespace cia402::sim {

YAML::Node DefinitionReader::node(const std::string& key) {
  const auto value = section_.get(key);
  return value ? value->node() : YAML::Node();
}

void DefinitionReader::problem(const std::string& key, const std::string& text) {
  const auto value = section_.get(key);
  value ? value->problem(text) : section_.problem("`" + key + "` " + text);
}

void DefinitionReader::read(const std::string& key, Duration& out) {
  double seconds = toSeconds(out);
  read(key, seconds, 0.0, 3600.0);
  out = fromSeconds(seconds);
}

void DefinitionReader::section(const std::string& key,
                               const std::function<void(DefinitionReader&)>& body) {
  const auto value = section_.get(key);
  if (!value) return;
  DefinitionReader reader(*value);
  body(reader);
}

void DefinitionReader::list(const std::string& key,
                            const std::function<void(const yaml::Value&)>& body) {
  const auto value = section_.get(key);
  if (!value) return;
  for (const yaml::Value& element : value->list()) body(element);
}

void DefinitionReader::each(
    const std::string& key,
    const std::function<void(const std::string&, const yaml::Value&)>& body) {
  const auto value = section_.get(key);
  if (!value) return;
  yaml::Section section(*value);
  for (const auto& [name, entry] : section.entries()) body(name, entry);
  section.finish();
}

}  // namespace cia402::sim
