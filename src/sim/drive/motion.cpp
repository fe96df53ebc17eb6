// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/motion.h"

#include <algorithm>
#include <cmath>

#include "sim/drive/set_point_modes.h"

namespace cia402::sim {
namespace {

// Controlword.
constexpr std::uint16_t kModeBit = 0x0010;  // new set-point, start of homing, ramp, interpolation
constexpr std::uint16_t kUnlockRamp = 0x0020;
constexpr std::uint16_t kReferenceRamp = 0x0040;
constexpr std::uint16_t kHalt = 0x0100;

}  // namespace

DriveMotion::DriveMotion(const DriveDefinition& definition, const MotorParameters& motor_parameters,
                         const AxisMechanics& mechanics, DriveValues& values)
    : mechanics_(mechanics),
      axis_(definition, motor_parameters, mechanics, values),
      time_constant_(mechanics.inertia_time_constant) {
  axis_.demand.takeOver(axis_.motor, time_constant_);
}

bool DriveMotion::positionControlled() const {
  if (stop_ || held_ || axis_.mode == nullptr || axis_.dropsTargets()) return true;
  switch (axis_.mode->behaviour) {
    case ModeBehaviour::velocity:
    case ModeBehaviour::profile_velocity:
    case ModeBehaviour::cyclic_velocity:
    case ModeBehaviour::profile_torque:
    case ModeBehaviour::cyclic_torque:
      return false;
    default:
      return true;
  }
}

bool DriveMotion::fadesInStops() const {
  return fades_ && axis_.mode != nullptr && axis_.mode->stops_fade != StopsFade::never;
}

bool DriveMotion::standing() const {
  const bool ends = stop_ && fadesInStops() && axis_.mode->stops_fade == StopsFade::always;
  return ends ? axis_.demand.torque == 0.0 : axis_.standing();
}

bool DriveMotion::modeBit() const { return (controlword_ & kModeBit) != 0; }

void DriveMotion::powerStage(bool on) {
  powered_ = on;
  if (!on) parts_.maker.begin(false);
  controlword_ = 0;
  stop_.reset();
  held_ = false;
  halted_ = paused_ = false;
  supervision_.restart();
  axis_.limits.release();
  axis_.limits.releaseSwitch();
  axis_.demand.takeOver(axis_.motor, time_constant_);
  setMode(axis_.mode);
}

void DriveMotion::setMode(const ModeDefinition* mode) {
  if (powered_) axis_.demand.takeOver(axis_.motor, time_constant_);
  axis_.mode = mode;
  started_ = false;
  axis_.demand.begin();
  cyclic_.forget();
  set_points_.begin();
  homing_.begin();
  supervision_.newMode();
}

void DriveMotion::stop(Ramp ramp, bool commanded) {
  // From where the rotor really is, whatever was demanded of it.
  const double torque = axis_.demand.torque;
  axis_.demand.takeOver(axis_.motor, time_constant_);
  const StopsFade fade = axis_.mode == nullptr ? StopsFade::never : axis_.mode->stops_fade;
  const bool ramped = commanded && (ramp == Ramp::slow_down || ramp == Ramp::quick_stop);
  fades_ = fade == StopsFade::always || (fade == StopsFade::ramps && ramped);
  if (fades_) axis_.demand.torque = torque;
  stop_ = ramp;
  set_points_.stopped();
}

void DriveMotion::release() {
  if (!stop_) return;
  stop_.reset();
  halted_ = false;
  axis_.demand.begin();
}

void DriveMotion::hold(bool on) {
  if (on == held_) return;
  held_ = on;
  axis_.demand.profile.reset(axis_.demand.position, 0.0);
  axis_.demand.interpolator.reset(axis_.demand.position);
}

void DriveMotion::controlBits(std::uint16_t controlword, std::uint16_t previous) {
  controlword_ = controlword;
  if (axis_.mode == nullptr) return;
  const bool bit_4 = modeBit();
  const bool rising = bit_4 && (previous & kModeBit) == 0;
  if (set_points_.control(controlword, previous)) begun();
  if (axis_.inMode(ModeBehaviour::homing)) homing_.control(bit_4, rising);
  started_ = started_ || (axis_.inMode(ModeBehaviour::homing) && rising);
  halt();
}

/// A set-point has come.
void DriveMotion::begun() {
  supervision_.newTarget();
  started_ = true;
}

void DriveMotion::pause(bool on) {
  if (on == paused_) return;
  paused_ = on && powered_;
  halt();
}

void DriveMotion::halt() {
  const bool wanted = paused_ || (axis_.definition.halt && (controlword_ & kHalt) != 0);
  if (wanted && !stop_) {
    const OptionTable& table = axis_.definition.halt_option;
    const auto option = table.options.find(axis_.values.raw(Role::halt_option, table.fallback));
    stop(option == table.options.end() ? Ramp::slow_down : option->second.ramp, true);
    halted_ = true;
  } else if (!wanted && halted_) {
    release();
  }
}

void DriveMotion::cyclicTarget(double seconds, double into) {
  if (!cyclic_.ofThisMode()) return;
  const bool follows =
      cyclic_.follows(modeBit()) && powered_ && !stop_ && !held_ && !axis_.dropsTargets();
  follows ? cyclic_.target(seconds, into) : cyclic_.forget();
}

void DriveMotion::limitTorque() {
  double torque = axis_.values.get(Role::max_torque, kUnlimited);
  if (axis_.mode != nullptr && axis_.mode->torque) {
    torque = std::min(torque, std::fabs(axis_.values.get(*axis_.mode->torque, kUnlimited)));
  }
  if (axis_.inMode(ModeBehaviour::homing)) torque = std::min(torque, homing_.mostTorque());
  const auto limit = [&](Role role) {
    return std::min(torque, std::fabs(axis_.values.get(role, kUnlimited)));
  };
  axis_.motor.limitTorque(limit(Role::forward_torque_limit), limit(Role::reverse_torque_limit));
}

void DriveMotion::step() {
  if (time_constant_ != mechanics_.inertia_time_constant) {
    time_constant_ = mechanics_.inertia_time_constant;
    axis_.motor.setPositionTimeConstant(time_constant_);
  }
  axis_.motor.setStops(mechanics_.negative_stop, mechanics_.positive_stop);
  if (parts_.maker.wantsPower() != parts_.maker.running() &&
      (parts_.maker.running() || !powered_)) {
    powerStage(parts_.maker.wantsPower());
    parts_.maker.begin(powered_);
  }
  const double from = axis_.motor.position();
  stepRotor(from);
  parts_.probes.turned(from);
  const bool rests = !powered_ && axis_.motor.atRest();
  parts_.watch.step(axis_.values, powered_ ? axis_.demand.velocity : 0.0, axis_.motor.velocity(),
                    rests);
}

void DriveMotion::stepRotor(double from) {
  Demand& demand = axis_.demand;
  if (!powered_) {
    axis_.motor.coast();
    demand.position = axis_.motor.position();
    demand.velocity = 0.0;
    return;
  }
  limitTorque();
  if (parts_.maker.running()) return parts_.maker.step();
  // Limits of a cyclic target last until the next one.
  if (!cyclic_.ofThisMode()) axis_.limits.release();
  axis_.limits.releaseSwitch();
  if (stop_ && fadesInStops()) {
    stepFading(axis_);
    const bool over = demand.torque == 0.0 && axis_.standing();
    if (over && axis_.mode->stops_fade == StopsFade::ramps) fades_ = false;  // held from now on
    if (!fades_) demand.begin();
  } else if (stop_) {
    const bool locked = ramps_locked_ && !halted_ && axis_.inMode(ModeBehaviour::velocity);
    locked ? axis_.keepSpeed() : axis_.slowDown(*stop_);
    axis_.motor.followPosition(demand.position);
  } else if (held_ || axis_.mode == nullptr || axis_.dropsTargets()) {
    demand.velocity = 0.0;
    axis_.motor.followPosition(demand.position);
  } else {
    stepMode(from);
  }
  supervision_.step(positionControlled(), halted_, set_points_);
}

void DriveMotion::stepMode(double from) {
  switch (axis_.mode->behaviour) {
    case ModeBehaviour::profile_position:
      return set_points_.step();
    case ModeBehaviour::cyclic_position:
    case ModeBehaviour::interpolated_position:
      return cyclic_.step(modeBit());
    case ModeBehaviour::velocity:
      return stepVelocityMode(axis_, {modeBit(), (controlword_ & kUnlockRamp) != 0,
                                      (controlword_ & kReferenceRamp) != 0});
    case ModeBehaviour::profile_velocity:
      return stepVelocity(axis_, true);
    case ModeBehaviour::cyclic_velocity:
      return stepVelocity(axis_, false);
    case ModeBehaviour::profile_torque:
      return stepTorque(axis_, true);
    case ModeBehaviour::cyclic_torque:
      return stepTorque(axis_, false);
    case ModeBehaviour::homing:
      return homing_.step(from);
    case ModeBehaviour::hold:
      return stepHold(axis_);
  }
}

std::uint16_t DriveMotion::statusBits() const {
  std::uint16_t bits = 0;
  if (axis_.limits.active() && axis_.definition.internal_limit_bit) bits |= 0x0800;
  if (axis_.mode == nullptr) return bits;
  const MakerBits& maker = axis_.mode->maker;
  const auto is_0 = [this](Role role) { return axis_.values.raw(role, 1) == 0; };
  if (std::any_of(maker.not_0.begin(), maker.not_0.end(), is_0)) bits |= 0x4000;
  if (maker.waits_for_start && !started_) {
    return static_cast<std::uint16_t>(bits | maker.before_start);
  }
  if (maker.stopped && (stop_ || axis_.limits.switchHit())) bits |= 0x0100;
  return bits | modeBits();
}

std::uint16_t DriveMotion::modeBits() const {
  std::uint16_t bits = 0;
  const ModeDefinition* mode = axis_.mode;
  if (mode->behaviour == ModeBehaviour::homing) return bits | homing_.statusBits(halted_);
  const bool reached = cyclic_.ofThisMode() ? cyclic_.reached() : supervision_.targetReached();
  if (mode->target_reached && reached) bits |= 0x0400;
  const bool bit_12 =
      (mode->bit_12 == Bit12::acknowledge && set_points_.acknowledged()) ||
      (mode->bit_12 == Bit12::started && started_) || mode->bit_12 == Bit12::always ||
      (mode->bit_12 == Bit12::zero_speed && supervision_.atZeroSpeed()) ||
      (mode->bit_12 == Bit12::follows && !stop_ && !held_ && !axis_.dropsTargets() &&
       (!cyclic_.ofThisMode() || cyclic_.follows(modeBit())));
  if (bit_12) bits |= 0x1000;
  if (mode->bit_13 == Bit13::following_error && followingErrorExceeded()) bits |= 0x2000;
  return bits;
}

bool DriveMotion::onLimitSwitch() const {
  const double turns = axis_.motor.position();
  return axis_.switches.negativeLimit(turns) || axis_.switches.positiveLimit(turns);
}

void DriveMotion::publish() {
  DriveValues& values = axis_.values;
  const double turns = axis_.motor.position();
  const double position = turns - axis_.frame;
  const double demand = axis_.demand.position - axis_.frame;
  const bool nothing = homing_.readsNothing();
  values.set(Role::position_actual, nothing ? 0.0 : position);
  values.set(Role::position_internal, position);
  values.set(Role::velocity_actual, parts_.watch.shown());
  values.set(Role::torque_actual, axis_.motor.torque());
  values.set(Role::current_actual, axis_.motor.torque());
  values.set(Role::position_demand, demand);
  values.set(Role::position_demand_internal, demand);
  values.set(Role::velocity_demand, axis_.demand.velocity);
  values.set(Role::following_error_actual,
             powered_ && positionControlled() ? axis_.demand.position - turns : 0.0);
  values.setRaw(Role::digital_inputs,
                static_cast<std::int64_t>(inputs_ | axis_.switches.levels(turns)));
}

}  // namespace cia402::sim
