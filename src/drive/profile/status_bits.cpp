// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/status_bits.h"

#include <optional>
#include <utility>

#include "common/text.h"

namespace cia402::drive {
namespace {

constexpr unsigned kTargetReachedBit = 10;

constexpr const char* kBits[16] = {"ready to switch on",
                                   "switched on",
                                   "operation enabled",
                                   "fault",
                                   "voltage enabled",
                                   "quick stop inactive",
                                   "switch on disabled",
                                   "warning",
                                   "bit 8",
                                   "remote",
                                   "bit 10",
                                   "internal limit active",
                                   "bit 12",
                                   "bit 13",
                                   "bit 14",
                                   "bit 15"};

const char* nameOf(unsigned bit, const ModeSpec* mode, const StatusWords& words) {
  const char* const known = words[bit].empty() ? kBits[bit] : words[bit].c_str();
  if (mode == nullptr) return bit == kTargetReachedBit ? "target reached" : known;
  const std::pair<const std::optional<int>&, const char*> named[] = {
      {mode->target_reached_bit, "target reached"},
      {mode->following_error_bit, "following error"},
      {mode->set_point_acknowledge_bit, "set-point acknowledged"},
      {mode->speed_zero_bit, "speed is zero"},
      {mode->homing_attained_bit, "homing attained"},
      {mode->homing_error_bit, "homing error"},
      {mode->follows_command_bit, "follows the command"}};
  for (const auto& [position, text] : named) {
    if (position && *position == static_cast<int>(bit)) return text;
  }
  return known;
}

}  // namespace

std::string statusBitsText(std::uint16_t statusword, const ModeSpec* mode,
                           const StatusWords& words) {
  std::string text;
  for (unsigned bit = 0; bit < 16; ++bit) {
    if ((statusword & (1u << bit)) != 0) append(text, nameOf(bit, mode, words), ", ");
  }
  return text.empty() ? "no bit set" : text;
}

}  // namespace cia402::drive
