// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "sim/drive/jerk_filter.h"
#include "sim/drive/moving_axis.h"

namespace cia402::sim {

/// Profile position mode (CiA 402-2): a set-point at work, those that wait, and the handshake by
/// which they come. Without handshake (ModeDefinition) 607Ah counts as it stands.
class ProfilePosition {
 public:
  explicit ProfilePosition(MovingAxis& axis) : axis_(axis) {}

  /// A mode begins: whatever was commanded before is void. In this mode the axis comes to rest at
  /// the nearest place.
  void begin();
  /// A controlword in this mode. @return true if it brought a set-point.
  bool control(std::uint16_t controlword, std::uint16_t previous);
  void step();  ///< one kDriveStep
  /// Something stops the motor: the set-points that wait may be lost by that.
  void stopped();

  /// Statusword bit 12.
  bool acknowledged() const { return acknowledged_; }
  /// Whether a set-point waits for the end of another.
  bool waits() const { return !waiting_.empty(); }
  /// Of the set-point at work, true turns.
  double target() const { return active_.target; }

 private:
  struct SetPoint {
    double target = 0.0;
    ProfileLimits limits;
    std::optional<double> commanded;  ///< as it came, in the drive's own turns
  };
  void accept(std::uint16_t controlword);
  double base() const;
  bool full() const;
  void follow();
  void beginNext();
  bool ofThisMode() const;

  MovingAxis& axis_;
  SetPoint active_;
  std::deque<SetPoint> waiting_;
  JerkFilter smooth_;
  bool acknowledged_ = false;
  bool bit_ = false;  ///< the one that brings set-points
};

}  // namespace cia402::sim
