// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

#include "sim/world/world.h"

namespace cia402::sim {

/// What a SYNC producer sends.
struct SyncSchedule {
  Duration period{std::chrono::milliseconds(4)};
  std::uint8_t counter_overflow = 0;  ///< 1019h: 0 without counter, else 2 to 240: counts 1 to this
  Duration jitter{};                  ///< each SYNC is late by a uniform time up to this (< period)
  std::uint32_t cob_id = 0x80;
};

/// A SYNC producer that is not the driver: another master, or a drive with bit 30 of 1005h.
///
///     SyncProducer producer;
///     producer.connect(world.addParticipant("sync", producer));
///     producer.start(schedule, world.now());
class SyncProducer final : public Participant {
 public:
  /// @param seed of the jitter.
  explicit SyncProducer(std::uint64_t seed = 1) : generator_(seed) {}

  /// Where to send; must be called once before start().
  void connect(can::Sink& sink) { sink_ = &sink; }
  /// The first SYNC is due at `now`, with the counter 1.
  void start(const SyncSchedule& schedule, Time now);
  void stop() { due_ = kNever; }
  /// SYNCs since construction.
  std::uint64_t sent() const { return sent_; }

  void receive(const can::Frame&, Time) override {}
  /// Sends the SYNC that is due.
  void tick(Time now) override;
  Time nextDeadline() const override { return due_; }

 private:
  Duration lateness();

  std::mt19937_64 generator_;
  can::Sink* sink_ = nullptr;
  SyncSchedule schedule_;
  Time slot_{};  // the SYNC's time without jitter
  Time due_ = kNever;
  std::uint8_t counter_ = 1;
  std::uint64_t sent_ = 0;
};

}  // namespace cia402::sim
