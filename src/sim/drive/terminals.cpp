// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/terminals.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sim/drive/core.h"

namespace cia402::sim {
namespace {

constexpr std::uint64_t kLogicLow = 0, kLogicRising = 1;  // logic
constexpr fieldbus::ObjectId kErrorsKept{0x1003, 0};
constexpr std::uint16_t kTerminalStateBits = 0x004F, kInFault = 0x0008;

HomingInput switchOf(InputFunction function) {
  switch (function) {
    case InputFunction::negative_limit:
      return HomingInput::negative_limit;
    case InputFunction::positive_limit:
      return HomingInput::positive_limit;
    case InputFunction::home_switch:
      return HomingInput::home_switch;
    default:
      return HomingInput::none;
  }
}

}  // namespace

std::uint64_t Terminals::number(fieldbus::ObjectId id) const {
  const Entry* entry = dictionary_.find(id);
  return entry == nullptr ? 0 : entry->number;
}

bool Terminals::holds(fieldbus::ObjectId id) const {
  const auto is = [&](const TerminalsDefinition::Input& input) {
    return input.function == id || input.logic == id;
  };
  const auto any = [&](const auto& list) { return std::any_of(list.begin(), list.end(), is); };
  return any(definition_.with_terminal) || any(definition_.without) || definition_.levels == id ||
         definition_.enabled == id || definition_.inversion == id;
}

InputFunction Terminals::functionOf(const TerminalsDefinition::Input& input) const {
  const auto known = definition_.functions.find(static_cast<std::int64_t>(number(input.function)));
  return known == definition_.functions.end() ? InputFunction::none : known->second;
}

/// Each function but 0 may stand once, over all inputs.
bool Terminals::twice() const {
  std::vector<std::uint64_t> numbers;
  for (const auto* list : {&definition_.with_terminal, &definition_.without}) {
    for (const auto& input : *list) numbers.push_back(number(input.function));
  }
  numbers.erase(std::remove(numbers.begin(), numbers.end(), std::uint64_t{0}), numbers.end());
  std::sort(numbers.begin(), numbers.end());
  return std::adjacent_find(numbers.begin(), numbers.end()) != numbers.end();
}

void Terminals::connect(AxisSwitches& switches) const {
  std::vector<AxisSwitches::Terminal> terminals;
  const bool by_bits = definition_.inversion.has_value();
  const std::uint64_t turned =
      by_bits ? number(*definition_.inversion) ^ definition_.normally_closed : 0;
  for (const auto& input : definition_.with_terminal) {
    const bool low = !by_bits && number(input.logic) == kLogicLow;
    const bool reversed = ((turned >> terminals.size()) & 1U) != 0;
    terminals.push_back({switchOf(functionOf(input)), low, reversed});
  }
  if (definition_.empty()) return;
  switches.connect(std::move(terminals));
  if (by_bits) switches.showFunctions(definition_.first_bit);
}

std::uint64_t Terminals::levels() const {
  const bool enabled = !definition_.enabled || number(*definition_.enabled) != 0;
  return enabled && definition_.levels ? number(*definition_.levels) : 0;
}

void Terminals::start(AxisSwitches& switches) {
  levels_ = levels();
  doubled_ = false;
  connect(switches);
}

Terminals::Change Terminals::look(AxisSwitches& switches) {
  Change change;
  const std::uint64_t now = levels(), rising = now & ~levels_;
  levels_ = now;
  Entry* seen = definition_.seen ? dictionary_.find(*definition_.seen) : nullptr;
  if (seen != nullptr) seen->number = now;
  for (std::size_t i = 0; i < definition_.without.size(); ++i) {
    const auto& input = definition_.without[i];
    const InputFunction function = functionOf(input);
    const bool triggered = ((rising >> i) & 1U) != 0 && number(input.logic) == kLogicRising;
    if (triggered && function != InputFunction::none) change.edges.push_back(function);
  }
  connect(switches);
  const bool doubled = twice();
  change.doubled = doubled && !doubled_;
  change.mended = doubled_ && !doubled;
  doubled_ = doubled;
  return change;
}

void obey(const Terminals::Change& change, DriveCore& core, ObjectDictionary& dictionary,
          const FaultDefinition* doubled) {
  for (const InputFunction function : change.edges) {
    if (function == InputFunction::set_home) core.onWrite(Role::save_zero);
    if (function == InputFunction::fault_reset) core.resetFault();
    Entry* history = dictionary.find(kErrorsKept);
    if (function == InputFunction::clear_history && history != nullptr) history->number = 0;
  }
  if (change.doubled && doubled != nullptr) core.raise(*doubled);
  if (change.mended && (core.statusword() & kTerminalStateBits) != kInFault) core.resetFault();
}

}  // namespace cia402::sim
