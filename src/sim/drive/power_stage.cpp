// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/power_stage.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

constexpr Duration kQuickStopFlash = std::chrono::milliseconds(2);
/// From when a brake closes on a motor that turned until the power goes.
constexpr Duration kPowerWhileBraking = std::chrono::milliseconds(50);

/// The power goes at once.
bool letsGo(Ramp ramp) { return ramp == Ramp::coast || ramp == Ramp::dynamic_brake; }

}  // namespace

PowerStage::PowerStage(const DriveDefinition& definition, const AxisMechanics& mechanics,
                       const DriveValues& values, DriveMotion& motion, ModeSelection& modes)
    : definition_(definition),
      mechanics_(mechanics),
      values_(values),
      motion_(motion),
      modes_(modes) {}

void PowerStage::start(Time now) {
  enabled_at_ = kNever;
  state_ = PdsState::not_ready_to_switch_on;
  ready_at_ = now + definition_.initialisation;
  after_stop_.reset();
  modes_.show(state_);
}

void PowerStage::powerOff() {
  motion_.powerStage(false);
  state_ = PdsState::not_ready_to_switch_on;
  ready_at_ = kNever;
  after_stop_.reset();
}

bool PowerStage::enabled() const {
  return state_ == PdsState::operation_enabled || state_ == PdsState::quick_stop_active ||
         state_ == PdsState::fault_reaction_active;
}

bool PowerStage::operating() const { return state_ == PdsState::operation_enabled && !after_stop_; }

PdsState PowerStage::shown(Time now) const {
  const bool flashed = definition_.quirks.quick_stop_flashes &&
                       state_ == PdsState::quick_stop_active &&
                       now - quick_stop_since_ > kQuickStopFlash;
  const bool hidden = flashed || definition_.quirks.shows_no_state;
  return hidden ? PdsState::switch_on_disabled : state_;
}

void PowerStage::finishInitialisation(Time due, Time now) {
  if (due < ready_at_) return;
  ready_at_ = kNever;
  enter(PdsState::switch_on_disabled, now);
}

bool PowerStage::finishEnabling(Time due, Time now) {
  if (due < enabled_at_) return false;
  enabled_at_ = kNever;
  enter(PdsState::operation_enabled, now);
  return true;
}

void PowerStage::waitForBrake(Time due) {
  if (state_ == PdsState::operation_enabled) motion_.hold(due < follow_at_);
}

/// Where there is a brake it closes on the way out of operation.
bool PowerStage::closesBrake() const {
  const bool holds = state_ == PdsState::quick_stop_active && hold_after_quick_stop_;
  return values_.raw(Role::brake_fitted, 0) == 1 && !holds;
}

bool PowerStage::atCloseSpeed() const {
  return std::fabs(motion_.motor().velocity()) < values_.get(Role::brake_close_speed, 0.0);
}

void PowerStage::beginStop(Ramp ramp, Time now, bool quick) {
  stop_since_ = now;
  power_ends_at_ = kNever;
  if (atCloseSpeed()) power_ends_at_ = now + fromSeconds(values_.get(Role::brake_power_time, 0.0));
  motion_.stop(ramp, quick);
}

/// The brake has closed, and the power may go, whether the motor stands or not.
bool PowerStage::brakeHolds(Time due) {
  const bool late = due - stop_since_ >= fromSeconds(values_.get(Role::brake_close_time, 0.0));
  if (power_ends_at_ == kNever && (late || atCloseSpeed())) {
    power_ends_at_ = due + kPowerWhileBraking;
  }
  return due >= power_ends_at_;
}

void PowerStage::finishStops(Time due, Time now) {
  if (!motion_.stopping()) return;
  const bool ended = closesBrake() ? brakeHolds(due) : motion_.standing();
  if (!ended) return;
  if (state_ == PdsState::fault_reaction_active) {
    enter(PdsState::fault, now);  // transition 14
  } else if (state_ == PdsState::quick_stop_active) {
    if (!hold_after_quick_stop_) enter(PdsState::switch_on_disabled, now);  // transition 12
  } else if (after_stop_) {
    enter(after_stop_->to, now);
  }
}

void PowerStage::enter(PdsState state, Time now) {
  const bool was_enabled = enabled();
  state_ = state;
  after_stop_.reset();
  if (state == PdsState::operation_enabled) {
    if (!was_enabled) {
      motion_.powerStage(true);
      follow_at_ =
          now + fromSeconds(std::max(mechanics_.brake_delay, values_.get(Role::brake_delay, 0.0)));
      motion_.hold(now < follow_at_);
    } else {
      motion_.release();
    }
  } else if (!enabled() && was_enabled) {
    motion_.powerStage(false);
    motion_.motor().shortWindings(false);
  }
  if (state != PdsState::switched_on) enabled_at_ = kNever;
  modes_.show(state_);
}

/// As enter(), into a state without power.
void PowerStage::letGo(PdsState state, Ramp ramp, Time now) {
  enter(state, now);
  motion_.motor().shortWindings(ramp == Ramp::dynamic_brake);
}

void PowerStage::execute(const PdsTransition& transition, Time now) {
  switch (transition.number) {
    case 5:
      return leaveEnabled(transition, definition_.disable_operation, Role::disable_operation_option,
                          now);
    case 8:
      return leaveEnabled(transition, definition_.shutdown, Role::shutdown_option, now);
    case 11:
      return quickStop(now);
    case 16:
      if (hold_after_quick_stop_ &&
          (definition_.resume_quick_stop_while_moving || motion_.standing())) {
        enter(PdsState::operation_enabled, now);
      }
      return;
    default:
      return enter(transition.to, now);
  }
}

bool PowerStage::enable(Time now) {
  const Duration time = definition_.quirks.enabling_time;
  if (time == Duration::zero()) {
    enter(PdsState::operation_enabled, now);
    return true;
  }
  if (enabled_at_ == kNever) enabled_at_ = now + time;
  return false;
}

void PowerStage::stay() {
  if (state_ != PdsState::operation_enabled || !after_stop_) return;
  after_stop_.reset();
  motion_.release();
}

StopOption PowerStage::option(const OptionTable& table, Role role) const {
  const auto found = table.options.find(values_.raw(role, table.fallback));
  return found == table.options.end() ? StopOption{} : found->second;
}

void PowerStage::leaveEnabled(const PdsTransition& transition, const OptionTable& table, Role role,
                              Time now) {
  const StopOption chosen = option(table, role);
  if (letsGo(chosen.ramp)) return letGo(transition.to, chosen.ramp, now);
  if (!after_stop_) beginStop(chosen.ramp, now, false);
  after_stop_ = transition;
}

void PowerStage::quickStop(StopOption chosen, Time now) {
  if (letsGo(chosen.ramp)) return letGo(PdsState::switch_on_disabled, chosen.ramp, now);
  hold_after_quick_stop_ = chosen.hold;
  quick_stop_since_ = now;
  enter(PdsState::quick_stop_active, now);
  beginStop(chosen.ramp, now, true);
}

void PowerStage::quickStop(Time now) {
  quickStop(option(definition_.quick_stop, Role::quick_stop_option), now);
}

void PowerStage::react(const FaultDefinition& fault, Time now) {
  const bool reacting = state_ == PdsState::fault_reaction_active || state_ == PdsState::fault;
  const Ramp ramp = fault.reaction
                        ? *fault.reaction
                        : option(definition_.fault_reaction, Role::fault_reaction_option).ramp;
  if (reacting && !letsGo(ramp)) return;
  if (!motion_.powered()) return enter(PdsState::fault, now);
  if (letsGo(ramp)) return letGo(PdsState::fault, ramp, now);
  enter(PdsState::fault_reaction_active, now);
  motion_.stop(ramp, false);
}

}  // namespace cia402::sim
