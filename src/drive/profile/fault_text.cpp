// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/fault_text.h"

#include "common/text.h"
#include "fieldbus/emergency.h"

namespace cia402::drive {

std::string errorName(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  return known == profile.errors.end() ? fieldbus::emergencyText(code) : known->second.text;
}

std::string errorCodeText(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  if (known == profile.errors.end()) {
    return hexText(code, 4) + " " + fieldbus::emergencyText(code) +
           ": the drive's manual says more about this code";
  }
  std::string text = hexText(code, 4) + " " + known->second.text;
  const char* separator = ": ";
  for (const std::string* part : {&known->second.cause, &known->second.remedy}) {
    if (part->empty()) continue;
    text += separator + *part;
    separator = "; ";
  }
  return text;
}

}  // namespace cia402::drive
