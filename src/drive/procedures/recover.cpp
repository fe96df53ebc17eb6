// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "drive/procedures/limits.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/enable.h"
#include "drive/procedures/steps/fault_reset.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// Brings an axis back from wherever it is: boots the device if it is not ready, or ready but
/// without feedback (nobody notices where an unsupervised device went), clears faults, enables. An
/// axis that is enabled and well is left alone, also in motion. Succeeds if the axis takes commands
/// then.
class Recover : public Procedure {
 public:
  explicit Recover(AxisCore& axis) : enabling_(axis.mode().working(), axis.profile()) {}

  Outcome advance(const Context& context) override {
    switch (phase_) {
      case Phase::begin:
        if (leavesAlone(context)) return leave(context);
        begin(context);
        return Outcome::running();
      case Phase::booting:
        return boot(context);
      case Phase::feedback:
        return awaitFeedback(context);
      case Phase::clearing: {
        const Outcome outcome = reset_.advance(context);
        if (outcome.isDone()) phase_ = Phase::enabling;
        return outcome.isDone() ? Outcome::running() : outcome;
      }
      case Phase::enabling: {
        if (context.axis.inOperation() && !enabling_.begun()) {  // it was enabled all the time
          return context.axis.brakeReleased() ? finish(context) : Outcome::running();
        }
        const Outcome outcome = enabling_.advance(context);
        return outcome.isDone() ? finish(context) : outcome;
      }
    }
    return Outcome::running();
  }

  bool leavesAlone(const Context& context) const override {
    const AxisCore& axis = context.axis;
    return axis.feedback().heardLately(context.now) && isWell(axis) && axis.brakeReleased();
  }
  bool survivesDeviceLoss() const override { return phase_ == Phase::booting; }

 private:
  enum class Phase { begin, booting, feedback, clearing, enabling };

  static bool isWell(const AxisCore& axis) {
    return axis.deviceReady() && axis.state().feedback_valid && axis.inOperation() &&
           !clearable(axis);
  }

  void begin(const Context& context) {
    AxisCore& axis = context.axis;
    started_ = context.now;
    if (axis.deviceReady()) {
      beginFeedback(context);
    } else {
      bootDevice(context);
    }
  }

  void bootDevice(const Context& context) {
    AxisCore& axis = context.axis;
    phase_ = Phase::booting;
    booted_ = context.now;
    showBoot(context);
    if (axis.device().health() != fieldbus::Health::booting) axis.device().boot(context.now, true);
  }

  void beginFeedback(const Context& context) {
    phase_ = Phase::feedback;
    since_ = context.now;
    context.show("reading feedback", "statusword and position from the drive");
  }

  Outcome boot(const Context& context) {
    AxisCore& axis = context.axis;
    if (axis.deviceReady()) {
      beginFeedback(context);
      return Outcome::running();
    }
    const bool failed = axis.device().health() == fieldbus::Health::failed ||
                        axis.device().health() == fieldbus::Health::absent;
    if (failed && context.now > *booted_) {
      return Outcome::failed(axis.who() + ": the " + axis.device().terms().device +
                             " did not boot: " + axis.device().problem());
    }
    if (context.now < *booted_ + kBootTimes * axis.device().times().boot) return Outcome::running();
    return Outcome::failed(axis.who() + ": the " + axis.device().terms().device +
                           " did not become ready within " + seconds(context.now - *booted_) +
                           ", it is " + fieldbus::toString(axis.device().health()) + ", " +
                           axis.device().bootStep());
  }

  Outcome awaitFeedback(const Context& context) {
    AxisCore& axis = context.axis;
    // What was heard before the call may be of a drive that has gone since.
    const bool valid = axis.state().feedback_valid;
    if (valid && !axis.feedback().heardLately(context.now)) return Outcome::running();
    if (valid) {
      phase_ = clearable(axis) ? Phase::clearing : Phase::enabling;
      return Outcome::running();
    }
    if (context.now - since_ <= axis.profile().timing.state_change) return Outcome::running();
    const std::string others = axis.basis().neighbours.refusal();
    if (!booted_ && others.empty()) {
      bootDevice(context);
      return Outcome::running();
    }
    const std::string missing = axis.who() + ": no usable " + axis.profile().feedbackObjects() +
                                " within " + seconds(context.now - since_);
    if (!booted_) {
      return Outcome::failed(missing + ": " + axis.feedback().text() +
                             "; the drive is not booted for it: " + others + ", then recover");
    }
    const fieldbus::Terms& terms = axis.device().terms();
    return Outcome::failed(missing + " after the " + terms.device +
                           " was ready: " + axis.feedback().text() +
                           "; check bus load, cable and the drive's " + terms.input + "s");
  }

  static Outcome leave(const Context& context) {
    AxisCore& axis = context.axis;
    const std::string obstacle = drive::obstacle(axis);
    if (!obstacle.empty()) return Outcome::failed(obstacle);
    return Outcome::done(jointName(axis.config()) + ": is enabled and well, mode " +
                         axis.mode().spec().name + "; it was left alone" +
                         axis.basis().neighbours.text());
  }

  Outcome finish(const Context& context) {
    AxisCore& axis = context.axis;
    const std::string obstacle = drive::obstacle(axis);
    const std::string done = "recovered, enabled in mode " + axis.mode().spec().name + " after " +
                             seconds(context.now - started_);
    if (!obstacle.empty()) return Outcome::failed(obstacle + " (" + done + ")");
    const Neighbours& others = axis.basis().neighbours;
    const bool booted_all = booted_ && others.any();
    return Outcome::done(jointName(axis.config()) + ": " + done +
                         (booted_all ? "; the drive was booted for it, with all its axes" : "") +
                         others.text());
  }

  Phase phase_ = Phase::begin;
  FaultResetStep reset_;
  EnableStep enabling_;
  Time started_{}, since_{};
  std::optional<Time> booted_;  ///< when the boot began; none: it was not needed so far
};

}  // namespace

Result<std::unique_ptr<Procedure>> makeRecover(AxisCore& axis) {
  const ModeChannel& mode = axis.mode().working();
  const std::string unusable = axis.mode().refusal(mode);
  if (!unusable.empty()) {
    return Error{axis.who() + ": cannot enable in mode " + mode.spec->name + ": " + unusable};
  }
  return std::unique_ptr<Procedure>(std::make_unique<Recover>(axis));
}

}  // namespace cia402::drive
