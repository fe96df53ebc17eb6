// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/reloader.h"

#include <ros/console.h>

#include <algorithm>
#include <utility>

#include "common/text.h"
#include "ros/command_call.h"
#include "ros/parameters.h"

namespace cia402::ros_node {
namespace {

using config::Change;
using config::ChangeTime;

bus::Answer refusalOf(const Problems& problems) {
  const std::size_t count = problems.list().size();
  return bus::answerOf(false, "nothing was changed: " + std::to_string(count) +
                                  (count == 1 ? " problem:\n" : " problems:\n") + problems.text());
}

void addOption(const char* key, const std::string& before, const std::string& after,
               std::vector<Change>& changes) {
  if (before == after) return;
  const config::ReloadRule& rule = config::reloadRuleOf(key);
  changes.push_back({key, before, after, rule.when, rule.because});
}

void put(const YAML::Node& root, const std::string& key, const std::string& value) {
  YAML::Node tree = root;
  std::size_t begin = 0;
  for (std::size_t end = key.find('/'); end != std::string::npos; end = key.find('/', begin)) {
    tree.reset(tree[key.substr(begin, end - begin)]);
    begin = end + 1;
  }
  tree[key.substr(begin)] = value;
}

}  // namespace

Reloader::Reloader(const ros::NodeHandle& private_node, bus::BusRunner& runner,
                   const LoadedRobot& loaded, std::function<void()> wake)
    : node_(private_node),
      runner_(runner),
      wake_(std::move(wake)),
      options_(loaded.options),
      lookup_(loaded.lookup),
      tree_(config::settledTree(loaded.tree, loaded.robot)),
      ready_{loaded.robot, loaded.master},
      joint_state_rate_(loaded.robot.joint_state_rate) {
  show();
}

std::vector<config::Tunable> Reloader::tunables() {
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  return shown_;
}

void Reloader::show() {
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  shown_ = config::tunablesOf(ready_.robot);
}

bus::Answer Reloader::reload() {
  const std::lock_guard<std::mutex> lock(mutex_);
  Problems problems;
  const Parameters parameters = readParameters(node_, problems);
  const auto ready = config::readyRobot(parameters.robot, lookup_, problems);
  if (!ready || !problems.empty()) return refusalOf(problems);
  const YAML::Node tree = config::settledTree(parameters.robot, ready->robot);
  Changes changes = config::changesOf(tree_, tree);
  const NodeOptions& options = parameters.options;
  addOption("profile_path", options_.profile_path, options.profile_path, changes);
  addOption("realtime_priority", std::to_string(options_.realtime_priority),
            std::to_string(options.realtime_priority), changes);
  return take(tree, std::move(changes));
}

bus::Answer Reloader::set(const std::map<std::string, std::string>& values) {
  const std::lock_guard<std::mutex> lock(mutex_);
  YAML::Node tree = YAML::Clone(tree_);
  for (const auto& [key, value] : values) put(tree, key, value);
  return take(tree, config::changesOf(tree_, tree));
}

bus::Answer Reloader::take(const YAML::Node& tree, Changes changes) {
  config::ChangeReport report;
  const auto restart = std::stable_partition(
      changes.begin(), changes.end(),
      [](const Change& change) { return change.when != ChangeTime::restart; });
  report.restart.assign(restart, changes.end());
  changes.erase(restart, changes.end());
  bus::ReloadAnswer answer = apply(tree, changes);
  if (answer.not_disabled) {
    report.waits_for = answer.message;
    const auto waiting = std::stable_partition(
        changes.begin(), changes.end(),
        [](const Change& change) { return change.when == ChangeTime::running; });
    report.waiting.assign(waiting, changes.end());
    changes.erase(waiting, changes.end());
    answer = apply(tree, changes);
  }
  if (!answer.success) return bus::answerOf(false, "nothing was changed: " + answer.message);
  report.changed = changes;
  report.remark = answer.message;
  const bool all = report.waiting.empty() && report.restart.empty();
  return bus::answerOf(all, config::toString(report, ready_.robot));
}

bus::ReloadAnswer Reloader::apply(const YAML::Node& tree, const Changes& changes) {
  bus::ReloadAnswer answer;
  answer.success = true;
  if (changes.empty()) return answer;
  const YAML::Node next = config::withChanges(tree_, changes, tree);
  Problems problems;
  auto ready = config::readyRobot(next, lookup_, problems);
  if (!ready) {
    answer.success = false;
    answer.message = problems.text();
    return answer;
  }
  const bool at_rest = std::any_of(changes.begin(), changes.end(), [](const Change& change) {
    return change.when == ChangeTime::disabled;
  });
  const auto reload =
      bus::makeReload({ready_.robot, ready_.master}, {ready->robot, ready->master}, at_rest);
  answer = call(runner_, bus::ReloadCommand{reload});
  if (!answer.success) return answer;
  for (const std::string& warning : ready->robot.warnings) {
    const auto& known = ready_.robot.warnings;
    if (std::find(known.begin(), known.end(), warning) == known.end()) ROS_WARN_STREAM(warning);
  }
  for (const Change& change : changes) {
    ROS_INFO_STREAM("changed: " << config::toString(change, ready->robot));
  }
  tree_ = next;
  ready_ = std::move(*ready);
  joint_state_rate_ = ready_.robot.joint_state_rate;
  show();
  ++changes_;
  wake_();
  return answer;
}

}  // namespace cia402::ros_node
