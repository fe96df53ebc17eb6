// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/drive/core.h"

namespace cia402::sim {
namespace {

constexpr std::uint8_t kGenericError = 0x01;  // 1001h bit 0 is set with every error

}  // namespace

std::uint8_t DriveCore::errorRegister() const {
  const bool generic = !causes_.empty() && !definition_.quirks.no_generic_error_bit;
  std::uint8_t bits = generic ? kGenericError : 0;
  for (const Cause& cause : causes_) {
    bits = static_cast<std::uint8_t>(bits | cause.fault->error_register);
  }
  return bits;
}

void DriveCore::raise(const FaultDefinition& fault) {
  if (!on_) return;
  const auto same = std::find_if(causes_.begin(), causes_.end(),
                                 [&fault](const Cause& c) { return c.fault == &fault; });
  const Time until = fault.persists == Duration::max() ? kNever : now_ + fault.persists;
  if (causes_.empty()) was_stopped_ = false;
  if (same != causes_.end()) {
    same->until = until;
  } else if (causes_.size() < causes_.capacity()) {
    causes_.push_back({&fault, until});
  }
  values_.setRaw(Role::error_code, fault.code);
  if (fault.warning) warning_ = true;
  if (!fault.warning || definition_.warning_stops) {
    const bool reacting = state_ == PdsState::fault_reaction_active || state_ == PdsState::fault;
    const Ramp ramp = fault.reaction
                          ? *fault.reaction
                          : option(definition_.fault_reaction, Role::fault_reaction_option).ramp;
    if (!reacting || ramp == Ramp::coast) beginFaultReaction(ramp);  // transition 13
  }
  updateStatusword();
  reports_.emergency(fault, errorRegister());
}

const FaultDefinition* DriveCore::lastingCause(bool warnings) const {
  for (const Cause& cause : causes_) {
    if (cause.fault->warning != warnings) continue;
    if (!cause.fault->resettable || cause.until > now_) return cause.fault;
  }
  return nullptr;
}

void DriveCore::resetFault() {
  if (state_ != PdsState::fault && !warning_) return;
  if (state_ == PdsState::fault_reaction_active) return;
  const FaultDefinition* lasting = lastingCause(false);
  if (lasting == nullptr) lasting = lastingCause(true);
  if (lasting != nullptr) {
    values_.setRaw(Role::error_code, lasting->code);
    reports_.emergency(*lasting, errorRegister());
    return;
  }
  if (!mayReset()) return;
  clearErrors();
  if (state_ == PdsState::fault) enter(PdsState::switch_on_disabled);  // transition 15
  updateStatusword();
}

void DriveCore::clearErrors() {
  causes_.clear();
  warning_ = was_stopped_ = false;
  resets_ = 0;
  values_.setRaw(Role::error_code, 0);
  reports_.errorsGone();
}

void DriveCore::removeCauses() {
  for (Cause& cause : causes_) cause.until = now_;
  motion_.motor().block(false);
  if (!definition_.warning_stops) endWarnings();
  updateStatusword();
}

/// A warning lasts as long as what it warns of, while a fault waits for its reset.
void DriveCore::endWarnings() {
  if (!warning_) return;
  causes_.erase(std::remove_if(causes_.begin(), causes_.end(),
                               [](const Cause& cause) { return cause.fault->warning; }),
                causes_.end());
  warning_ = false;
  if (causes_.empty()) clearErrors();
}

void DriveCore::superviseMotion() {
  if (motion_.followingErrorExceeded() && definition_.following_error_is_fault &&
      state_ != PdsState::fault_reaction_active) {
    if (const FaultDefinition* fault = definition_.fault("following_error")) raise(*fault);
  }
  if (!motion_.limitSwitchHit()) {
    limit_reported_ = false;
  } else if (!limit_reported_) {
    limit_reported_ = true;
    const FaultDefinition* fault = definition_.fault("limit_switch");
    if (fault != nullptr && definition_.limit_switch_is_fault) raise(*fault);
  }
}

void DriveCore::onNonFinite() {
  if (const FaultDefinition* fault = definition_.fault("not_a_number")) raise(*fault);
}

void DriveCore::connectionLost(ConnectionLoss reaction) {
  if (definition_.quirks.master_lost_holds) return holdUnwatched();
  switch (reaction) {
    case ConnectionLoss::none:
      return;
    case ConnectionLoss::fault:
      if (const FaultDefinition* fault = definition_.fault("master_lost")) raise(*fault);
      return;
    case ConnectionLoss::disable_voltage:
      if (enabledState()) enter(PdsState::switch_on_disabled);
      break;
    case ConnectionLoss::quick_stop:
      if (state_ == PdsState::operation_enabled) {
        beginQuickStop(option(definition_.quick_stop, Role::quick_stop_option));
      }
      break;
  }
  updateStatusword();
}

void DriveCore::onMasterLost() {
  constexpr ConnectionLoss kByOption[] = {ConnectionLoss::none, ConnectionLoss::fault,
                                          ConnectionLoss::disable_voltage,
                                          ConnectionLoss::quick_stop};
  const std::int64_t code = values_.raw(Role::abort_connection_option,
                                        static_cast<std::int64_t>(definition_.master_lost));
  connectionLost(code >= 0 && code <= 3 ? kByOption[code] : definition_.master_lost);
}

void DriveCore::onNmtState(canopen::NmtState state) {
  const bool left =
      nmt_ == canopen::NmtState::operational && state != canopen::NmtState::operational;
  nmt_ = state;
  if (state == canopen::NmtState::stopped) {
    stopped_since_ = now_;
  } else if (stopped_since_ != kNever) {
    was_stopped_ = now_ - stopped_since_ >= definition_.quirks.fault_reset_needs_stop;
    stopped_since_ = kNever;
  }
  if (!left || !definition_.stops_outside_operational) return;
  if (state_ != PdsState::operation_enabled && state_ != PdsState::quick_stop_active) return;
  if (definition_.quirks.master_lost_holds) return holdUnwatched();
  beginQuickStop({Ramp::quick_stop, false});
  updateStatusword();
}

}  // namespace cia402::sim
