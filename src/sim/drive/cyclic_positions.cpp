// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/cyclic_positions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cia402::sim {

bool CyclicPositions::ofThisMode() const {
  return axis_.mode != nullptr && (axis_.mode->behaviour == ModeBehaviour::cyclic_position ||
                                   axis_.mode->behaviour == ModeBehaviour::interpolated_position);
}

Role CyclicPositions::targetRole() const {
  return axis_.mode->behaviour == ModeBehaviour::cyclic_position ? Role::target_position
                                                                 : Role::interpolation_target;
}

bool CyclicPositions::follows(bool bit_4) const {
  return bit_4 || axis_.mode->behaviour == ModeBehaviour::cyclic_position;
}

void CyclicPositions::target(double seconds, double into) {
  axis_.limits.release();
  const bool csp = axis_.mode->behaviour == ModeBehaviour::cyclic_position;
  const double offset = csp ? axis_.offset(Role::position_offset) : 0.0;
  double target = axis_.trueTarget(axis_.commanded(targetRole()) + offset);
  // From the one before, or from where the drive is, which may have stopped at a switch.
  const double at = axis_.demand.interpolator.position();
  const double step = std::min(std::fabs(target - last_.value_or(at)), std::fabs(target - at));
  const double farthest = axis_.definition.position_step * axis_.motor.maxSpeed() * seconds;
  last_ = target;
  resolution_ = axis_.values.resolution(targetRole());
  far_ = far_ || (farthest > 0.0 && step > farthest);
  if (far_) return;
  if (axis_.mode->delayed) {
    target = std::exchange(pending_, target).value_or(axis_.demand.interpolator.position());
  }
  led_ = target;
  axis_.demand.interpolator.moveTo(target, seconds, into);
}

/// A set-point that reads like the present place is none to go to.
bool CyclicPositions::goesOn() const {
  return !led_ || std::fabs(*led_ - axis_.demand.position) > resolution_;
}

void CyclicPositions::step(bool bit_4) {
  Demand& demand = axis_.demand;
  if (!follows(bit_4)) {
    axis_.slowDown(Ramp::slow_down);
    demand.interpolator.reset(demand.position);
    axis_.motor.followPosition(demand.position);
    return;
  }
  const double before = demand.interpolator.position();
  demand.interpolator.step();
  const double moved = demand.interpolator.position() - before;
  if (moved != 0.0 && goesOn() && axis_.blocked(moved)) {
    stopAtSwitch(moved);
  } else {
    demand.position = demand.interpolator.position();
    demand.velocity = demand.interpolator.velocity();
    demand.profile.reset(demand.position, demand.velocity);
  }
  if (axis_.mode->behaviour == ModeBehaviour::cyclic_position) {
    axis_.motor.followPosition(
        demand.position, {axis_.offset(Role::velocity_offset), axis_.offset(Role::torque_offset)});
  } else {
    axis_.motor.followPosition(demand.position);
  }
}

void CyclicPositions::stopAtSwitch(double moved) {
  Demand& demand = axis_.demand;
  const double speed = demand.velocity * moved <= 0.0 ? 0.0
                                                      : std::min(std::fabs(demand.velocity),
                                                                 std::fabs(axis_.motor.velocity()));
  demand.profile.reset(demand.position, std::copysign(speed, moved));
  axis_.slowDown(Ramp::quick_stop);
  demand.interpolator.reset(demand.position);
}

bool CyclicPositions::reached() const {
  const Demand& demand = axis_.demand;
  const double window = std::fabs(axis_.values.get(Role::position_window, 0.0));
  return demand.velocity == 0.0 && std::fabs(demand.position - axis_.motor.position()) <= window;
}

}  // namespace cia402::sim
