// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/mode.h"
#include "drive/procedures/steps/mode_shown.h"
#include "drive/procedures/steps/settings.h"

namespace cia402::drive {

/// Brings a disabled axis into operation in a mode: fresh feedback, the drive's settings compared
/// with what the profile expects, standstill, before_enable
/// writes, position limits (PositionLimits), mode and neutral target on the wire, then each
/// transition awaited, then the mode where the drive shows it only now, then the brake.
class EnableStep {
 public:
  EnableStep(const ModeChannel& mode, const DriveProfile& profile)
      : channel_(&mode),
        settings_(profile, SettingCheck::Before::enabling),
        writes_(profile.before_enable),
        mode_(mode),
        shown_(mode) {}
  Outcome advance(const Context& context);
  bool begun() const { return begun_; }

 private:
  enum class Phase {
    settings,
    feedback,
    standing,
    writing,
    limits,
    mode,
    transitions,
    shown,
    brake
  };
  void enter(Phase phase, const Context& context);
  Outcome awaitFeedback(const Context& context);
  bool resumes(const AxisCore& axis) const;
  Outcome awaitRest(const Context& context);
  Outcome awaitLimits(const Context& context);
  Outcome awaitMode(const Context& context);
  Outcome climb(const Context& context);
  Outcome awaitShown(const Context& context);
  Outcome awaitBrake(const Context& context);
  Outcome fail(const Context& context, std::string why);
  Outcome explain(const Context& context);

  const ModeChannel* channel_;
  SettingsStep settings_;
  WriteStep writes_;
  ModeStep mode_;
  ModeShownStep shown_;
  Phase phase_ = Phase::settings;
  bool begun_ = false;
  State last_ = State::unknown;
  std::string why_;  ///< it fails, and what the drive says to that:
  fieldbus::Ticket reason_;
  Time since_{};
};

}  // namespace cia402::drive
