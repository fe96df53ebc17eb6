// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/definition/drive_definition.h"
#include "sim/drive/homing_switches.h"
#include "sim/drive/trajectory_profile.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// Where an object that would limit something does not exist, in any unit.
inline constexpr double kUnlimited = 1e9;

/// What objects, switches and motor of one axis allow, and whether that was in the way
/// (statusword bit 11). Speeds in turns/s, accelerations in turns/s^2.
class MotionLimits {
 public:
  /// @param most_deceleration that the motor can give.
  MotionLimits(const DriveDefinition& definition, const DriveValues& values,
               const AxisSwitches& switches, double most_deceleration)
      : definition_(definition),
        values_(values),
        switches_(switches),
        most_deceleration_(most_deceleration) {}

  /// Of a ramp in a mode; nullptr: in none.
  double deceleration(Ramp ramp, const ModeDefinition* mode) const;
  /// More no change of a speed has.
  double clamp() const { return values_.get(Role::acceleration_clamp, kUnlimited); }
  /// So long the corners of a profile take, s; 0: it has them.
  double cornerTime(const ProfileLimits& limits) const;
  /// Of the motor (6080h).
  double maxSpeed() const;
  /// Of profiles in a mode; nullptr: in none.
  ProfileLimits profile(const ModeDefinition* mode) const;

  /// From the lowest to the highest position, turns.
  struct Span {
    double low, high;
  };
  /// 607Dh in the drive's own turns; none where it limits nothing: both equal, or at their widest.
  std::optional<Span> positions() const;
  /// 607Ch lies outside 607Dh, whether that counts or not.
  bool offsetOutside() const;
  /// A target in the drive's own turns, within 607Dh.
  double clamped(double turns);
  /// The speed that still comes to rest at 607Dh with the deceleration `braking`. `turns` is where
  /// the axis stands, in the drive's own turns.
  double braked(double velocity, double turns, double braking);
  /// Whether a limit switch forbids to go on in this direction; `position` in true turns.
  bool blocked(double direction, double position);

  /// The drive has found its home by itself, or has lost it.
  void setHomed(bool homed) { homed_ = homed; }
  bool homed() const { return homed_; }
  /// A limit was in the way (statusword bit 11).
  bool active() const { return active_; }
  /// A switch was in the way in this step.
  bool switchHit() const { return switch_hit_; }
  /// The name of the fault or warning that a switch is, as the drive is set.
  const char* switchFault() const {
    return values_.raw(Role::limit_switch_action, 0) == 1 ? "limit_warning" : "limit_switch";
  }
  /// 607Dh is in the way of a target.
  bool positionHit() const { return position_hit_; }
  /// What was in the way last lies upwards.
  bool upwards() const { return upwards_; }
  /// What was in the way, is so no more.
  void release() { active_ = position_hit_ = false; }
  /// The next step finds out anew whether a switch is in the way.
  void releaseSwitch() { switch_hit_ = false; }

 private:
  double velocityModeRamp(Role speed, Role time) const;
  double rampOf(Ramp ramp, const ModeDefinition* mode) const;
  bool positionsCount() const;
  Span software() const;

  const DriveDefinition& definition_;
  const DriveValues& values_;
  const AxisSwitches& switches_;
  double most_deceleration_;
  bool homed_ = false;
  bool active_ = false;
  bool switch_hit_ = false;
  bool position_hit_ = false;
  bool upwards_ = false;
};

}  // namespace cia402::sim
