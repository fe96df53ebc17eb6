// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/mode_control.h"

namespace cia402::drive {

/// Torques or forces, by cyclic synchronous or profile mode (CiA 402-2): the drive pushes on with
/// the last one.
class TorqueControl : public ModeControl {
 public:
  using ModeControl::ModeControl;
  bool accepts(double value) const override;
  /// It would come to rest beyond the limit if it were not braked from now on, whatever the effort
  /// is: what its load makes of that nobody knows.
  bool stopsAtLimit() const override;
  /// Where the driver does not brake (`command_timeout_action: coast`), who commands efforts may.
  bool maySlow(double value) const override;
  /// An effort makes a motor without load ever faster, and not every drive has a limit of speed for
  /// its torque modes: from nine tenths of the limit on it gets less, at the limit it is 0.
  double guarded(double value) const override;
  /// A stream that dries up is given up.
  std::optional<double> follow(Stream& stream, Time now) override;
};

}  // namespace cia402::drive
