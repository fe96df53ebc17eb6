// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/core.h"

#include <utility>

#include "drive/axis/words.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

[[gnu::cold]] void tellNotTaken(AxisCore& axis, const char* missing, double target) {
  axis.notices().notify(axis.who() + ": the drive did not take the set-point " + number(target) +
                        ": waited " + seconds(axis.profile().timing.state_change) + " for " +
                        missing + "; " + report(axis));
}

/// With its bits the mode begins to follow: from where the motor is by then.
[[gnu::cold]] void releaseBits(AxisCore& axis, Time now) {
  const ModeSpec& mode = axis.mode().spec();
  const bool released = axis.control().releaseBits(now, axis.feedback().shows(mode));
  if (released && mode.controlword_bits != 0) axis.generator().neutralize();
}

/// The place to stand at was not taken: what waits in the drive would be gone to as the halt ends.
[[gnu::cold]] void leaveHalt(AxisCore& axis) {
  axis.notices().fail(
      axis.who() +
      ": the drive did not take the place where it stands, so that it would go on "
      "as soon as the halt ends: it is switched off. enable begins anew; "
      "where it happens again, look why the drive takes no set-point while it is halted");
  axis.setGoal(Goal::quick_stop);
}

}  // namespace

AxisCore::AxisCore(AxisConfig config, fieldbus::Device& device)
    : axis_(std::move(config), device),
      coordinates_(axis_.config, axis_.objects.signals[SignalId::position], axis_.state),
      mode_(axis_),
      feedback_(axis_, coordinates_, mode_),
      control_(axis_, feedback_),
      generator_(axis_, coordinates_, feedback_, mode_, control_),
      faults_(axis_),
      limits_(axis_, coordinates_),
      stops_(*this) {}

void AxisCore::readFeedback(Time now) {
  const Feedback::Commanded commanded{generator_.commandedPosition(), generator_.handingOver()};
  if (!feedback_.read(now, commanded)) return;
  faults_.read(now);
  if (!coordinates_.followsHome() || !state().feedback_valid || mode_.homing()) return;
  if (const auto moved = coordinates_.followHome(state().statusword)) zeroMoved(*moved);
}

/// A part of each cycle: it keeps its place in supervise(), whatever is added to it.
[[gnu::always_inline]] inline void AxisCore::superviseOperation(Time now) {
  const bool enabled = state().state == State::operation_enabled;
  if (!enabled && !feedback_.maybeDecodable(now)) return giveUpOperation();
  if (state().warning && !goesOnWarned(now)) return;
  if (mode_.brakes()) stops_.watchBrakeMode(now);
  if (control_.bitsWait()) releaseBits(*this, now);
  generator_.watchFollowing(now, faults_.holdsMotor());
}

void AxisCore::supervise(Time now) {
  stops_.watch(now);
  const bool late = now > written_ + 2 * config().cycle && written_ != Time{};
  if (late) generator_.lateCycle(now);
  if (!deviceReady()) return;
  if (limits_.works()) limits_.work(inOperation() ? generator_.target() : state().position);
  if (control_.commanded() && !state().feedback_valid) return stopUnheard(now);
  if (inOperation()) {
    superviseOperation(now);
  } else if (goal() == Goal::enabled && state().state == State::operation_enabled) {
    control_.enterOperation(now);
    (void)control_.releaseBits(now, feedback_.shows(mode_.spec()));
    faults_.acknowledgeWarning();
    generator_.beginFollowing(control_.brakeReleasedAt());
    generator_.neutralize();
  }
}

void AxisCore::stopUnheard(Time now) {
  if (stops_.brakesUnheard(now)) return;
  const bool brakes = stops_.brakeUnheard(now);
  if (!brakes) setGoal(Goal::quick_stop);
  notices().fail(who() + ": no usable " + profile().feedbackObjects() + ": " + feedback_.text() +
                 (brakes ? "; mode " + mode_.spec().name + " is to brake it, then" : ";") +
                 " quick stop is commanded. Check bus load, cable and the drive's " +
                 device().terms().input + "s");
}

void AxisCore::giveUpOperation() {
  notices().fail(who() + ": the drive left operation enabled by itself: " + feedback_.stateText() +
                 "; " +
                 (faulted() || state().error_code != 0 ? faults_.text() : faults_.emergencyText()) +
                 (faulted() ? "" : "; enable brings it back once the reason is gone"));
  // Switching off would cut a quick stop ramp of the drive short.
  setGoal(state().state == State::quick_stop_active ? Goal::quick_stop : Goal::disabled);
}

bool AxisCore::goesOnWarned(Time now) {
  switch (faults_.warning()) {
    case FaultWatch::Warning::goes_on:
      return true;
    case FaultWatch::Warning::stops:
      notices().fail(who() +
                     ": the drive warns (statusword bit 7), which makes it stop like a fault: " +
                     faults_.text());
      setGoal(Goal::quick_stop);  // what the drive does itself; switching off would let it coast
      return false;
    case FaultWatch::Warning::holds:
      notices().fail(faults_.text() +
                     "; the drive holds the motor, and the axis is halted, so that it does not "
                     "move on when the warning ends: enable releases it");
      faults_.acknowledgeWarning();
      stops_.hold(now);
      return inOperation();
  }
  return true;
}

/// Not inlined: superviseOperation() would lose its place in Axis::update() to it.
[[gnu::noinline]] void AxisCore::updateReadiness(bool busy) {
  AxisState& state = axis_.state;
  state.ready_for_motion = brakeReleased() && !busy && !state.halted && state.feedback_valid &&
                           inMode(*this) && state.state == State::operation_enabled &&
                           feedback_.needsMet();
}

void AxisCore::writeCommands(Time now) {
  generator_.stepCommands(now);
  if (inOperation()) {
    generator_.advance(now);
    stops_.watchEffort(now);
    const double target = generator_.target();
    if (const char* missing = generator_.send(now)) {
      tellNotTaken(*this, missing, target);
      if (state().halted || stops_.endsGoal()) leaveHalt(*this);
    }
  } else {
    generator_.sendNeutral();
  }
  written_ = now;
  generator_.watchDrive(now);
  control_.write(generator_.mode().bits(), mode_.spec());
  mode_.write();
}

void AxisCore::setGoal(Goal goal) {
  control_.aim(goal);
  if (goal != Goal::enabled) leaveOperation();
}

void AxisCore::switchOff() {
  setGoal(Goal::disabled);
  control_.switchOff();
}

void AxisCore::leaveOperation() {
  stops_.forgetBrakeMode();
  axis_.state.halted = axis_.state.ready_for_motion = false;
  mode_.overrideValue({});
  control_.leaveOperation();
  generator_.leave();
}

void AxisCore::selectMode(const ModeChannel& mode) {
  mode_.select(mode);
  stops_.forgetBrakeMode();
  if (!mode_.homing()) coordinates_.resumeCounting();
  control_.setHomingStart(false);
  if (!feedback_.shows(mode_.spec())) control_.awaitMode();
  control_.endBraking();  // it belongs to the mode that is left, at rest
  generator_.enter();
}

void AxisCore::onDeviceLost() {
  const bool was_commanded = !control_.silent();
  setGoal(Goal::disabled);
  control_.silence();
  feedback_.forget();
  axis_.objects.signals.forget();
  faults_.forget();
  if (const auto moved = coordinates_.forget(mode_.homing())) zeroMoved(*moved);
  limits_.forget();
  axis_.state.health = device().health();
  selectMode(mode_.configured());
  std::string text =
      who() + ": the " + device().terms().device + " is " + fieldbus::toString(device().health());
  if (!device().problem().empty()) text += " (" + device().problem() + ")";
  notices().fail(text + "; the axis stays disabled until recover or enable", was_commanded);
}

void AxisCore::onBusLost(const std::string& why) {
  if (!control_.commanded() || stops_.brakesUnheard(written_)) return;
  if (!stops_.brakeUnheard(written_)) setGoal(Goal::quick_stop);
  notices().fail(who() + ": " + why +
                 ": nothing reaches the drive; it gets a quick stop once the bus is back and stays "
                 "disabled until enable or recover");
}

void AxisCore::zeroMoved(double moved) {
  generator_.shiftZero(moved);
  limits_.renew();
  feedback_.watchAnew();
}

void AxisCore::declarePosition(double value) {
  if (const auto moved = coordinates_.declare(value)) zeroMoved(*moved);
}

void AxisCore::adoptDriveZero(double shift) {
  zeroMoved(coordinates_.adopt(shift, mode_.homing()));
}

void AxisCore::loseZero() { zeroMoved(coordinates_.lose()); }

void AxisCore::measureAnew() {
  coordinates_.countAnew(mode_.homing());
  feedback_.watchAnew();
  feedback_.forgetPosition();
}

}  // namespace cia402::drive
