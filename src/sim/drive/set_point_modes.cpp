// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/set_point_modes.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

/// What limit switches and 607Dh leave of a speed.
double allowedVelocity(MovingAxis& axis, double velocity, double braking) {
  if (velocity != 0.0 && axis.blocked(velocity)) return 0.0;
  return axis.limits.braked(velocity, axis.motor.position() - axis.frame, braking);
}

/// Of torques that stream, where the maker has ramps for them.
double streamedSlope(const MovingAxis& axis, double target) {
  const double to_zero = axis.values.get(Role::torque_ramp_to_zero, 0.0);
  const double slope = axis.values.get(Role::torque_ramp, 0.0);
  if (target == 0.0 && to_zero > 0.0) return to_zero;
  return slope > 0.0 ? slope : kUnlimited;
}

/// The most that a torque may lead to.
double speedByTorque(const MovingAxis& axis) {
  const double most = axis.limits.maxSpeed();
  if (!axis.mode->velocity) return most;
  return std::min(most, std::fabs(axis.values.get(*axis.mode->velocity, 0.0)));
}

}  // namespace

void stepVelocity(MovingAxis& axis, bool ramped) {
  Demand& demand = axis.demand;
  double limit = axis.limits.maxSpeed();
  if (ramped) limit = std::min(limit, axis.values.get(Role::max_profile_velocity, kUnlimited));
  const double offset = ramped ? 0.0 : axis.offset(Role::velocity_offset);
  const double wanted = std::clamp(axis.commanded(Role::target_velocity) + offset, -limit, limit);
  const ProfileLimits limits = axis.limits.profile(axis.mode);
  const double braking = axis.limits.deceleration(Ramp::quick_stop, axis.mode);
  const double target = allowedVelocity(axis, wanted, braking);
  const bool forced = target != wanted;
  const double most = axis.limits.clamp();
  const double corners = ramped && !forced ? axis.limits.cornerTime(limits) : 0.0;
  if (corners > 0.0) {
    demand.ramp = rampVelocity(demand.ramp, target, limits.acceleration, limits.deceleration);
    demand.corners.limit(corners);
    demand.velocity = demand.corners.step(demand.ramp);
  } else {
    const double up = ramped || forced ? limits.acceleration : most;
    const double down = forced ? braking : ramped ? limits.deceleration : most;
    demand.velocity = rampVelocity(demand.velocity, target, up, down);
    demand.beginRamp();
  }
  axis.motor.followVelocity(demand.velocity, ramped ? 0.0 : axis.offset(Role::torque_offset));
  demand.position = axis.motor.position();
}

void stepVelocityMode(MovingAxis& axis, const VelocityModeBits& bits) {
  Demand& demand = axis.demand;
  const double target = axis.values.get(Role::vl_target_velocity, 0.0);
  const double most =
      std::min(axis.limits.maxSpeed(), axis.values.get(Role::vl_maximum, kUnlimited));
  const double least = std::min(axis.values.get(Role::vl_minimum, 0.0), most);
  const double amount = std::clamp(std::fabs(target), least, most);
  const double wanted = bits.reference ? std::copysign(amount, target) : 0.0;
  const double braking = axis.limits.deceleration(Ramp::quick_stop, axis.mode);
  const double allowed = allowedVelocity(axis, bits.unlocked ? wanted : demand.velocity, braking);
  const ProfileLimits limits = axis.limits.profile(axis.mode);
  demand.velocity =
      bits.ramped ? rampVelocity(demand.velocity, allowed, limits.acceleration, limits.deceleration)
                  : allowed;
  axis.values.set(Role::vl_velocity_demand, demand.velocity);
  axis.motor.followVelocity(demand.velocity);
  demand.position = axis.motor.position();
}

void stepTorque(MovingAxis& axis, bool ramped) {
  Demand& demand = axis.demand;
  const double target =
      axis.commanded(Role::target_torque) + (ramped ? 0.0 : axis.offset(Role::torque_offset));
  const double slope =
      ramped ? axis.values.get(Role::torque_slope, kUnlimited) : streamedSlope(axis, target);
  const double change = slope * kDriveStepS;
  demand.torque = std::clamp(target, demand.torque - change, demand.torque + change);
  const bool stopped = demand.torque != 0.0 && axis.blocked(demand.torque);
  axis.motor.applyTorque(stopped ? 0.0 : demand.torque, speedByTorque(axis));
  demand.position = axis.motor.position();
  demand.velocity = axis.motor.velocity();
}

void stepFading(MovingAxis& axis) {
  Demand& demand = axis.demand;
  const double change = axis.values.get(Role::torque_slope, kUnlimited) * kDriveStepS;
  demand.torque = std::clamp(0.0, demand.torque - change, demand.torque + change);
  axis.motor.applyTorque(demand.torque, speedByTorque(axis));
  demand.position = axis.motor.position();
  demand.velocity = axis.motor.velocity();
}

void stepHold(MovingAxis& axis) {
  axis.slowDown(Ramp::slow_down);
  axis.motor.followPosition(axis.demand.position);
}

}  // namespace cia402::sim
