// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SYNC counter and period. The counter may change only while the period is 0 (CiA 301, 7.5.2.22).
#include "canopen/boot/steps.h"

namespace cia402::canopen {
namespace {

constexpr ObjectId kSyncPeriod{0x1006, 0};   // CiA 301, 7.5.2.6
constexpr ObjectId kSyncCounter{0x1019, 0};  // CiA 301, 7.5.2.22
constexpr const char* kSyncPeriodName = "communication cycle period";
constexpr const char* kSyncCounterName = "synchronous counter overflow value";
constexpr const char* kCounterRemedy =
    "where a drive takes no SYNC with a counter, write `sync_counter: 0` under `bus`";

class SyncSetup : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (boot.found.unchanged) return false;
    for (; phase_ != Phase::done; phase_ = after(phase_)) {
      if (ask(boot, now)) return true;
    }
    return false;
  }

  Progress check(BootContext& boot, Time now) override {
    if (const auto resting = patience_.rest(boot, now)) return *resting;
    if (!boot.answered()) return Progress::waiting;
    if (!take(boot)) {
      if (patience_.grant(boot, boot.ticket->abortCode(), now)) return Progress::waiting;
      const bool counted = phase_ == Phase::read_counter || phase_ == Phase::write_counter;
      return boot.failTransfer(counted && boot.refused() ? kCounterRemedy : "");
    }
    patience_.renew();
    phase_ = after(phase_);
    return Progress::again;
  }

 private:
  enum class Phase { read_counter, read_period, stop, write_counter, write_period, done };
  static Phase after(Phase phase) { return static_cast<Phase>(static_cast<int>(phase) + 1); }

  bool ask(BootContext& boot, Time now) {
    const NodeConfig& config = boot.config;
    switch (phase_) {
      case Phase::read_counter:
        if (!config.sync_counter) return false;
        boot.read(kSyncCounter, kSyncCounterName, now, boot.ifThere());
        return true;
      case Phase::read_period:
        if (!counter_differs_ && !config.sync_period_us) return false;
        boot.read(kSyncPeriod, kSyncPeriodName, now, boot.ifThere());
        return true;
      case Phase::stop:
        if (!counter_differs_ || period_.value_or(0) == 0) return false;
        boot.write(kSyncPeriod, toBytes(0, 4), kSyncPeriodName, now);
        return true;
      case Phase::write_counter:
        if (!counter_differs_) return false;
        boot.write(kSyncCounter, toBytes(*config.sync_counter, 1), kSyncCounterName, now);
        return true;
      case Phase::write_period:
        if (!wanted_period_ || period_ == wanted_period_) return false;
        boot.write(kSyncPeriod, toBytes(*wanted_period_, 4), kSyncPeriodName, now);
        return true;
      case Phase::done:
        break;
    }
    return false;
  }

  /// @return false if that answer ends the boot.
  bool take(BootContext& boot) {
    const NodeConfig& config = boot.config;
    switch (phase_) {
      case Phase::read_counter:
        if (!boot.ok()) return boot.refusedAsMissing() && *config.sync_counter == 0;
        counter_differs_ = boot.value() != *config.sync_counter;
        return true;
      case Phase::read_period:
        if (boot.ok()) {
          period_ = boot.value();
          wanted_period_ = config.sync_period_us.value_or(*period_);
        } else if (boot.refusedAsMissing() && config.sync_period_us.value_or(0) != 0) {
          boot.noteTransfer("does not know the SYNC period");
        }
        return boot.ok() || boot.refusedAsMissing();
      case Phase::stop:
        period_ = 0;
        return boot.ok();
      default:
        return boot.ok();
    }
  }

  Phase phase_ = Phase::read_counter;
  bool counter_differs_ = false;
  std::optional<std::uint32_t> period_;         ///< 1006h as the drive has it
  std::optional<std::uint32_t> wanted_period_;  ///< 1006h as it shall be
  StatePatience patience_;
};

}  // namespace

BootStepPointer makeSyncSetup() { return std::make_unique<SyncSetup>(); }

}  // namespace cia402::canopen
