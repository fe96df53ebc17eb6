// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/homing_mode.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

constexpr unsigned kZeroReading = 64;  // every so many readings are 0 while it homes by an object

constexpr double kHard = 300.0;  // turns/s^2 where there is no 609Ah

constexpr double kStopSpeed = 0.05;  // turns/s, below it a motor that pushes has come to a stop
constexpr double kPushing = 0.02;    // turns
constexpr Role kTerminals[] = {Role::input_1_function, Role::input_2_function,
                               Role::input_3_function, Role::input_4_function,
                               Role::input_5_function};

using Phase = HomingSequence::Phase;

/// By the number of the role home_offset_mode.
enum OffsetMode : std::int64_t {
  kReadAtHome,     // home reads 607Ch
  kAdded,          // what was read at home, and 607Ch more
  kMoved,          // it moves on by 607Ch, where it reads 0 ...
  kMovedAndAdded,  // ... or 607Ch
};

constexpr char kIllogical[] = "homing_logic";

bool seeksStop(const HomingRoute& route) {
  return std::any_of(route.legs.begin(), route.legs.end(),
                     [](const HomingLeg& leg) { return leg.until == HomingEvent::hard_stop; });
}

}  // namespace

void HomingMode::begin() {
  sequence_.stop();
  returning_ = false;
  if (axis_.definition.quirks.homing_result_stays) return;
  attained_ = failed_ = false;
}

void HomingMode::control(bool bit_4, bool rising) {
  if (byObject()) return;
  if (rising) start();
  if (!bit_4) giveUp();
}

void HomingMode::giveUp() {
  if (searching()) sequence_.stop();
  if (returning_ && movesOn()) returning_ = false;
}

/// Drives that have a fault for that take no search which cannot be, nor one in motion.
bool HomingMode::illogical(const HomingRoute* route) const {
  if (axis_.definition.fault(kIllogical) == nullptr) return false;
  const DriveValues& values = axis_.values;
  const bool moves = route != nullptr && !route->legs.empty();
  const bool set = values.get(Role::homing_search_speed, 1.0) > 0.0 &&
                   values.get(Role::homing_zero_speed, 1.0) > 0.0 &&
                   values.get(Role::homing_acceleration, 1.0) > 0.0;
  return route == nullptr || !axis_.standing() || (moves && !set);
}

void HomingMode::start() {
  const std::int64_t number = axis_.values.raw(Role::homing_method, 0);
  const auto& inert = axis_.definition.homing.inert;
  if (std::find(inert.begin(), inert.end(), number) != inert.end()) return;
  const HomingRoute* route = axis_.definition.homing.route(number);
  attained_ = false;
  failed_ = route == nullptr;
  returning_ = false;
  sequence_.stop();
  illogical_ = illogical(route);
  if (route == nullptr || illogical_) return;
  terminals_wrong_ = !terminalsAreRight(*route);
  if (terminals_wrong_) return;
  searched_s_ = pushed_s_ = 0.0;
  seeks_stop_ = seeksStop(*route);
  sequence_.start(*route, axis_.switches, axis_.motor.position());
  if (sequence_.phase() == Phase::found) finish();
}

/// Each switch of the method is the function of one terminal.
bool HomingMode::terminalsAreRight(const HomingRoute& route) const {
  for (const auto& [input, function] : axis_.definition.homing.terminal_functions) {
    int terminals = 0;
    for (const Role role : kTerminals) {
      if (axis_.values.raw(role, -1) == function) ++terminals;
    }
    if (terminals > 1 || (terminals == 0 && route.uses(input))) return false;
  }
  return true;
}

bool HomingMode::movesOn() const {
  return axis_.values.raw(Role::home_offset_mode, kReadAtHome) >= kMoved;
}

/// The home position was found.
void HomingMode::finish() {
  goal_ = sequence_.home();
  returning_ = axis_.definition.homing.returns || movesOn();
  if (movesOn()) {
    goal_ += axis_.values.get(Role::home_offset, 0.0);
  } else {
    arrive();
  }
}

/// What home reads by 607Ch, turns.
double HomingMode::homeReads() const {
  const double offset = axis_.values.get(Role::home_offset, 0.0);
  return axis_.definition.homing.home_offset_is_zero_shift ? -offset : offset;
}

void HomingMode::offsetWritten() {
  offset_wrong_ = axis_.limits.offsetOutside();
  if (!axis_.definition.homing.offset_counts_at_once || !offset_) return;
  axis_.frame -= homeReads() - *offset_;
  offset_ = homeReads();
}

double HomingMode::mostTorque() const {
  const bool bounds = axis_.definition.homing.stop_torque_bounds && seeks_stop_ && searching();
  return bounds ? axis_.values.get(Role::homing_stop_torque, kUnlimited) : kUnlimited;
}

/// The search is over: positions count from the home that was found.
void HomingMode::arrive() {
  const double offset = axis_.values.get(Role::home_offset, 0.0);
  switch (axis_.values.raw(Role::home_offset_mode, kReadAtHome)) {
    case kAdded:
      axis_.frame -= offset;
      break;
    case kMoved:
      axis_.frame = goal_;
      break;
    case kMovedAndAdded:
      axis_.frame = goal_ - offset;
      break;
    default:
      axis_.frame = sequence_.home() - homeReads();
      offset_ = homeReads();
  }
  offset_wrong_ = axis_.limits.offsetOutside();
  attained_ = true;
  axis_.limits.setHomed(true);
}

void HomingMode::goToGoal() {
  Demand& demand = axis_.demand;
  const double acceleration = axis_.values.get(Role::homing_acceleration, kHard);
  demand.profile.reset(demand.position, demand.velocity);
  const double speed = axis_.values.get(Role::homing_zero_speed, 0.0);
  demand.profile.step(goal_, {speed, acceleration, acceleration});
  demand.followProfile();
  if (demand.position != goal_ || demand.velocity != 0.0) return;
  returning_ = false;
  if (movesOn()) arrive();
}

void HomingMode::search() {
  Demand& demand = axis_.demand;
  const double acceleration = axis_.values.get(Role::homing_acceleration, kHard);
  const Role speed_of = sequence_.slow() ? Role::homing_zero_speed : Role::homing_search_speed;
  const double speed = axis_.values.get(speed_of, 0.0);
  const double target = searching() ? sequence_.direction() * std::fabs(speed) : 0.0;
  const bool hard = axis_.definition.homing.stops_quickly_at_limits && sequence_.atLimit();
  const double deceleration =
      hard ? axis_.limits.deceleration(Ramp::quick_stop, axis_.mode) : acceleration;
  demand.velocity = rampVelocity(demand.velocity, target, acceleration, deceleration);
  demand.position += demand.velocity * kDriveStepS;
}

void HomingMode::step(double from) {
  const bool was_searching = searching();
  returning_ ? goToGoal() : search();
  axis_.motor.followPosition(axis_.demand.position);
  if (!was_searching) return;
  const bool pushes = atHardStop();
  sequence_.step(axis_.switches, from, axis_.motor.position(), pushes);
  if (pushes) standWhereItIs();
  if (sequence_.seeksStop()) keepNear();
  if (sequence_.phase() == Phase::found) finish();
  failed_ = failed_ || sequence_.phase() == Phase::failed;
  tells_failure_ = sequence_.phase() == Phase::failed;
  watchTime();
}

/// The motor has pushed hard enough for long enough, and has not moved where that counts.
bool HomingMode::atHardStop() {
  if (!sequence_.seeksStop()) return false;
  const double torque = axis_.motor.torque() * sequence_.direction();
  const bool stands = std::fabs(axis_.motor.velocity()) < kStopSpeed;
  const bool pushes = torque >= axis_.values.get(Role::homing_stop_torque, kUnlimited) &&
                      (stands || axis_.definition.homing.stops_by_torque);
  pushed_s_ = pushes ? pushed_s_ + kDriveStepS : 0.0;
  return pushes && pushed_s_ >= axis_.values.get(Role::homing_stop_time, 0.0);
}

void HomingMode::standWhereItIs() {
  axis_.demand.position = axis_.motor.position();
  axis_.demand.velocity = 0.0;
}

/// A motor that pushes stays behind by no more than it takes to push.
void HomingMode::keepNear() {
  if (std::fabs(axis_.motor.velocity()) >= kStopSpeed) return;
  double& demand = axis_.demand.position;
  const double position = axis_.motor.position();
  demand = std::clamp(demand, position - kPushing, position + kPushing);
}

void HomingMode::watchTime() {
  searched_s_ += kDriveStepS;
  const auto unit = static_cast<double>(axis_.values.raw(Role::homing_time_unit, 0));
  const double limit = axis_.values.get(Role::homing_time_limit, 0.0) * std::pow(10.0, unit);
  late_ = searching() && limit > 0.0 && searched_s_ > limit;
  if (late_) sequence_.stop();
}

bool HomingMode::readsNothing() {
  return byObject() && searching() && ++readings_ % kZeroReading == 0;
}

const char* HomingMode::takeFault() {
  const char* fault = illogical_         ? kIllogical
                      : terminals_wrong_ ? "terminal_setup"
                      : late_            ? "homing_time"
                      : tells_failure_   ? "homing_failed"
                      : offset_wrong_    ? "home_offset"
                                         : nullptr;
  illogical_ = terminals_wrong_ = late_ = tells_failure_ = offset_wrong_ = false;
  return fault;
}

// CiA 402-2, table of bits 10, 12 and 13 in homing mode.
std::uint16_t HomingMode::statusBits(bool halted) const {
  if (byObject()) return attained_ ? 0x8000 : 0;
  std::uint16_t bits = 0;
  const bool at_rest = axis_.standing() && !returning_;
  const bool tells = !axis_.definition.quirks.homing_reaches_no_target;
  if (!(searching() && !halted) && at_rest && tells) bits |= 0x0400;
  if (attained_) bits |= 0x1000;
  if (failed_ && axis_.mode->bit_13 == Bit13::homing_error) bits |= 0x2000;
  return bits;
}

}  // namespace cia402::sim
