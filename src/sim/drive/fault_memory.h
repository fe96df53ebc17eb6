// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "canopen/nmt/nmt.h"
#include "sim/definition/drive_definition.h"
#include "sim/drive/alarm_memory.h"
#include "sim/drive/alarm_words.h"
#include "sim/drive/fault_records.h"

namespace cia402::sim {

/// The errors of one axis since the last reset: what caused them and for how long, what they do to
/// error register and statusword, and what it takes to reset them.
class FaultMemory {
 public:
  /// Both must outlive it.
  FaultMemory(const DriveDefinition& definition, DriveValues& values, ObjectDictionary& dictionary);

  /// The error as the drive is set.
  const FaultDefinition& asSet(const FaultDefinition& fault) { return words_.asSet(fault); }

  /// Power-on or reset: nothing has happened.
  void start(Time now);
  /// Remembers an error whose cause lasts from now on. Does not allocate; a seventeenth different
  /// one is not remembered.
  void add(const FaultDefinition& fault, Time now);
  /// All errors are reset.
  void clear();
  /// The causes vanish; the errors still want their reset.
  void endCauses(Time now);
  /// There are errors, and the drive resets each of them by itself.
  bool endByThemselves() const;
  /// Whether it is among those that have not been cleared.
  bool stands(const FaultDefinition& fault) const;
  /// One warning is over: 603Fh shows the newest error that is left. @return true if none is
  bool endWarning(const FaultDefinition& warning);
  /// Warnings last as long as what they warn of; the same.
  bool endWarnings();

  /// What the maker keeps of the past.
  AlarmMemory& alarms() { return alarms_; }
  bool empty() const { return causes_.empty(); }
  bool has(const FaultDefinition& fault) const;
  /// Statusword bit 7.
  bool warning() const { return warning_; }
  /// What the errors contribute to 1001h.
  std::uint8_t errorRegister() const;
  /// An error whose cause is still there, faults before warnings; nullptr if there is none.
  const FaultDefinition* lasting(Time now) const;
  /// Statusword bit 4 is gone.
  bool voltageLost(Time now) const;

  /// A new NMT state: some drives reset faults only after NMT stop.
  void onNmtState(canopen::NmtState state, Time now);
  /// One more try to reset faults whose causes are gone. @param history 1003h:00 is not 0.
  /// @return true if it works.
  bool tryReset(bool history);

 private:
  struct Cause {
    const FaultDefinition* fault;
    Time until;
  };
  const FaultDefinition* lasting(bool warnings, Time now) const;
  bool resettable(const FaultDefinition& fault) const;
  void showRest();

  const DriveDefinition& definition_;
  DriveValues& values_;
  const ObjectDictionary& dictionary_;
  AlarmMemory alarms_;
  FaultRecords records_;
  AlarmWords words_;
  std::vector<Cause> causes_;
  bool warning_ = false;
  std::int64_t tries_ = 0;       ///< to reset the present faults
  Time stopped_since_ = kNever;  ///< by NMT
  bool was_stopped_ = false;     ///< long enough, since the present faults
};

}  // namespace cia402::sim
