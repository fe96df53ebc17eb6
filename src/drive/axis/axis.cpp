// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/axis.h"

#include <utility>

#include "common/text.h"
#include "drive/axis/inquiry.h"
#include "drive/axis/words.h"
#include "drive/procedures/limits.h"
#include "drive/procedures/procedure.h"
#include "drive/profile/fault_text.h"

namespace cia402::drive {

namespace {

/// Does it work on what the whole device remembers? That may take its time, in which its other axes
/// get nothing else done.
bool ofMemory(ProcedureKind kind) {
  return kind == ProcedureKind::save_parameters || kind == ProcedureKind::restore_parameters;
}

}  // namespace

struct Axis::Impl {
  Impl(AxisConfig config, fieldbus::Device& device)
      : core(std::move(config), device), boot_ups(device.bootUps()) {}

  void watchDevice();
  void advance(Time now);
  void finish(bool success, std::string message);
  void preempt(ProcedureKind by);
  [[gnu::cold]] void stepProcedure(Time now);
  /// Why nothing but a stop can begin now; empty: it can.
  std::string busyRefusal(ProcedureKind kind) const;
  /// Ends a procedure that would enable the axis.
  void endEnabling(const std::string& why);
  /// What runs takes the motion over.
  bool busy() const { return status.running && !(procedure && procedure->letsMotionGoOn()); }
  Context context(Time now) { return {core, status, now}; }

  AxisCore core;
  std::vector<const Impl*> neighbours;  ///< of the other axes in the device
  Inquiry inquiry{core};
  ProcedureStatus status, previous;
  std::unique_ptr<Procedure> procedure;
  bool begun = false;  ///< the procedure has been advanced
  bool was_ready = false;
  bool lost = false;  ///< since the last update(), though the device may be ready again
  std::uint32_t boot_ups = 0;
  std::string calibrating;  ///< what is being written; empty: nothing
  bool moves_zero = true;   ///< that may
  Time watched{};           ///< when watchDevice() was called by readFeedback()
};

std::string Axis::Impl::busyRefusal(ProcedureKind kind) const {
  const std::string what = core.who() + ": " + toString(kind) + " is refused while ";
  if (stops(kind)) return {};
  if (status.running) {
    return what + toString(status.kind) + " runs (" + status.step +
           "); wait for its end, or stop it by halt, quick_stop or disable";
  }
  for (const Impl* other : neighbours) {
    const ProcedureStatus& its = other->status;
    if (!its.running || its.kind == kind || !(ofMemory(kind) || ofMemory(its.kind))) continue;
    return what + toString(its.kind) + " runs on " + jointName(other->core.config()) +
           ", in the same drive; wait for its end, or stop it by halt, quick_stop or disable";
  }
  if (calibrating.empty()) return {};
  return what + calibrating + " is being written" +
         (moves_zero ? ", which may give the drive another zero" : "") + "; call it again";
}

/// Notices a device that is not what it was, even if nobody called onHealthChange().
void Axis::Impl::watchDevice() {
  const bool ready = core.deviceReady();
  const std::uint32_t count = core.device().bootUps();
  if (was_ready && (!ready || count != boot_ups)) {
    core.onDeviceLost();
    lost = true;
  }
  was_ready = ready;
  boot_ups = count;
}

/// What fails the procedure that runs is of no interest where none does.
void Axis::Impl::stepProcedure(Time now) {
  const std::string failure = core.notices().takeFailure();
  if (!procedure) return;
  const bool waits = (lost || !core.deviceReady()) && procedure->survivesDeviceLoss();
  if (!failure.empty() && !waits) {
    finish(false, std::string(toString(status.kind)) + " failed: " + failure);
  } else {
    advance(now);
  }
}

void Axis::Impl::advance(Time now) {
  begun = true;
  Outcome outcome = procedure->step(context(now));
  if (outcome.isRunning()) return;
  finish(outcome.isDone(), std::move(outcome.message));
  status.remark = outcome.remark;
}

void Axis::Impl::finish(bool success, std::string message) {
  core.control().setFaultReset(false);
  core.control().setHomingStart(false);
  core.limits().open(false);
  status.running = false;
  status.success = success;
  status.message = std::move(message);
  status.waiting_for.clear();
  procedure.reset();
}

void Axis::Impl::preempt(ProcedureKind by) {
  finish(false, core.who() + ": " + toString(status.kind) + " was stopped by " + toString(by) +
                    " while " + (status.step.empty() ? std::string("starting") : status.step));
}

void Axis::Impl::endEnabling(const std::string& why) {
  if (!procedure || !enables(status.kind)) return;
  if (core.goal() == Goal::enabled && !core.inOperation()) core.setGoal(Goal::disabled);
  finish(false, core.who() + ": " + toString(status.kind) + " was ended: " + why);
}

Axis::Axis(AxisConfig config, fieldbus::Device& device)
    : impl_(std::make_unique<Impl>(std::move(config), device)),
      shown_{&impl_->core.state(), &impl_->status, &impl_->core.notices().count(),
             &impl_->core.generator().sent(), &impl_->core.generator().commands().stream()} {}
Axis::~Axis() = default;
Axis::Axis(Axis&&) noexcept = default;

const AxisConfig& Axis::config() const { return impl_->core.config(); }
fieldbus::Device& Axis::device() { return impl_->core.device(); }
const ProcedureStatus& Axis::previousProcedure() const { return impl_->previous; }

void Axis::readFeedback(Time now) {
  impl_->watchDevice();
  impl_->watched = now;
  impl_->core.readFeedback(now);
}

std::vector<ShownSignal> Axis::signals(Time now) const {
  return impl_->core.objects().signals.shown(now);
}

void Axis::look() { impl_->core.basis().objects.signals.look(); }

void Axis::update(Time now) {
  Impl& impl = *impl_;
  if (impl.watched != now) impl.watchDevice();  // else readFeedback() just did
  impl.core.supervise(now);
  impl.inquiry.advance(now);
  if (impl.procedure || impl.core.notices().failed()) impl.stepProcedure(now);
  impl.lost = false;
  impl.core.updateReadiness(impl.busy());
}

void Axis::writeCommands(Time now) { impl_->core.writeCommands(now); }

Result<std::uint32_t> Axis::start(const ProcedureRequest& request, Time now) {
  Impl& impl = *impl_;
  impl.watchDevice();
  const std::string failure = impl.core.notices().takeFailure();
  if (impl.procedure && !failure.empty() && !impl.procedure->survivesDeviceLoss()) {
    impl.finish(false, std::string(toString(impl.status.kind)) + " failed: " + failure);
  }
  std::string busy = impl.busyRefusal(request.kind);
  if (!busy.empty()) return Error{std::move(busy)};
  // A stop that was called just now is not taken back by a softer one.
  if (impl.procedure && stops(impl.status.kind) && !impl.begun) impl.advance(now);
  auto procedure = makeProcedure(request, impl.core);
  if (!procedure) {
    if (!impl.status.running) return procedure.error();
    // It cannot be done now, but what was asked is that the axis shall not go on.
    impl.preempt(request.kind);
    return Error{procedure.error().message + "; " + toString(impl.status.kind) + " was ended"};
  }
  if (impl.status.running) impl.preempt(request.kind);
  impl.previous = impl.status;
  const std::uint32_t id = impl.status.id + 1;
  impl.status = ProcedureStatus();
  impl.status.kind = request.kind;
  impl.status.id = id;
  impl.status.running = true;
  impl.status.step = "starting";
  impl.status.started = now;
  impl.status.deadline = now + timeLimit(request.kind, impl.core.config(),
                                         impl.core.device().times(), impl.core.state().velocity);
  impl.procedure = std::move(procedure.value());
  impl.begun = false;
  if (impl.procedure->leavesAlone(impl.context(now))) impl.advance(now);
  impl.core.updateReadiness(impl.busy());
  return id;
}

std::string Axis::refusal(const ProcedureRequest& request) const {
  std::string busy = impl_->busyRefusal(request.kind);
  if (!busy.empty()) return busy;
  const auto procedure = makeProcedure(request, impl_->core);
  return procedure ? std::string() : procedure.error().message;
}

void Axis::cancel(const std::string& reason, Time now) {
  Impl& impl = *impl_;
  if (!impl.procedure || !impl.procedure->cancel(reason, impl.context(now))) return;
  const bool switching_on = impl.core.goal() == Goal::enabled && !impl.core.inOperation();
  if (switching_on) impl.core.setGoal(Goal::disabled);
  impl.finish(false,
              impl.core.who() + ": " + toString(impl.status.kind) + " was cancelled: " + reason);
}

std::string Axis::calibrationRefusal() const {
  if (!impl_->calibrating.empty()) return impl_->calibrating + " is being written; call it again";
  if (impl_->status.running) {
    return std::string(toString(impl_->status.kind)) + " runs; wait for its end";
  }
  return drive::calibrationRefusal(impl_->core);
}
void Axis::beginCalibration(std::string what, bool moves_zero) {
  impl_->calibrating = std::move(what);
  impl_->moves_zero = moves_zero;
}
void Axis::adopt(const AxisConfig& next, bool at_rest) {
  AxisConfig& config = impl_->core.basis().config;
  drive::tune(config, next);
  if (!at_rest) return;
  drive::adopt(config, next);
  impl_->core.limits().adopt();
}
void Axis::loseZero(bool device) {
  impl_->core.loseZero();
  if (device) impl_->core.basis().neighbours.loseZero();
}
void Axis::measureAnew(bool device) {
  impl_->core.measureAnew();
  if (device) impl_->core.basis().neighbours.measureAnew();
}
void Axis::addNeighbour(Axis& other) {
  impl_->neighbours.push_back(other.impl_.get());
  impl_->core.basis().neighbours.add(other.impl_->core);
}
std::string Axis::deviceRefusal() const { return impl_->core.basis().neighbours.refusal(); }
std::string Axis::neighbourText() const { return impl_->core.basis().neighbours.text(); }
void Axis::endCalibration() { impl_->calibrating.clear(); }
void Axis::noteWritten(fieldbus::ObjectId object) { impl_->core.basis().written.insert(object); }

Result<void> Axis::command(double value, Time now) {
  std::string refusal = motionRefusal();
  if (!refusal.empty()) return Error{std::move(refusal)};
  return impl_->core.generator().command(value, now);
}

std::string Axis::commandRefusal(double value) const {
  std::string refusal = motionRefusal();
  if (!refusal.empty()) return refusal;
  const Generator& generator = impl_->core.generator();
  refusal = generator.commands().refusal(value, generator.mode());
  if (refusal.empty()) refusal = generator.commands().excess(value, generator.mode());
  return refusal.empty() ? refusal : jointName(config()) + ": " + refusal;
}

void Axis::follow(const std::string* who) { impl_->core.generator().commands().follow(who); }
const std::string* Axis::leader() const { return impl_->core.generator().commands().leader(); }
bool Axis::late() const { return impl_->core.generator().late(); }
bool Axis::setTarget(double value) { return impl_->core.generator().take(value); }
void Axis::stopSetPoint(Duration over) { impl_->core.stops().endMotion(over); }

bool Axis::endsGoal() const { return impl_->core.stops().endsGoal(); }
bool Axis::handsOver() const { return impl_->core.generator().handingOver(); }

double Axis::positionResolution() const { return impl_->core.feedback().positionResolution(); }
std::string Axis::motionRefusal() const { return drive::motionRefusal(impl_->core, impl_->busy()); }
double Axis::positionBy(const ObjectSpec& object, std::uint64_t raw) const {
  return impl_->core.feedback().positionBy(object, raw);
}
bool Axis::heardLately(Time now) const { return impl_->core.feedback().heardLately(now); }
bool Axis::beingFound() const { return impl_->core.device().seesToMotors(); }
bool Axis::mayMove() const { return impl_->core.feedback().mayMove(); }
std::string Axis::obstacle() const { return drive::obstacle(impl_->core); }
const std::string& Axis::modeName() const { return impl_->core.mode().spec().name; }

void Axis::stopBesideCycle(const std::string& why) {
  impl_->core.stops().stopUrgently(why);
  impl_->endEnabling(why);
}

void Axis::onEmergency(const fieldbus::Emergency& emergency, Time now, const std::string& excuse) {
  impl_->core.faults().onEmergency(emergency, excuse, now);
  const auto missing = missingByCode(*config().profile, emergency.code);
  const bool without_outputs = missing == ErrorText::Missing::outputs;
  if (!without_outputs || !excuse.empty() || !impl_->core.deviceReady()) return;
  const fieldbus::Terms& terms = impl_->core.device().terms();
  stopBesideCycle(std::string("the drive reports ") + terms.emergency + " " +
                  hexText(emergency.code, 4) + ": " + terms.outputs_late +
                  "; quick stop is commanded by " + terms.access + ". Check " +
                  terms.outputs_check + ", then enable again");
}

void Axis::onHealthChange() { impl_->watchDevice(); }

void Axis::onBusLost(const std::string& why) {
  impl_->core.onBusLost(why);
  impl_->endEnabling(why + ": nothing reaches the drive");
}

std::string Axis::faultText() const { return impl_->core.faults().text(); }
bool Axis::faultTextAwaited() const { return impl_->core.faults().textAwaited(); }
std::string Axis::unknownText() const { return impl_->core.feedback().unknownText(); }
const Notice& Axis::notice(std::uint32_t number) const { return impl_->core.notices().at(number); }

}  // namespace cia402::drive
