// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/device/pdo_parameters.h"

namespace cia402::sim {

/// One TPDO (CiA 301, 7.2.2): synchronous, on request, on change or by event timer. Sends nothing
/// unless started.
class SlaveTpdo {
 public:
  /// @param number 0 is TPDO 1.
  SlaveTpdo(SlaveContext& context, unsigned number);

  const PdoRecords& records() const { return records_; }
  /// Takes communication and mapping parameters over from the dictionary; begins anew.
  void configure();
  /// Entering operational: counts SYNCs and runs timers from now on.
  void start();
  void stop();
  /// CAN-ID to which a remote request is answered, or a value no frame has.
  std::uint32_t requestId() const { return rtr_allowed_ ? can_id_ : kNoCanId; }

  /// Whether the SYNC with this counter (0: none) makes the PDO sample its objects; counts it.
  bool wantsSample(std::uint8_t counter);
  /// Samples after such a SYNC, and sends as the type asks.
  void onSync();
  /// Samples and sends, if event-driven and the content is new.
  void onChange();
  /// Sends now, or when the inhibit time ends, if event-driven.
  void onStart();
  void onRequest();
  bool sendsOnChange() const;
  /// As configured, running or not.
  bool eventDriven() const;
  /// Sends what the event timer or the end of the inhibit time made due.
  void tick();
  Time deadline() const;

 private:
  static constexpr std::uint32_t kNoCanId = 0xFFFFFFFF;

  bool valid() const { return can_id_ != kNoCanId && !mapping_.empty(); }
  bool active() const { return running_ && valid(); }
  bool isNew(std::uint64_t data) const { return !sent_ || data != last_; }
  std::uint64_t sample();
  void trigger(std::uint64_t data);
  void transmit(std::uint64_t data);

  SlaveContext& context_;
  PdoRecords records_;
  Mapping mapping_;
  std::uint32_t can_id_ = kNoCanId;
  bool rtr_allowed_ = false;
  unsigned type_ = 255;
  Duration inhibit_time_{};
  Duration event_time_{};
  std::uint8_t sync_start_ = 0;

  bool running_ = false;
  bool counting_ = false;  // the first SYNC of the count has come
  unsigned syncs_ = 0;
  bool sent_ = false;
  std::uint64_t last_ = 0;
  struct Word {
    std::uint64_t word;
    Time since;
  };
  std::vector<Word> words_;  // DeviceBehaviour::stale_statusword: from the one that is shown on
  bool sampled_ = false;     // type 252: `sampled_data_` holds the data of the last SYNC
  std::uint64_t sampled_data_ = 0;
  bool waiting_ = false;  // for the end of the inhibit time
  Time inhibited_until_ = Time::min();
  Time event_deadline_ = kNever;
};

}  // namespace cia402::sim
