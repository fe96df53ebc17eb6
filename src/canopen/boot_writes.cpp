// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The start-up writes of profile and user.
#include "boot_steps.h"
#include "cia402_driver/canopen/abort_code.h"

namespace cia402::canopen {
namespace {

constexpr Duration kStateRetry = std::chrono::milliseconds(50);
constexpr Duration kStatePatience = std::chrono::seconds(3);  // a drive stops and disables in that

class StartupWrites : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    const std::vector<StartupWrite>& writes = boot.config.writes;
    while (boot.found.unchanged && item_ < writes.size() && !writes[item_].always) ++item_;
    if (item_ >= writes.size()) return false;
    repeat_at_ = patient_until_ = kNever;
    reading_ = writes[item_].only_if_different;
    if (reading_) {
      boot.read(writes[item_].object, writes[item_].name, now);
    } else {
      send(boot, now);
    }
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (repeat_at_ != kNever) {
      if (now < repeat_at_) return Progress::waiting;
      repeat_at_ = boot.deadline = kNever;
      send(boot, now);
      return Progress::waiting;
    }
    if (!boot.answered()) return Progress::waiting;
    if (reading_) return compare(boot, now);
    if (boot.ok()) return done();
    const bool optional = boot.config.writes[item_].optional;
    if (!optional && boot.ticket->abortCode() == abort_code::kDeviceState) {
      return repeatLater(boot, now);
    }
    if (!optional || !boot.refused()) return boot.failTransfer();
    boot.noteTransfer("optional start-up write left out");
    return done();
  }

 private:
  Progress done() {
    ++item_;
    return Progress::again;
  }

  void send(BootContext& boot, Time now) {
    const StartupWrite& wanted = boot.config.writes[item_];
    reading_ = false;
    boot.write(wanted.object, wanted.data, wanted.name, now);
  }

  Progress compare(BootContext& boot, Time now) {
    if (boot.ok() && boot.ticket->data() == boot.config.writes[item_].data) return done();
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    send(boot, now);  // also where the object cannot be read
    return Progress::waiting;
  }

  /// Drives that lock parameters while they are enabled may still be on their way out of that
  /// state.
  Progress repeatLater(BootContext& boot, Time now) {
    if (patient_until_ == kNever) patient_until_ = now + kStatePatience;
    if (now >= patient_until_) return boot.failTransfer();
    repeat_at_ = boot.deadline = now + kStateRetry;
    return Progress::waiting;
  }

  std::size_t item_ = 0;
  bool reading_ = false;
  /// A write that the drive's present state forbids: when to try again, and until when.
  Time repeat_at_ = kNever, patient_until_ = kNever;
};

}  // namespace

BootStepPointer makeStartupWrites() { return std::make_unique<StartupWrites>(); }

}  // namespace cia402::canopen
