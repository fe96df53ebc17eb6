// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/drive/mode_selection.h"
#include "sim/drive/motion.h"
#include "sim/drive/state_machine.h"

namespace cia402::sim {

/// The state of the power drive system (CiA 402-2) and what its states do to the motor: brake,
/// ramps on the way out, and the transitions that happen by themselves.
class PowerStage {
 public:
  /// All references must outlive it.
  PowerStage(const DriveDefinition& definition, const AxisMechanics& mechanics,
             const DriveValues& values, DriveMotion& motion, ModeSelection& modes);

  /// Power-on or reset: not ready to switch on, for as long as the initialisation takes.
  void start(Time now);
  /// No supply.
  void powerOff();

  PdsState state() const { return state_; }
  /// Power on the motor.
  bool enabled() const;
  /// Operation enabled, and not on the way out.
  bool operating() const;
  /// Until when it initialises; kNever: it has.
  Time readyAt() const { return ready_at_; }
  /// Whether enabling is under way that takes its time (DriveQuirks::enabling_time).
  bool enabling() const { return enabled_at_ != kNever; }
  /// The state that the statusword shows.
  PdsState shown(Time now) const;

  /// Transition 1, if due.
  void finishInitialisation(Time due, Time now);
  /// Transition 4, if it is under way and due. @return true if operation is enabled from now on.
  bool finishEnabling(Time due, Time now);
  /// The brake is still opening.
  bool braking(Time now) const { return state_ == PdsState::operation_enabled && now < follow_at_; }
  /// Set-points are not followed before the brake is open.
  void waitForBrake(Time due);
  /// Transitions 12 and 14 and those that wait for a ramp, where standstill is reached.
  /// @param due of the step that was done
  void finishStops(Time due, Time now);

  /// Does a transition of a command, but not 4 (enable operation). Some wait for a ramp first.
  void execute(const PdsTransition& transition, Time now);
  /// Transition 4. @return true if operation is enabled from now on, false if that takes its time.
  bool enable(Time now);
  /// "Enable operation" while a ramp on the way out runs ends that.
  void stay();
  /// Transitions 2 to 10 at once.
  void enter(PdsState state, Time now);
  /// Transition 11.
  void quickStop(StopOption chosen, Time now);
  /// Transition 11 by 605Ah.
  void quickStop(Time now);
  /// Transition 13. The fault's own reaction counts before 605Eh.
  void react(const FaultDefinition& fault, Time now);

 private:
  StopOption option(const OptionTable& table, Role role) const;
  void leaveEnabled(const PdsTransition& transition, const OptionTable& table, Role role, Time now);
  bool closesBrake() const;
  bool atCloseSpeed() const;
  void letGo(PdsState state, Ramp ramp, Time now);
  void beginStop(Ramp ramp, Time now, bool quick);
  bool brakeHolds(Time due);

  const DriveDefinition& definition_;
  const AxisMechanics& mechanics_;
  const DriveValues& values_;
  DriveMotion& motion_;
  ModeSelection& modes_;
  PdsState state_ = PdsState::not_ready_to_switch_on;
  Time ready_at_ = kNever;
  Time follow_at_{};          ///< end of the brake delay
  Time enabled_at_ = kNever;  ///< end of DriveQuirks::enabling_time
  Time quick_stop_since_{};
  Time stop_since_{};                        ///< on the way out of operation, ...
  Time power_ends_at_ = kNever;              ///< ... where a brake closes
  std::optional<PdsTransition> after_stop_;  ///< transition waiting for the slow-down ramp
  bool hold_after_quick_stop_ = false;
};

}  // namespace cia402::sim
