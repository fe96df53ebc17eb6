// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_mode.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

constexpr double kHard = 300.0;  // turns/s^2 where there is no 609Ah

using Phase = HomingSequence::Phase;

}  // namespace

void HomingMode::begin() {
  sequence_.stop();
  attained_ = failed_ = returning_ = false;
}

void HomingMode::control(bool bit_4, bool rising) {
  if (byObject()) return;
  if (rising) start();
  if (!bit_4 && searching()) sequence_.stop();
}

void HomingMode::start() {
  const std::int64_t number = axis_.values.raw(Role::homing_method, 0);
  const auto& inert = axis_.definition.inert_methods;
  if (std::find(inert.begin(), inert.end(), number) != inert.end()) return;
  const HomingMethod* method = findHomingMethod(number);
  attained_ = false;
  failed_ = method == nullptr;
  returning_ = false;
  sequence_.stop();
  if (method == nullptr) return;
  sequence_.start(*method, axis_.switches, axis_.motor.position());
  if (sequence_.phase() == Phase::found) finish();
}

void HomingMode::finish() {
  const double offset = axis_.values.get(Role::home_offset, 0.0);
  axis_.frame = sequence_.home() - (axis_.definition.home_offset_is_zero_shift ? -offset : offset);
  attained_ = true;
  axis_.limits.setHomed(true);
  returning_ = axis_.definition.homing_returns;
}

void HomingMode::returnHome() {
  Demand& demand = axis_.demand;
  const double acceleration = axis_.values.get(Role::homing_acceleration, kHard);
  demand.profile.reset(demand.position, demand.velocity);
  const double speed = axis_.values.get(Role::homing_zero_speed, 0.0);
  demand.profile.step(sequence_.home(), {speed, acceleration, acceleration});
  demand.followProfile();
  if (demand.position == sequence_.home() && demand.velocity == 0.0) returning_ = false;
}

void HomingMode::search() {
  Demand& demand = axis_.demand;
  const double acceleration = axis_.values.get(Role::homing_acceleration, kHard);
  const Role speed_of = sequence_.slow() ? Role::homing_zero_speed : Role::homing_search_speed;
  const double speed = axis_.values.get(speed_of, 0.0);
  const double target = searching() ? sequence_.direction() * std::fabs(speed) : 0.0;
  demand.velocity = rampVelocity(demand.velocity, target, acceleration, acceleration);
  demand.position += demand.velocity * kDriveStepS;
}

void HomingMode::step(double from) {
  const bool was_searching = searching();
  returning_ ? returnHome() : search();
  axis_.motor.followPosition(axis_.demand.position);
  if (!was_searching) return;
  sequence_.step(axis_.switches, from, axis_.motor.position());
  if (sequence_.phase() == Phase::found) finish();
  if (sequence_.phase() == Phase::failed) failed_ = true;
}

// CiA 402-2, table of bits 10, 12 and 13 in homing mode.
std::uint16_t HomingMode::statusBits(bool halted) const {
  if (byObject()) return attained_ ? 0x8000 : 0;
  std::uint16_t bits = 0;
  const bool at_rest = axis_.standing() && !returning_;
  const bool tells = !axis_.definition.quirks.homing_reaches_no_target;
  if (!(searching() && !halted) && at_rest && tells) bits |= 0x0400;
  if (attained_) bits |= 0x1000;
  if (failed_) bits |= 0x2000;
  return bits;
}

}  // namespace cia402::sim
