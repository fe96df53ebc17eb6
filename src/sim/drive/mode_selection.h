// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/drive/motion.h"
#include "sim/drive/state_machine.h"

namespace cia402::sim {

/// Modes of operation (6060h) and their display (6061h) with all that drives in the field make of
/// them.
class ModeSelection {
 public:
  /// What a command of 6060h came to.
  enum class Outcome : std::uint8_t {
    nothing,  ///< it is ignored, takes its time, or is the present mode
    applied,  ///< the mode counts now
    fault,    ///< the drive answers it by the fault `mode_change`
  };

  ModeSelection(const DriveDefinition& definition, DriveValues& values, DriveMotion& motion)
      : definition_(definition), values_(values), motion_(motion) {}

  /// After power-on or reset the mode is what 6060h says.
  void start();
  /// 6060h was written.
  /// @param enabled the power stage is on. @param halted controlword bit 8 is set.
  Outcome command(PdsState state, bool enabled, bool halted, Time now);
  /// A mode that was commanded some time ago counts from now on.
  void apply(PdsState state);
  /// Shows the mode in 6061h as it is shown in that state.
  void show(PdsState state);

  /// In which the drive is, whatever 6061h shows.
  std::int64_t applied() const { return applied_; }
  /// When apply() is due; kNever if no mode waits.
  Time due() const { return due_; }

 private:
  bool ignores(std::int64_t wanted, bool enabled, bool halted);
  bool faulty(std::int64_t wanted) const;

  const DriveDefinition& definition_;
  DriveValues& values_;
  DriveMotion& motion_;
  std::int64_t applied_ = 0;
  std::int64_t last_command_ = 0;
  bool commanded_ = false;  ///< since it started
  Time due_ = kNever;       ///< end of DriveQuirks::mode_change_time
};

}  // namespace cia402::sim
