// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/reload.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using Leaves = std::map<std::string, std::string>;

std::vector<std::string> namesIn(const std::string& key) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while (begin <= key.size()) {
    const std::size_t end = std::min(key.find('/', begin), key.size());
    names.push_back(key.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

bool fits(const std::string& pattern, const std::string& key) {
  const std::vector<std::string> wanted = namesIn(pattern), names = namesIn(key);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] == "**") return names.size() >= i;
    if (i >= names.size() || (wanted[i] != "*" && wanted[i] != names[i])) return false;
  }
  return names.size() == wanted.size();
}

/// Everything but mappings is a leaf; what is empty is none.
void addLeaves(const YAML::Node& node, const std::string& key, Leaves& leaves) {
  if (node.IsMap()) {
    for (const auto& pair : node) {
      if (!pair.first.IsScalar()) continue;
      const std::string& name = pair.first.Scalar();
      addLeaves(pair.second, key.empty() ? name : key + "/" + name, leaves);
    }
  } else if (node.IsScalar()) {
    leaves[key] = node.Scalar();
  } else if (node.IsSequence()) {
    YAML::Emitter text;
    text << YAML::Flow << node;
    leaves[key] = text.c_str();
  }
}

bool same(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto x = yaml::parseNumber(a), y = yaml::parseNumber(b);
  return x && y && *x == *y;
}

const std::string& valueOf(const Leaves& leaves, const std::string& key) {
  static const std::string kNone;
  const auto leaf = leaves.find(key);
  return leaf == leaves.end() ? kNone : leaf->second;
}

bool hasBelow(const Leaves& leaves, const std::string& section) {
  const auto next = leaves.lower_bound(section + "/");
  return next != leaves.end() && next->first.compare(0, section.size() + 1, section + "/") == 0;
}

/// Why this change is none for a running node though the key's rule permits it; empty: it is.
std::string exceptionOf(const Change& change, const Leaves& before, const Leaves& after) {
  if (fits("axes/*/limits/*", change.key) && change.after.empty()) {
    return "a drive keeps a limit that it was given until it is switched off; give a wider one "
           "instead";
  }
  const std::string section = change.key.substr(0, change.key.rfind('/'));
  if (fits("axes/*/homing", section) && !(hasBelow(before, section) && hasBelow(after, section))) {
    return "whether an axis is homed hangs on it";
  }
  return {};
}

/// "axes/m3" of a key that lies there and without which others there mean something else.
std::string ownerOf(const std::string& key) {
  const std::vector<std::string> names = namesIn(key);
  if (names.size() < 3 || (names[0] != "axes" && names[0] != "groups")) return {};
  const bool apart = names[2] == "frame" || names[2] == "simulation";
  return apart ? std::string() : names[0] + "/" + names[1];
}

/// What is given in another unit, or for another joint, must not be taken by the one that runs.
void waitForRestarts(std::vector<Change>& changes) {
  std::map<std::string, std::string> waits;
  for (const Change& change : changes) {
    if (change.when == ChangeTime::restart) waits.emplace(ownerOf(change.key), change.key);
  }
  for (Change& change : changes) {
    const auto cause = waits.find(ownerOf(change.key));
    if (cause == waits.end() || cause->first.empty() || change.when == ChangeTime::restart)
      continue;
    change.when = ChangeTime::restart;
    change.because = "it was given together with a new " + cause->second;
  }
}

/// A place in a tree; made where it is not there.
YAML::Node placeOf(YAML::Node tree, const std::string& key) {
  for (const std::string& name : namesIn(key)) tree.reset(tree[name]);
  return tree;
}

void removeFrom(YAML::Node tree, const std::string& key) {
  const std::size_t slash = key.rfind('/');
  if (slash == std::string::npos) {
    tree.remove(key);
  } else {
    placeOf(tree, key.substr(0, slash)).remove(key.substr(slash + 1));
  }
}

std::string shown(const std::string& value) { return value.empty() ? "not given" : value; }

}  // namespace

const ReloadRule& reloadRuleOf(const std::string& key) {
  const std::vector<ReloadRule>& rules = reloadRules();
  return *std::find_if(rules.begin(), rules.end(),
                       [&](const ReloadRule& rule) { return fits(rule.keys, key); });
}

YAML::Node settledTree(const YAML::Node& tree, const RobotConfig& robot) {
  YAML::Node settled = YAML::Clone(tree);
  const YAML::Node defaults = settled["defaults"];
  if (defaults && settled["axes"].IsMap()) {
    YAML::Node axes(YAML::NodeType::Map);
    for (const auto& axis : settled["axes"]) {
      axes.force_insert(axis.first, YAML::Clone(mergeDefaults(defaults, axis.second)));
    }
    settled["axes"] = axes;
  }
  settled.remove("defaults");
  settleLimits(settled, robot);
  if (settled["groups"].IsMap()) return settled;
  for (const GroupConfig& group : robot.groups) {
    settled["groups"][group.name]["joints"] = group.joints;
  }
  return settled;
}

std::vector<Change> changesOf(const YAML::Node& before, const YAML::Node& after) {
  Leaves was, is;
  addLeaves(before, "", was);
  addLeaves(after, "", is);
  std::set<std::string> keys;
  for (const auto& [key, value] : was) keys.insert(key);
  for (const auto& [key, value] : is) keys.insert(key);
  std::vector<Change> changes;
  for (const std::string& key : keys) {
    Change change{key, valueOf(was, key), valueOf(is, key), ChangeTime::restart, {}};
    if (same(change.before, change.after)) continue;
    const ReloadRule& rule = reloadRuleOf(key);
    change.when = rule.when;
    change.because = rule.because;
    const std::string exception = exceptionOf(change, was, is);
    if (!exception.empty()) change.when = ChangeTime::restart;
    if (!exception.empty()) change.because = exception;
    changes.push_back(change);
  }
  waitForRestarts(changes);
  return changes;
}

YAML::Node withChanges(const YAML::Node& before, const std::vector<Change>& changes,
                       const YAML::Node& after) {
  YAML::Node tree = YAML::Clone(before);
  const YAML::Node source = YAML::Clone(after);
  for (const Change& change : changes) {
    if (change.after.empty()) {
      removeFrom(tree, change.key);
    } else {
      placeOf(tree, change.key) = placeOf(source, change.key);
    }
  }
  return tree;
}

std::string toString(const Change& change, const RobotConfig& robot) {
  const std::vector<std::string> names = namesIn(change.key);
  std::string joint;
  for (const drive::AxisConfig& axis : robot.axes) {
    const bool concerned = names.size() > 2 && names[0] == "axes" && names[1] == axis.name;
    if (concerned && axis.joint != axis.name) joint = " (joint " + axis.joint + ")";
  }
  return change.key + joint + ": " + shown(change.before) + " -> " + shown(change.after);
}

std::string toString(const ChangeReport& report, const RobotConfig& robot) {
  std::string changed, waiting, restart;
  for (const Change& change : report.changed) append(changed, toString(change, robot));
  for (const Change& change : report.waiting) append(waiting, toString(change, robot));
  for (const Change& change : report.restart) {
    append(restart, toString(change, robot) + ", because " + change.because);
  }
  std::string all;
  if (!changed.empty()) append(all, "changed: " + changed, "\n");
  if (!report.remark.empty()) append(all, report.remark, "\n");
  if (!waiting.empty()) {
    append(all, "only while all axes are disabled: " + waiting + " (" + report.waits_for + ")",
           "\n");
  }
  if (!restart.empty()) append(all, "needs a restart of the node: " + restart, "\n");
  return all.empty() ? "nothing has changed" : all;
}

}  // namespace cia402::config
