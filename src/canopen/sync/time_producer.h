// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "can/bus.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// Wall-clock time: since 1970-01-01 00:00 UTC.
using UnixTime = std::chrono::nanoseconds;

/// The TIME message (CiA 301, 7.2.6): COB-ID 0x100, TIME_OF_DAY (7.1.6.7): 28 bits of milliseconds
/// after midnight, 4 void bits, 16 bits of days since 1984-01-01, all little-endian; UTC. Nothing
/// for a time that it cannot tell (before 1984, after 2163: the clock is not set).
std::optional<can::Frame> timeFrame(UnixTime time);

/// Produces TIME at a regular interval.
class TimeProducer {
 public:
  /// @param interval zero: none is produced.
  explicit TimeProducer(Duration interval) : interval_(interval) {}

  bool enabled() const { return interval_ > Duration::zero(); }
  /// Tells which wall-clock time it is at `now`; nothing is sent before.
  void setWallTime(UnixTime wall, Time now);
  void start(Time now);
  /// Sends TIME if it is due.
  void tick(can::Sink& sink, Time now);
  Time deadline() const { return deadline_; }

 private:
  Duration interval_;
  std::optional<UnixTime> offset_;  ///< wall-clock time at Time()
  Time deadline_ = kNever;
};

}  // namespace cia402::canopen
