// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/mode_selection.h"

#include <algorithm>
#include <utility>

namespace cia402::sim {

void ModeSelection::start() {
  applied_ = values_.raw(Role::mode, 0);
  motion_.setMode(definition_.mode(applied_));
  last_command_ = applied_;
  commanded_ = false;
  due_ = kNever;
}

bool ModeSelection::ignores(std::int64_t wanted, bool enabled, bool halted) {
  const DriveQuirks& quirks = definition_.quirks;
  const bool changes = wanted != last_command_;
  last_command_ = wanted;
  if (quirks.mode_command != ModeCommand::any && !enabled) return true;
  if (quirks.mode_command == ModeCommand::change && !changes) return true;
  if (quirks.mode_ignored_while_enabled && enabled) return true;
  return quirks.halt_blocks_mode && halted;
}

bool ModeSelection::faulty(std::int64_t wanted) const {
  const auto& faults = definition_.quirks.mode_faults;
  return std::find(faults.begin(), faults.end(), std::make_pair(applied_, wanted)) !=
             faults.end() &&
         definition_.fault("mode_change") != nullptr;
}

ModeSelection::Outcome ModeSelection::command(PdsState state, bool enabled, bool halted, Time now) {
  const std::int64_t wanted = values_.raw(Role::mode, 0);
  commanded_ = true;
  if (ignores(wanted, enabled, halted)) return Outcome::nothing;
  if (wanted == applied_ && motion_.mode() == definition_.mode(wanted)) {
    due_ = kNever;
    show(state);
    return Outcome::nothing;
  }
  if (enabled && faulty(wanted)) return Outcome::fault;
  const Duration time = definition_.quirks.mode_change_time;
  if (time == Duration::zero()) {
    apply(state);
    return Outcome::applied;
  }
  if (due_ == kNever) due_ = now + time;
  show(state);
  return Outcome::nothing;
}

void ModeSelection::apply(PdsState state) {
  due_ = kNever;
  applied_ = values_.raw(Role::mode, 0);
  motion_.setMode(definition_.mode(applied_));
  show(state);
}

void ModeSelection::show(PdsState state) {
  const DriveQuirks& quirks = definition_.quirks;
  std::int64_t shown = commanded_ ? applied_ : quirks.mode_shown_at_start;
  if (due_ != kNever) shown = -1;
  if (quirks.mode_shown_when_enabled && state != PdsState::operation_enabled) shown = 0;
  values_.setRaw(Role::mode_display, shown);
}

}  // namespace cia402::sim
