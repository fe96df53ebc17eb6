// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/reader.h"

#include <cmath>
#include <utility>

#include "yaml/reader.h"

namespace cia402::sim {

DefinitionReader::DefinitionReader(const YAML::Node& node, std::string path, ProblemTexts& problems)
    : node_(node), path_(std::move(path)), problems_(problems) {
  if (!node_.IsMap()) {
    problems_.push_back((path_.empty() ? "the file" : path_) + ": must be a map");
    node_ = YAML::Node(YAML::NodeType::Map);
  }
}

DefinitionReader::~DefinitionReader() {
  for (const auto& pair : node_) {
    const std::string key = pair.first.Scalar();
    if (asked_.count(key) == 0) problem(key, "unknown key");
  }
}

bool DefinitionReader::has(const std::string& key) {
  asked_.insert(key);
  return static_cast<bool>(node(key));
}

YAML::Node DefinitionReader::node(const std::string& key) {
  asked_.insert(key);
  return std::as_const(node_)[key];
}

std::string DefinitionReader::pathOf(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

void DefinitionReader::problem(const std::string& key, const std::string& text) {
  const YAML::Node at = std::as_const(node_)[key];
  const std::string line =
      at && at.Mark().line >= 0 ? " (line " + std::to_string(at.Mark().line + 1) + ")" : "";
  problems_.push_back(pathOf(key) + line + ": " + text);
}

void DefinitionReader::read(const std::string& key, bool& out) {
  if (!has(key)) return;
  if (!YAML::convert<bool>::decode(node(key), out)) problem(key, "must be true or false");
}

void DefinitionReader::read(const std::string& key, std::string& out) {
  if (!has(key)) return;
  if (!node(key).IsScalar()) return problem(key, "must be a text");
  out = node(key).Scalar();
}

void DefinitionReader::read(const std::string& key, double& out, double low, double high) {
  if (!has(key)) return;
  const YAML::Node at = node(key);
  const auto value = at.IsScalar() ? yaml::parseNumber(at.Scalar()) : std::nullopt;
  if (!value || !std::isfinite(*value) || *value < low || *value > high) {
    return problem(key,
                   "must be a number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  out = *value;
}

void DefinitionReader::read(const std::string& key, std::int64_t& out, std::int64_t low,
                            std::int64_t high) {
  if (!has(key)) return;
  const YAML::Node at = node(key);
  const auto value = at.IsScalar() ? yaml::parseInteger(at.Scalar()) : std::nullopt;
  if (!value || *value < low || *value > high) {
    return problem(
        key, "must be an integer from " + std::to_string(low) + " to " + std::to_string(high));
  }
  out = *value;
}

void DefinitionReader::read(const std::string& key, Duration& out) {
  double seconds = toSeconds(out);
  read(key, seconds, 0.0, 3600.0);
  out = fromSeconds(seconds);
}

void DefinitionReader::section(const std::string& key,
                               const std::function<void(DefinitionReader&)>& body) {
  if (!has(key)) return;
  DefinitionReader reader(node(key), pathOf(key), problems_);
  body(reader);
}

void DefinitionReader::each(
    const std::string& key,
    const std::function<void(const std::string&, const YAML::Node&)>& body) {
  if (!has(key)) return;
  if (!node(key).IsMap()) return problem(key, "must be a map");
  for (const auto& pair : node(key)) body(pair.first.Scalar(), pair.second);
}

}  // namespace cia402::sim
