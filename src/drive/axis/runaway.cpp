// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/runaway.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "drive/axis/core.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// A set-point that moved leads for so long: what the motor makes of it comes later.
constexpr Duration kLeads{std::chrono::milliseconds(500)};
/// What a drive was told before, and was called back, it may go to until it has stood for so long.
constexpr Duration kSettles{std::chrono::seconds(1)};
/// A drive searches for home no faster than with so many times the velocity of its search.
constexpr double kOfSearch = 2.0;
constexpr double kAnySpeed = std::numeric_limits<double>::infinity();

constexpr char kRemedy[] =
    "See that the motor's phases and its encoder count the same way (the drive's setting of the "
    "direction), that the load does not drag it along, and that torque limits let it hold that";

std::string speedText(double velocity, const AxisConfig& config) {
  return number(velocity) + (config.geometry.prismatic() ? " m/s" : " rad/s");
}

double fastestSearch(const AxisConfig& config) {
  const bool told = config.homing && config.homing->search_velocity > 0.0;
  return told ? kOfSearch * config.homing->search_velocity : kAnySpeed;
}

}  // namespace

Runaway::Runaway(AxisCore& axis)
    : axis_(axis),
      watch_(axis.config().standstill_velocity, axis.feedback().positionResolution(),
             stopDeceleration(axis.config()), axis.config().cycle) {}

/// Not in every cycle: a speed is a mean over a window.
void Runaway::look(Time now) {
  look_at_ = now + watch_.window();
  const AxisState& state = axis_.state();
  const SetPoint& sent = axis_.generator().sent();
  const bool turned = sent.kind() == SetPointKind::velocity;
  const double before = std::exchange(turned_at_, turned ? sent.value() : kUnknown);
  const bool moved = std::exchange(zero_changes_, state.zero_changes) != state.zero_changes;
  // An effort may have made it faster just before another mode brakes it.
  const bool other = std::exchange(kind_, sent.kind()) != sent.kind();
  if (moved || other || !state.feedback_valid) return watch_.forget();
  if (!axis_.inOperation()) return lookAtStop(now);
  watches_stop_ = let_go_ = false;
  if (!state.internal_limit) {
    limited_at_ = kUnknown;
  } else if (std::isnan(limited_at_)) {
    // The limit came within the last window.
    limited_at_ = state.position - watch_.velocity() * toSeconds(watch_.window());
  }
  if (!watch_.measure(state.position, state.stamp)) return;
  if (sent.kind() == SetPointKind::stream && watch_.follows(sent.velocity())) return;
  RunawayWatch::Led where = led(now);
  where.velocity_before = before;
  if (watch_.runsAway(where)) stop(where, now);
}

/// It is being stopped, or nobody wants it to move.
void Runaway::lookAtStop(Time now) {
  const AxisState& state = axis_.state();
  if (!axis_.deviceReady() || axis_.powerOff()) {
    watches_stop_ = let_go_ = false;
    return watch_.forget();
  }
  const bool reacts = state.state == State::fault_reaction_active;
  if (axis_.goal() != Goal::quick_stop && !reacts && !let_go_) return;
  if (!std::exchange(watches_stop_, true)) watch_.beginStop(now, false);
  if (!watch_.measure(state.position, state.stamp) || !watch_.escapes()) return;
  reacts || let_go_ ? reset(now) : letGo(now);
}

/// Where the motor is led by what was sent last, or by the drive itself.
RunawayWatch::Led Runaway::led(Time now) {
  Generator& generator = axis_.generator();
  const AxisConfig& config = axis_.config();
  const SetPoint& sent = generator.sent();
  RunawayWatch::Led where;
  where.on = !sent.atRest() || generator.goalAhead() || now < sent.movedAt() + kLeads;
  switch (sent.kind()) {
    case SetPointKind::none:  // a search for home, that goes to and fro as the drive sees fit
      where.on = axis_.control().homingStart();
      where.speed = where.on ? fastestSearch(config) : 0.0;
      break;
    case SetPointKind::torque:  // leads it to nowhere, and no faster than its load lets it go
      where.speed = kAnySpeed;
      break;
    case SetPointKind::velocity:
      where.velocity = sent.value();
      break;
    case SetPointKind::goal:
      if (generator.goalAhead() || !axis_.feedback().atStandstill()) settled_ = now;
      if (now >= settled_ + kSettles) generator.goalReached();
      where.lowest = sent.goals().lowest;
      where.highest = sent.goals().highest;
      break;
    case SetPointKind::stream:
      where.velocity = sent.velocity();
      where.lowest = where.highest = sent.value();
      break;
  }
  // A drive that a limit stops holds the motor there, whatever it is led to, and swings back to it.
  where.lowest = std::fmin(where.lowest, limited_at_);  // of a number and none: the number
  where.highest = std::fmax(where.highest, limited_at_);
  return where;
}

void Runaway::stop(const RunawayWatch::Led& led, Time now) {
  const AxisConfig& config = axis_.config();
  const bool prismatic = config.geometry.prismatic();
  std::string to = "nothing leads it there";
  if (std::isfinite(led.lowest)) {
    to = "it is led to " + length(axis_.generator().target(), prismatic) + ", and is at " +
         length(axis_.state().position, prismatic);
  } else if (led.velocity != 0.0) {
    to = "it is to turn at " + speedText(led.velocity, config);
  } else if (std::isfinite(led.speed) && led.speed > 0.0) {
    to = "it may go no faster than " + speedText(led.speed, config) + " here";
  }
  const std::string text = axis_.who() + ": the motor runs away: it moves at " +
                           speedText(watch_.velocity(), config) + ", faster and faster, but " + to +
                           ". Quick stop is commanded, and its power is switched off if that does "
                           "not brake it. " +
                           kRemedy;
  watch_.beginStop(now, true);
  watches_stop_ = true;
  axis_.setGoal(Goal::quick_stop);
  axis_.notices().fail(text);
}

void Runaway::letGo(Time now) {
  axis_.notices().fail(axis_.who() + ": the quick stop does not brake the motor, which moves at " +
                       speedText(watch_.velocity(), axis_.config()) +
                       ": its power is switched off, so that it coasts, unless a brake holds it. " +
                       kRemedy);
  axis_.switchOff();
  watch_.beginStop(now, true);
  let_go_ = true;
}

/// It does not listen to the controlword; started anew it has no power.
void Runaway::reset(Time now) {
  const std::string gap = axis_.device().restartGap();
  const std::string what = let_go_ ? "the drive does not switch the motor's power off"
                                   : "its fault reaction drives the motor";
  axis_.notices().fail(axis_.who() + ": " + what + ", which moves at " +
                       speedText(watch_.velocity(), axis_.config()) + ": the " +
                       axis_.device().terms().device + " is reset" +
                       (gap.empty() ? "" : " (" + gap + ")") +
                       "; switch its power off at once if the motor goes on");
  axis_.device().restart(now);
  watch_.forget();
  watches_stop_ = let_go_ = false;
}

}  // namespace cia402::drive
