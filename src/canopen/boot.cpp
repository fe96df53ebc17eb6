// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "boot.h"

#include "boot_steps.h"

namespace cia402::canopen {
namespace {

/// In this order; each step is skipped where the configuration asks nothing of it.
std::vector<BootStepPointer> makeSteps(const NodeConfig& config) {
  std::vector<BootStepPointer> steps;
  steps.push_back(makeBootUpWait());
  steps.push_back(makeProofOfLife());
  steps.push_back(makeIdentification());
  steps.push_back(makeStop());
  steps.push_back(makeRestore());
  steps.push_back(makeErrorControl());
  steps.push_back(makeUnchangedCheck());
  steps.push_back(makeCobIds());
  steps.push_back(makeSyncSetup());
  steps.push_back(makePdos(config));
  steps.push_back(makeStartupWrites());
  steps.push_back(makeSignature());
  steps.push_back(makeStart());
  return steps;
}

}  // namespace

BootProcedure::BootProcedure(const NodeConfig& config, const MasterConfig& master, SdoClient& sdo,
                             can::Sink& sink, SdoPacer& pacer)
    : boot_(config, master, sdo, sink, pacer) {}

void BootProcedure::start(From from, Time now) {
  boot_.reset();
  steps_ = makeSteps(boot_.config);
  status_ = Status::running;
  boot_.absent_at = now + boot_.config.boot_timeout;
  boot_.found.after_reset = from == From::boot_up;
  if (boot_.restore_pending && from == From::boot_up) boot_.restored = boot_.must_configure = true;
  boot_.restore_pending = false;
  if (from == From::unknown) boot_.command(NmtCommand::enter_pre_operational);
  enter(from == From::reset ? 0 : 1, now);
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
  status_ = Status::done;
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
        if (boot_.found.started) boot_.command(NmtCommand::enter_pre_operational);
        boot_.found.started = false;
        boot_.sdo.holdUntil(Time());
        status_ = boot_.failure == BootFailure::absent ? Status::absent : Status::failed;
        break;
    }
  }
  return status_;
}

void BootProcedure::heartbeatHeard(NmtState state) {
  boot_.found.heartbeat_heard = true;
  if (started() && state == NmtState::operational) boot_.found.operational_heard = true;
}

bool BootProcedure::tpdoHeard() {
  if (!running() || !started() || boot_.found.operational_heard) return false;
  boot_.found.operational_heard = true;
  return true;
}

}  // namespace cia402::canopen
