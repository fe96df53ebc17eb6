// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/cyclic_position.h"
#include "drive/profile/position_loop.h"

namespace cia402::drive {

/// Positions, a new one each cycle, to which the host leads the drive by velocities (PositionLoop):
/// for drives that have no mode of operation for a stream of positions.
///
/// Such a drive does not stand at the last set-point: it turns on while the host is late, so that a
/// late cycle ends a motion.
class PositionByVelocity : public CyclicPosition {
 public:
  PositionByVelocity(const ModeChannel& channel, const Context& context);
  void place() override;
  bool neutralRaw(std::uint64_t& raw) const override;
  const char* handOver(std::uint64_t& raw, Time now) override;
  bool late(Time now) override;
  void rest() override;

 private:
  double velocity() const;
  double leading(double away) const;
  /// The loop that the configuration has by now.
  const PositionLoop& configured() const;
  void retune();

  PositionLoop loop_;
  PositionLoop wanted_;     ///< to which loop_ is led,
  double retuned_s_ = 0.0;  ///< in this time still
  Conversion velocity_;     ///< of the target
  double resolution_;       ///< of the position that is measured, rad or m
};

}  // namespace cia402::drive
