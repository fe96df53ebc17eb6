// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/writes.h"

namespace cia402::drive {

/// Brings the drive into a mode of operation: entry writes, neutral target on the wire, 6060h, and
/// 6061h awaited. Other values of 6061h on the way are no errors; some drives show -1 for seconds.
/// If the drive does not follow, the mode from before is commanded again.
class ModeStep {
 public:
  /// @param bound_for where that mode or the one from before only lies on the way to another one:
  /// what the axis is to be enabled in should it be cut off there.
  explicit ModeStep(const ModeChannel& mode, const ModeChannel* bound_for = nullptr)
      : mode_(&mode), bound_for_(bound_for), writes_(mode.spec->entry_writes) {}
  Outcome advance(const Context& context);

 private:
  enum class Phase { writing, presetting, sending, waiting };
  void select(const Context& context);
  void enter(AxisCore& axis, const ModeChannel& mode) const;
  Outcome await(const Context& context);
  void askForDisplay(const Context& context);
  Outcome fail(const Context& context, const std::string& why);

  const ModeChannel* mode_;
  const ModeChannel* bound_for_;
  const ModeChannel* before_ = nullptr;
  WriteStep writes_;
  Phase phase_ = Phase::writing;
  fieldbus::Ticket command_, display_;
  std::uint64_t frames_ = 0, controlword_frames_ = 0;
  Time started_{}, next_question_{};
};

}  // namespace cia402::drive
