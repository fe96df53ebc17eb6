// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Factory settings before the drive is configured, where the user asks for them.
#include <algorithm>

#include "canopen/boot/steps.h"

namespace cia402::canopen {
namespace {

constexpr ObjectId kRestoreAll{0x1011, 1};  // CiA 301, 7.5.2.14
constexpr const char* kRestoreAllName = "restore all default parameters";
const Bytes kLoad{0x6C, 0x6F, 0x61, 0x64};                   // the signature, "load"
constexpr Duration kRest = std::chrono::seconds(1);          // a drive left in motion stops in that
constexpr Duration kRestoreTime = std::chrono::seconds(10);  // drives write their memory meanwhile

/// Writes the signature and resets the node; its boot-up begins the boot anew.
class Restore : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (!boot.config.boot.restore_before_configure || boot.restored) return false;
    const std::vector<StartupWrite>& writes = boot.config.writes;
    const bool was_stopped = std::any_of(writes.begin(), writes.end(),
                                         [](const StartupWrite& write) { return write.always; });
    boot.step = "waiting for the drive to stand still before its parameters are restored";
    boot.deadline = now + (was_stopped ? kRest : Duration::zero());
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    switch (phase_) {
      case Phase::resting:
        if (now < boot.deadline) return Progress::waiting;
        restore(boot, now);
        return Progress::waiting;
      case Phase::restoring:
        return boot.answered() ? restart(boot, now) : Progress::waiting;
      case Phase::restarting:
        break;
    }
    if (now < boot.deadline) return Progress::waiting;
    return boot.fail(BootFailure::refused,
                     std::string("boot failed: the drive restored its parameters (1011:01), but "
                                 "did not reset when told so (NMT reset ") +
                         (boot.config.reset_node_allowed ? "node" : "communication") +
                         "); switch its power off and on");
  }

 private:
  enum class Phase { resting, restoring, restarting };

  void restore(BootContext& boot, Time now) {
    SdoOptions patient = boot.config.sdo;
    patient.timeout = std::max(patient.timeout, kRestoreTime);
    phase_ = Phase::restoring;
    boot.deadline = kNever;
    boot.write(kRestoreAll, kLoad, kRestoreAllName, now, patient);
  }

  Progress restart(BootContext& boot, Time now) {
    if (!boot.ok()) {
      const Progress failed = boot.failTransfer();
      boot.error += "; leave out `restore_before_configure` where the drive cannot do it";
      return failed;
    }
    boot.restore_pending = true;
    boot.command(
        boot.config.reset_node_allowed ? NmtCommand::reset_node : NmtCommand::reset_communication,
        now);
    phase_ = Phase::restarting;
    boot.step = "waiting for boot-up after its parameters were restored";
    boot.deadline = now + boot.config.boot_timeout;
    return Progress::waiting;
  }

  Phase phase_ = Phase::resting;
};

}  // namespace

BootStepPointer makeRestore() { return std::make_unique<Restore>(); }

}  // namespace cia402::canopen
