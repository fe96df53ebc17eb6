// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/time_law.h"

#include <algorithm>
#include <cmath>

#include "motion/time_grid.h"

namespace cia402::motion {
namespace {

constexpr int kMostRounds = 12;
/// By which more than it was exceeded a limit is kept the next time, so that few rounds do.
constexpr double kSure = 1.0 + 1e-3;

/// The grids of a path, one a segment, which are made where something has to be slowed down.
class SlowedPath {
 public:
  explicit SlowedPath(const TimedPath& path) : path_(path) {
    const std::size_t joints = path.limits.size();
    for (std::size_t at = 0; at + joints <= path.segments.size(); at += joints) {
      grids_.emplace_back(&path.segments[at], path.limits);
    }
  }

  /// @return whether all is within the limits as asked
  bool fits() const {
    return !standsAtBegin() && !standsAtEnd() &&
           std::all_of(grids_.begin(), grids_.end(),
                       [](const TimeGrid& grid) { return grid.fits(); });
  }
  /// Lays rates that keep the limits at the knots. @return false: it cannot begin in motion
  bool slowDown() {
    double ceiling = standsAtEnd() ? 0.0 : 1.0;
    for (auto grid = grids_.rbegin(); grid != grids_.rend(); ++grid) {
      grid->lower(ceiling);
      ceiling = grid->ceiling();
    }
    if (!path_.from_rest && ceiling < 1.0) return false;
    double square = path_.from_rest && standsAtBegin() ? 0.0 : ceiling;
    for (TimeGrid& grid : grids_) square = grid.climb(square);
    return true;
  }
  /// Holds what exceeds between the knots closer to the limits. @return whether anything did
  bool tighten() {
    bool any = false;
    for (TimeGrid& grid : grids_) any = grid.tighten(kSure) || any;
    return any;
  }
  const std::vector<TimeGrid>& grids() const { return grids_; }

 private:
  bool jumps(std::size_t first, double time_s) const {
    for (std::size_t j = 0; j < path_.limits.size(); ++j) {
      const MotionState state = path_.segments[first + j].sample(time_s);
      if (path_.limits[j].acceleration && std::abs(state.velocity) > kStandstill) return true;
    }
    return false;
  }
  bool standsAtBegin() const { return path_.from_rest && jumps(0, 0.0); }
  bool standsAtEnd() const {
    const std::size_t last = path_.segments.size() - path_.limits.size();
    return jumps(last, path_.segments[last].duration());
  }

  static constexpr double kStandstill = 1e-6;  ///< rad/s or m/s
  const TimedPath& path_;
  std::vector<TimeGrid> grids_;
};

}  // namespace

std::optional<TimeLaw> TimeLaw::of(const TimedPath& path) {
  TimeLaw law;
  if (path.segments.empty()) return law;
  SlowedPath slowed(path);
  if (slowed.fits()) return law;
  for (int round = 0;; ++round) {
    if (!slowed.slowDown()) return std::nullopt;
    if (!slowed.tighten() || round == kMostRounds) break;
  }
  double time_s = 0.0, along_s = 0.0;
  for (const TimeGrid& grid : slowed.grids()) {
    for (const TimeGrid::Step& step : grid.steps()) {
      law.steps_.push_back({time_s, along_s, step.rate, step.change});
      time_s += step.lasts_s;
      along_s += step.along_s;
    }
  }
  law.steps_.push_back({time_s, along_s, slowed.grids().back().steps().back().end_rate, 0.0});
  law.delay_s_ = std::max(0.0, time_s - along_s);
  return law;
}

TimeLaw::Moment TimeLaw::at(double time_s) const {
  if (steps_.empty()) return {time_s, 1.0, 0.0};
  const auto after =
      std::upper_bound(steps_.begin(), steps_.end(), time_s,
                       [](double time, const Step& step) { return time < step.time_s; });
  if (after == steps_.begin()) return {0.0, steps_.front().rate, steps_.front().change};
  const Step& step = *(after - 1);
  if (after == steps_.end()) return {step.along_s, step.rate, 0.0};
  const double since_s = time_s - step.time_s;
  const double along_s = step.along_s + since_s * (step.rate + 0.5 * step.change * since_s);
  return {std::min(along_s, after->along_s), step.rate + step.change * since_s, step.change};
}

}  // namespace cia402::motion
