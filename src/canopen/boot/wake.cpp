// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that says "stopped", by heartbeat or asked by guarding, answers no SDO (CiA 301, table
// 38): it is brought out of that state first.
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"

namespace cia402::canopen {
namespace {

constexpr unsigned kQuick = 4;  // commands in quick succession, then slowly
constexpr Duration kQuickInterval = std::chrono::milliseconds(20);
constexpr Duration kSlowInterval = std::chrono::milliseconds(100);
constexpr Duration kSilence = std::chrono::milliseconds(500);  // then an SDO request may tell
constexpr unsigned kEnough = 4;                                // heartbeats that say stopped, ...
constexpr Duration kPatience = std::chrono::seconds(1);        // ... over so long

class Wake : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (!boot.found.stopped) return false;
    boot.step = "waiting for the drive to leave the NMT state stopped";
    command(boot, now);
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    const BootFindings& found = boot.found;
    if (now >= found.stopped_last + kSilence) boot.found.stopped = false;
    if (!found.stopped) return Progress::next;
    if (found.stopped_count >= kEnough && now >= found.stopped_since + kPatience) {
      return boot.failStopped();
    }
    if (now >= boot.deadline) command(boot, now);
    return Progress::waiting;
  }

 private:
  void command(BootContext& boot, Time now) {
    boot.wake(now);
    ++boot.found.wake_ups;
    boot.deadline = now + (++sent_ < kQuick ? kQuickInterval : kSlowInterval);
  }

  unsigned sent_ = 0;
};

}  // namespace

BootStepPointer makeWake() { return std::make_unique<Wake>(); }

}  // namespace cia402::canopen
