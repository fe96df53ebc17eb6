// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "campaign/stage.h"

namespace cia402::campaign {

/// Until when each axis may move, and why: made from what was commanded and answered, and from
/// what became of motor, host and bus. Knows nothing of what the driver thinks.
class Permits {
 public:
  /// Who can move an axis; each for itself.
  enum class Source { stream, target, trajectory, homing };

  /// `stage` must outlive it.
  explicit Permits(const Stage& stage);

  /// The axis may move until then, or longer if it may already. A `target` is used up as soon as
  /// the axis stands for a while: a position that was reached is no reason to move again.
  void allow(std::size_t axis, Source source, Time until);
  /// It may move no longer than that by `source`, or by any.
  void cut(std::size_t axis, Source source, Time until);
  void cut(std::size_t axis, Time until);
  /// What still permits it to move does until then, or longer.
  void prolong(std::size_t axis, Source source, Time until);
  /// All that was commanded before `called` is void from now on; a homing that was called later
  /// goes on.
  void end(std::size_t axis, Time called, Time now);
  /// Everything that is under way lasts so much longer: the host stood still.
  void delay(Duration duration, Time now);
  /// Everything that is under way may take so much longer, also what begins before `until`.
  void stretch(std::size_t axis, Duration duration, Time until);
  /// All that is under way by `source` lasts so much longer.
  void delay(Source source, Duration duration, Time now);
  /// Something keeps it from moving until then: that it stands says nothing about its target.
  void hinder(std::size_t axis, Time until);
  /// To be called with each look at the motors.
  void watch(const std::vector<AxisTruth>& truths, Time now);

  /// When something was commanded last that may move the axis.
  Time given(std::size_t axis) const;
  Time given(std::size_t axis, Source source) const {
    return axes_[axis].given[static_cast<std::size_t>(source)];
  }
  Time until(std::size_t axis) const;
  Time until(std::size_t axis, Source source) const {
    return axes_[axis].until[static_cast<std::size_t>(source)];
  }
  bool allowed(std::size_t axis, Time now) const { return now <= until(axis); }

 private:
  struct Axis {
    std::array<Time, 4> until{}, given{};
    Time moved{}, homing_called{};
    Duration stretched{};
    Time stretched_until{};
    bool power = false, faulted = false;
  };
  Time& at(std::size_t axis, Source source) {
    return axes_[axis].until[static_cast<std::size_t>(source)];
  }
  void watch(Axis& axis, const AxisFacts& facts, const AxisTruth& truth, Time now);

  const Stage& stage_;
  std::vector<Axis> axes_;
};

}  // namespace cia402::campaign
