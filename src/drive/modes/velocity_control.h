// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/mode_control.h"
#include "motion/setpoint_limiter.h"

namespace cia402::drive {

/// Velocities, by cyclic synchronous, profile or velocity mode (CiA 402-2): the drive turns on with
/// the last one.
class VelocityControl : public ModeControl {
 public:
  VelocityControl(const ModeChannel& channel, const Context& context);
  bool accepts(double value) const override;
  void beginStream(const Stream& stream, Time at) override;
  void takeCommand(Stream& stream) override;
  /// A stream that dries up is ramped to rest.
  std::optional<double> follow(Stream& stream, Time now) override;

 private:
  motion::VelocityLimiter limiter_;
};

}  // namespace cia402::drive
