// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/fault_memory.h"

#include <algorithm>

namespace cia402::sim {
namespace {

constexpr std::uint8_t kGenericError = 0x01;  // 1001h bit 0 is set with every error
constexpr std::size_t kMostCauses = 16;

}  // namespace

FaultMemory::FaultMemory(const DriveDefinition& definition, DriveValues& values,
                         ObjectDictionary& dictionary)
    : definition_(definition),
      values_(values),
      dictionary_(dictionary),
      alarms_(values, dictionary, definition.own.monitors.at_alarm),
      records_(definition, dictionary),
      words_(definition, dictionary) {
  causes_.reserve(kMostCauses);
}

void FaultMemory::start(Time now) {
  alarms_.start(now);
  records_.start();
  causes_.clear();
  warning_ = was_stopped_ = false;
  tries_ = 0;
  stopped_since_ = kNever;
}

void FaultMemory::add(const FaultDefinition& fault, Time now) {
  const auto same = std::find_if(causes_.begin(), causes_.end(),
                                 [&fault](const Cause& cause) { return cause.fault == &fault; });
  const Time until = fault.persists == Duration::max() ? kNever : now + fault.persists;
  if (causes_.empty()) was_stopped_ = false;
  if (same != causes_.end()) {
    same->until = until;
  } else if (causes_.size() < kMostCauses) {
    causes_.push_back({&fault, until});
  }
  if (fault.warning) warning_ = true;
  alarms_.add(fault.details, now);
  records_.add(fault);
}

void FaultMemory::clear() {
  causes_.clear();
  warning_ = was_stopped_ = false;
  tries_ = 0;
}

void FaultMemory::endCauses(Time now) {
  for (Cause& cause : causes_) cause.until = now;
}

bool FaultMemory::endByThemselves() const {
  return !causes_.empty() && std::all_of(causes_.begin(), causes_.end(), [](const Cause& cause) {
    return cause.fault->ends_by_itself;
  });
}

bool FaultMemory::stands(const FaultDefinition& fault) const {
  return std::any_of(causes_.begin(), causes_.end(),
                     [&fault](const Cause& cause) { return cause.fault->name == fault.name; });
}

bool FaultMemory::endWarning(const FaultDefinition& warning) {
  const auto over = [&warning](const Cause& cause) {
    return cause.fault->warning && cause.fault->name == warning.name;
  };
  const auto kept = std::remove_if(causes_.begin(), causes_.end(), over);
  if (kept == causes_.end()) return false;
  causes_.erase(kept, causes_.end());
  warning_ = std::any_of(causes_.begin(), causes_.end(),
                         [](const Cause& cause) { return cause.fault->warning; });
  showRest();
  return causes_.empty();
}

bool FaultMemory::endWarnings() {
  if (!warning_) return false;
  causes_.erase(std::remove_if(causes_.begin(), causes_.end(),
                               [](const Cause& cause) { return cause.fault->warning; }),
                causes_.end());
  warning_ = false;
  showRest();
  return causes_.empty();
}

void FaultMemory::showRest() {
  if (causes_.empty()) return;
  values_.setRaw(Role::error_code, causes_.back().fault->code);
  values_.setRaw(Role::error_code_copy, causes_.back().fault->code);
}

std::uint8_t FaultMemory::errorRegister() const {
  const bool generic = !causes_.empty() && !definition_.quirks.no_generic_error_bit;
  std::uint8_t bits = generic ? kGenericError : 0;
  for (const Cause& cause : causes_) {
    bits = static_cast<std::uint8_t>(bits | cause.fault->error_register);
  }
  return bits;
}

bool FaultMemory::resettable(const FaultDefinition& fault) const {
  const Entry* by = fault.reset_by ? dictionary_.find(*fault.reset_by) : nullptr;
  return fault.resettable || (by != nullptr && by->number != 0);
}

bool FaultMemory::has(const FaultDefinition& fault) const {
  return std::any_of(causes_.begin(), causes_.end(),
                     [&fault](const Cause& cause) { return cause.fault == &fault; });
}

const FaultDefinition* FaultMemory::lasting(bool warnings, Time now) const {
  for (const Cause& cause : causes_) {
    if (cause.fault->warning != warnings) continue;
    if (!resettable(*cause.fault) || cause.until > now) return cause.fault;
  }
  return nullptr;
}

const FaultDefinition* FaultMemory::lasting(Time now) const {
  const FaultDefinition* fault = lasting(false, now);
  return fault != nullptr ? fault : lasting(true, now);
}

bool FaultMemory::voltageLost(Time now) const {
  return std::any_of(causes_.begin(), causes_.end(), [now](const Cause& cause) {
    return cause.fault->voltage_lost && cause.until > now;
  });
}

void FaultMemory::onNmtState(canopen::NmtState state, Time now) {
  if (state == canopen::NmtState::stopped) {
    stopped_since_ = now;
  } else if (stopped_since_ != kNever) {
    was_stopped_ = now - stopped_since_ >= definition_.quirks.fault_reset_needs_stop;
    stopped_since_ = kNever;
  }
}

bool FaultMemory::tryReset(bool history) {
  const DriveQuirks& quirks = definition_.quirks;
  if (quirks.fault_reset_needs_empty_history && history) return false;
  if (++tries_ < quirks.fault_reset_tries) return false;
  return quirks.fault_reset_needs_stop == Duration::zero() || was_stopped_;
}

}  // namespace cia402::sim
