// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/position_control.h"
#include "motion/setpoint_limiter.h"

namespace cia402::drive {

/// Positions, a new one each cycle (cyclic synchronous and interpolated position mode, CiA 402-2):
/// the drive stands at the last one.
class CyclicPosition : public PositionControl {
 public:
  CyclicPosition(const ModeChannel& channel, const Context& context);
  void beginStream(const Stream& stream, Time at) override;
  void takeCommand(Stream& stream) override;
  std::optional<double> follow(Stream& stream, Time now) override;

 private:
  motion::PositionLimiter limiter_;
};

}  // namespace cia402::drive
