// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The NMT command to start, and the proof that it arrived.
#include <algorithm>

#include "canopen/boot/steps.h"

namespace cia402::canopen {
namespace {

constexpr Duration kLeastStartTime = std::chrono::seconds(1);
constexpr Duration kRepeatTime = std::chrono::milliseconds(250);  // a lost command is sent again
constexpr Duration kProbeTime = std::chrono::milliseconds(100);

/// The longest time to a TPDO that comes by itself: with every SYNC or every event timer. None if
/// there is no such TPDO.
std::optional<Duration> tpdoPeriod(const NodeConfig& config, Duration sync_period) {
  std::optional<Duration> shortest;
  for (const PdoConfig& pdo : config.pdos) {
    if (pdo.direction != PdoDirection::tpdo || !pdo.enabled) continue;
    const bool on_sync = pdo.transmission >= 1 && pdo.transmission <= 240;
    if (!on_sync && pdo.event_timer == 0) continue;
    const Duration period = on_sync ? pdo.transmission * sync_period
                                    : Duration(std::chrono::milliseconds(pdo.event_timer));
    shortest = shortest ? std::min(*shortest, period) : period;
  }
  return shortest;
}

class Start : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    boot.found.started = true;
    const std::optional<Duration> tpdo = tpdoPeriod(boot.config, boot.sync_period);
    Duration wait = std::max(boot.config.heartbeat_timeout, kLeastStartTime);
    if (tpdo) wait = std::max(wait, 3 * *tpdo);
    blind_ = !boot.found.supervised && !tpdo;
    if (boot.found.guarded) {
      boot.step = "waiting for an answer to guarding that says operational";
    } else if (boot.found.supervised) {
      boot.step = "waiting for the heartbeat to say operational";
    } else {
      boot.step = blind_ ? "asking for the NMT state" : "waiting for the first TPDO";
    }
    end_ = now + (blind_ ? kProbeTime : wait);
    command(boot, now);
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (boot.found.operational_heard) return Progress::next;
    if (now < boot.deadline) return Progress::waiting;
    if (now < end_) {
      command(boot, now);
      return Progress::waiting;
    }
    if (!blind_) return fail(boot);
    boot.notes.emplace_back(
        "it was started (NMT), but nothing tells whether it became operational: it sends neither a "
        "heartbeat nor a TPDO by itself and answers no node guarding");
    return Progress::next;
  }

 private:
  /// Repeated until it shows: the command is not acknowledged.
  void command(BootContext& boot, Time now) {
    boot.command(NmtCommand::start, now);
    boot.deadline = std::min(end_, now + kRepeatTime);
    if (blind_ || boot.found.guarded) boot.ask_state = true;
  }

  static Progress fail(BootContext& boot) {
    const char* missing = boot.found.guarded ? "its answers to guarding did not say operational"
                          : boot.found.supervised ? "its heartbeat did not say operational"
                                                  : "none of its TPDOs came";
    return boot.fail(BootFailure::timed_out,
                     std::string("boot failed: the drive was started (NMT), but ") + missing +
                         (boot.found.heartbeat_heard
                              ? std::string(" (but ") + toString(boot.found.heartbeat_state) + ")"
                              : std::string()) +
                         " in time; read its error register 1001:00 and emergencies");
  }

  bool blind_ = false;  ///< only the drive's answer to a remote frame could tell
  Time end_ = kNever;
};

}  // namespace

BootStepPointer makeStart() { return std::make_unique<Start>(); }

}  // namespace cia402::canopen
