// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Store and restore parameters, CiA 301, 7.5.2.13 (1010h) and 7.5.2.14 (1011h).

#include "common/text.h"
#include "drive/procedures/limits.h"
#include "drive/procedures/parameter_step.h"
#include "drive/sentence.h"
#include "fieldbus/abort_code.h"

namespace cia402::drive {
namespace {

constexpr std::uint32_t kOnCommand = 1;  // capability bits of 1010h; of 1011h only the first
constexpr std::uint32_t kByItself = 2;

/// What differs between the two objects.
struct Storage {
  const char* verb;  ///< "save"
  std::uint16_t index;
  const char* name;  ///< of the object
  fieldbus::Bytes signature;
};
const Storage& saving() {
  static const Storage kSaving{"save", 0x1010, "store_parameters", {0x73, 0x61, 0x76, 0x65}};
  return kSaving;
}
const Storage& restoring() {
  static const Storage kRestoring{
      "restore", 0x1011, "restore_default_parameters", {0x6C, 0x6F, 0x61, 0x64}};
  return kRestoring;
}

/// "1010:02 (communication parameters)".
std::string groupText(const Storage& storage, std::uint8_t subindex) {
  constexpr const char* kNames[] = {"", "all parameters", "communication parameters",
                                    "application parameters"};
  return fieldbus::toString(ObjectId{storage.index, subindex}) + " (" +
         (subindex <= 3 ? kNames[subindex] : "parameters of the maker") + ")";
}

/// Writes the signature to each chosen sub-index of 1010h or 1011h that can be commanded so.
class StorageStep final : public ParameterStep {
 public:
  StorageStep(const Storage& storage, std::vector<std::uint8_t> subindices)
      : storage_(storage), subindices_(std::move(subindices)) {}

  Outcome advance(const Context& context) override {
    while (next_ < subindices_.size()) {
      if (next_ > 0 && !ticket_ && !context.axis.state().feedback_valid) {  // see loseZeros()
        context.show("waiting for feedback", "the axis to tell its state anew");
        return Outcome::running();
      }
      const std::string refusal = parameterRefusal(context.axis, storage_.verb);
      if (!refusal.empty()) return Outcome::failed(refusal + done());
      if (next_ == 0 && !ticket_ && !context.axis.feedback().atStandstill()) {
        context.show("waiting for rest", "the axis to be seen standing");
        return Outcome::running();
      }
      if (!ticket_) askCapability(context);
      if (!ticket_->done()) return Outcome::running();
      if (writing_ && mayHaveMovedZero()) {
        loseZeros(context.axis);
      }
      const std::string problem = judge();
      if (!problem.empty()) return Outcome::failed(context.axis.who() + ": " + problem + done());
      if (!writing_) {
        command(context);
        continue;
      }
      append(done_, groupText(storage_, subindices_[next_]), ", ");
      ++next_;
      ticket_.reset();
      writing_ = false;
    }
    return Outcome::done();
  }
  std::string what() const override { return done_; }

 private:
  ObjectId object() const { return {storage_.index, subindices_[next_]}; }
  std::string done() const {
    return done_.empty() ? std::string() : std::string("; done before that: ") + done_;
  }

  void askCapability(const Context& context) {
    context.show(storage_.index == saving().index ? "asking what can be saved"
                                                  : "asking what can be restored",
                 "the drive to tell " + groupText(storage_, subindices_[next_]));
    ticket_ = context.axis.device().objects().upload(object(), storage_.name);
  }

  void command(const Context& context) {
    writing_ = true;
    context.show(storage_.index == saving().index ? "saving parameters" : "restoring parameters",
                 "the drive to confirm " + groupText(storage_, subindices_[next_]));
    fieldbus::AccessOptions patient;  // memory is slow, and a second command would find it busy
    patient.timeout = context.axis.profile().parameters.timeout;
    patient.retries = 0;
    ticket_ = context.axis.device().objects().download(object(), storage_.signature, storage_.name,
                                                       patient);
  }

  /// What the factory set may hold another zero; what only concerns the communication does not.
  bool mayHaveMovedZero() const {
    constexpr std::uint8_t kCommunication = 2;
    const bool refused =
        !ticket_->ok() && ticket_->failure() == fieldbus::Transfer::Failure::aborted_by_server;
    return storage_.index == restoring().index && !refused && subindices_[next_] != kCommunication;
  }

  std::string judge() const {
    const std::string group = groupText(storage_, subindices_[next_]);
    if (!ticket_->ok()) {
      return std::string("cannot ") + storage_.verb + " " + group + ": " + ticket_->reason();
    }
    if (writing_) return {};
    const std::uint64_t capability = fieldbus::toUnsigned(ticket_->data());
    if ((capability & kOnCommand) != 0) return {};
    const bool by_itself = storage_.index == saving().index && (capability & kByItself) != 0;
    return std::string("the drive does not ") + storage_.verb + " " + group + " on command (" +
           fieldbus::toString(object()) + " is " + hexText(capability, 8) + ")" +
           (by_itself ? "; it saves by itself" : "; choose others with `parameters`");
  }

  const Storage& storage_;
  std::vector<std::uint8_t> subindices_;
  std::size_t next_ = 0;
  bool writing_ = false;
  fieldbus::Ticket ticket_;
  std::string done_;
};

class SaveParameters : public Procedure {
 public:
  explicit SaveParameters(std::unique_ptr<ParameterStep> storing) : storing_(std::move(storing)) {}

  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    const Outcome outcome = storing_->advance(context);
    if (!outcome.isDone()) return outcome;
    const std::string saved = axis.who() + ": saved " + storing_->what() +
                              " in the drive's memory after " +
                              seconds(context.now - context.status.started);
    if (!axis.profile().parameters.power_cycle_after_save) return Outcome::done(saved);
    const std::string why =
        "its parameters were saved, after which the drive takes no enabling "
        "(power_cycle_after_save of its profile)";
    axis.control().wantPowerCycle(why);
    axis.basis().neighbours.wantPowerCycle(why);
    return Outcome::remarked(saved + "; switch the drive off and on before it is enabled again");
  }

 private:
  std::unique_ptr<ParameterStep> storing_;
};

/// Restored values count from the next reset (CiA 301, 7.5.2.14), so the device is reset; the
/// driver configures it again and leaves it disabled.
class RestoreParameters : public Procedure {
 public:
  explicit RestoreParameters(std::unique_ptr<ParameterStep> restoring)
      : restoring_(std::move(restoring)) {}

  Outcome advance(const Context& context) override {
    if (resetting_) return awaitBoot(context);
    const Outcome outcome = restoring_->advance(context);
    if (!outcome.isDone()) return outcome;
    const std::string others = context.axis.basis().neighbours.refusal();
    if (!others.empty()) {
      return Outcome::failed(context.axis.who() + ": restored the factory's values of " +
                             restoring_->what() + ", but did not reset the drive, as " + others +
                             ", then call it again: they count after a reset only");
    }
    resetting_ = true;
    reset_at_ = context.now;
    showBoot(context);
    context.axis.device().restart(context.now);
    return Outcome::running();
  }

  bool survivesDeviceLoss() const override { return resetting_; }

 private:
  static Duration bootTime(const Context& context) {
    return kBootTimes * context.axis.device().times().boot;
  }

  Outcome awaitBoot(const Context& context) {
    AxisCore& axis = context.axis;
    const std::string then = axis.profile().parameters.recipes.restore.then;
    const std::string restored = axis.who() + ": restored the factory's values of " +
                                 restoring_->what() + (then.empty() ? "" : " (" + then + ")");
    if (axis.deviceReady()) {
      const std::string gap = axis.device().restartGap();
      return Outcome::done(restored +
                           "; the drive was reset, configured again by the driver and is disabled" +
                           (axis.state().homed ? "" : ", not homed") +
                           (gap.empty() ? "" : "; " + gap + " for the values to count") +
                           axis.basis().neighbours.text());
    }
    const fieldbus::Health health = axis.device().health();
    const bool failed = health == fieldbus::Health::failed || health == fieldbus::Health::absent;
    if (failed && context.now > reset_at_) {
      return Outcome::failed(restored +
                             " and reset it, but it did not boot (has it got the "
                             "factory's " +
                             axis.device().terms().address + "?): " + axis.device().problem());
    }
    if (context.now < reset_at_ + bootTime(context)) return Outcome::running();
    return Outcome::failed(restored + " and reset it, but it was not ready within " +
                           seconds(context.now - reset_at_) + ", it is " +
                           fieldbus::toString(health) + ", " + axis.device().bootStep());
  }

  bool resetting_ = false;
  std::unique_ptr<ParameterStep> restoring_;
  Time reset_at_{};
};

std::string refusal(AxisCore& axis, const Storage& storage, const char* what) {
  const std::string away = deviceRefusal(axis, what);
  return away.empty() ? parameterRefusal(axis, storage.verb) : away;
}

}  // namespace

std::string parameterRefusal(AxisCore& axis, const std::string& verb) {
  const std::string what = axis.who() + ": cannot " + verb + " parameters: ";
  if (!axis.state().feedback_valid) return what + "no fresh statusword says that it is disabled";
  if (!axis.powerOff()) {
    return what + "the axis is not disabled (" + toString(axis.state().state) +
           "); disable it first";
  }
  if (axis.generator().moving()) return what + "the axis moves; wait until it is at rest";
  const std::string others = axis.basis().neighbours.refusal();
  return others.empty() ? others : what + others;
}

void loseZeros(AxisCore& axis) {
  axis.loseZero();
  axis.measureAnew();
  axis.basis().neighbours.loseZero();
  axis.basis().neighbours.measureAnew();
}

Result<std::unique_ptr<Procedure>> makeSaveParameters(AxisCore& axis) {
  const std::string why_not = refusal(axis, saving(), "save parameters");
  if (!why_not.empty()) return Error{why_not};
  std::unique_ptr<ParameterStep> step;
  if (axis.profile().parameters.recipes.memory.object.empty()) {
    step = std::make_unique<StorageStep>(saving(), axis.config().saved());
  } else {
    step = makeSaveBySwitch();
  }
  return std::unique_ptr<Procedure>(std::make_unique<SaveParameters>(std::move(step)));
}

Result<std::unique_ptr<Procedure>> makeRestoreParameters(AxisCore& axis, bool confirmed) {
  const std::string why_not = refusal(axis, restoring(), "restore parameters");
  if (!why_not.empty()) return Error{why_not};
  const bool by_object = !axis.profile().parameters.recipes.restore.object.empty();
  if (by_object && !confirmed) {
    return Error{axis.who() + ": nothing was restored: it would be by " +
                 restoreText(axis.profile()) + "; the service ~" + axis.config().name +
                 "/factory_reset with confirm: true does it"};
  }
  std::unique_ptr<ParameterStep> step;
  if (by_object) {
    step = makeRestoreByObject();
  } else {
    step = std::make_unique<StorageStep>(restoring(), axis.config().restored());
  }
  return std::unique_ptr<Procedure>(std::make_unique<RestoreParameters>(std::move(step)));
}

}  // namespace cia402::drive
