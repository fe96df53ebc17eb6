// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "bus/axis_cycle.h"
#include "bus/cycle_statistics.h"
#include "bus/event.h"
#include "bus/fixed_text.h"
#include "canopen/master.h"
#include "config/robot.h"

namespace cia402::bus {

/// SYNC, and with it the pace of the cycle: produces it, or follows that of another device, and
/// watches that it is as it should be. Half a period after SYNC the cycle is due.
class SyncSupervisor {
 public:
  /// All must outlive the supervisor.
  SyncSupervisor(const config::BusConfig& bus, canopen::Master& master, AxisCycle& cycle,
                 EventSink& events)
      : bus_(bus),
        master_(master),
        cycle_(cycle),
        events_(events),
        external_(bus.sync_period, bus.sync_counter) {}

  /// The drives are being started: the first SYNC comes in a period.
  void begin(Time now);
  /// When SYNC or the cycle is due.
  Time deadline() const { return std::min(next_sync_, next_cycle_); }
  bool syncDue(Time now) const { return now >= next_sync_; }
  /// SYNC is due, or that of the other device.
  void onSyncDue(Time now) { bus_.external_sync ? lack(now) : produce(now); }
  /// This program's own SYNC is due.
  bool ownSyncDue(Time now) const { return syncDue(now) && !bus_.external_sync; }
  bool cycleDue(Time now) const { return now >= next_cycle_; }
  bool anythingDue(Time now) const { return syncDue(now) || cycleDue(now); }
  /// The cycle that was due has begun.
  void beginCycle() { next_cycle_ = kNever; }
  /// Another device has sent SYNC.
  void onForeignSync(const can::Frame& frame, Time stamp, Time now);
  /// Once a cycle: tells of trouble, and stops what it makes move otherwise than commanded.
  void watch(Time now) {
    if (now >= looked_ + kLookInterval) look(now);
  }

  /// Why no axis may be enabled as SYNC is now, or was a moment ago; empty if it is well.
  std::string enableProblem() const;
  /// How this program was late itself around `stamp`, in words; empty if it was not.
  std::string ownLateness(Time stamp) const;

  const CycleStatistics& statistics() const { return statistics_; }
  /// The trouble that was told, in words; empty if there is none.
  const FixedText<256>& problem() const { return problem_; }
  std::uint64_t missed() const { return external_.missed(); }  ///< of an external producer
  std::uint64_t foreign() const { return foreign_; }  ///< of others, while SYNC is produced here

 private:
  static constexpr Duration kLookInterval = std::chrono::milliseconds(100);

  enum class Trouble : std::uint8_t { none, second_producer, absent, wrong_form, wrong_period };

  bool mayProduce();
  void produce(Time now);
  void lack(Time now);
  void follow(const can::Frame& frame, Time stamp, Time now);
  void look(Time now);
  void watchSecondProducer();
  void tellTrouble(Trouble trouble, Time now);
  Trouble trouble() const;
  std::string textOf(Trouble trouble) const;

  const config::BusConfig& bus_;
  canopen::Master& master_;
  AxisCycle& cycle_;
  EventSink& events_;
  canopen::SyncConsumer external_;
  CycleStatistics statistics_;
  Time next_sync_ = kNever, next_cycle_ = kNever;
  bool held_ = false;                             ///< the first SYNC waits
  std::uint64_t foreign_ = 0, foreign_seen_ = 0;  ///< the latter at the last look
  unsigned foreign_looks_ = 0;                    ///< in a row that found new ones
  Time last_foreign_{};
  Duration lateness_{0};              ///< of the last SYNC of this program that was late
  Time late_since_{}, late_until_{};  ///< what drives miss meanwhile may be because of it
  Time looked_{};
  Trouble told_ = Trouble::none;
  Trouble seen_ = Trouble::none;  ///< at the last look
  Time seen_since_{};
  FixedText<256> problem_;
};

}  // namespace cia402::bus
