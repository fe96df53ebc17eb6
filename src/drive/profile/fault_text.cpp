// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/fault_text.h"

#include "common/text.h"
#include "fieldbus/emergency.h"

namespace cia402::drive {

namespace {

/// @param known ErrorText or WarningText
template <typename Known>
std::string codeText(const Known& known, std::uint16_t code) {
  std::string text = hexText(code, 4) + " " + known.text;
  const char* separator = ": ";
  for (const std::string* part : {&known.cause, &known.remedy}) {
    if (part->empty()) continue;
    text += separator + *part;
    separator = "; ";
  }
  return text;
}

}  // namespace

std::string errorName(const DriveProfile& profile, std::uint16_t code) {
  const auto error = profile.errors.find(code);
  if (error != profile.errors.end()) return error->second.text;
  const auto warning = profile.warnings.find(code);
  return warning == profile.warnings.end() ? fieldbus::emergencyText(code) : warning->second.text;
}

std::string afterwardsText(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  const auto reset = known == profile.errors.end() ? ErrorText::Reset::by_bit : known->second.reset;
  switch (reset) {
    case ErrorText::Reset::by_itself:
      return "it ends by itself once its cause is gone, then enable";
    case ErrorText::Reset::power_cycle:
      return "then switch the drive's power off and on: nothing else clears it";
    case ErrorText::Reset::by_bit:
      break;
  }
  return "then clear_faults";
}

std::string errorCodeText(const DriveProfile& profile, std::uint16_t code) {
  const auto error = profile.errors.find(code);
  if (error != profile.errors.end()) return codeText(error->second, code);
  const auto warning = profile.warnings.find(code);
  if (warning != profile.warnings.end()) return codeText(warning->second, code);
  return hexText(code, 4) + " " + fieldbus::emergencyText(code) +
         ": the drive's manual says more about this code";
}

std::string warningCodeText(const DriveProfile& profile, std::uint16_t code) {
  const auto warning = profile.warnings.find(code);
  return warning == profile.warnings.end() ? errorCodeText(profile, code)
                                           : codeText(warning->second, code);
}

}  // namespace cia402::drive
