// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Statusword and controlword (CiA 402-2) in words.
#include "common/text.h"
#include "decode/value_text.h"
#include "drive/axis/state_machine.h"
#include "drive/profile/status_bits.h"

namespace cia402::decode {
namespace {

using drive::ControlKind;
using drive::ModeSpec;

/// CiA 402-2, table "command coding": bits that count, their value, and the command.
struct Command {
  std::uint16_t mask, value;
  const char* name;
};
constexpr Command kCommands[] = {
    {0x0080, 0x0080, "fault reset"}, {0x0002, 0x0000, "disable voltage"},
    {0x0006, 0x0002, "quick stop"},  {0x0007, 0x0006, "shutdown"},
    {0x000F, 0x0007, "switch on"},   {0x000F, 0x000F, "enable operation"},
};

std::string controlBit(unsigned bit, const ModeSpec* mode) {
  if (bit == 8) return "halt";
  if (mode != nullptr && !mode->handover.words.empty()) {
    if (bit == 4) return "new set-point";
    if (bit == 5) return "change at once";
    if (bit == 6) return "relative";
  }
  if (mode != nullptr && mode->kind == ControlKind::homing && bit == 4) return "start homing";
  return "bit " + std::to_string(bit);
}

}  // namespace

std::string statuswordText(std::uint16_t statusword, const ModeSpec* mode,
                           const drive::StatusWords& words) {
  std::string text = hexText(statusword, 4) + " " + drive::toString(drive::decodeState(statusword));
  const auto others = static_cast<std::uint16_t>(statusword & ~drive::kStateBits);
  if (others != 0) text += "; " + drive::statusBitsText(others, mode, words);
  return text;
}

std::string controlwordText(std::uint16_t controlword, const ModeSpec* mode) {
  std::string text = hexText(controlword, 4);
  for (const Command& command : kCommands) {
    if ((controlword & command.mask) != command.value) continue;
    text += std::string(" ") + command.name;
    break;
  }
  const char* separator = "; ";
  for (unsigned bit = 4; bit < 16; ++bit) {
    if ((controlword >> bit & 1U) == 0 || bit == 7) continue;
    text += separator + controlBit(bit, mode);
    separator = ", ";
  }
  return text;
}

}  // namespace cia402::decode
