// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/procedure.h"

#include <utility>

#include "canopen/boot/steps.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

// Places in makeSteps().
constexpr std::size_t kBrake = 0, kBootUpWait = 1, kWake = 2, kBrakeOfKnown = 5;
constexpr Duration kOnItsWay = std::chrono::milliseconds(20);   // a heartbeat of before a command
constexpr Duration kResetTime = std::chrono::milliseconds(50);  // after which no old state is told

/// In this order; each step is skipped where the configuration asks nothing of it.
std::vector<BootStepPointer> makeSteps(const NodeConfig& config) {
  std::vector<BootStepPointer> steps;
  steps.push_back(makeBrake(false));
  steps.push_back(makeBootUpWait());
  steps.push_back(makeWake());
  steps.push_back(makeProofOfLife());
  steps.push_back(makeIdentification());
  steps.push_back(makeBrake(true));
  steps.push_back(makeStop());
  steps.push_back(makeRestore());
  steps.push_back(makeErrorControl());
  steps.push_back(makeHalfFloatSearch());
  steps.push_back(makeWidths());
  steps.push_back(makeUnchangedCheck());
  steps.push_back(makeCobIds());
  steps.push_back(makeSyncSetup());
  steps.push_back(makeEarlyWrites());
  steps.push_back(makePdos(config));
  steps.push_back(makeStartupWrites());
  steps.push_back(makeKeptValues());
  steps.push_back(makeSignature());
  steps.push_back(makeStart());
  return steps;
}

}  // namespace

BootProcedure::BootProcedure(const NodeConfig& config, const MasterConfig& master, SdoClient& sdo,
                             can::Sink& sink, SdoPacer& pacer)
    : boot_(config, master, sdo, sink, pacer) {}

void BootProcedure::start(From from, Time now, NmtState told, NmtCommand reset) {
  boot_.reset();
  status_ = Status::running;
  boot_.absent_at = now + boot_.config.boot_timeout;
  boot_.found.after_reset = from == From::boot_up;
  if (from == From::boot_up) boot_.vendor_known = false;  // another one may have been put there
  if (boot_.restore_pending && from == From::boot_up) boot_.restored = boot_.must_configure = true;
  boot_.restore_pending = false;
  unheard_ = from != From::reset && from != From::boot_up;
  boot_.found.appeared = from == From::heard;
  from_reset_ = !unheard_;
  if (unheard_) {
    boot_.reset_when_braked = from == From::before_reset;
    boot_.braking = true;
    boot_.stopped_before = told == NmtState::stopped;
    return begin(kBrake, now);
  }
  if (from == From::reset) {
    boot_.reset_command = reset;
    boot_.awaitReset(now);
  }
  begin(from == From::reset ? kBootUpWait : kWake, now);
}

void BootProcedure::begin(std::size_t step, Time now) {
  steps_ = makeSteps(boot_.config);
  enter(step, now);
}

void BootProcedure::stop() {
  status_ = Status::idle;
  boot_.sdo.holdUntil(Time());
  boot_.step = "not running";
}

void BootProcedure::enter(std::size_t step, Time now) {
  for (index_ = step; index_ < steps_.size(); ++index_) {
    boot_.deadline = kNever;
    if (steps_[index_]->begin(boot_, now)) return;
  }
  boot_.sdo.holdUntil(Time());
  boot_.step = "ready";
  tellWhatIsLacking();
  status_ = Status::done;
}

void BootProcedure::tellWhatIsLacking() {
  const BootFindings& found = boot_.found;
  if (!found.lacking.empty()) {
    const std::string& remedy = boot_.config.lacking_remedy;
    boot_.notes.insert(boot_.notes.begin(),
                       "left out, for only defaults ask for it and the drive does not have it, or "
                       "does not let it be written or mapped" +
                           (remedy.empty() ? "" : " (" + remedy + ")") + ": " +
                           joined(found.lacking, ", "));
  }
  if (!found.lacking_optional.empty()) {
    boot_.remarks.push_back(
        "optional start-up writes left out, for it does not have them or does "
        "not let them be written: " +
        joined(found.lacking_optional, ", "));
  }
}

BootProcedure::Status BootProcedure::advance(Time now) {
  while (status_ == Status::running) {
    BootStep& present = *steps_[index_];
    switch (present.check(boot_, now)) {
      case Progress::waiting:
        return status_;
      case Progress::again:
        if (present.begin(boot_, now)) break;
        [[fallthrough]];
      case Progress::next:
        enter(index_ + 1, now);
        break;
      case Progress::failed:
        if (boot_.found.started) boot_.command(NmtCommand::enter_pre_operational, now);
        boot_.found.started = false;
        boot_.sdo.holdUntil(Time());
        status_ = boot_.failure == BootFailure::absent ? Status::absent : Status::failed;
        break;
    }
  }
  return status_;
}

bool BootProcedure::ignoresReset(NmtState state, Time now) const {
  return running() && boot_.resetting && state == NmtState::operational &&
         now >= boot_.commanded + kResetTime;
}

bool BootProcedure::asksForMotors(NmtState heard) const {
  const bool known = !boot_.config.vendor_id || boot_.vendor_known;
  return running() && boot_.braking && !boot_.found.braked && known && heard != NmtState::stopped &&
         !boot_.config.brakes.empty();
}

/// A reset of the communication stops no motor by itself.
bool BootProcedure::seesToMotors() const {
  if (!running() || boot_.config.brakes.empty()) return false;
  if (index_ == kBrake || index_ == kBrakeOfKnown) return true;
  const BootFindings& found = boot_.found;
  const bool there = from_reset_ || found.heartbeat_heard || found.tpdo_heard || found.identity;
  return there && !found.braked && index_ < kBrakeOfKnown;
}

/// Silent while its motors were asked for, it is there now and may still turn them: they come first
/// again. One that missed its master may have left the state operational by itself, and one that
/// tells so without a boot-up message has not heard its reset.
bool BootProcedure::mayStillTurn(NmtState state, Time now) {
  const bool reset_in_vain = boot_.resetting && state == NmtState::pre_operational;
  if (reset_in_vain && now < boot_.commanded + kResetTime) return false;
  const bool appears =
      std::exchange(unheard_, false) && (state == NmtState::operational || reset_in_vain);
  if (!appears || boot_.found.braked || boot_.config.brakes.empty()) return false;
  boot_.resetting = boot_.stopped_before = false;
  boot_.braking = true;
  begin(kBrake, now);
  return true;
}

void BootProcedure::heartbeatHeard(NmtState state, Time now) {
  boot_.found.heartbeat_heard = true;
  boot_.found.heartbeat_state = state;
  boot_.found.heartbeat_at = now;
  if (state == NmtState::stopped) boot_.found.tpdo_heard = false;  // it had left before
  if (started()) {
    if (state == NmtState::operational) boot_.found.operational_heard = true;
    return;
  }
  if (state == NmtState::pre_operational) boot_.found.stopped = false;
  if (boot_.braking) unheard_ = false;
  if (boot_.braking || mayStillTurn(state, now)) return;
  const bool disobeys = state == NmtState::operational || state == NmtState::stopped;
  // One that is guarded answers a question that left behind the command.
  const Duration heard_late = boot_.guarded() ? Duration::zero() : kOnItsWay;
  const Duration on_its_way = boot_.resetting ? kResetTime : heard_late;
  if (!disobeys || now < boot_.commanded + on_its_way) return;
  if (boot_.resetting) {
    boot_.command(boot_.reset_command, now);
    boot_.resetting = --boot_.resets_left > 0;  // else it takes no reset
  } else if (state == NmtState::stopped) {
    stoppedHeard(now);
  } else {
    boot_.found.stopped = false;
    boot_.command(NmtCommand::enter_pre_operational, now);
  }
}

/// No SDO answer can come: what was asked is void, and begins again once the drive has woken up.
void BootProcedure::stoppedHeard(Time now) {
  BootFindings& found = boot_.found;
  if (found.stopped_count++ == 0) found.stopped_since = now;
  found.stopped_last = now;
  if (std::exchange(found.stopped, true)) return;
  boot_.sdo.cancelAll("it says that it is stopped (NMT)");
  boot_.notes.clear();
  boot_.remarks.clear();
  begin(kWake, now);
}

bool BootProcedure::tpdoHeard() {
  if (!running() || !started() || boot_.found.operational_heard) return false;
  boot_.found.operational_heard = boot_.found.only_by_tpdo = true;
  return true;
}

bool BootProcedure::tpdoAppears(Time now) {
  boot_.found.tpdo_heard = true;
  if (boot_.braking) unheard_ = false;
  const bool on_its_way = now < boot_.commanded + kOnItsWay;
  if (boot_.braking) return true;
  return !on_its_way && mayStillTurn(NmtState::operational, now);
}

bool BootProcedure::overtakenByTpdo(NmtState state) {
  return std::exchange(boot_.found.only_by_tpdo, false) && state == NmtState::pre_operational;
}

}  // namespace cia402::canopen
