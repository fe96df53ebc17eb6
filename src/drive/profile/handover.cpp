// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/handover.h"

namespace cia402::drive {
namespace {

constexpr unsigned kNewSetPoint = 1u << 4, kChangeAtOnce = 1u << 5, kRelative = 1u << 6;

}  // namespace

std::uint16_t Handover::ofCommand(std::size_t index) const {
  unsigned word = words[index];
  if (queued) word &= ~kChangeAtOnce;
  if (relative()) word |= kRelative;
  return static_cast<std::uint16_t>(word);
}

Handover standardHandover(bool acknowledged) {
  Handover handover;
  handover.words = {kChangeAtOnce, kChangeAtOnce | kNewSetPoint};
  handover.acknowledge = acknowledged ? Handover::Acknowledge::level : Handover::Acknowledge::none;
  return handover;
}

}  // namespace cia402::drive
