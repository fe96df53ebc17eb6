// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/enable.h"
#include "drive/procedures/steps/mode.h"

namespace cia402::drive {

/// What an axis with power waits for before it gets another mode: it stands, no target leads it
/// away from there, and the drive's own position limits, beyond which an effort, a load or a homing
/// may have taken it, are open there.
class ReadyToSwitchStep {
 public:
  Outcome advance(const Context& context);

 private:
  bool begun_ = false, standing_ = false, withdrawn_ = false, ready_ = false;
  Time started_{};
};

/// Brings an axis into another mode, enabled or not. Where the drive does not stand that change
/// while its power stage is on (profile, `mode_change`), an enabled axis is disabled and enabled
/// again, or goes through the mode that the profile names. To be used at standstill.
class SwitchStep {
 public:
  SwitchStep(const ModeChannel& mode, const DriveProfile& profile)
      : channel_(&mode), mode_(mode), enabling_(mode, profile) {}
  Outcome advance(const Context& context);
  /// The power stage was off for the switch.
  bool wasDisabled() const { return was_disabled_; }

 private:
  enum class Phase { begin, disabling, enabling, detour, switching };
  Outcome begin(const Context& context);
  Outcome awaitDisabled(const Context& context);

  const ModeChannel* channel_;
  ModeStep mode_;
  std::optional<ModeStep> between_;  ///< into the mode on the way
  EnableStep enabling_;
  Phase phase_ = Phase::begin;
  bool was_disabled_ = false;
  Time since_{};
};

}  // namespace cia402::drive
