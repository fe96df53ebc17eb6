// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/home_by_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drive/procedures/home_offset.h"
#include "drive/procedures/limits.h"
#include "drive/profile/named_write.h"
#include "drive/sentence.h"
#include "fieldbus/abort_code.h"

namespace cia402::drive {
namespace {
constexpr char kOffset[] = "homing.offset";  // NamedWrite::from
/// How long a drive may show the result of an earlier homing before bit 4 rises.
constexpr Duration kClearTime{std::chrono::milliseconds(500)};
/// After the edge the drive gets this long to drop an old result, or to stay "interrupted".
constexpr Duration kReaction{std::chrono::milliseconds(500)};

}  // namespace

DriveHoming::DriveHoming(AxisCore& axis, const ModeChannel& homing, const HomingMethod& method)
    : homing_(&homing),
      before_(axis.mode().spec().kind == ControlKind::homing
                  ? axis.objects().channel(axis.config().mode)
                  : &axis.mode().working()),
      settings_(axis.profile(), SettingCheck::Before::homing),
      writes_(axis.profile().homing.writes, kOffset, WriteStep::Part::others),
      offset_(axis.profile().homing.writes, kOffset, WriteStep::Part::named),
      mode_(homing, axis.profile()),
      enabling_(homing, axis.profile()),
      method_(method) {}

void DriveHoming::enter(Phase phase, const Context& context) {
  phase_ = phase;
  since_ = context.now;
  frames_ = context.axis.control().frames();
}

Outcome DriveHoming::advance(const Context& context) {
  switch (phase_) {
    case Phase::begin: {
      const Outcome outcome = settings_.advance(context);
      if (outcome.isDone()) begin(context);
      return outcome.isFailed() ? outcome : Outcome::running();
    }
    case Phase::writing: {
      Outcome outcome = writes_.advance(context);
      const bool disabled = !context.axis.inOperation();
      if (outcome.isDone() && disabled) outcome = offset_.advance(context);
      if (outcome.isDone() && method_.moves) outcome = speeds_.advance(context);
      if (!outcome.isDone()) return outcome;
      if (!context.axis.generator().sent().atRest() || context.axis.stops().endsGoal() ||
          !context.axis.limits().settled()) {
        return Outcome::running();
      }
      entered_by_mode_ = context.axis.inOperation();
      enter(Phase::entering, context);
      return Outcome::running();
    }
    case Phase::entering:
      return enterHoming(context);
    case Phase::offsetting:
      return writeOffset(context);
    case Phase::clearing:
      return clearOldResult(context);
    case Phase::searching:
      return search(context);
    case Phase::reading_offset:
      return readOffset(context);
    case Phase::settling:
      return settle(context);
    case Phase::limiting:
      return limit(context);
    case Phase::stopping:
      return stop(context);
    case Phase::restoring:
      return finishRestoring(context);
  }
  return Outcome::running();
}

void DriveHoming::begin(const Context& context) {
  AxisCore& axis = context.axis;
  started_ = context.now;
  axis.limits().open(true);
  enter(Phase::writing, context);
}

Outcome DriveHoming::enterHoming(const Context& context) {
  const Outcome outcome = entered_by_mode_ ? mode_.advance(context) : enabling_.advance(context);
  if (outcome.isDone()) {
    context.axis.control().setHalt(false);  // of a halt from before: it would keep the drive still
    enter(Phase::offsetting, context);
  }
  return outcome.isDone() ? Outcome::running() : outcome;
}

/// In a drive that has homed before it may count at once: in this mode nothing follows it.
Outcome DriveHoming::writeOffset(const Context& context) {
  const Outcome outcome = offset_.advance(context);
  if (outcome.isFailed()) giveUp(context, outcome.message);
  if (!outcome.isDone()) return Outcome::running();
  enter(Phase::clearing, context);
  context.show("preparing the start", "the result of an earlier homing to be cleared");
  return Outcome::running();
}

Outcome DriveHoming::clearOldResult(const Context& context) {
  AxisCore& axis = context.axis;
  if (axis.control().frames() < frames_ + kSureFrames) return Outcome::running();  // bit 4 is low
  // A motor on its way to a goal is brought to rest by the homing mode; some drives fault where the
  // search begins before.
  const Duration braking = stopTime(axis.config(), axis.state().velocity);
  if (!axis.feedback().measuredStill() && context.now - since_ <= braking) {
    return Outcome::running();
  }
  if (const StatusNeed* need = axis.feedback().unmet()) {
    giveUp(context, needText(*need));
    return Outcome::running();
  }
  const HomingStatus now = status(context);
  const bool clear = now == HomingStatus::in_progress || now == HomingStatus::interrupted;
  if (clear) {
    start(context);
  } else if (context.now - since_ > kClearTime) {
    old_result_ = attained(context);
    if (!axis.profile().homing.needs_zero_attained_before_start) {
      start(context);
    } else {
      giveUp(context, std::string("the drive still shows the result of an earlier homing (") +
                          toString(now) + ") with bit 4 low");
    }
  }
  return Outcome::running();
}

void DriveHoming::start(const Context& context) {
  AxisCore& axis = context.axis;
  axis.control().setHomingStart(true);
  end_ = context.now + axis.config().homing->timeout;
  enter(Phase::searching, context);
  context.show("searching home",
               "homing attained (statusword bit " +
                   std::to_string(homing_->spec->homing_attained_bit.value_or(12)) + "), " +
                   method(axis));
}

Outcome DriveHoming::search(const Context& context) {
  AxisCore& axis = context.axis;
  if (context.now >= end_) return timeOut(context);
  if (axis.control().frames() < frames_ + kSureFrames || !statuswordIsFresh(context)) {
    return Outcome::running();
  }
  const HomingStatus now = status(context);
  if (!attained(context)) old_result_ = false;
  switch (now) {
    case HomingStatus::in_progress:
      was_running_ = true;
      break;
    case HomingStatus::completed:
      // Methods that do not move are over at once: an old result that stays is the new one, too.
      if (!old_result_ || (!method_.moves && context.now - since_ > kReaction)) succeed(context);
      return Outcome::running();
    case HomingStatus::error_moving:
    case HomingStatus::error_stopped:
    case HomingStatus::contradictory:
      giveUp(context, std::string("the drive reports ") + toString(now) + " (" +
                          axis.feedback().stateText() + "), " + axis.faults().emergencyText());
      return Outcome::running();
    case HomingStatus::interrupted:
      if (!was_running_) break;
      if (interrupted_since_ == Time{}) interrupted_since_ = context.now;
      if (context.now - interrupted_since_ <= kReaction) return Outcome::running();
      giveUp(context, "the drive interrupted it (" + axis.feedback().stateText() + "), " +
                          axis.faults().emergencyText());
      return Outcome::running();
    case HomingStatus::attained_moving:
      break;
  }
  interrupted_since_ = Time{};
  return Outcome::running();
}

Outcome DriveHoming::timeOut(const Context& context) {
  AxisCore& axis = context.axis;
  const std::string waited = seconds(axis.config().homing->timeout);
  std::string why = axis.who() + ": homing timed out after " + waited + " waiting for " +
                    context.status.waiting_for + ", at " +
                    length(axis.state().position, axis.config().geometry.prismatic()) +
                    "; quick stop is commanded. ";
  why += old_result_    ? "The drive never dropped the result of an earlier homing. "
         : was_running_ ? "The drive was still searching: check switches, direction of the method "
                          "and homing: {timeout}. "
                        : "The drive never started. ";
  why += report(axis);
  axis.setGoal(Goal::quick_stop);
  axis.selectMode(*before_);
  return Outcome::failed(why);
}

void DriveHoming::succeed(const Context& context) {
  AxisCore& axis = context.axis;
  end_ = context.now;
  const ObjectSpec* object = axis.profile().find(axis.profile().own({0x607C, 0}));
  const bool lacks = object == nullptr || saidToLack(axis.config(), object->name);
  if (writesOffset(axis)) {
    adopt(context, axis.config().homing->atHome());
  } else if (!lacks && object->readable) {
    read_ = axis.device().objects().upload(object->id, object->name);
    enter(Phase::reading_offset, context);
    context.show("reading the home offset", axis.profile().address(0x607C) + " home offset");
  } else {
    adopt(context, axis.objects().signals[SignalId::position].conversion.toJoint(0));
  }
}

Outcome DriveHoming::readOffset(const Context& context) {
  if (!read_->done()) return Outcome::running();
  const bool missing = read_->failure() == fieldbus::Transfer::Failure::aborted_by_server &&
                       (read_->abortCode() == fieldbus::abort_code::kNoSuchObject ||
                        read_->abortCode() == fieldbus::abort_code::kNoSuchSubindex);
  if (missing) {  // the home position is its zero then
    adopt(context, context.axis.objects().signals[SignalId::position].conversion.toJoint(0));
    return Outcome::running();
  }
  if (!read_->ok() || read_->data().size() > 8) {
    giveUp(context, "home was found, but the home offset could not be read: " + read_->message());
    return Outcome::running();
  }
  const AxisCore& axis = context.axis;
  const Signal& position = axis.objects().signals[SignalId::position];
  const std::uint64_t offset = fieldbus::toUnsigned(read_->data());
  const bool minus = axis.config().homing->offset_shifts_zero;
  adopt(context,
        position.conversion.toJoint(minus ? negated(offset, position.spec->type) : offset));
  return Outcome::running();
}

void DriveHoming::adopt(const Context& context, double home_in_drive) {
  AxisCore& axis = context.axis;
  axis.control().setHomingStart(false);
  axis.adoptDriveZero(axis.config().homing->atHome() - home_in_drive);
  enter(Phase::settling, context);
  context.show("home found", "standstill");
}

Outcome DriveHoming::settle(const Context& context) {
  AxisCore& axis = context.axis;
  const bool sent = axis.control().frames() >= frames_ + kSureFrames;
  if (sent && (axis.feedback().atStandstill() ||
               context.now - since_ > axis.profile().timing.state_change)) {
    const std::string wrong = offsetProblem(axis, writesOffset(axis), method_.moves);
    if (!wrong.empty()) {
      axis.loseZero();
      return failHomed(context, ": is not homed: " + wrong + "; quick stop is commanded");
    }
    axis.limits().open(false);
    enter(Phase::limiting, context);
    context.show("writing position limits", "the drive to take those of the new zero");
  }
  return Outcome::running();
}

/// Home was found, and yet it is not to be relied on.
Outcome DriveHoming::failHomed(const Context& context, const std::string& why) {
  AxisCore& axis = context.axis;
  axis.setGoal(Goal::quick_stop);
  axis.selectMode(*before_);
  return Outcome::failed(axis.who() + why);
}

/// Before a mode comes back in which the drive would clamp its target to those of another zero.
Outcome DriveHoming::limit(const Context& context) {
  AxisCore& axis = context.axis;
  if (!axis.limits().settled()) return Outcome::running();
  const std::string problem = axis.limits().problem();
  if (problem.empty()) {
    restore(context);
    return Outcome::running();
  }
  return failHomed(context, ": homed by " + method(axis) + ", position " +
                                length(axis.state().position, axis.config().geometry.prismatic()) +
                                ", but the drive holds position limits of another zero: " +
                                problem + "; quick stop is commanded, enable writes them again");
}

bool DriveHoming::cancel(const std::string& reason, const Context& context) {
  if (phase_ == Phase::stopping || phase_ == Phase::restoring) return false;
  const bool entered = phase_ == Phase::entering && context.axis.inOperation();
  if (!entered &&
      (phase_ == Phase::begin || phase_ == Phase::writing || phase_ == Phase::entering)) {
    return true;
  }
  giveUp(context, "it was cancelled: " + reason);
  return false;
}

void DriveHoming::giveUp(const Context& context, std::string why) {
  AxisCore& axis = context.axis;
  failure_ = std::move(why);
  axis.control().setHomingStart(false);
  axis.control().setHalt(axis.profile().halt_supported);
  enter(Phase::stopping, context);
  context.show("stopping", "standstill after controlword bit 4 was dropped");
}

/// Without the halt a drive that had just found home would go back to it: the halt ends with the
/// mode, but before where it is in the way of another one.
Outcome DriveHoming::stop(const Context& context) {
  AxisCore& axis = context.axis;
  const bool sent = axis.control().frames() >= frames_ + kSureFrames;
  if (sent && released_ == kNever && axis.feedback().atStandstill()) {
    if (axis.profile().mode_change.while_halted) {
      restore(context);
      return Outcome::running();
    }
    axis.control().setHalt(false);
    released_ = context.now;
  }
  if (released_ != kNever && axis.feedback().seenStill(released_)) {
    restore(context);
    return Outcome::running();
  }
  if (context.now - since_ <= axis.profile().timing.state_change) return Outcome::running();
  axis.setGoal(Goal::quick_stop);
  axis.selectMode(*before_);
  return Outcome::failed(axis.who() + ": homing stopped: " + failure_ +
                         "; the axis did not come to rest, quick stop is commanded");
}

void DriveHoming::restore(const Context& context) {
  restoring_.emplace(*before_, context.axis.profile());
  enter(Phase::restoring, context);
}

Outcome DriveHoming::finishRestoring(const Context& context) {
  AxisCore& axis = context.axis;
  if (!restored_) {
    const Outcome outcome = restoring_->advance(context);
    if (outcome.isRunning()) return outcome;
    restored_ = outcome;
    if (axis.control().halt()) frames_ = axis.control().frames();
    axis.control().setHalt(false);
  }
  const bool released = axis.control().frames() >= frames_ + kSureFrames;
  if (axis.inOperation() && !released) return Outcome::running();
  const Outcome& outcome = *restored_;
  const std::string where = length(axis.state().position, axis.config().geometry.prismatic());
  if (!failure_.empty()) {
    return Outcome::failed(axis.who() + ": homing stopped: " + failure_ + "; the axis stands at " +
                           where + (axis.state().homed ? "" : " and is not homed") +
                           (outcome.isFailed() ? "; " + outcome.message : ""));
  }
  if (outcome.isFailed()) {
    axis.setGoal(Goal::quick_stop);
    return Outcome::failed(axis.who() + ": homed by " + method(axis) + ", position " + where +
                           ", but then " + outcome.message + "; quick stop is commanded");
  }
  return Outcome::done(jointName(axis.config()) + ": homed by " + method(axis) + " in " +
                       seconds(end_ - started_) + ", position " + where + axis.limits().remark());
}

HomingStatus DriveHoming::status(const Context& context) const {
  const AxisCore& axis = context.axis;
  return decodeHoming(axis.state().statusword, *homing_->spec, axis.feedback().measuredStill());
}

bool DriveHoming::attained(const Context& context) const {
  const int bit = homing_->spec->homing_attained_bit.value_or(12);
  return ((static_cast<unsigned>(context.axis.state().statusword) >> bit) & 1u) != 0;
}

bool DriveHoming::statuswordIsFresh(const Context& context) const {
  AxisCore& axis = context.axis;
  const Signal& object = axis.objects().signals[SignalId::statusword];
  const fieldbus::ProcessImage& image = axis.device().image();
  if (!image.regular(object.slot)) return context.now - since_ > std::chrono::milliseconds(20);
  return image.input(object.slot).stamp > since_;
}

bool DriveHoming::writesOffset(const AxisCore& axis) const {
  const std::vector<NamedWrite>& writes = axis.profile().homing.writes;
  const bool has = std::any_of(writes.begin(), writes.end(),
                               [](const NamedWrite& write) { return write.from == kOffset; });
  return has && !offset_.leftOut(kOffset);
}

std::string DriveHoming::method(const AxisCore& axis) const {
  std::string text = "method " + std::to_string(*axis.config().homing->method);
  if (!method_.text.empty()) text += " (" + method_.text + ")";
  return text;
}

}  // namespace cia402::drive
