// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/motion.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

constexpr double kStandingSpeed = 1e-3;  // turns/s
constexpr double kUnlimited = 1e9;

MotorParameters withMechanics(MotorParameters parameters, const AxisMechanics& mechanics) {
  parameters.position_time_constant = mechanics.inertia_time_constant;
  return parameters;
}

}  // namespace

DriveMotion::DriveMotion(const DriveDefinition& definition, const AxisMechanics& mechanics,
                         DriveValues& values)
    : definition_(definition),
      mechanics_(mechanics),
      values_(values),
      switches_(mechanics),
      motor_(withMechanics(definition.motor, mechanics), mechanics.initial_position),
      time_constant_(mechanics.inertia_time_constant) {
  takeOver();
}

bool DriveMotion::positionControlled() const {
  if (stop_ || held_ || mode_ == nullptr) return true;
  switch (mode_->behaviour) {
    case ModeBehaviour::profile_velocity:
    case ModeBehaviour::cyclic_velocity:
    case ModeBehaviour::profile_torque:
    case ModeBehaviour::cyclic_torque:
      return false;
    default:
      return true;
  }
}

void DriveMotion::takeOver() {
  // Where the demand has to be for the position loop to keep the present speed.
  demand_ = motor_.position() + motor_.velocity() * time_constant_;
  demand_velocity_ = motor_.velocity();
  demand_torque_ = 0.0;
  profile_.reset(demand_, demand_velocity_);
  interpolator_.reset(demand_);
}

void DriveMotion::powerStage(bool on) {
  powered_ = on;
  stop_.reset();
  held_ = false;
  halted_ = false;
  following_.reset();
  following_error_exceeded_ = false;
  limited_ = false;
  limit_switch_hit_ = false;
  takeOver();
  setMode(mode_);
}

void DriveMotion::setMode(const ModeDefinition* mode) {
  if (powered_) takeOver();
  mode_ = mode;
  profile_.reset(demand_, demand_velocity_);
  interpolator_.reset(demand_);
  active_ = {demand_, {}};
  buffered_.reset();
  acknowledged_ = false;
  bit_4_ = false;
  homing_.stop();
  homing_attained_ = homing_failed_ = homing_returning_ = false;
  target_reached_ = false;
  position_reached_.reset();
  velocity_reached_.reset();
  if (mode_ != nullptr && mode_->behaviour == ModeBehaviour::profile_position && mode_->handshake) {
    active_.limits = profileLimits();
    if (active_.limits.deceleration > 0.0) {  // the nearest place to stand still
      active_.target +=
          demand_velocity_ * std::fabs(demand_velocity_) / (2.0 * active_.limits.deceleration);
    }
  }
}

void DriveMotion::stop(Ramp ramp) {
  takeOver();  // from where the rotor really is, whatever was demanded of it
  stop_ = ramp;
}

void DriveMotion::release() {
  if (!stop_) return;
  stop_.reset();
  halted_ = false;
  profile_.reset(demand_, demand_velocity_);
  interpolator_.reset(demand_);
}

void DriveMotion::hold(bool on) {
  if (on == held_) return;
  held_ = on;
  profile_.reset(demand_, 0.0);
  interpolator_.reset(demand_);
}

double DriveMotion::deceleration(Ramp ramp) const {
  switch (ramp) {
    case Ramp::slow_down:
      return values_.get(Role::profile_deceleration, kUnlimited);
    case Ramp::quick_stop:
      return values_.get(Role::quick_stop_deceleration, kUnlimited);
    case Ramp::limit:
    case Ramp::coast:
      break;
  }
  return definition_.motor.max_torque * definition_.motor.rated_acceleration;
}

double DriveMotion::maxSpeed() const {
  return std::fabs(values_.get(Role::max_motor_speed, kUnlimited));
}

ProfileLimits DriveMotion::profileLimits() const {
  ProfileLimits limits;
  const double speed = mode_ != nullptr && mode_->velocity
                           ? std::fabs(values_.get(*mode_->velocity, kUnlimited))
                           : kUnlimited;
  limits.velocity =
      std::min({speed, maxSpeed(), values_.get(Role::max_profile_velocity, kUnlimited)});
  limits.acceleration = std::min(values_.get(Role::profile_acceleration, kUnlimited),
                                 values_.get(Role::max_acceleration, kUnlimited));
  limits.deceleration = std::min(values_.get(Role::profile_deceleration, kUnlimited),
                                 values_.get(Role::max_deceleration, kUnlimited));
  return limits;
}

/// 607Dh in the drive's own turns; none where it limits nothing: both equal, or at their widest.
std::optional<DriveMotion::Span> DriveMotion::positionLimits() const {
  if (!values_.has(Role::position_minimum)) return std::nullopt;
  const Span span{values_.get(Role::position_minimum, 0.0),
                  values_.get(Role::position_maximum, 0.0)};
  const double all = values_.range(Role::position_minimum);
  const double most = all - all / std::ldexp(1.0, 31);
  if (span.low >= span.high || (all > 0.0 && span.high - span.low >= most)) return std::nullopt;
  return span;
}

/// True turns of what the drive reads as `turns`. Numbers that wrap around mean the nearest of all
/// the places that read so.
double DriveMotion::trueTarget(double turns) {
  const auto limits = positionLimits();
  const double clamped = limits ? std::clamp(turns, limits->low, limits->high) : turns;
  limited_ = limited_ || clamped != turns;
  const double target = clamped + frame_;
  const double range = values_.range(Role::target_position);
  if (!definition_.positions_wrap || range == 0.0) return target;
  const double ranges = std::round((target - demand_) / range);
  return ranges == 0.0 ? target : target - ranges * range;
}

bool DriveMotion::blocked(double direction) {
  const double position = motor_.position();
  const bool at_switch = (direction > 0.0 && switches_.positiveLimit(position)) ||
                         (direction < 0.0 && switches_.negativeLimit(position));
  limited_ = limited_ || at_switch;
  limit_switch_hit_ = limit_switch_hit_ || at_switch;
  return at_switch;
}

bool DriveMotion::standing() const {
  return std::fabs(motor_.velocity()) < kStandingSpeed && demand_velocity_ == 0.0;
}

void DriveMotion::controlBits(std::uint16_t controlword, std::uint16_t previous) {
  if (mode_ == nullptr) return;
  const bool rising = (controlword & 0x0010) != 0 && (previous & 0x0010) == 0;
  bit_4_ = (controlword & 0x0010) != 0;
  if (mode_->behaviour == ModeBehaviour::profile_position && mode_->handshake) {
    if (rising && !acknowledged_) acceptSetPoint(controlword);
    if (!bit_4_) acknowledged_ = buffered_.has_value();
  }
  if (mode_->behaviour == ModeBehaviour::homing && !homesByObject()) {
    if (rising) startHoming();
    if (!bit_4_ && homing_.phase() == HomingSequence::Phase::searching) homing_.stop();
  }
  const bool halt = definition_.halt && (controlword & 0x0100) != 0;
  if (halt && !stop_) {
    const OptionTable& table = definition_.halt_option;
    const auto option = table.options.find(values_.raw(Role::halt_option, table.fallback));
    stop(option == table.options.end() ? Ramp::slow_down : option->second.ramp);
    halted_ = true;
  } else if (!halt && halted_) {
    release();
  }
}

void DriveMotion::acceptSetPoint(std::uint16_t controlword) {
  const bool immediately = (controlword & 0x0020) != 0;
  const bool relative = (controlword & 0x0040) != 0;
  const SetPoint& last = buffered_ ? *buffered_ : active_;
  const double turns = values_.get(Role::target_position, 0.0);
  const SetPoint next{trueTarget(relative ? last.target - frame_ + turns : turns), profileLimits()};
  acknowledged_ = true;
  target_reached_ = false;
  position_reached_.reset();
  const bool busy = profile_.position() != active_.target || profile_.velocity() != 0.0;
  if (immediately || !busy) {
    active_ = next;
    buffered_.reset();
  } else {
    buffered_ = next;
  }
}

void DriveMotion::cyclicTarget(double seconds, double into) {
  if (mode_ == nullptr || mode_->behaviour != ModeBehaviour::cyclic_position) return;
  if (!powered_ || stop_ || held_) return;
  limited_ = false;
  interpolator_.moveTo(trueTarget(values_.get(Role::target_position, 0.0)), seconds, into);
}

void DriveMotion::step() {
  if (time_constant_ != mechanics_.inertia_time_constant) {
    time_constant_ = mechanics_.inertia_time_constant;
    motor_.setPositionTimeConstant(time_constant_);
  }
  if (!powered_) {
    motor_.coast();
    demand_ = motor_.position();
    demand_velocity_ = 0.0;
    return;
  }
  double torque = values_.get(Role::max_torque, kUnlimited);
  if (mode_ != nullptr && mode_->torque) {
    torque = std::min(torque, std::fabs(values_.get(*mode_->torque, kUnlimited)));
  }
  motor_.limitTorque(torque);
  if (mode_ == nullptr || mode_->behaviour != ModeBehaviour::cyclic_position) limited_ = false;
  limit_switch_hit_ = false;
  const double from = motor_.position();
  if (stop_) {
    stepStop();
  } else if (held_ || mode_ == nullptr) {
    demand_velocity_ = 0.0;
    motor_.followPosition(demand_);
  } else {
    switch (mode_->behaviour) {
      case ModeBehaviour::profile_position:
        stepProfilePosition();
        break;
      case ModeBehaviour::cyclic_position:
        stepCyclicPosition();
        break;
      case ModeBehaviour::profile_velocity:
        stepVelocity(true);
        break;
      case ModeBehaviour::cyclic_velocity:
        stepVelocity(false);
        break;
      case ModeBehaviour::profile_torque:
        stepTorque(true);
        break;
      case ModeBehaviour::cyclic_torque:
        stepTorque(false);
        break;
      case ModeBehaviour::homing:
        stepHoming(from);
        break;
      case ModeBehaviour::hold:
        profile_.stop(deceleration(Ramp::slow_down));
        demand_ = profile_.position();
        demand_velocity_ = profile_.velocity();
        motor_.followPosition(demand_);
        break;
    }
  }
  superviseFollowing();
  superviseTargets();
}

void DriveMotion::stepStop() {
  profile_.stop(deceleration(*stop_));
  demand_ = profile_.position();
  demand_velocity_ = profile_.velocity();
  motor_.followPosition(demand_);
}

void DriveMotion::stepProfilePosition() {
  if (!mode_->handshake) {
    active_ = {trueTarget(values_.get(Role::target_position, 0.0)), profileLimits()};
  }
  if (blocked(active_.target - profile_.position())) {
    profile_.stop(deceleration(Ramp::quick_stop));
  } else {
    profile_.step(active_.target, active_.limits);
  }
  if (buffered_ && profile_.position() == active_.target && profile_.velocity() == 0.0) {
    active_ = *buffered_;
    buffered_.reset();
    if (!bit_4_) acknowledged_ = false;
  }
  demand_ = profile_.position();
  demand_velocity_ = profile_.velocity();
  motor_.followPosition(demand_);
}

void DriveMotion::stepCyclicPosition() {
  const double before = interpolator_.position();
  interpolator_.step();
  const double moved = interpolator_.position() - before;
  if (moved != 0.0 && blocked(moved)) {
    const double speed = demand_velocity_ * moved <= 0.0
                             ? 0.0
                             : std::min(std::fabs(demand_velocity_), std::fabs(motor_.velocity()));
    demand_velocity_ = std::copysign(speed, moved);
    profile_.reset(demand_, demand_velocity_);
    profile_.stop(deceleration(Ramp::quick_stop));
    demand_ = profile_.position();
    demand_velocity_ = profile_.velocity();
    interpolator_.reset(demand_);
  } else {
    demand_ = interpolator_.position();
    demand_velocity_ = interpolator_.velocity();
  }
  motor_.followPosition(demand_);
}

double DriveMotion::limitedVelocity(double velocity, double braking) {
  if (velocity != 0.0 && blocked(velocity)) return 0.0;
  const auto limits = positionLimits();
  if (!limits || velocity == 0.0) return velocity;
  const double position = motor_.position() - frame_;
  const double room = velocity > 0.0 ? limits->high - position : position - limits->low;
  const double reachable = room <= 0.0 ? 0.0 : std::sqrt(2.0 * braking * room);
  limited_ = limited_ || reachable < std::fabs(velocity);
  return std::copysign(std::min(std::fabs(velocity), reachable), velocity);
}

void DriveMotion::stepVelocity(bool ramped) {
  double limit = maxSpeed();
  if (ramped) limit = std::min(limit, values_.get(Role::max_profile_velocity, kUnlimited));
  const double wanted = std::clamp(values_.get(Role::target_velocity, 0.0), -limit, limit);
  const ProfileLimits limits = profileLimits();
  const double target = limitedVelocity(wanted, deceleration(Ramp::quick_stop));
  const bool forced = target != wanted;
  const double down = forced ? deceleration(Ramp::quick_stop) : limits.deceleration;
  demand_velocity_ =
      ramped || forced ? rampVelocity(demand_velocity_, target, limits.acceleration, down) : target;
  motor_.followVelocity(demand_velocity_);
  demand_ = motor_.position();
}

void DriveMotion::stepTorque(bool ramped) {
  const double target = values_.get(Role::target_torque, 0.0);
  const double slope = ramped ? values_.get(Role::torque_slope, kUnlimited) : kUnlimited;
  const double change = slope * kDriveStepS;
  demand_torque_ = std::clamp(target, demand_torque_ - change, demand_torque_ + change);
  double speed = maxSpeed();
  if (mode_->velocity) speed = std::min(speed, std::fabs(values_.get(*mode_->velocity, 0.0)));
  const bool stopped = demand_torque_ != 0.0 && blocked(demand_torque_);
  motor_.applyTorque(stopped ? 0.0 : demand_torque_, speed);
  demand_ = motor_.position();
  demand_velocity_ = motor_.velocity();
}

}  // namespace cia402::sim
