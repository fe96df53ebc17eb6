// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <set>
#include <sstream>
#include <utility>

#include "config/robot_parts.h"

namespace cia402::config {
namespace {

// The node at a path of keys ("limits/upper"), stopping at list elements; undefined if none.
bool contains(YAML::Node node, const std::string& path) {
  std::istringstream keys(path);
  std::string key;
  while (std::getline(keys, key, '/')) {
    const std::size_t element = key.find('[');
    key = key.substr(0, element);
    if (!node.IsMap()) return false;
    bool found = false;
    for (const auto& pair : node) {
      if (!pair.first.IsScalar() || pair.first.Scalar() != key) continue;
      node.reset(pair.second);
      found = true;
      break;
    }
    if (!found) return false;
    if (element != std::string::npos) return true;
  }
  return true;
}

YAML::Node child(const YAML::Node& node, const std::string& key) {
  if (!node.IsMap()) return YAML::Node();
  for (const auto& pair : node) {
    if (pair.first.IsScalar() && pair.first.Scalar() == key) return pair.second;
  }
  return YAML::Node();
}

}  // namespace

YAML::Node mergeDefaults(const YAML::Node& defaults, const YAML::Node& axis) {
  if (!axis.IsMap() || !defaults.IsMap()) return axis;
  YAML::Node merged(YAML::NodeType::Map);
  for (const auto& pair : axis) {
    const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : std::string();
    merged.force_insert(pair.first, mergeDefaults(child(defaults, key), pair.second));
  }
  for (const auto& pair : defaults) {
    if (pair.first.IsScalar() && !contains(axis, pair.first.Scalar())) {
      merged.force_insert(pair.first, YAML::Clone(pair.second));
    }
  }
  return merged;
}

void nameDefaults(const YAML::Node& tree, const Problems& from, Problems& to) {
  const YAML::Node defaults = child(tree, "defaults");
  std::set<std::pair<std::string, std::string>> told;
  for (const Problem& problem : from.list()) {
    std::string path = problem.path;
    const std::size_t slash = path.find('/', 5);
    if (path.compare(0, 5, "axes/") == 0 && slash != std::string::npos) {
      const std::string rest = path.substr(slash + 1);
      if (contains(defaults, rest) && !contains(tree, path)) path = "defaults/" + rest;
    }
    if (told.emplace(path, problem.message).second) to.add(path, problem.message);
  }
}

}  // namespace cia402::config
