// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "axis_objects.h"
#include "axis_poller.h"
#include "cia402_driver/drive/axis.h"
#include "cia402_driver/drive/position_unwrap.h"
#include "cia402_driver/drive/set_point.h"
#include "cia402_driver/drive/set_point_handshake.h"
#include "cia402_driver/drive/standstill.h"
#include "error_evidence.h"
#include "follow_watch.h"
#include "position_limits.h"

namespace cia402::drive {

/// After so many RPDOs with a value, or a level of a bit, the drive has it.
inline constexpr std::uint64_t kSureFrames = 2;

/// The axis without its procedures: feedback, state machine, targets, and the reactions that must
/// not wait for anybody. Procedures tell it where to go and watch it.
class AxisCore {
 public:
  AxisCore(AxisConfig config, fieldbus::Device& device);
  AxisCore(const AxisCore&) = delete;
  AxisCore& operator=(const AxisCore&) = delete;

  const AxisConfig& config() const { return config_; }
  const DriveProfile& profile() const { return *config_.profile; }
  const AxisObjects& objects() const { return objects_; }
  fieldbus::Device& device() { return device_; }
  const AxisState& state() const { return state_; }
  bool nodeReady() const { return device_.health() == fieldbus::Health::ready; }

  // --- The cycle -------------------------------------------------------------------------------
  void readFeedback(Time now);
  /// See Axis::look().
  void look();
  /// Reacts to what the feedback says.
  void supervise(Time now);
  /// A procedure that runs must fail.
  bool failed() const { return !failure_.empty(); }
  /// Why: the node was lost, the drive does something else; empty: it need not.
  std::string takeFailure() { return std::exchange(failure_, std::string()); }
  /// @param busy a procedure runs
  void updateReadiness(bool busy, Time now);
  void writeCommands(Time now);
  void onEmergency(const fieldbus::Emergency& emergency, const std::string& excuse, Time now) {
    errors_.onEmergency(emergency, excuse, now);
  }
  /// An EMCY whose end the drive has not told; 0: none.
  std::uint16_t pendingEmergency() const { return errors_.pending(); }
  void onBusLost(const std::string& why);
  /// Quick stop by SDO: RPDOs do not reach the drive.
  void stopBySdo(const std::string& why);
  /// The node is not ready any more: forgets everything, commands nothing.
  void onNodeLost();

  // --- State machine ---------------------------------------------------------------------------
  Goal goal() const { return goal_; }
  void setGoal(Goal goal);
  /// Disable voltage, also where the drive's state is not known; until the next goal.
  void switchOff();
  void setFaultReset(bool on) { fault_reset_ = on; }
  void setHomingStart(bool on) { homing_start_ = on; }
  void setHaltBit(bool on) { halt_bit_ = on; }
  bool inOperation() const { return in_operation_; }
  /// In operation, and the drive follows its set-points: the time that the brake needs is over, and
  /// the mode's bit for it is set. A drive that never sets that bit is waited for once.
  bool brakeReleased(Time now) const {
    return in_operation_ && now >= brake_released_ && following_.follows();
  }
  /// RPDOs with the controlword sent so far.
  std::uint64_t controlwordFrames() const;
  /// No motion is possible by this drive: the power stage is off, as far as the statusword says.
  bool powerOff() const;

  /// The newest feedback is as new as it can be: none that was due has failed to come. Of a drive
  /// that sends only what changes nothing is due.
  bool heardLately(Time now) const;

  // --- Modes -----------------------------------------------------------------------------------
  const ModeChannel& mode() const { return *mode_; }
  /// The mode to enable in: the selected one; or the configured one where a homing was cut off, or
  /// the one that the axis is bound for where the way there was.
  const ModeChannel& workingMode() const;
  /// Makes `mode` the one whose value and target the RPDOs carry; its target becomes neutral.
  void selectMode(const ModeChannel& mode);
  /// The selected mode only lies on the way to another one. Until a mode is selected.
  void bindFor(const ModeChannel& mode) { bound_for_ = &mode; }
  /// Another value of 6060h is sent instead of the mode's, where it travels by RPDO; until it is
  /// taken back, another mode is selected, or the axis leaves operation.
  void overrideMode(std::optional<int> value) { mode_override_ = value; }
  /// The value that 6061h shows, if known.
  std::optional<int> shownMode() const { return shown_mode_; }
  void putShownMode(std::uint64_t raw, Time now);
  /// Keeps `raw` in an RPDO object while the mode is active (ModeSpec::entry_writes).
  void holdOutput(fieldbus::Slot slot, std::uint64_t raw);

  // --- Targets ---------------------------------------------------------------------------------
  bool setTarget(double value);
  double target() const { return set_point_.value(); }
  const SetPoint& setPoint() const { return set_point_; }
  /// Brings the set-points to rest, by a ramp where they move. Nothing if they do not.
  void stopSetPoint() { set_point_.stop(); }
  std::string motionRefusal(bool busy) const;
  std::string obstacle() const;
  std::string unknownText() const;
  /// Why a mode cannot be used with this drive; empty: it can.
  std::string modeRefusal(const ModeChannel& mode) const;
  /// Target := actual in position modes, 0 in the others.
  void neutralizeTarget();
  /// Puts a neutral target of another mode into its RPDO, before that mode becomes active.
  void presetTarget(const ModeChannel& mode);
  /// RPDOs with the active mode's target (or the controlword where it has none) sent so far.
  std::uint64_t targetFrames() const;
  /// Measured over a window that lies wholly after the last set-point that could have moved it.
  bool atStandstill() const;
  /// What is measured says that it stands, whatever the drive may do the next moment.
  bool measuredStill() const { return standstill_.still(); }
  /// The same by feedback that is no older than it must be, for answers: what comes late may tell
  /// that it has begun to move.
  bool seenToStand(Time now) const { return atStandstill() && heardLately(now); }
  /// Has been seen to move, or is being moved.
  bool moving() const;
  /// Is not known to stand. Without feedback one that stood without power still does.
  bool mayMove() const;
  /// Takes a target that an enabled axis at rest has not come to back to where it stands: what
  /// holds the motor may let go. @return how long the drive may take to come back from it; nothing
  /// if there was none.
  std::optional<Duration> withdrawTarget();

  // --- Halt ------------------------------------------------------------------------------------
  /// Stops by what the mode has for it (stopBy()). By quick stop the axis leaves operation.
  void beginHalt(Time now);
  /// Replaces the set-point that a halted drive would go on to by "stay here". The halt itself is
  /// released once that is on the wire and handshakeBusy() is over.
  void replaceHaltedTarget();
  void releaseHalt();
  /// A standing axis whose drive still goes to a position by itself, which something holds or which
  /// has yet to set off, gets where it stands for that. @return whether that was so
  bool giveUpGoal();
  bool halted() const { return state_.halted; }
  /// Takes back the halt bit that brakes an axis at rest whose efforts have ended.
  void endBraking() {
    if (braking_) braking_ = halt_bit_ = false;
  }
  bool setPointsAtRest() const { return set_point_.atRest(); }
  /// The longest that a stop may take, from the fastest that the axis may go.
  Duration stopTime() const;
  bool handshakeBusy() const { return handshake_.busy(); }

  // --- Zero ------------------------------------------------------------------------------------
  /// The present position shall read `value` from now on.
  void declarePosition(double value);
  /// The drive has found its home by itself: what was declared before is void. @param shift joint
  /// value to add to what the drive's own zero says
  void adoptDriveZero(double shift);
  /// The drive's zero may be another than before, and nobody has said where it lies: not homed,
  /// also where no homing is required, until a position is declared or found.
  void loseZero();
  /// Forgets what was measured in other coordinates, until the drive tells anew.
  void measureAnew();
  /// Parameters were saved, and the drive wants to be switched off and on before it is enabled.
  void wantPowerCycle() { power_cycle_after_ = device_.bootUps(); }
  /// Why the drive takes no enabling now; empty: it may.
  std::string enablingRefusal() const;
  /// Why an object that shifts coordinates must not be written now; empty: it may.
  std::string calibrationRefusal() const;

  // --- Limits in the drive (607Dh), which follow the zero ---------------------------------------
  /// Keeps them open, for the drive is about to get another zero; or no more. The end of a
  /// procedure ends it, too.
  void openLimits(bool open);
  /// Has them worked out anew, for the axis is about to be enabled.
  void renewLimits() { limits_due_ = true; }
  /// The drive has them, or has refused them.
  bool limitsSettled() const { return !limits_due_ && limits_.settled(); }
  const PositionLimits& limits() const { return limits_; }

  // --- Words -----------------------------------------------------------------------------------
  /// "shoulder (node 3)".
  std::string who() const;
  std::string stateText() const;  ///< "statusword 0x0233 (switched on: ...)"
  /// Why there is no feedback: "TPDO 1 (COB-ID 0x183) did not come for 11 cycles".
  std::string feedbackText() const;
  /// Why an axis without power is not known to stand.
  std::string coastingText() const;
  std::string emergencyText() const;
  /// An error code in words, with its excuse where it has one.
  std::string codeText(std::uint16_t code) const;
  /// What was commanded, what the drive shows and its last EMCY.
  std::string report() const;
  std::string faultText() const;
  bool faulted() const;
  void forgetFault();
  /// When the next edge of the fault reset bit is allowed (guard against storms of resets).
  Time nextFaultReset() const { return next_fault_reset_; }
  void noteFaultReset(Time next_allowed) { next_fault_reset_ = next_allowed; }
  const std::string& notice() const { return notice_; }
  const std::uint32_t& noticeCount() const { return notices_; }
  void notify(std::string text);
  /// A notice of what stops nothing, told once.
  void warnOnce(std::string text);
  bool noticeWarns() const { return notice_warns_; }

 private:
  void readState(Time now);
  void readMotion(Time now);
  bool errorFree() const;
  void readError(Time now);
  void readDigitalInputs(Time now);
  void readMode(Time now);
  void showMode(std::uint64_t raw);
  /// The raw value of an object that is mapped or polled; none where it is unknown or too old.
  const fieldbus::ProcessValue* told(const InputObject& object, int polled, Time now) const {
    if (!object.mapped()) return poller_.value(polled, now);
    return image_.fresh(object.slot) ? &image_.input(object.slot) : nullptr;
  }
  double read(const InputObject& object, int polled, Time now, Time& stamp) const;
  void forgetFeedback();
  void forgetMotion();
  void leaveOperation();
  std::uint16_t composeControlword();
  std::uint16_t silentControlword() const;
  void writeTarget(Time now);
  void writeNeutralTargets();
  void advanceHandshake(Time now);
  void encodeTarget();
  StopBy stopBy() const { return drive::stopBy(*mode_->spec, profile()); }
  /// A torque is nobody's any more: the axis must not coast on (command_timeout_action).
  void brakeEffort(Time now);
  void giveStopPoint(Time now);
  void renewStopPoint(Time now);
  /// Cycles were missed: nothing of them is made good.
  void onLateCycle(Time now);
  // Reactions of supervise(), with the reason in failure_.
  void stopUnheard();
  void giveUpOperation();
  void stopForWarning();

  void watchFollowing(Time now);
  /// The set-points come back to where the motor stands.
  void callBack();
  void takeTargetBack();
  const ModeChannel* brakeMode() const;
  bool brakeByMode(Time now);
  void followByBrakeMode();
  void watchBrakeMode(Time now);
  void arrest();
  bool leadsInside(double value) const;
  double guardSpeed(double effort) const;
  bool withinLimits(double value) const;
  void watchStopBySdo();
  /// Limits of the position belong into the drive: its coordinates are known, and stay.
  bool limitsBelong() const { return state_.homed && !limits_open_; }
  void keepLimits();
  bool homedEnough() const;
  bool absolute() const;
  void returnToDriveZero();
  void setZero(double shift);
  void placeZero();
  bool withinReach(double position) const;
  bool goalAhead() const;
  bool movesItself() const;
  bool mayTurnBack(Time now) const;
  void watchDrive(Time now);
  bool seenStill(Time from) const;
  bool neutralTarget(const ModeChannel& mode, std::uint64_t& raw) const;

  AxisConfig config_;
  fieldbus::Device& device_;
  fieldbus::ProcessImage& image_;
  AxisObjects objects_;
  AxisState state_;
  AxisPoller poller_;
  int polled_velocity_, polled_effort_, polled_following_error_, polled_mode_, polled_inputs_;
  Standstill standstill_;
  bool stood_without_power_ = false;  ///< when its feedback ended

  Goal goal_ = Goal::disabled;
  bool silent_ = true;  ///< nobody has asked for anything since the node came: controlword 0
  bool in_operation_ = false;
  bool fault_reset_ = false, homing_start_ = false, halt_bit_ = false;
  double halted_goal_ = kUnknown;    ///< to which the drive was going by itself
  Time seen_moving_ = Time::min();   ///< by the drive itself: not seen to stand until then
  Time moved_itself_ = Time::min();  ///< the drive may have moved by itself until then
  Time stop_point_after_ = kNever;   ///< feedback newer than this has the stop point judged anew
  bool braking_ = false;      ///< the halt bit brakes an axis whose torque is nobody's any more
  bool voltage_off_ = false;  ///< the power stage is to be off, whatever the drive shows
  const ModeChannel* bound_for_ = nullptr;
  const ModeChannel* braked_in_ = nullptr;  ///< the mode that mode_ brakes, see StopBy::mode
  Time braked_at_{};
  bool braking_mode_shown_ = false;
  fieldbus::Ticket brake_ticket_;
  std::optional<int> mode_override_;  ///< commanded instead of mode_ for a moment
  std::uint16_t controlword_ = 0, base_controlword_ = 0;
  Command command_ = nextCommand(State::unknown, Goal::disabled);  ///< of these two:
  State commanded_in_ = State::unknown;
  Goal commanded_for_ = Goal::disabled;
  Time brake_released_ = kNever, known_state_{};

  const ModeChannel* mode_;
  std::optional<int> shown_mode_;
  std::uint64_t shown_raw_ = 0;            ///< of 6061h, for which shown_mode_ was decoded
  Conversion position_, mode_conversion_;  ///< with what set_position declared
  double zero_shift_ = 0.0;
  bool zero_lost_ = false;  ///< by a write, and not declared or found since
  PositionUnwrap unwrap_;   ///< counts for continuous joints
  PositionLimits limits_;
  bool limits_due_ = true, limits_open_ = false, limits_known_ = false;

  SetPoint set_point_;
  double given_ = kUnknown;  ///< the last set-point that was taken, and its raw number
  std::uint64_t given_raw_ = 0, target_raw_ = 0, neutral_raw_ = 0;
  bool neutral_known_ = false;
  Time written_{};
  SetPointHandshake handshake_;
  bool set_point_dropped_ = false;  ///< the drive does not have target_
  bool effort_streamed_ = false;    ///< and not braked since
  FollowWatch following_;
  struct Held {
    fieldbus::Slot slot;
    std::uint64_t raw;
  };
  std::vector<Held> held_;

  Time next_fault_reset_ = Time::min();
  std::optional<std::uint32_t> power_cycle_after_;  ///< boot-ups seen when it was asked for
  ErrorEvidence errors_;
  fieldbus::Ticket stop_ticket_;
  std::string failure_, notice_;
  bool notice_warns_ = false;
  std::vector<std::string> warned_;  ///< of warnOnce()
  std::uint32_t notices_ = 0;
};

}  // namespace cia402::drive
