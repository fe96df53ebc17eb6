// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Where DriveQuirks has a say: modes, enabling, fault reset, statusword.
#include <algorithm>

#include "sim/drive/core.h"

namespace cia402::sim {
namespace {

constexpr Duration kSyncLost = std::chrono::milliseconds(100);
constexpr std::uint16_t kFaultReset = 0x0080;  // controlword
constexpr std::uint16_t kHalt = 0x0100;

}  // namespace

bool DriveCore::mayEnable() {
  const DriveQuirks& quirks = definition_.quirks;
  if (quirks.mode_needed && applied_mode_ == 0) return false;
  if (quirks.needs_power_cycle_to_save && stored_) return false;
  if (!quirks.sync_needed || (last_sync_ && now_ - *last_sync_ < kSyncLost)) return true;
  if (const FaultDefinition* fault = definition_.fault("rpdo_timeout")) raise(*fault);
  return false;
}

/// 0x0F in Switched on.
void DriveCore::beginEnabling() {
  if (!mayEnable()) return;
  const Duration time = definition_.quirks.enabling_time;
  if (time == Duration::zero()) {
    enter(PdsState::operation_enabled);
    // Without SYNC the set-point that stands in the dictionary counts at once.
    onTargetPosition();
  } else if (enabled_at_ == kNever) {
    enabled_at_ = now_ + time;
  }
}

/// Whether a command of 6060h comes to nothing.
bool DriveCore::ignoresMode(std::int64_t wanted) {
  const DriveQuirks& quirks = definition_.quirks;
  const bool changes = wanted != last_mode_command_;
  last_mode_command_ = wanted;
  if (quirks.mode_command != ModeCommand::any && !enabledState()) return true;
  if (quirks.mode_command == ModeCommand::change && !changes) return true;
  return quirks.halt_blocks_mode && (controlword_ & kHalt) != 0;
}

void DriveCore::onMode() {
  const std::int64_t wanted = values_.raw(Role::mode, 0);
  mode_commanded_ = true;
  if (ignoresMode(wanted)) return;
  if (wanted == applied_mode_ && motion_.mode() == definition_.mode(wanted)) {
    mode_at_ = kNever;
    return showMode();
  }
  const auto faulty = std::make_pair(applied_mode_, wanted);
  const auto& faults = definition_.quirks.mode_faults;
  if (enabledState() && std::find(faults.begin(), faults.end(), faulty) != faults.end()) {
    if (const FaultDefinition* fault = definition_.fault("mode_change")) return raise(*fault);
  }
  changeMode(wanted);
}

void DriveCore::changeMode(std::int64_t wanted) {
  const Duration time = definition_.quirks.mode_change_time;
  if (time == Duration::zero()) return applyMode(wanted);
  if (mode_at_ == kNever) mode_at_ = now_ + time;
  showMode();
}

void DriveCore::applyMode(std::int64_t wanted) {
  mode_at_ = kNever;
  applied_mode_ = wanted;
  motion_.setMode(definition_.mode(wanted));
  showMode();
  updateStatusword();
}

void DriveCore::showMode() {
  const DriveQuirks& quirks = definition_.quirks;
  std::int64_t shown = mode_commanded_ ? applied_mode_ : quirks.mode_shown_at_start;
  if (mode_at_ != kNever) shown = -1;
  if (quirks.mode_shown_when_enabled && state_ != PdsState::operation_enabled) shown = 0;
  values_.setRaw(Role::mode_display, shown);
}

/// A rising edge of bit 7 has come. `previous` is the controlword before it.
bool DriveCore::seesResetEdge(std::uint16_t previous) {
  const bool was_low = (previous & kFaultReset) == 0;
  return was_low && now_ - reset_low_since_ >= definition_.quirks.reset_edge_time;
}

/// One more try to reset a fault whose cause is gone.
bool DriveCore::mayReset() {
  const DriveQuirks& quirks = definition_.quirks;
  const bool history = history_count_ != nullptr && history_count_->number != 0;
  if (quirks.fault_reset_needs_empty_history && history) return false;
  if (++resets_ < quirks.fault_reset_tries) return false;
  return quirks.fault_reset_needs_stop == Duration::zero() || was_stopped_;
}

void DriveCore::onBootedAlone() {
  if (!definition_.quirks.passive_when_alone) return;
  if (const FaultDefinition* fault = definition_.fault("can_passive")) raise(*fault);
}

/// The next controlword ends it.
void DriveCore::holdUnwatched() {
  if (state_ != PdsState::operation_enabled || after_stop_) return;
  motion_.controlBits(static_cast<std::uint16_t>(controlword_ | kHalt), controlword_);
}

/// They mean nothing to anybody but the maker, and change as they like: here every 10 ms.
std::uint16_t DriveCore::vendorBits() const {
  const std::uint64_t turn = static_cast<std::uint64_t>(now_.time_since_epoch().count() / 10000000);
  return static_cast<std::uint16_t>((turn * 0x9E3779B97F4A7C15U >> 40U) &
                                    definition_.quirks.vendor_bits);
}

}  // namespace cia402::sim
