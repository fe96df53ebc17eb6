// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/joint.h"

#include <algorithm>

namespace cia402::bus {
namespace {

std::string switchAdvice(const drive::AxisConfig& axis) {
  const drive::ModeSpec* mode = drive::trajectoryMode(axis);
  return mode == nullptr ? "no mode that it can be in does"
                         : "~" + axis.name + "/set_mode " + mode->name + " first";
}

}  // namespace

Joint::Joint(AxisUnit& unit)
    : unit_(&unit),
      description_(drive::jointOf(unit.axis.config())),
      who_(drive::jointName(unit.axis.config())),
      stop_deceleration_(drive::stopDeceleration(unit.axis.config())) {}

void Joint::adoptLimits() {
  description_ = drive::jointOf(unit_->axis.config());
  stop_deceleration_ = drive::stopDeceleration(unit_->axis.config());
}

JointState Joint::state() const {
  const drive::AxisState& from = axis().state();
  JointState state;
  state.known = from.feedback_valid;
  state.stamp = from.stamp;
  state.position = from.position;
  state.velocity = from.velocity;
  state.effort = from.effort;
  const bool takes_positions =
      from.mode != nullptr && from.mode->kind == drive::ControlKind::position;
  if (takes_positions) {
    state.desired = axis().target();
    state.desired_velocity = sent().velocity();
  }
  return state;
}

int Joint::homingOrder() const {
  const auto& homing = axis().config().homing;
  return homing ? homing->order : 0;
}

std::string Joint::refusal(const std::string& group) const {
  std::string reason = axis().motionRefusal();
  if (!reason.empty()) return reason;
  const drive::ModeSpec* mode = axis().state().mode;
  if (mode == nullptr || !mode->cyclic || mode->kind != drive::ControlKind::position) {
    return who_ + " is in mode " + (mode ? mode->name : "unknown") +
           ", which does not follow trajectories: " + switchAdvice(axis().config());
  }
  const std::string* leader = axis().leader();
  if (followsAnother(group)) return who_ + " follows a trajectory of group " + *leader;
  // In the cycle in which a trajectory has ended, the stream still knows the way to its goal only.
  const bool rests = axis().streamAtRest() || sent().atRest();
  if (leader == nullptr && !rests) {
    return who_ + " is still moved by streamed set-points: end the stream and let it come to rest";
  }
  return {};
}

std::string Joint::trouble(std::uint32_t told_before) const {
  std::string reason = axis().motionRefusal();
  if (!reason.empty()) return reason;
  if (axis().noticeCount() != told_before) return axis().notice();
  return who_ + " fell out of operation or got another zero on the way";
}

std::vector<motion::Joint> jointsOf(const config::RobotConfig& robot) {
  std::vector<motion::Joint> joints;
  for (const drive::AxisConfig& axis : robot.axes) joints.push_back(drive::jointOf(axis));
  return joints;
}

Joints::Joints(std::vector<AxisUnit>& units) {
  joints_.reserve(units.size());
  for (AxisUnit& unit : units) joints_.emplace_back(unit);
}

Joint* Joints::find(const std::string& name) {
  const auto found = std::find_if(joints_.begin(), joints_.end(),
                                  [&](const Joint& joint) { return joint.name() == name; });
  return found != joints_.end() ? &*found : nullptr;
}

}  // namespace cia402::bus
