// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/mode.h"

namespace cia402::drive {

/// In operation enabled, with neutral targets: sees to it that the drive is in the mode that was
/// commanded before. Some drives show it only now (profile, `mode_change/shown: enabled`), some
/// want it commanded once more (`mode_change/again`), by way of another mode where they do not
/// stand the change from the mode that they are in (`mode_change/detours`). Over at once where
/// 6061h shows it.
class ModeShownStep {
 public:
  explicit ModeShownStep(const ModeChannel& mode) : mode_(&mode) {}
  Outcome advance(const Context& context);

 private:
  enum class Phase { begin, zero, between, detour, again, waiting };
  void command(const Context& context, Phase phase, int value);
  bool beginDetour(const AxisCore& axis);
  bool sent(const Context& context) const;
  Outcome await(const Context& context);

  const ModeChannel* mode_;
  std::optional<ModeStep> between_, last_;  ///< of the detour
  Phase phase_ = Phase::begin;
  fieldbus::Ticket ticket_;
  std::uint64_t frames_ = 0;
  Time since_{};
};

}  // namespace cia402::drive
