// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "drive/axis/follow_watch.h"

namespace cia402::drive::test {

using namespace std::chrono_literals;

inline constexpr Duration kCycle = 4ms;
inline constexpr double kStandstill = 0.01;  // rad/s
/// A drive may react so late, and a standstill is seen in whole windows.
inline constexpr Duration kSeen = 2 * kCycle + 2 * Standstill::kWindow + 2 * kCycle;

/// An axis of which the motor does what `motor` says, cycle by cycle.
struct WatchBench {
  SetPoint sent{motion::JointLimits{}, 5.0, kCycle};
  Standstill standstill{kStandstill, 1e-6};
  AxisState state;
  FollowWatch watch{kStandstill, kCycle};
  Time now{1s};
  bool has_bit = false, bit = false;
  bool heard = true;  ///< its feedback arrives
  bool held = false, warned = false;

  explicit WatchBench(SetPointKind kind = SetPointKind::stream) {
    sent.rest(kind, 0.0);
    state.position = 0.0;
    state.ready_for_motion = true;
    watch.begin(now);
    stand(100ms);
  }
  /// One cycle: the motor is at `motor`, `target` is given. @return whether it is called back.
  bool cycle(double motor, std::optional<double> target = {}) {
    now += kCycle;
    state.position = motor;
    if (heard) standstill.update(motor, now);
    if (target) sent.give(*target);
    sent.advance(now);
    return watch.watch({sent, standstill, state, has_bit, bit, held, warned, false}, now);
  }
  void stand(Duration duration) {
    for (const Time end = now + duration; now < end;) {
      ASSERT_FALSE(cycle(state.position, sent.value())) << "at rest";
    }
  }
  /// The targets run at 1 rad/s while the motor stands. @return after how long they are called
  /// back.
  std::optional<Duration> runAhead(Duration longest = 1s) {
    const Time began = now;
    while (now - began < longest) {
      if (cycle(state.position, sent.value() + 0.004)) return now - began;
    }
    return std::nullopt;
  }
};

}  // namespace cia402::drive::test
