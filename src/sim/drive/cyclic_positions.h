// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "sim/drive/moving_axis.h"

namespace cia402::sim {

/// The modes that go along a line from one set-point to the next (CiA 402-2): cyclic synchronous
/// position, and interpolated position, which does so while controlword bit 4 is set.
class CyclicPositions {
 public:
  explicit CyclicPositions(MovingAxis& axis) : axis_(axis) {}

  bool ofThisMode() const;
  /// A set-point becomes valid: it is reached `seconds` from now, which is `into` seconds after the
  /// last step.
  void target(double seconds, double into);
  /// What came and has not begun yet is forgotten.
  void forget() {
    pending_.reset();
    last_.reset();
    led_.reset();
  }
  /// Whether one was too far away since it was asked last (DriveDefinition::position_step).
  bool takeStep() { return std::exchange(far_, false); }
  /// One kDriveStep along the line. @param bit_4 of the controlword
  void step(bool bit_4);
  /// The set-points are followed (statusword bit 12). @param bit_4 of the controlword
  bool follows(bool bit_4) const;
  /// It stands where the last set-point was, within the window of 6067h (bit 10 of ip).
  bool reached() const;

 private:
  Role targetRole() const;
  void stopAtSwitch(double moved);
  bool goesOn() const;

  MovingAxis& axis_;
  std::optional<double> pending_;  ///< true turns; ModeDefinition::delayed
  std::optional<double> last_;     ///< true turns, the set-point that came last
  std::optional<double> led_;      ///< true turns, the set-point that the line leads to
  double resolution_ = 0.0;        ///< of its object, turns
  bool far_ = false;
};

}  // namespace cia402::sim
