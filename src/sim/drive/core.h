// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "cia402_driver/canopen/nmt.h"
#include "sim/definition/drive_definition.h"
#include "sim/drive/motion.h"
#include "sim/drive/state_machine.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// A drive without its CAN connection: state machine, faults, modes and motor on the object
/// dictionary. Everything that happens by itself happens on the grid of kDriveStep.
class DriveCore {
 public:
  /// Where the core tells of its errors.
  class Reports {
   public:
    virtual ~Reports() = default;
    virtual void emergency(const FaultDefinition& fault, std::uint8_t error_register) = 0;
    virtual void errorsGone() = 0;
  };

  DriveCore(const DriveDefinition& definition, const AxisMechanics& mechanics,
            ObjectDictionary& dictionary, Reports& reports);

  /// Power or reset: forgets faults and set-points; `cold` also loses an incremental position.
  void start(bool cold, Time now);
  void powerOff();
  /// Brings everything to `now`. Call it before anything that comes from outside.
  void advance(Time now);
  /// When the core changes something visible by itself, unless asked more often before.
  Time nextEvent() const;

  // Writes from the bus, after the dictionary took them.
  void onControlword();
  void onMode();
  void onTargetPosition();
  void onSync();  ///< a SYNC was received
  void onParametersStored() { stored_ = true; }
  void onBootedAlone();  ///< nobody was heard between power-on and boot-up
  void onNonFinite();
  void resetFault();     ///< what the rising edge of controlword bit 7 does
  void onHomingStart();  ///< by the object for it
  void saveZero();       ///< the present position is 0 from now on
  /// SDO abort code against writing an object now, 0 if allowed.
  std::uint32_t refuseWrite(const Entry& entry, std::uint64_t number) const;

  void onNmtState(canopen::NmtState state);
  void onMasterLost();
  void raise(const FaultDefinition& fault);
  void blockRotor(bool blocked) { motion_.motor().block(blocked); }
  /// Causes of injected faults vanish; a fault itself still wants its reset.
  void removeCauses();
  bool enabled() const { return enabledState(); }
  bool hasFault() const { return !causes_.empty(); }

  PdsState state() const { return state_; }
  std::uint16_t statusword() const { return statusword_; }
  std::int64_t mode() const { return applied_mode_; }
  const DriveMotion& motion() const { return motion_; }

 private:
  struct Cause {
    const FaultDefinition* fault;
    Time until;
  };

  bool enabledState() const;
  bool idle() const;
  void step();
  void stepState();
  void enter(PdsState state);
  void execute(const PdsTransition& transition);
  void leaveEnabled(const PdsTransition& transition, const OptionTable& table, Role role);
  void beginQuickStop(StopOption chosen);
  void beginFaultReaction(Ramp ramp);
  StopOption option(const OptionTable& table, Role role) const;
  void clearErrors();
  const FaultDefinition* lastingCause(bool warnings) const;
  void endWarnings();
  void superviseMotion();
  void connectionLost(ConnectionLoss reaction);
  void startSegment();
  void applyMode(std::int64_t wanted);
  void showMode();
  void changeMode(std::int64_t wanted);
  bool ignoresMode(std::int64_t wanted);
  bool seesResetEdge(std::uint16_t previous);
  bool mayReset();
  bool mayEnable();
  void holdUnwatched();
  void beginEnabling();
  std::uint16_t vendorBits() const;
  void updateStatusword();
  std::uint8_t errorRegister() const;

  const DriveDefinition& definition_;
  const AxisMechanics& mechanics_;
  DriveValues values_;
  const Entry* history_count_;  ///< 1003h:00; nullptr: there is none
  DriveMotion motion_;
  Reports& reports_;

  Time now_{};
  std::int64_t step_ = 0;  ///< number of the grid step reached
  bool on_ = false;
  PdsState state_ = PdsState::not_ready_to_switch_on;
  Time ready_at_ = kNever;
  Time follow_at_{};               ///< end of the brake delay
  Time enabled_at_ = kNever;       ///< end of DriveQuirks::enabling_time
  std::int64_t applied_mode_ = 0;  ///< in which it is, whatever 6061h shows
  std::int64_t last_mode_command_ = 0;
  bool mode_commanded_ = false;  ///< since it started
  Time mode_at_ = kNever;        ///< end of DriveQuirks::mode_change_time
  std::int64_t resets_ = 0;      ///< of the present fault
  Time stopped_since_ = kNever;  ///< by NMT
  bool was_stopped_ = false;     ///< long enough, since the present fault
  Time reset_low_since_{};       ///< controlword bit 7
  Time quick_stop_since_{};
  bool stored_ = false;  ///< parameters, since its power was off
  std::uint16_t controlword_ = 0;
  std::uint16_t statusword_ = 0;
  std::optional<PdsTransition> after_stop_;  ///< transition waiting for the slow-down ramp
  bool hold_after_quick_stop_ = false;
  canopen::NmtState nmt_ = canopen::NmtState::unknown;

  std::vector<Cause> causes_;  ///< errors since the last reset
  bool warning_ = false;
  bool limit_reported_ = false;
  std::optional<Time> last_sync_;
  Duration sync_interval_{0};
};

}  // namespace cia402::sim
