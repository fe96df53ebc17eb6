// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drive/axis/fault_watch.h"
#include "drive/axis/generator.h"
#include "drive/axis/limit_keeper.h"
#include "drive/axis/stops.h"

namespace cia402::drive {

/// Sent so often with a value, or a level of a bit, the drive has it.
inline constexpr std::uint64_t kSureFrames = 2;

/// The axis without its procedures: its parts, the cycle that ties them together, and the reactions
/// that must not wait for anybody. Procedures tell it where to go and watch it.
class AxisCore {
 public:
  AxisCore(AxisConfig config, fieldbus::Device& device);
  AxisCore(const AxisCore&) = delete;
  AxisCore& operator=(const AxisCore&) = delete;

  AxisBasis& basis() { return axis_; }
  const AxisConfig& config() const { return axis_.config; }
  const DriveProfile& profile() const { return axis_.profile(); }
  const AxisObjects& objects() const { return axis_.objects; }
  fieldbus::Device& device() const { return axis_.device; }
  const AxisState& state() const { return axis_.state; }
  bool deviceReady() const { return axis_.deviceReady(); }
  bool powerOff() const { return axis_.powerOff(); }
  bool faulted() const { return axis_.faulted(); }
  std::string who() const { return axis_.who(); }

  // --- Parts -----------------------------------------------------------------------------------
  Notices& notices() { return axis_.notices; }
  const Notices& notices() const { return axis_.notices; }
  Feedback& feedback() { return feedback_; }
  const Feedback& feedback() const { return feedback_; }
  Control& control() { return control_; }
  const Control& control() const { return control_; }
  ActiveMode& mode() { return mode_; }
  const ActiveMode& mode() const { return mode_; }
  Generator& generator() { return generator_; }
  const Generator& generator() const { return generator_; }
  FaultWatch& faults() { return faults_; }
  const FaultWatch& faults() const { return faults_; }
  LimitKeeper& limits() { return limits_; }
  const LimitKeeper& limits() const { return limits_; }
  Stops& stops() { return stops_; }

  // --- The cycle -------------------------------------------------------------------------------
  void readFeedback(Time now);
  /// Reacts to what the feedback says.
  void supervise(Time now);
  /// @param busy a procedure runs
  void updateReadiness(bool busy);
  void writeCommands(Time now);
  [[gnu::cold]] void onBusLost(const std::string& why);
  /// The device is not ready any more: forgets everything, commands nothing.
  [[gnu::cold]] void onDeviceLost();

  // --- What concerns several parts -------------------------------------------------------------
  Goal goal() const { return control_.goal(); }
  bool inOperation() const { return control_.inOperation(); }
  void setGoal(Goal goal);
  /// Disable voltage, also where the drive's state is not known; until the next goal.
  void switchOff();
  /// Makes `mode` the one whose value and target are sent; its target becomes neutral.
  void selectMode(const ModeChannel& mode);
  /// In operation, and the drive follows its set-points: the time that the brake needs is over, and
  /// the mode's bit for it is set. A drive that never sets that bit is waited for once.
  bool brakeReleased() const { return control_.brakeReleased() && generator_.followed(); }

  /// The present position shall read `value` from now on.
  void declarePosition(double value);
  /// The drive has found its home by itself. @param shift Coordinates::adopt()
  void adoptDriveZero(double shift);
  /// Coordinates::lose()
  void loseZero();
  /// Forgets what was measured in other coordinates, until the drive tells anew.
  void measureAnew();

 private:
  void leaveOperation();
  [[gnu::cold]] void zeroMoved(double moved);
  void superviseOperation(Time now);
  // Reactions of supervise(). Cold: what tells much is kept out of the code of every cycle.
  [[gnu::cold]] void stopUnheard(Time now);
  [[gnu::cold]] void giveUpOperation();
  /// @return false: it leaves operation
  [[gnu::cold]] bool goesOnWarned(Time now);

  AxisBasis axis_;
  Coordinates coordinates_;
  ActiveMode mode_;
  Feedback feedback_;
  Control control_;
  Generator generator_;
  FaultWatch faults_;
  LimitKeeper limits_;
  Stops stops_;
  Time written_{};  ///< when commands were written last
};

/// The drive shows the active mode, and has all that this needs.
inline bool inMode(const AxisCore& axis) {
  return axis.feedback().shows(axis.mode().spec()) && axis.mode().prepared();
}

}  // namespace cia402::drive
