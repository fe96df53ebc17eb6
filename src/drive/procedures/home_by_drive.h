// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "drive/procedures/homing_status.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/homing_speed.h"
#include "drive/procedures/steps/settings.h"
#include "drive/procedures/steps/switch.h"

namespace cia402::drive {

/// Homing by the drive (CiA 402-2, homing mode): parameters, mode, enabled, edge of bit 4, result
/// from bits 10, 12 and 13, mode from before. Where the home point lies in joint coordinates:
///
/// The profile writes 607Ch from `homing.offset`, that is the device value of the joint position
/// `homing.offset` under the configured `position_offset`; the drive then sets 6064h = 607Ch at
/// home, so the joint reads `homing.offset` there and device zero stays at `position_offset`. Where
/// the profile does not write 607Ch, or the drive does not take it, it is read (0 if there is none)
/// and the joint's zero is shifted in software by what is missing.
class DriveHoming : public Procedure {
 public:
  /// @param homing the profile's homing mode, @param method that is configured; its number is known
  DriveHoming(AxisCore& axis, const ModeChannel& homing, const HomingMethod& method);
  Outcome advance(const Context& context) override;
  bool cancel(const std::string& reason, const Context& context) override;

 private:
  enum class Phase {
    begin,  ///< what must hold before (SettingsStep)
    writing,
    entering,  ///< homing mode, enabled
    offsetting,
    clearing,   ///< bits of an earlier homing
    searching,  ///< bit 4 is high
    reading_offset,
    settling,   ///< new position on the wire
    limiting,   ///< position limits around the new zero
    stopping,   ///< after failure or cancellation
    restoring,  ///< mode from before
  };

  void enter(Phase phase, const Context& context);
  void begin(const Context& context);
  Outcome enterHoming(const Context& context);
  Outcome writeOffset(const Context& context);
  Outcome clearOldResult(const Context& context);
  void start(const Context& context);
  Outcome search(const Context& context);
  Outcome timeOut(const Context& context);
  void succeed(const Context& context);
  Outcome readOffset(const Context& context);
  void adopt(const Context& context, double home_in_drive);
  Outcome settle(const Context& context);
  Outcome limit(const Context& context);
  Outcome failHomed(const Context& context, const std::string& why);
  void giveUp(const Context& context, std::string why);
  Outcome stop(const Context& context);
  void restore(const Context& context);
  Outcome finishRestoring(const Context& context);

  HomingStatus status(const Context& context) const;
  bool attained(const Context& context) const;
  bool statuswordIsFresh(const Context& context) const;
  bool writesOffset(const AxisCore& axis) const;
  std::string method(const AxisCore& axis) const;

  const ModeChannel* homing_;
  const ModeChannel* before_;
  SettingsStep settings_;
  WriteStep writes_;
  WriteStep offset_;  ///< 607Ch: before an axis is enabled, else in homing mode
  HomingSpeedStep speeds_;
  SwitchStep mode_;
  EnableStep enabling_;
  std::optional<SwitchStep> restoring_;
  std::optional<Outcome> restored_;  ///< what came of that
  fieldbus::Ticket read_;            ///< of 607Ch

  Phase phase_ = Phase::begin;
  HomingMethod method_;  ///< that is configured
  bool entered_by_mode_ = false;
  bool old_result_ = false;   ///< the drive shows "attained" before the start
  bool was_running_ = false;  ///< it showed "in progress" after the start
  std::string failure_;       ///< set: this homing will fail
  std::uint64_t frames_ = 0;
  Time since_{}, started_{}, interrupted_since_{}, end_{};
  Time released_ = kNever;  ///< of a search that was stopped: its halt
};

}  // namespace cia402::drive
