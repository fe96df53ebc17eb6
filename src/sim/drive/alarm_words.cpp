// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/alarm_words.h"

namespace cia402::sim {
namespace {

constexpr fieldbus::ObjectId kReactionOption{0x605E, 0};

}  // namespace

const FaultDefinition& AlarmWords::reacting(const FaultDefinition& fault) {
  const Entry* entry = dictionary_.find(fault.reaction_by->object);
  const auto ramp = fault.reaction_by->ramps.find(entry == nullptr ? 0 : asSigned(*entry));
  FaultDefinition& set = set_[fault.name];
  set = fault;
  if (ramp != fault.reaction_by->ramps.end()) set.reaction = ramp->second;
  return set;
}

const FaultDefinition& AlarmWords::asSet(const FaultDefinition& fault) {
  if (fault.reaction_by) return reacting(fault);
  const Entry* entry = fault.word ? dictionary_.find(*fault.word) : nullptr;
  if (entry == nullptr) return fault;
  FaultDefinition& set = set_[fault.name];
  set = fault;
  const std::uint64_t word = entry->number, reaction = word >> 24;
  set.code = static_cast<std::uint16_t>(word & 0xFFFF);
  for (unsigned i = 0; i < 4; ++i) {
    set.vendor[i + 1] = static_cast<std::uint8_t>((word >> (8 * i)) & 0xFF);
  }
  set.warning = reaction == 3 || reaction == 4;
  set.holds = reaction == 3 && (fault.holds || !fault.warning);  // a limit holds by itself
  set.tells = reaction < 5;
  set.records = reaction < 6;
  set.ends_by_itself = !set.warning && ((word >> 16) & 0xFF) != 0;
  const auto moved = definition_.objects.find(Role::fault_reaction_option);
  const Entry* option =
      dictionary_.find(moved == definition_.objects.end() ? kReactionOption : moved->second);
  if (option != nullptr && asSigned(*option) < 0 && reaction < 3) {
    constexpr Ramp kRamps[] = {Ramp::coast, Ramp::slow_down, Ramp::quick_stop};
    set.reaction = kRamps[reaction];
  }
  return set;
}

}  // namespace cia402::sim
