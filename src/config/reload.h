// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "config/robot.h"

// What of a robot's file can be changed while the driver runs. Trees of parameters are compared key
// by key; what is taken over of them is loaded and checked as a whole like any robot's file.
namespace cia402::config {

/// When a parameter can be changed.
enum class ChangeTime : std::uint8_t {
  running,   ///< at any time, also in motion
  disabled,  ///< while all axes are disabled
  restart,   ///< by a new start of the driver alone
};

/// A row of the table of what can be changed when.
struct ReloadRule {
  const char* keys;  ///< "axes/*/limits/*": a * is one name, ** at the end as many as there are
  ChangeTime when;
  const char* because;  ///< of `restart`: "needs a restart of the node, because ..."
};
/// All of them; of several that fit a key the first counts.
const std::vector<ReloadRule>& reloadRules();
const ReloadRule& reloadRuleOf(const std::string& key);

/// A parameter that is another one than before.
struct Change {
  std::string key;            ///< "axes/m3/limits/velocity"
  std::string before, after;  ///< as YAML has it; empty: not given
  ChangeTime when = ChangeTime::restart;
  std::string because;  ///< of `restart`
};
/// "axes/m3/limits/velocity (joint shoulder): 1.5 -> 1".
std::string toString(const Change& change, const RobotConfig& robot);

/// What has become of some changes.
struct ChangeReport {
  std::vector<Change> changed, waiting, restart;
  std::string waits_for;  ///< why those of `waiting` were not made
  std::string remark;     ///< to those that were; or empty
};
/// In sentences.
std::string toString(const ChangeReport& report, const RobotConfig& robot);

/// A robot's tree with its `defaults` in its axes, and no `defaults` any more, and with the groups
/// that it has without saying so. @param robot that was loaded from it
YAML::Node settledTree(const YAML::Node& tree, const RobotConfig& robot);
/// What differs, in the order of the keys. Numbers that are equal do, however they are written.
/// What else of an axis or group changes waits for a restart that changes what it means.
/// @param before, @param after of settledTree()
std::vector<Change> changesOf(const YAML::Node& before, const YAML::Node& after);
/// `before` with some of what changesOf() has found.
YAML::Node withChanges(const YAML::Node& before, const std::vector<Change>& changes,
                       const YAML::Node& after);

/// A parameter that can be changed at any time, with the value that counts now, given or not.
struct Tunable {
  std::string key;  ///< in the robot's tree
  bool is_flag = false;
  double value = 0.0;  ///< of a flag 0 or 1
  double low = 0.0, high = 1.0;
  std::string meaning;  ///< a few words, with the unit
};
/// Those of a robot.
std::vector<Tunable> tunablesOf(const RobotConfig& robot);

}  // namespace cia402::config
