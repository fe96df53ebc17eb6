// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "motion/joint.h"
#include "motion/spline.h"

namespace cia402::motion {

/// The rates at which one segment of a path is passed. Along it knots are laid at equal distances
/// h; between them the square x of the rate is a straight line of slope 2 w, w being what the rate
/// changes by per second. At a place where a joint has the velocity p and the acceleration q on the
/// path its velocity is p sqrt(x), its acceleration q x + p w: linear in both unknowns, so that the
/// greatest x that leaves a way on is found from knot to knot, backwards, and then the fastest way
/// below that, forwards.
///
/// A segment that keeps the limits as it is has no knots until somebody comes in slower.
class TimeGrid {
 public:
  /// @param joints one segment a limit, which must outlive this, as the limits must
  TimeGrid(const SplineSegment* joints, const std::vector<JointLimits>& limits);

  /// It keeps the limits at the rate 1.
  bool fits() const { return fits_; }
  /// Backwards: the greatest squares from which the end is passed at `ceiling` or less.
  void lower(double ceiling);
  /// That at the beginning.
  double ceiling() const { return ceilings_.empty() ? 1.0 : ceilings_.front(); }
  /// Forwards from a square of at most that. @return the square at the end. @pre lower() was called
  double climb(double square);
  /// What exceeds the limits between the knots is held closer to them from the next lower() on.
  /// @param over by which more. @return whether anything did
  bool tighten(double over);

  struct Step {
    double lasts_s, along_s, rate, end_rate, change;
  };
  /// What climb() has found; a single one where it changes nothing.
  const std::vector<Step>& steps() const { return steps_; }

 private:
  /// What all joints permit the change of the rate to be, as lines over the square.
  struct Line {
    double offset, slope;
    double at(double square) const { return offset + slope * square; }
  };
  struct Room {
    Line lowest, highest;
    double at(double square) const { return highest.at(square) - lowest.at(square); }
  };

  /// A joint asks of a place in a step: the change within `reach` of what `slope` says.
  struct Demand {
    double slope, reach;
  };
  /// The most that joints have in a step, as shares of their limits.
  struct Excess {
    double velocity = 0.0, acceleration = 0.0;
  };
  static constexpr std::size_t kParts = 4;  ///< of a step, at whose ends is looked
  using Looks = std::array<double, kParts + 1>;

  static double peak(const Looks& values);
  void layKnots();
  void addDemands(std::size_t step);
  double cap(std::size_t knot) const;
  Room room(std::size_t step, double square) const;
  double greatest(std::size_t step) const;
  void hold(std::size_t step, double divisor);
  Excess excess(std::size_t step) const;
  const SplineRates& ratesAt(std::size_t step, std::size_t part, std::size_t joint) const {
    return rates_[(kParts * step + part) * limits_->size() + joint];
  }

  const SplineSegment* joints_;
  const std::vector<JointLimits>* limits_;
  double duration_s_;
  bool fits_ = true;
  std::size_t count_ = 0;           ///< of steps
  double width_s_ = 0.0;            ///< of a step, on the path
  bool held_ = false;               ///< something is tightened
  std::vector<SplineRates> rates_;  ///< of all joints, at the ends of all parts of the steps
  std::vector<Demand> demands_;     ///< as many a step
  std::vector<double> still_;       ///< the greatest square of a step that no change helps
  std::vector<double> ceilings_;    ///< of the squares, one a knot; none: as asked
  std::vector<double> most_;        ///< the same, as tighten() has found
  std::vector<double> tightened_;   ///< what the accelerations are divided by, one a step
  std::vector<Step> steps_;
};

}  // namespace cia402::motion
