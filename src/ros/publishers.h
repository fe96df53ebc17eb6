// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cia402_driver/AxisStates.h>
#include <cia402_driver/BusState.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <vector>

#include "bus/runner.h"
#include "config/robot.h"
#include "motion/joint.h"
#include "ros/joint_states.h"
#include "ros/link_watch.h"

namespace cia402::ros_node {

/// joint_states, ~axis_states, ~bus_state and ~<group>/state.
class Publishers {
 public:
  /// @param node where joint_states is published, @param private_node for the rest.
  Publishers(ros::NodeHandle& node, ros::NodeHandle& private_node, bus::BusRunner& runner,
             const LinkWatch& link, const config::RobotConfig& robot);

  /// Sends joint_states where a position is newer than those sent before, and the states of groups
  /// to those who listen; to be called at the configured rate.
  void publishJointStates(const bus::NetworkSnapshot& snapshot);
  /// Sends ~axis_states if something has changed or 0.1 s have passed, ~bus_state every 0.5 s.
  void publishStates();

 private:
  void publishGroups(const bus::NetworkSnapshot& snapshot, const ros::Time& stamp);
  cia402_driver::BusState busState(const bus::NetworkSnapshot& snapshot) const;
  cia402_driver::AxisStates axisStates(const bus::NetworkSnapshot& snapshot) const;
  bool changed(const cia402_driver::AxisStates& states) const;

  bus::BusRunner& runner_;
  const LinkWatch& link_;
  const config::RobotConfig& robot_;
  const std::vector<motion::Joint> joints_;  ///< in the order of the snapshots
  JointStateStamps joint_state_stamps_;
  cia402_driver::AxisStates last_states_;
  Time axis_states_sent_{}, bus_state_sent_{};
  ros::Publisher joint_states_pub_, axis_states_pub_, bus_state_pub_;
  std::vector<ros::Publisher> group_pubs_;
};

/// What the fault or the procedure of an axis says, as cia402_driver::AxisState and diagnostics
/// show it.
std::string stepText(const bus::AxisSnapshot& axis);

}  // namespace cia402::ros_node
