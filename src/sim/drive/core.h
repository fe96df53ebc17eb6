// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canopen/nmt/nmt.h"
#include "sim/definition/drive_definition.h"
#include "sim/drive/fault_memory.h"
#include "sim/drive/limit_reports.h"
#include "sim/drive/mode_selection.h"
#include "sim/drive/motion.h"
#include "sim/drive/obstacle.h"
#include "sim/drive/power_stage.h"
#include "sim/drive/sync_watch.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// One axis of a drive without its CAN connection: power stage, faults, modes and motor on the
/// axis' objects. Everything that happens by itself happens on the grid of kDriveStep.
class DriveCore {
 public:
  /// Where the core tells of its errors.
  class Reports {
   public:
    virtual ~Reports() = default;
    /// An error has occurred, or its reset was in vain.
    virtual void emergency(const FaultDefinition& fault) = 0;
    /// No error is left in this axis.
    virtual void errorsGone() = 0;
  };

  /// @param axis of the device, 0 to 7. All references must outlive the core.
  DriveCore(const DriveDefinition& definition, unsigned axis, const AxisMechanics& mechanics,
            ObjectDictionary& dictionary, Reports& reports);

  /// Power or reset: forgets faults and set-points; `cold` also loses an incremental position.
  void start(bool cold, Time now);
  /// No supply: the rotor coasts, nothing is heard.
  void powerOff();
  /// Brings everything to `now`. Call it before anything that comes from outside.
  void advance(Time now);
  /// When the core changes something visible by itself, unless asked more often before.
  Time nextEvent() const;

  // Writes from the bus, after the dictionary took them.
  void onControlword();     ///< 6040h
  void onMode();            ///< 6060h
  void onTargetPosition();  ///< 607Ah, or 60C1h:01
  void onWrite(Role role);  ///< an object of the maker's own that makes the axis do something
  void onNonFinite();       ///< an object of floats got what is no number
  void resetFault();        ///< what the rising edge of controlword bit 7 does
  /// SDO abort code against writing an object now, 0 if allowed.
  std::uint32_t refuseWrite(const Entry& entry, std::uint64_t number) const;

  // What happens to the device.
  void onSync();                                 ///< a SYNC was received
  void onParametersStored() { stored_ = true; }  ///< by 1010h
  void onBootedAlone();                          ///< nobody was heard between power-on and boot-up
  /// The device has entered that state.
  void onNmtState(canopen::NmtState state);
  void onMasterLost();  ///< heartbeat or life guarding

  /// An error occurs; nothing without power.
  void raise(const FaultDefinition& known);
  /// What keeps the axis from being switched on, and its inputs; onObstacle() follows a change.
  Obstacle& obstacle() { return obstacle_; }
  void onObstacle();
  /// Causes of injected faults vanish; a fault itself still wants its reset.
  void removeCauses();

  bool enabled() const { return power_.enabled(); }
  const FaultMemory& faults() const { return faults_; }
  std::uint16_t statusword() const { return statusword_; }
  /// In which the axis is, whatever 6061h shows.
  std::int64_t mode() const { return modes_.applied(); }
  /// Digital outputs that are on.
  std::uint32_t outputs() const;
  DriveMotion& motion() { return motion_; }

 private:
  bool idle() const;
  void step();
  void command(PdsCommand command);
  void execute(const PdsTransition& transition);
  void beginEnabling();
  bool mayEnable();
  void raise(const char* fault);
  void superviseMotion();
  void connectionLost(ConnectionLoss reaction);
  void holdUnwatched();
  void clearErrors();
  const ModeDefinition* enabledMode() const {
    return power_.state() == PdsState::operation_enabled ? motion_.mode() : nullptr;
  }
  void startSegment();
  void updateStatusword();

  const DriveDefinition& definition_;
  DriveValues values_;
  const Entry* history_count_;  ///< 1003h:00; nullptr: there is none
  DriveMotion motion_;
  ModeSelection modes_;
  PowerStage power_;
  FaultMemory faults_;
  Obstacle obstacle_;
  SyncWatch sync_;
  Reports& reports_;

  Time now_{};
  std::int64_t step_ = 0;  ///< number of the grid step reached
  bool on_ = false;
  bool stored_ = false;  ///< parameters, since its power was off
  LimitReports limits_told_;
  Time reset_low_since_{};  ///< controlword bit 7
  std::uint16_t controlword_ = 0;
  std::uint16_t statusword_ = 0;
  canopen::NmtState nmt_ = canopen::NmtState::unknown;
};

}  // namespace cia402::sim
