// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"
#include "cia402_driver/motion/joint.h"

namespace cia402::motion {

/// How a joint is brought to rest.
struct StopLimits {
  double deceleration = 0;     ///< rad/s² or m/s², > 0
  std::optional<double> jerk;  ///< rad/s³ or m/s³, > 0; absent: the deceleration sets in at once
  /// Where the ramp must not end beyond. One that would is made steeper, without jerk limit, as far
  /// as `hardest` allows. A joint that already stands beyond is just stopped.
  std::optional<double> lower, upper;
  std::optional<double> hardest;  ///< rad/s² or m/s²; absent: never steeper than `deceleration`
};

/// The configured stop of a joint: its position limits are kept, its acceleration limit is the
/// hardest deceleration. @return why `deceleration` or `jerk` cannot be used, naming the joint.
Result<StopLimits> stopLimits(const Joint& joint, double deceleration,
                              std::optional<double> jerk = std::nullopt);

/// Brings one moving joint to rest in the shortest time that its deceleration (and jerk) allow:
/// constant deceleration, or, with a jerk limit, up to three phases of constant jerk that take the
/// present acceleration along. A value; nothing here allocates.
class StopRamp {
 public:
  /// At rest at position 0 since ever.
  StopRamp() = default;
  /// From the present commanded state at `start`. A stop must never fail: with a deceleration that
  /// is not above 0, or a state that is not finite, the joint is held at its position at once.
  StopRamp(const MotionState& state, const StopLimits& limits, Time start);

  /// Before the start as at the start; after the end at rest at stopPosition().
  MotionState sample(Time time) const;
  bool finished(Time time) const { return time >= endTime(); }
  Time endTime() const { return end_; }
  /// Seconds until at rest.
  double duration() const { return duration_s_; }
  /// Where it comes to rest. With a jerk limit, a joint that was about to turn round may pass a
  /// little beyond on the way.
  double stopPosition() const { return stop_position_; }

 private:
  struct Phase {
    double duration_s = 0, jerk = 0;
    MotionState begin;
  };

  void plan(const MotionState& state, double deceleration);
  void planWithJerk(const MotionState& state, double deceleration, double jerk);
  void append(const MotionState& begin, double duration_s, double jerk);
  void keepWithin(const MotionState& state, const StopLimits& limits);

  std::array<Phase, 3> phases_{};
  std::size_t count_ = 0;
  Time start_{}, end_{};
  double duration_s_ = 0, stop_position_ = 0;
};

/// Stops several joints at once, each by its own ramp (the path is left; the machine is at rest as
/// early as each joint can be). Allocates only when built.
class GroupStop {
 public:
  /// One entry a joint.
  explicit GroupStop(std::vector<StopLimits> limits);

  /// Begins from the present commanded states, one a joint; missing ones count as at rest at 0.
  void start(const std::vector<MotionState>& states, Time time);
  /// Writes the states of the joints, as many as `states` has room for; never resizes it.
  void sample(Time time, std::vector<MotionState>& states) const;
  /// When the last joint is at rest.
  Time endTime() const;
  bool finished(Time time) const { return time >= endTime(); }

 private:
  std::vector<StopLimits> limits_;
  std::vector<StopRamp> ramps_;
};

}  // namespace cia402::motion
