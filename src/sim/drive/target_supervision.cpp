// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/target_supervision.h"

#include <cmath>

namespace cia402::sim {
namespace {

constexpr double kStandingSpeed = 1e-3;  // turns/s, where there is no 606Fh
constexpr double kSameSpeed = 1e-3;      // turns/s, where there is no 606Dh

}  // namespace

void TargetSupervision::restart() {
  following_.reset();
  following_error_ = false;
}

void TargetSupervision::newTarget() {
  target_reached_ = false;
  position_reached_.reset();
}

void TargetSupervision::newMode() {
  newTarget();
  velocity_reached_.reset();
}

void TargetSupervision::superviseFollowing(bool controlled) {
  const DriveValues& values = axis_.values;
  following_error_ = false;
  const double error = std::fabs(axis_.demand.position - axis_.motor.position());
  const double range = values.get(Role::position_error_range, 0.0);
  const bool ranged = range > 0.0 && values.raw(Role::position_error_off, 0) == 0;
  if (!controlled || !values.has(Role::following_error_window) ||
      values.allOnes(Role::following_error_window)) {
    following_.reset();
    following_error_ = controlled && ranged && error > range;
    return;
  }
  const bool outside = error > std::fabs(values.get(Role::following_error_window, 0.0));
  const double timeout = outside ? values.get(Role::following_error_timeout, 0.0) : 0.0;
  following_error_ = following_.step(outside, timeout) || (ranged && error > range);
}

void TargetSupervision::step(bool controlled, bool halted, const ProfilePosition& set_points) {
  superviseFollowing(controlled);
  const DriveValues& values = axis_.values;
  const double speed = std::fabs(axis_.motor.velocity());
  const bool slow = speed <= values.get(Role::velocity_threshold, kStandingSpeed);
  at_zero_speed_ =
      zero_speed_.step(slow, slow ? values.get(Role::velocity_threshold_time, 0.0) : 0.0);
  target_reached_ = axis_.mode != nullptr && reached(halted, set_points);
}

/// By the maker's own rule, which does not look at the target, or by the target of pt.
bool TargetSupervision::torqueReached() {
  const DriveValues& values = axis_.values;
  if (!values.has(Role::torque_reached_on)) {
    const bool profiled = axis_.mode->behaviour == ModeBehaviour::profile_torque;
    return profiled && axis_.demand.torque == axis_.commanded(Role::target_torque);
  }
  const double above = std::fabs(axis_.motor.torque()) - values.get(Role::torque_reached_base, 0.0);
  const Role limit = torque_above_ ? Role::torque_reached_off : Role::torque_reached_on;
  torque_above_ = above > values.get(limit, 0.0);
  return torque_above_;
}

bool TargetSupervision::reached(bool halted, const ProfilePosition& set_points) {
  const DriveValues& values = axis_.values;
  switch (axis_.mode->behaviour) {
    case ModeBehaviour::profile_position: {
      const bool off = values.allOnes(Role::position_window);
      const double distance = std::fabs(set_points.target() - axis_.motor.position());
      const bool inside = off ? axis_.demand.position == set_points.target()
                              : distance <= std::fabs(values.get(Role::position_window, 0.0));
      const bool there =
          position_reached_.step(inside, values.get(Role::position_window_time, 0.0));
      return halted ? axis_.standing() : there && !set_points.waits();
    }
    case ModeBehaviour::profile_velocity: {
      const double difference = axis_.commanded(Role::target_velocity) - axis_.motor.velocity();
      const bool inside =
          std::fabs(difference) <= std::fabs(values.get(Role::velocity_window, kSameSpeed));
      const bool there =
          velocity_reached_.step(inside, values.get(Role::velocity_window_time, 0.0));
      return halted ? axis_.standing() : there;
    }
    case ModeBehaviour::profile_torque:
    case ModeBehaviour::cyclic_torque:
      return torqueReached();
    default:
      return false;
  }
}

}  // namespace cia402::sim
