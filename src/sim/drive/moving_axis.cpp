// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/moving_axis.h"

#include <cmath>

namespace cia402::sim {
namespace {

constexpr double kStandingSpeed = 1e-3;  // turns/s

MotorParameters withMechanics(MotorParameters parameters, const AxisMechanics& mechanics) {
  parameters.position_time_constant = mechanics.inertia_time_constant;
  return parameters;
}

}  // namespace

MovingAxis::MovingAxis(const DriveDefinition& drive_definition,
                       const MotorParameters& motor_parameters, const AxisMechanics& mechanics,
                       DriveValues& drive_values)
    : definition(drive_definition),
      values(drive_values),
      switches(mechanics),
      motor(withMechanics(motor_parameters, mechanics), mechanics.initial_position),
      limits(definition, values, switches,
             motor_parameters.max_torque * motor_parameters.rated_acceleration) {}

double MovingAxis::commanded(Role target) const {
  const double value = values.get(target, 0.0);
  const auto quantity = static_cast<std::size_t>(roleInfo(target).quantity);
  const bool turned = (values.raw(Role::polarity, 0) & definition.polarity[quantity]) != 0;
  return turned ? -value : value;
}

double MovingAxis::trueTarget(double turns) {
  const double target = limits.clamped(turns) + frame;
  const double range = values.range(Role::target_position);
  if (!definition.positions_wrap || range == 0.0) return target;
  const double ranges = std::round((target - demand.position) / range);
  return ranges == 0.0 ? target : target - ranges * range;
}

void MovingAxis::slowDown(Ramp ramp) {
  demand.profile.stop(limits.deceleration(ramp, mode));
  demand.followProfile();
}

void MovingAxis::keepSpeed() {
  demand.position += demand.velocity * kDriveStepS;
  demand.profile.reset(demand.position, demand.velocity);
}

bool MovingAxis::standing() const {
  return std::fabs(motor.velocity()) < kStandingSpeed && demand.velocity == 0.0;
}

}  // namespace cia402::sim
