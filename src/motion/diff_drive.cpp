// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/diff_drive.h"

#include <algorithm>
#include <cmath>

namespace cia402::motion {
namespace {

/// By which an excess is to be reduced, so that `value` is at most `most`.
double share(double value, double most) {
  return std::fabs(value) > most ? most / std::fabs(value) : 1.0;
}

/// The chord of an arc is so much shorter. @param half of its angle, rad
double chord(double half) { return std::fabs(half) > 1e-9 ? std::sin(half) / half : 1.0; }

}  // namespace

WheelSpeeds wheelSpeeds(const DiffDriveGeometry& base, const PlanarTwist& twist) {
  const double turn = twist.angular * base.separation / 2.0;
  return {(twist.linear - turn) / base.radius, (twist.linear + turn) / base.radius};
}

PlanarTwist twistOf(const DiffDriveGeometry& base, const WheelSpeeds& wheels) {
  return {base.radius * (wheels.left + wheels.right) / 2.0,
          base.radius * (wheels.right - wheels.left) / base.separation};
}

PlanarTwist TwistLimiter::within(const PlanarTwist& wanted) const {
  const WheelSpeeds wheels = wheelSpeeds(base_, wanted);
  const double least = std::min({share(wanted.linear, limits_.linear_velocity),
                                 share(wanted.angular, limits_.angular_velocity),
                                 share(wheels.left, limits_.wheel_velocity),
                                 share(wheels.right, limits_.wheel_velocity)});
  return {wanted.linear * least, wanted.angular * least};
}

const PlanarTwist& TwistLimiter::step(const PlanarTwist& wanted, double dt) {
  const PlanarTwist goal = within(wanted);
  const double linear = goal.linear - twist_.linear, angular = goal.angular - twist_.angular;
  const double part = std::min(share(linear, limits_.linear_acceleration * dt),
                               share(angular, limits_.angular_acceleration * dt));
  if (part == 1.0) return twist_ = goal;
  twist_.linear += linear * part;
  twist_.angular += angular * part;
  return twist_;
}

void WheelOdometry::update(double left, double right) {
  if (last_) {
    const PlanarTwist moved = twistOf(base_, {left - last_->left, right - last_->right});
    const double half = moved.angular / 2.0;
    const double along = pose_.heading + half;
    pose_.position +=
        moved.linear * chord(half) * Eigen::Vector2d(std::cos(along), std::sin(along));
    pose_.heading += moved.angular;
  }
  last_ = Wheels{left, right};
}

}  // namespace cia402::motion
