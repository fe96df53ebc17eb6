// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/fault_text.h"

#include <array>
#include <cstdio>

#include "fieldbus/emergency.h"

namespace cia402::drive {

std::string hexWord(std::uint16_t word) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "0x%04X", static_cast<unsigned>(word));
  return text.data();
}

std::string errorName(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  return known == profile.errors.end() ? fieldbus::emergencyText(code) : known->second.text;
}

std::string errorCodeText(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  if (known == profile.errors.end()) {
    return hexWord(code) + " " + fieldbus::emergencyText(code) +
           ": the drive's manual says more about this code";
  }
  std::string text = hexWord(code) + " " + known->second.text;
  const char* separator = ": ";
  for (const std::string* part : {&known->second.cause, &known->second.remedy}) {
    if (part->empty()) continue;
    text += separator + *part;
    separator = "; ";
  }
  return text;
}

}  // namespace cia402::drive
