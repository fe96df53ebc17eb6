// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/joints.h"

#include <algorithm>
#include <cmath>

#include "motion/coupling.h"

namespace cia402::campaign {
namespace {

std::size_t indexOf(const std::vector<AxisFacts>& axes, const std::string& name) {
  const auto found = std::find_if(axes.begin(), axes.end(),
                                  [&](const AxisFacts& axis) { return axis.name == name; });
  return static_cast<std::size_t>(found - axes.begin());
}

JointFacts jointOf(const motion::Joint& joint) {
  JointFacts facts;
  facts.name = joint.name;
  facts.limits = joint.limits;
  facts.velocity = joint.limits.velocity.value_or(1.0);
  const bool linear = joint.unit == motion::JointUnit::metre;
  facts.acceleration = joint.limits.acceleration.value_or(linear ? 0.5 : 5.0);
  return facts;
}

/// What an axis does to the joints that it moves with others, by the inverse of the matrix.
void couple(AxisFacts& axis, const config::CouplingConfig& coupling,
            const std::vector<JointFacts>& joints, std::size_t column) {
  axis.gantry = coupling.gantry.has_value();
  axis.joint_share = 0.0;
  for (std::size_t row = 0; row < joints.size(); ++row) {
    axis.joint_share += std::fabs(coupling.matrix->shareOfAxis(column, row));
    const Duration stop = fromSeconds(1.2 * joints[row].velocity / joints[row].acceleration + 0.15);
    axis.longest_joint_stop = std::max(axis.longest_joint_stop, stop);
  }
}

}  // namespace

std::vector<JointFacts> jointsOf(const config::RobotConfig& robot, std::vector<AxisFacts>& axes) {
  std::vector<JointFacts> joints;
  for (AxisFacts& axis : axes) {
    axis.coupled = {axis.index};
    if (robot.couplingOf(axis.name) != nullptr) continue;
    const auto all = robot.joints();
    const auto own = std::find_if(all.begin(), all.end(), [&](const motion::Joint& joint) {
      return joint.name == axis.config->joint;
    });
    joints.push_back(jointOf(*own));
    joints.back().axes = {axis.index};
    joints.back().shares = {1.0};
  }
  for (const config::CouplingConfig& coupling : robot.couplings) {
    std::vector<JointFacts> together;
    std::vector<std::size_t> members;
    for (const std::string& name : coupling.axes) members.push_back(indexOf(axes, name));
    for (std::size_t row = 0; row < coupling.joints.size(); ++row) {
      together.push_back(jointOf(coupling.joints[row]));
      together.back().axes = members;
      for (std::size_t column = 0; column < members.size(); ++column) {
        together.back().shares.push_back(coupling.matrix->matrix()(
            static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)));
      }
    }
    for (std::size_t column = 0; column < members.size(); ++column) {
      axes[members[column]].coupled = members;
      couple(axes[members[column]], coupling, together, column);
    }
    joints.insert(joints.end(), together.begin(), together.end());
  }
  return joints;
}

double JointFacts::position(const std::vector<AxisTruth>& truths) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < axes.size(); ++k) sum += shares[k] * truths[axes[k]].position;
  return sum;
}

double JointFacts::speed(const std::vector<AxisTruth>& truths) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    sum += std::fabs(shares[k] * truths[axes[k]].velocity);
  }
  return sum;
}

}  // namespace cia402::campaign
