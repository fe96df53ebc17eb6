// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "drive/axis/axis.h"
#include "drive/axis/runaway_watch.h"
#include "drive/axis/set_point.h"

namespace cia402::drive {

class AxisCore;

/// What an axis does about a motor that runs away: a quick stop; where that does not brake it, its
/// power is switched off; and a drive that does not do that, or whose fault reaction drives the
/// motor on, is reset.
class Runaway {
 public:
  explicit Runaway(AxisCore& axis);  ///< @param axis must outlive this; its other parts exist

  /// Once a cycle, in and out of operation.
  void watch(Time now) {
    if (now >= look_at_) look(now);
  }

 private:
  [[gnu::noinline]] void look(Time now);  // not in every cycle
  [[gnu::cold]] void lookAtStop(Time now);
  [[gnu::cold]] RunawayWatch::Led led(Time now);
  [[gnu::cold]] void stop(const RunawayWatch::Led& led, Time now);
  [[gnu::cold]] void letGo(Time now);
  [[gnu::cold]] void reset(Time now);

  AxisCore& axis_;
  Time look_at_{};  ///< when it looks again
  RunawayWatch watch_;
  double turned_at_ = kUnknown;   ///< velocity that it was led by at the last look; NaN: by none
  double limited_at_ = kUnknown;  ///< where a limit of the drive came to hold it, rad or m
  Time settled_{};                ///< the drive had not come to its goal then
  SetPointKind kind_ = SetPointKind::none;  ///< of the set-points that it has seen
  bool watches_stop_ = false;               ///< a quick stop, or a fault reaction, has begun
  bool let_go_ = false;                     ///< the power was to be off
  std::uint32_t zero_changes_ = 0;          ///< of the positions that it has seen
};

}  // namespace cia402::drive
