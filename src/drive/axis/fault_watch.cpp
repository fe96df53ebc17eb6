// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/fault_watch.h"

#include "drive/profile/fault_text.h"
#include "drive/sentence.h"

namespace cia402::drive {

void FaultWatch::readError(Time now) {
  const Signals& signals = axis_.objects.signals;
  const Signal& row = signals[SignalId::error_code];
  ErrorEvidence::Look look;
  look.faulted = axis_.faulted();
  look.warning = axis_.state.warning;
  if (!row.mapped()) {
    look.asked = row.spec;
  } else if (signals.fresh(SignalId::error_code)) {
    look.told = static_cast<std::uint16_t>(signals.image(SignalId::error_code).raw);
  }
  const auto& warnings = axis_.profile().warnings;
  look.of_warning = look.warning && look.told && warnings.find(*look.told) != warnings.end();
  errors_.update(look, axis_.device.objects(), now);
  axis_.state.error_code = errors_.code();
  const std::uint16_t code = look.faulted ? axis_.state.error_code : 0;
  if (code != faulted_by_) faulted_since_ = now;
  faulted_by_ = code;
  if (!look.warning) acknowledged_ = 0;
  const bool stands = look.faulted || look.warning;
  details_.update(axis_.profile(), stands ? axis_.state.error_code : std::uint16_t{0},
                  axis_.device.objects());
}

FaultWatch::Warning FaultWatch::warning() const {
  const DriveProfile& profile = axis_.profile();
  const std::uint16_t code = axis_.state.error_code;
  // Its code goes before its bit in the statusword does: it is about to end.
  if (code == 0 && acknowledged_ != 0) return Warning::goes_on;
  const auto known = profile.warnings.find(code);
  if (known == profile.warnings.end() || !known->second.reaction) {
    return profile.warning_stops ? Warning::stops : Warning::goes_on;
  }
  switch (*known->second.reaction) {
    case WarningText::Reaction::stops:
      return Warning::stops;
    case WarningText::Reaction::holds:
      return code != acknowledged_ ? Warning::holds : Warning::goes_on;
    case WarningText::Reaction::goes_on:
      break;
  }
  return Warning::goes_on;
}

bool FaultWatch::holdsMotor() const {
  if (!axis_.state.warning) return false;
  const auto known = axis_.profile().warnings.find(axis_.state.error_code);
  return known != axis_.profile().warnings.end() &&
         known->second.reaction == WarningText::Reaction::holds;
}

std::string FaultWatch::resetRefusal(Time now) const {
  const std::uint16_t code = axis_.state.error_code;
  const auto known = axis_.profile().errors.find(code);
  if (!axis_.faulted() || known == axis_.profile().errors.end()) return {};
  const ErrorText& error = known->second;
  if (error.reset == ErrorText::Reset::power_cycle) {
    return axis_.who() + ": fault " + errorCodeText(axis_.profile(), code) + "; " +
           afterwardsText(axis_.profile(), code);
  }
  if (code != faulted_by_ || now >= faulted_since_ + error.wait) return {};
  return axis_.who() + ": fault " + errorCodeText(axis_.profile(), code) +
         "; the drive takes no reset of it for " + seconds(error.wait) + ": call again in " +
         seconds(std::chrono::ceil<std::chrono::seconds>(faulted_since_ + error.wait - now));
}

void FaultWatch::forgetFault() {
  errors_.forget();
  axis_.state.error_code = 0;
}

void FaultWatch::forget() {
  errors_ = ErrorEvidence();
  details_ = FaultDetails();
  axis_.state.error_code = acknowledged_ = 0;
}

std::string FaultWatch::codeText(std::uint16_t code) const {
  const std::string* excuse = errors_.excuse(code);
  return errorCodeText(axis_.profile(), code) +
         (excuse != nullptr ? "; the cause is that " + *excuse : std::string());
}

std::string FaultWatch::detailText() const {
  const std::string text = details_.text(axis_.profile(), axis_.state.error_code);
  return text.empty() ? text : "; " + text;
}

std::string FaultWatch::emergencyText() const {
  const std::string emergency = axis_.device.terms().emergency;
  if (errors_.pending() == 0) return "no " + emergency + " is pending";
  return "last " + emergency + " " + codeText(errors_.pending());
}

std::string FaultWatch::text() const {
  const AxisState& state = axis_.state;
  if (axis_.faulted()) {
    const char* reacting =
        state.state == State::fault_reaction_active ? " (the drive is still stopping)" : "";
    if (state.error_code == 0) {
      return axis_.who() + ": fault" + reacting + ", no error code yet (" +
             axis_.profile().address(0x603F) + " is 0 and no " + axis_.device.terms().emergency +
             " came); clear_faults, then look at the drive's own display or log";
    }
    return axis_.who() + ": fault " + codeText(state.error_code) + detailText() + reacting +
           reactionText(axis_.profile(), state.error_code) + "; " +
           afterwardsText(axis_.profile(), state.error_code);
  }
  if (state.error_code != 0 && errors_.excuse(state.error_code) == nullptr) {
    return axis_.who() + ": " +
           (state.warning
                ? "warning " + warningCodeText(axis_.profile(), state.error_code) + detailText()
                : "error reported " + errorCodeText(axis_.profile(), state.error_code));
  }
  if (state.warning && axis_.profile().warning_stops) {
    return axis_.who() + ": warning without a code (statusword bit 7); clear_faults";
  }
  return {};
}

}  // namespace cia402::drive
