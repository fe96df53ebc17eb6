// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/publishers.h"

#include <control_msgs/JointTrajectoryControllerState.h>

#include <cmath>
#include <limits>

#include "ros/clock_map.h"
#include "ros/group_message.h"

namespace cia402::ros_node {
namespace {

constexpr Duration kAxisStatesInterval = std::chrono::milliseconds(100);  // at the latest
constexpr Duration kBusStateInterval = std::chrono::milliseconds(500);
constexpr Duration kEarly = std::chrono::milliseconds(5);  // of timers, that is on time

double age(Time since, Time now) {
  return since == Time() ? std::numeric_limits<double>::infinity() : toSeconds(now - since);
}

/// Of a value that may be unknown: NaN then.
double age(bool known, Time since, Time now) {
  return known ? toSeconds(now - since) : std::numeric_limits<double>::quiet_NaN();
}

void addAges(const drive::AxisState& state, Time now, cia402_driver::AxisState& message) {
  const drive::AxisState::Stamps& stamps = state.stamps;
  message.feedback_age = age(state.stamp, now);
  message.mode_age = age(state.mode != nullptr, stamps.mode, now);
  message.velocity_age = age(!std::isnan(state.velocity), stamps.velocity, now);
  message.effort_age = age(!std::isnan(state.effort), stamps.effort, now);
  message.following_error_age =
      age(!std::isnan(state.following_error), stamps.following_error, now);
  message.digital_inputs_age = age(state.digital_inputs_valid, stamps.digital_inputs, now);
}

cia402_driver::AxisState axisState(const bus::AxisSnapshot& axis, const drive::AxisConfig& config,
                                   const bus::BusTime& time) {
  cia402_driver::AxisState message;
  message.name = config.name;
  message.joint = config.joint;
  message.state = drive::toString(axis.state.state);
  message.mode = axis.state.mode ? axis.state.mode->name : "";
  message.statusword = axis.state.statusword;
  message.homed = axis.state.homed;
  message.halted = axis.state.halted;
  message.target_reached = axis.state.target_reached;
  message.warning = axis.state.warning;
  message.internal_limit = axis.state.internal_limit;
  message.error_code = axis.state.error_code;
  message.error_text = axis.words.problem.str();
  message.procedure = axis.procedure_running ? drive::toString(axis.procedure) : "";
  message.step = stepText(axis);
  message.position = axis.state.position;
  message.velocity = axis.state.velocity;
  message.effort = axis.state.effort;
  message.following_error = axis.state.following_error;
  message.digital_inputs = axis.state.digital_inputs;
  message.digital_inputs_valid = axis.state.digital_inputs_valid;
  addAges(axis.state, time.now(), message);
  if (axis.state.stamp != Time()) message.stamp = toRos(time, axis.state.stamp);
  return message;
}

/// @param axis the first one in it
cia402_driver::NodeState nodeState(const bus::AxisSnapshot& axis, canopen::NodeId node_id,
                                   Time now) {
  cia402_driver::NodeState message;
  message.node_id = node_id;
  message.nmt_state = canopen::toString(axis.node.nmt);
  message.ready = axis.state.health == fieldbus::Health::ready;
  message.step = message.ready ? "" : axis.words.step.str();
  message.heartbeat_age = age(axis.node.last_heartbeat, now);
  message.boot_ups = axis.node.boot_ups;
  message.emergencies = static_cast<std::uint32_t>(axis.emergencies.total);
  message.vendor_id = axis.node.identity.vendor_id;
  message.product_code = axis.node.identity.product_code;
  message.revision_number = axis.node.identity.revision;
  message.serial_number = axis.node.identity.serial;
  return message;
}

}  // namespace

std::string stepText(const bus::AxisSnapshot& axis) {
  std::string text = axis.words.step.str();
  if (!axis.words.waiting_for.empty()) text += ", waiting for " + axis.words.waiting_for.str();
  return text;
}

Publishers::Publishers(ros::NodeHandle& node, ros::NodeHandle& private_node, bus::BusRunner& runner,
                       const LinkWatch& link, const config::RobotConfig& robot)
    : runner_(runner), link_(link), robot_(robot), joints_(robot.joints()) {
  joint_states_pub_ = node.advertise<sensor_msgs::JointState>("joint_states", 10);
  axis_states_pub_ = private_node.advertise<cia402_driver::AxisStates>("axis_states", 10, true);
  bus_state_pub_ = private_node.advertise<cia402_driver::BusState>("bus_state", 10, true);
  for (const config::GroupConfig& group : robot.groups) {
    group_pubs_.push_back(private_node.advertise<control_msgs::JointTrajectoryControllerState>(
        group.name + "/state", 10));
  }
}

void Publishers::publishJointStates(const bus::NetworkSnapshot& snapshot) {
  const ros::Time now = ros::Time::now();
  const Time newest = newestFeedback(snapshot.joints);
  const ros::Time when = newest == Time() ? now : toRos(runner_.time(), newest);
  sensor_msgs::JointState message =
      jointStates(joints_, snapshot.joints, robot_.omit_unknown_joints);
  if (!message.name.empty()) {
    if (const auto stamp = joint_state_stamps_.next(snapshot.joints, when, now)) {
      message.header.stamp = *stamp;
      joint_states_pub_.publish(message);
    }
  }
  publishGroups(snapshot, when);
}

void Publishers::publishGroups(const bus::NetworkSnapshot& snapshot, const ros::Time& stamp) {
  for (std::size_t g = 0; g < group_pubs_.size(); ++g) {
    if (group_pubs_[g].getNumSubscribers() == 0) continue;
    control_msgs::JointTrajectoryControllerState message;
    message.header.stamp = stamp;
    addGroup(robot_.groups[g], joints_, snapshot, message);
    group_pubs_[g].publish(message);
  }
}

void Publishers::publishStates() {
  const bus::NetworkSnapshot snapshot = runner_.snapshot();
  const Time now = bus::realNow() + kEarly;
  const cia402_driver::AxisStates states = axisStates(snapshot);
  if (changed(states) || now - axis_states_sent_ >= kAxisStatesInterval) {
    if (axis_states_pub_.getNumSubscribers() > 0) runner_.look();
    axis_states_sent_ = now;
    last_states_ = states;
    axis_states_pub_.publish(states);
  }
  if (now - bus_state_sent_ >= kBusStateInterval) {
    bus_state_sent_ = now;
    bus_state_pub_.publish(busState(snapshot));
  }
}

cia402_driver::AxisStates Publishers::axisStates(const bus::NetworkSnapshot& snapshot) const {
  cia402_driver::AxisStates message;
  message.header.stamp = ros::Time::now();
  for (std::size_t i = 0; i < snapshot.axes.size(); ++i) {
    message.axes.push_back(axisState(snapshot.axes[i], robot_.axes[i], runner_.time()));
  }
  return message;
}

bool Publishers::changed(const cia402_driver::AxisStates& states) const {
  if (states.axes.size() != last_states_.axes.size()) return true;
  for (std::size_t i = 0; i < states.axes.size(); ++i) {
    const cia402_driver::AxisState& a = states.axes[i];
    const cia402_driver::AxisState& b = last_states_.axes[i];
    if (a.state != b.state || a.mode != b.mode || a.homed != b.homed || a.halted != b.halted ||
        a.target_reached != b.target_reached || a.warning != b.warning ||
        a.internal_limit != b.internal_limit || a.error_code != b.error_code ||
        a.error_text != b.error_text || a.procedure != b.procedure || a.step != b.step ||
        a.digital_inputs != b.digital_inputs || a.digital_inputs_valid != b.digital_inputs_valid) {
      return true;
    }
  }
  return false;
}

cia402_driver::BusState Publishers::busState(const bus::NetworkSnapshot& snapshot) const {
  cia402_driver::BusState message;
  message.header.stamp = ros::Time::now();
  message.interface = robot_.bus.interface;
  message.state = can::toString(snapshot.bus_state);
  message.description = snapshot.bus_text.str();
  const can::TrafficMeter::Load load = link_.load(snapshot);
  message.load = load.nominal;
  message.load_most = load.most;
  message.frames_sent = snapshot.counters.frames_sent;
  message.frames_received = snapshot.counters.frames_received;
  message.frames_deferred = snapshot.counters.frames_deferred;
  message.frames_dropped = snapshot.counters.frames_dropped;
  message.error_frames = snapshot.counters.error_frames;
  message.bus_off_events = snapshot.counters.bus_off_events;
  message.interface_losses = snapshot.counters.interface_losses;
  message.receive_overflows = snapshot.counters.receive_overflows;
  message.frames_stale = snapshot.counters.frames_stale;
  message.tx_pending = static_cast<std::uint32_t>(snapshot.pending);
  message.arbitration_lost = snapshot.counters.error_classes[1];
  message.restart_attempts = snapshot.counters.restart_attempts;
  message.restarts = snapshot.counters.restarts;
  message.transmit_errors = snapshot.error_counters
                                ? static_cast<std::int16_t>(snapshot.error_counters->transmit)
                                : std::int16_t{-1};
  message.receive_errors = snapshot.error_counters
                               ? static_cast<std::int16_t>(snapshot.error_counters->receive)
                               : std::int16_t{-1};
  message.sync_period = toSeconds(robot_.bus.sync_period);
  message.cycles = snapshot.statistics.cycles();
  message.overruns = snapshot.statistics.overruns();
  message.sync_lateness_last = snapshot.statistics.lastLateness();
  message.sync_lateness_rms = snapshot.statistics.rmsLateness();
  message.sync_lateness_max = snapshot.statistics.maxLateness();
  message.real_time = runner_.realtime().complete();
  const Time now = runner_.time().now();
  for (std::size_t i = 0; i < snapshot.axes.size(); ++i) {
    message.missed_feedback += snapshot.axes[i].missed_feedback;
    const drive::AxisConfig& axis = robot_.axes[i];
    if (message.nodes.size() == axis.device) {  // devices are in the order of their first axes
      const canopen::NodeId id = robot_.deviceOf(axis).node_id;
      message.nodes.push_back(nodeState(snapshot.axes[i], id, now));
    }
    message.nodes[axis.device].axes.push_back(axis.name);
  }
  return message;
}

}  // namespace cia402::ros_node
