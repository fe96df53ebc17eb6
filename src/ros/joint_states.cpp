// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/joint_states.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace cia402::ros_node {
namespace {

constexpr double kPatience = 2.0;  // s; what is still known then is so because its drive is silent

bool anyUnknown(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
}

}  // namespace

Time newestFeedback(const std::vector<bus::JointState>& states) {
  Time newest{};
  for (const bus::JointState& state : states) {
    if (!std::isnan(state.position)) newest = std::max(newest, state.stamp);
  }
  return newest;
}

sensor_msgs::JointState jointStates(const std::vector<motion::Joint>& joints,
                                    const std::vector<bus::JointState>& states, bool omit_unknown) {
  sensor_msgs::JointState message;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (omit_unknown && std::isnan(states[i].position)) continue;
    message.name.push_back(joints[i].name);
    message.position.push_back(states[i].position);
    message.velocity.push_back(states[i].velocity);
    message.effort.push_back(states[i].effort);
  }
  if (omit_unknown && anyUnknown(message.velocity)) message.velocity.clear();
  if (omit_unknown && anyUnknown(message.effort)) message.effort.clear();
  return message;
}

std::optional<ros::Time> JointStateStamps::next(const std::vector<bus::JointState>& states,
                                                const ros::Time& newest, const ros::Time& now) {
  std::vector<bool> known;
  bool any_known = false, lost = false;
  for (const bus::JointState& state : states) {
    const std::size_t i = known.size();
    known.push_back(!std::isnan(state.position));
    any_known = any_known || known[i];
    lost = lost || (!known[i] && i < told_.size() && told_[i]);
  }
  const bool clock_counts = !any_known || (lost && now - newest > ros::Duration(kPatience));
  std::optional<ros::Time> stamp;
  if (any_known && order_.next(newest, now)) {
    stamp = newest;
  } else if (clock_counts && order_.next(now, now)) {
    stamp = now;
  }
  if (stamp) told_ = std::move(known);
  return stamp;
}

}  // namespace cia402::ros_node
