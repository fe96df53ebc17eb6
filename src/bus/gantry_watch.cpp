// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/gantry_watch.h"

#include <algorithm>
#include <cmath>

namespace cia402::bus {
namespace {

using drive::ProcedureKind;

bool inOperation(const AxisUnit& unit) {
  return unit.axis.state().state == drive::State::operation_enabled;
}

bool runs(const AxisUnit& unit, ProcedureKind kind) {
  const drive::ProcedureStatus& procedure = unit.axis.procedure();
  return procedure.running && procedure.kind == kind;
}

/// It may need a while longer for it than the other side.
bool isSwitchingOff(const AxisUnit& unit) {
  return runs(unit, ProcedureKind::disable) || runs(unit, ProcedureKind::quick_stop);
}

bool isSwitchingOn(const AxisUnit& unit) {
  const drive::ProcedureStatus& procedure = unit.axis.procedure();
  return procedure.running && enables(procedure.kind);
}

constexpr double kJump = 4.0;  // times as far as a search for home moves is none

double searchSpeed(const drive::AxisConfig& axis) {
  const double given = axis.homing ? axis.homing->search_velocity : 0.0;
  return given > 0.0 ? std::max(given, axis.homing->zero_velocity)
                     : axis.limits.velocity.value_or(1e300);
}

double speedOf(const drive::Axis& axis) {
  const double measured = std::fabs(axis.state().velocity);
  const double sent = std::fabs(axis.setPoint().velocity());
  return std::max(std::isfinite(measured) ? measured : 0.0, std::isfinite(sent) ? sent : 0.0);
}

}  // namespace

GantryWatch::GantryWatch(const config::CouplingConfig& config, AxisUnit& a, AxisUnit& b)
    : config_(*config.gantry), joint_(config.joints.front()), sides_{{{&a}, {&b}}} {}

bool GantryWatch::homed() const {
  return sides_[0].unit->axis.state().homed && sides_[1].unit->axis.state().homed;
}

bool GantryWatch::homing() const {
  return runs(*sides_[0].unit, ProcedureKind::home) || runs(*sides_[1].unit, ProcedureKind::home);
}

bool GantryWatch::powered() const {
  return inOperation(*sides_[0].unit) || inOperation(*sides_[1].unit);
}

std::string GantryWatch::watch() {
  measure();
  std::string why = alone();
  if (why.empty()) why = homesAlone();
  if (why.empty()) why = skewed();
  return why;
}

/// By how much a side reads otherwise since the cycle before without having moved. A drive that has
/// found its home counts anew before that is known here: nothing moves that fast.
double GantryWatch::newZero(Side& side) {
  const drive::AxisState& state = side.unit->axis.state();
  const double step = state.position - side.position;
  const double most =
      kJump * searchSpeed(side.unit->axis.config()) * toSeconds(state.stamp - side.stamp);
  const bool jumped = runs(*side.unit, ProcedureKind::home) && std::fabs(step) > most;
  const bool renewed = state.zero_changes != side.zeros;
  side.position = state.position;
  side.stamp = state.stamp;
  side.zeros = state.zero_changes;
  return jumped || renewed ? step : 0.0;
}

void GantryWatch::measure() {
  const drive::AxisState &a = sides_[0].unit->axis.state(), &b = sides_[1].unit->axis.state();
  base_ += newZero(sides_[1]) - newZero(sides_[0]);
  skew_ = a.feedback_valid && b.feedback_valid ? b.position - a.position : drive::kUnknown;
  if (!powered() || std::isnan(base_)) base_ = skew_;
  const bool is_level = std::fabs(skew_) <= config_.skew_window;
  if (homed() && !homing() && is_level) base_ = 0.0;
}

std::string GantryWatch::alone() const {
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const AxisUnit &on = *sides_[i].unit, &off = *sides_[1 - i].unit;
    if (!inOperation(on) || isSwitchingOff(on)) continue;
    if (inOperation(off) || isSwitchingOn(off)) continue;
    const std::string fault = off.axis.faultText();
    return "one side has no power, " + drive::jointName(off.axis.config()) + " (" +
           toString(off.axis.state().state) + "), so that " + drive::jointName(on.axis.config()) +
           " is stopped, too" + (fault.empty() ? std::string() : ": " + fault);
  }
  return {};
}

std::string GantryWatch::homesAlone() {
  const bool any = homing();
  std::string why;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    Side& side = sides_[i];
    const AxisUnit &unit = *side.unit, &other = *sides_[1 - i].unit;
    const drive::ProcedureStatus& procedure = unit.axis.procedure();
    if (!any) {
      side.homing = Homing::no;
    } else if (runs(unit, ProcedureKind::home)) {
      side.homing = Homing::runs;
    } else if (side.homing == Homing::runs && procedure.kind == ProcedureKind::home &&
               procedure.success) {
      side.homing = Homing::done;
    } else if (side.homing != Homing::done) {
      why = "both sides home together, and " + drive::jointName(unit.axis.config()) +
            (side.homing == Homing::no ? std::string(" does not home")
                                       : " does no more (" + procedure.message + ")") +
            ", so that " + drive::jointName(other.axis.config()) + " is stopped, too";
    }
  }
  return why;
}

/// What one side has moved between the moments at which both were measured is no skew.
std::string GantryWatch::skewed() const {
  if (!powered()) return {};
  const drive::Axis &a = sides_[0].unit->axis, &b = sides_[1].unit->axis;
  const bool free = homing() || !homed();
  const double window = free ? config_.homing_window : config_.skew_window;
  const double apart = std::fabs(toSeconds(a.state().stamp - b.state().stamp));
  const double off = skew_ - base_;
  if (!(std::fabs(off) > window + apart * std::max(speedOf(a), speedOf(b)))) return {};
  const bool second = off > 0.0;
  return drive::jointName((second ? b : a).config()) + " is " +
         motion::lengthText(std::fabs(off), joint_.unit) + " ahead of " +
         drive::jointName((second ? a : b).config()) +
         (base_ == 0.0 ? "" : ", from where they stood") + ", and skew/" +
         (free ? "homing" : "window") + " is " + motion::lengthText(window, joint_.unit) +
         ": both are stopped. See what holds one of them back, then enable" +
         (homed() ? "" : " and home");
}

std::string GantryWatch::refusal() const {
  if (level()) return {};
  const std::string a = drive::jointName(sides_[0].unit->axis.config());
  const std::string b = drive::jointName(sides_[1].unit->axis.config());
  return a + " and " + b + " stand " + motion::lengthText(std::fabs(skew_), joint_.unit) +
         " apart, and skew/window is " + motion::lengthText(config_.skew_window, joint_.unit) +
         ": home squares them; disabled they can be pushed";
}

}  // namespace cia402::bus
