// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/mode_control.h"
#include "drive/modes/set_point_handshake.h"

namespace cia402::drive {

/// What modes of positions have in common: limits, zero, and where the axis is as neutral target.
class PositionControl : public ModeControl {
 public:
  using ModeControl::ModeControl;
  void place() override;
  /// An axis that stands outside its limits may come back, not go further out.
  bool accepts(double value) const override;
  double neutral() const override { return state().position; }
  bool neutralRaw(std::uint64_t& raw) const override;
  Duration wayBack(double away) const override;

 protected:
  /// A drive that has passed the place where it is to stop goes back to it, and where it turns it
  /// seems to stand. One that stands for longer than it takes to be seen to move again is held
  /// there.
  bool comesBack(Time now, Time seen_moving) const;
  /// What a handshake is to know of this cycle.
  SetPointHandshake::Input handshakeInput() const;
  /// Has the target leave with this cycle where the handshake insists on it.
  void insist(const SetPointHandshake& handshake) const;
};

}  // namespace cia402::drive
