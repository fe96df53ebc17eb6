// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/home_by_edge.h"

#include <cmath>

#include "drive/profile/named_write.h"
#include "drive/sentence.h"

namespace cia402::drive {
bool mayHavePower(const AxisCore& axis) {
  return !axis.powerOff() || axis.inOperation() || axis.goal() == Goal::enabled;
}

HomeByEdge::HomeByEdge(const AxisCore& axis, const HomingMethod& method)
    : object_(axis.profile().find(method.edge->object)),
      mask_(method.edge->mask()),
      text_("method " + std::to_string(*axis.config().homing->method) + " (" + method.text + ")"),
      settings_(axis.profile(), SettingCheck::Before::homing) {}

void HomeByEdge::enter(Phase phase, const Context& context, const char* step, const char* what) {
  phase_ = phase;
  since_ = context.now;
  context.show(step, what);
}

Outcome HomeByEdge::failed(const Context& context, const std::string& why) const {
  return Outcome::failed(context.axis.who() + ": not homed by " + text_ + ": " + why);
}

Outcome HomeByEdge::advance(const Context& context) {
  switch (phase_) {
    case Phase::begin:
      return stand(context);
    case Phase::comparing:
      return prepare(context);
    case Phase::opening:
      return open(context);
    case Phase::measuring:
      return measure(context);
    case Phase::closing:
      return close(context);
    default:
      return write(context);
  }
}

Outcome HomeByEdge::stand(const Context& context) {
  const AxisCore& axis = context.axis;
  if (mayHavePower(axis)) return failed(context, calibrationRefusal(axis));
  if (calibrationRefusal(axis).empty()) {
    phase_ = Phase::comparing;
  } else {
    context.show("waiting for rest", "the axis to be seen standing");
  }
  return Outcome::running();
}

Outcome HomeByEdge::prepare(const Context& context) {
  const Outcome outcome = settings_.advance(context);
  if (!outcome.isDone()) return outcome;
  context.axis.limits().open(true);
  enter(Phase::opening, context, "opening position limits",
        "the drive to let go of those of the old zero");
  return Outcome::running();
}

Outcome HomeByEdge::open(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limits().settled()) return Outcome::running();
  const std::string refusal = calibrationRefusal(axis);
  if (!refusal.empty()) return failed(context, refusal);
  if (!axis.limits().problem().empty()) return failed(context, axis.limits().problem());
  enter(Phase::reading, context, "reading the bits beside", "the drive to tell them");
  ticket_ = axis.device().objects().upload(object_->id, object_->name);
  return Outcome::running();
}

void HomeByEdge::writeBit(const Context& context, bool on) {
  const std::uint64_t bits = others_ | (on ? mask_ : 0);
  ticket_ = context.axis.device().objects().download(object_->id, wireBytes(bits, object_->type),
                                                     object_->name);
}

/// The bit low, high and low again.
Outcome HomeByEdge::write(const Context& context) {
  AxisCore& axis = context.axis;
  if (!ticket_->done()) return Outcome::running();
  if (!ticket_->ok()) return failed(context, ticket_->message());
  switch (phase_) {
    case Phase::reading:
      others_ = fieldbus::toUnsigned(ticket_->data()) & ~mask_;
      enter(Phase::low, context, "taking the present position", "the drive to take its bit");
      writeBit(context, false);
      break;
    case Phase::low:
      phase_ = Phase::high;
      axis.loseZero();
      writeBit(context, true);
      break;
    case Phase::high:
      phase_ = Phase::settling;
      since_ = context.now;
      break;
    case Phase::settling:
      if (context.now < since_ + kZeroSettles) break;
      phase_ = Phase::lowered;
      writeBit(context, false);
      break;
    default:
      axis.measureAnew();
      enter(Phase::measuring, context, "measuring", "the drive to tell its new position");
      break;
  }
  return Outcome::running();
}

Outcome HomeByEdge::measure(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.state().feedback_valid) {
    if (context.now < since_ + axis.profile().timing.state_change) return Outcome::running();
    return failed(context, "the drive has not told its position since");
  }
  const double zero = axis.objects().signals[SignalId::position].conversion.toJoint(0);
  const double away = axis.state().position - zero;
  if (std::fabs(away) > axis.feedback().standstill().tolerance()) {
    return failed(context, "the drive does not call the present position its zero, it is " +
                               length(away, axis.config().geometry.prismatic()) + " off");
  }
  axis.adoptDriveZero(axis.config().homing->atHome() - zero);
  axis.limits().open(false);
  enter(Phase::closing, context, "writing position limits",
        "the drive to take those of the new zero");
  return Outcome::running();
}

Outcome HomeByEdge::close(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limits().settled()) return Outcome::running();
  return Outcome::done(jointName(axis.config()) + ": homed by " + text_ + ", position " +
                       length(axis.state().position, axis.config().geometry.prismatic()) +
                       "; nothing moved" + axis.limits().remark());
}

}  // namespace cia402::drive
