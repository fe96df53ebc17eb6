// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/fault_text.h"

#include <algorithm>
#include <vector>

#include "common/text.h"
#include "fieldbus/emergency.h"

namespace cia402::drive {

namespace {

/// @param known ErrorText or WarningText
template <typename Known>
std::string wordsOf(const Known& known) {
  std::string text = known.text;
  const char* separator = ": ";
  for (const std::string* part : {&known.cause, &known.remedy}) {
    if (part->empty()) continue;
    text += separator + *part;
    separator = "; ";
  }
  return text;
}

/// The codes that stand together in one that the family does not have; empty: they do not.
std::vector<std::uint16_t> partsOf(const DriveProfile& profile, std::uint16_t code) {
  if (profile.error_bits == 0 || profile.errors.count(code) != 0) return {};
  std::vector<std::uint16_t> parts;
  const auto rest = static_cast<std::uint16_t>(code & ~profile.error_bits);
  if (rest != 0) parts.push_back(rest);
  for (unsigned bit = 0; bit < 16; ++bit) {
    const auto part = static_cast<std::uint16_t>(code & profile.error_bits & (1U << bit));
    if (part != 0) parts.push_back(part);
  }
  const auto known = [&](std::uint16_t part) { return profile.errors.count(part) != 0; };
  return std::all_of(parts.begin(), parts.end(), known) ? parts : std::vector<std::uint16_t>();
}

}  // namespace

bool knowsCode(const DriveProfile& profile, std::uint16_t code) {
  return profile.errors.count(code) != 0 || profile.warnings.count(code) != 0 ||
         !partsOf(profile, code).empty();
}

std::string errorName(const DriveProfile& profile, std::uint16_t code) {
  const auto error = profile.errors.find(code);
  if (error != profile.errors.end()) return error->second.text;
  const auto warning = profile.warnings.find(code);
  if (warning != profile.warnings.end()) return warning->second.text;
  std::string together;
  for (const std::uint16_t part : partsOf(profile, code)) {
    append(together, profile.errors.at(part).text, " and ");
  }
  return together.empty() ? fieldbus::emergencyText(code) : together;
}

std::string reactionText(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  const bool its_own = known != profile.errors.end() && known->second.reaction;
  const auto& reaction = its_own ? known->second.reaction : profile.fault_reaction;
  if (!reaction) return "";
  return *reaction == ErrorText::Reaction::coasts ? "; the drive lets the motor coast"
                                                  : "; the drive brakes the motor";
}

std::string afterwardsText(const DriveProfile& profile, std::uint16_t code) {
  const std::vector<std::uint16_t> parts = partsOf(profile, code);
  const auto known = profile.errors.find(parts.empty() ? code : parts.front());
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
  const std::string number = hexText(code, 4) + " ";
  if (error != profile.errors.end()) return number + wordsOf(error->second);
  const auto warning = profile.warnings.find(code);
  if (warning != profile.warnings.end()) return number + wordsOf(warning->second);
  std::string together;
  for (const std::uint16_t part : partsOf(profile, code)) {
    append(together, wordsOf(profile.errors.at(part)), ", and ");
  }
  if (!together.empty()) return number + together;
  return number + fieldbus::emergencyText(code) + ": the drive's manual says more about this code";
}

std::string warningCodeText(const DriveProfile& profile, std::uint16_t code) {
  const auto warning = profile.warnings.find(code);
  return warning == profile.warnings.end() ? errorCodeText(profile, code)
                                           : hexText(code, 4) + " " + wordsOf(warning->second);
}

}  // namespace cia402::drive
