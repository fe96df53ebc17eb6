// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/time_grid.h"

#include <algorithm>
#include <cmath>

namespace cia402::motion {
namespace {

constexpr double kWidth = 0.01;  // s, about, of a step once it is slowed down
constexpr std::size_t kFewest = 8, kMost = 80;
constexpr double kFull = 1.0 - 1e-12;     // a square from which on it is 1
constexpr double kRounding = 1.0 + 1e-6;  // as that of trajectories
constexpr double kExcess = 1.0 + 1.1e-6;
constexpr double kAim =
    1.0 - 3e-4;                     // of the limits where it is slowed down: room between the knots
constexpr double kTightest = 1.05;  // from here on the square itself is held down, too

std::size_t stepsOf(double duration_s) {
  const double wanted = std::ceil(std::min(duration_s / kWidth, static_cast<double>(kMost)));
  return std::clamp(static_cast<std::size_t>(wanted), kFewest, kMost);
}

double full(double square) { return square >= kFull ? 1.0 : square; }

/// Velocity and acceleration alone, as positions ask for no rate.
JointLimits ratesOf(const JointLimits& limits) {
  JointLimits rates;
  rates.velocity = limits.velocity;
  rates.acceleration = limits.acceleration;
  return rates;
}

/// By what its time would have to be multiplied for a segment to keep the limits.
double stretch(const SplineSegment& segment, const JointLimits& limits) {
  if (segment.surelyWithin(ratesOf(limits))) return 1.0;
  double factor = 1.0;
  if (limits.velocity) {
    factor = std::abs(segment.velocityRange().largest().value) / *limits.velocity;
  }
  if (limits.acceleration) {
    const double most = std::abs(segment.accelerationRange().largest().value);
    const double share = most / *limits.acceleration;
    factor = std::max(factor, share > kRounding ? std::sqrt(share) : share);
  }
  return factor;
}

}  // namespace

TimeGrid::TimeGrid(const SplineSegment* joints, const std::vector<JointLimits>& limits)
    : joints_(joints), limits_(&limits), duration_s_(joints->duration()) {
  double factor = 1.0;
  for (std::size_t j = 0; j < limits.size(); ++j) {
    factor = std::max(factor, stretch(joints[j], limits[j]));
  }
  fits_ = factor <= kRounding;
  count_ = stepsOf(duration_s_ * factor);
  width_s_ = duration_s_ / static_cast<double>(count_);
}

void TimeGrid::layKnots() {
  if (!ceilings_.empty()) return;
  const std::size_t steps = count_;
  ceilings_.assign(steps + 1, 1.0);
  if (!rates_.empty()) return;
  rates_.reserve((kParts * steps + 1) * limits_->size());
  for (std::size_t i = 0; i <= kParts * steps; ++i) {
    const double time_s = static_cast<double>(i) * width_s_ / static_cast<double>(kParts);
    for (std::size_t j = 0; j < limits_->size(); ++j) rates_.push_back(joints_[j].rates(time_s));
  }
  demands_.reserve(3 * steps * limits_->size());
  for (std::size_t step = 0; step < steps; ++step) addDemands(step);
  most_.assign(steps + 1, 1.0);
  tightened_.assign(steps, 1.0);
}

/// At both ends of a step and in its middle.
void TimeGrid::addDemands(std::size_t step) {
  double still = 1.0;
  for (std::size_t j = 0; j < limits_->size(); ++j) {
    if (!(*limits_)[j].acceleration) continue;
    const double limit = *(*limits_)[j].acceleration * (fits_ ? kRounding : kAim);
    for (std::size_t place = 0; place < 3; ++place) {
      const SplineRates& rates = ratesAt(step, place * kParts / 2, j);
      const double reach = width_s_ * rates.acceleration;
      const double per_change = rates.velocity + static_cast<double>(place) * reach;
      const double beside = std::abs(rates.velocity) + 2.0 * std::abs(reach);
      if (std::abs(per_change) > 1e-9 * beside) {
        demands_.push_back({-rates.acceleration / per_change, limit / std::abs(per_change)});
      } else {
        demands_.push_back({0.0, 1e300});
        still = std::min(still, limit / std::max(std::abs(rates.acceleration), 1e-300));
      }
    }
  }
  still_.push_back(still);
}

/// By the velocities alone.
double TimeGrid::cap(std::size_t knot) const {
  double square = most_[knot];
  for (std::size_t j = 0; j < limits_->size(); ++j) {
    const std::optional<double>& limit = (*limits_)[j].velocity;
    const double velocity = std::abs(ratesAt(knot, 0, j).velocity);
    if (!limit || velocity <= *limit * kRounding) continue;
    const double rate = *limit / velocity;
    square = std::min(square, rate * rate);
  }
  return square;
}

/// The lines that count at this square: of the joints, and the ceiling.
TimeGrid::Room TimeGrid::room(std::size_t step, double square) const {
  const double falls = -0.5 / width_s_, share = 1.0 / tightened_[step];
  Room room{{0.0, falls}, {-falls * ceilings_[step + 1], falls}};
  double lowest = room.lowest.at(square), highest = room.highest.at(square);
  const std::size_t count = demands_.size() / still_.size();
  for (std::size_t i = step * count; i < (step + 1) * count; ++i) {
    const double middle = demands_[i].slope * square, reach = demands_[i].reach * share;
    if (middle - reach > lowest) {
      lowest = middle - reach;
      room.lowest = {-reach, demands_[i].slope};
    }
    if (middle + reach < highest) {
      highest = middle + reach;
      room.highest = {reach, demands_[i].slope};
    }
  }
  return room;
}

/// The room is what a concave function of the square says, above 0 at 0: from beyond its zero
/// Newton's steps come down to that without ever passing it.
double TimeGrid::greatest(std::size_t step) const {
  double square = std::min(cap(step), still_[step] / tightened_[step]);
  for (int i = 0; i < 50; ++i) {
    const Room here = room(step, square);
    const double left = here.at(square);
    const double size = std::abs(here.highest.at(square)) + std::abs(here.lowest.at(square));
    if (left >= -1e-12 * size) return full(square);
    const double falls = here.highest.slope - here.lowest.slope;
    if (!(falls < 0.0)) return 0.0;
    square = std::max(0.0, square - left / falls);
  }
  return full(square);
}

void TimeGrid::lower(double ceiling) {
  if (fits_ && !held_ && ceiling >= kFull) {
    ceilings_.clear();
    return;
  }
  layKnots();
  ceilings_.back() = std::min(ceiling, cap(ceilings_.size() - 1));
  for (std::size_t i = ceilings_.size() - 1; i-- > 0;) ceilings_[i] = greatest(i);
}

double TimeGrid::climb(double square) {
  steps_.clear();
  if (ceilings_.empty() && square >= kFull) {
    steps_.push_back({duration_s_, duration_s_, 1.0, 1.0, 0.0});
    return 1.0;
  }
  layKnots();
  square = std::min(square, ceilings_.front());
  for (std::size_t i = 0; i + 1 < ceilings_.size(); ++i) {
    const Room here = room(i, square);
    const double change = std::max(here.lowest.at(square), here.highest.at(square));
    const double wanted = square + 2.0 * width_s_ * std::min(change, here.highest.at(square));
    const double next = full(std::clamp(wanted, 0.0, ceilings_[i + 1]));
    const double rate = std::sqrt(square), end_rate = std::sqrt(next);
    const double lasts_s = 2.0 * width_s_ / std::max(rate + end_rate, 1e-150);
    steps_.push_back({lasts_s, width_s_, rate, end_rate, (end_rate - rate) / lasts_s});
    square = next;
  }
  return square;
}

/// The largest magnitude that a curve through these values has, by the parabolas through each
/// three.
double TimeGrid::peak(const Looks& values) {
  double most = std::max(std::abs(values.front()), std::abs(values.back()));
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double middle = values[i], slope = 0.5 * (values[i + 1] - values[i - 1]);
    const double bend = values[i + 1] - 2.0 * middle + values[i - 1];
    most = std::max(most, std::abs(middle));
    if (std::abs(slope) < std::abs(bend)) {
      most = std::max(most, std::abs(middle - 0.5 * slope * slope / bend));
    }
  }
  return most;
}

TimeGrid::Excess TimeGrid::excess(std::size_t step) const {
  const Step& given = steps_[step];
  const double from = given.rate * given.rate, to = given.end_rate * given.end_rate;
  Looks squares, rates, velocities, accelerations;
  for (std::size_t i = 0; i <= kParts; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kParts);
    squares[i] = from + share * (to - from);
    rates[i] = std::sqrt(squares[i]);
  }
  Excess most;
  for (std::size_t j = 0; j < limits_->size(); ++j) {
    const JointLimits& limits = (*limits_)[j];
    for (std::size_t i = 0; i <= kParts; ++i) {
      const SplineRates& path = ratesAt(step, i, j);
      velocities[i] = path.velocity * rates[i];
      accelerations[i] = path.acceleration * squares[i] + path.velocity * given.change;
    }
    if (limits.velocity) {
      most.velocity = std::max(most.velocity, peak(velocities) / *limits.velocity);
    }
    if (limits.acceleration) {
      most.acceleration = std::max(most.acceleration, peak(accelerations) / *limits.acceleration);
    }
  }
  return most;
}

/// A step is passed with lower squares.
void TimeGrid::hold(std::size_t step, double divisor) {
  const double begin = steps_[step].rate, end = steps_[step].end_rate;
  most_[step] = std::min(most_[step], begin * begin / divisor);
  most_[step + 1] = std::min(most_[step + 1], end * end / divisor);
}

bool TimeGrid::tighten(double over) {
  bool any = false;
  for (std::size_t i = 0; i < steps_.size() && !ceilings_.empty(); ++i) {
    const Excess most = excess(i);
    if (most.velocity > kExcess) hold(i, most.velocity * most.velocity * over);
    if (most.acceleration > kExcess) {
      if (tightened_[i] > kTightest) hold(i, most.acceleration * over);
      tightened_[i] *= most.acceleration * over;
    }
    any = any || most.velocity > kExcess || most.acceleration > kExcess;
  }
  held_ = held_ || any;
  return any;
}

}  // namespace cia402::motion
