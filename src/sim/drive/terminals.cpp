// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/terminals.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sim/drive/core.h"

namespace cia402::sim {
namespace {

constexpr std::uint64_t kLogicLow = 0, kLogicHigh = 1, kLogicRising = 1;  // the last: virtual ones
constexpr std::uint64_t kTerminalRising = 2, kTerminalFalling = 3, kTerminalBoth = 4;
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
  return entry == nullptr ? 0 : entry->acting();
}

bool Terminals::holds(fieldbus::ObjectId id) const {
  const auto is = [&](const TerminalsDefinition::Input& input) {
    return input.function == id || input.logic == id || input.is_output == id;
  };
  const auto any = [&](const auto& list) { return std::any_of(list.begin(), list.end(), is); };
  return any(definition_.with_terminal) || any(definition_.without) || definition_.levels == id ||
         definition_.enabled == id || definition_.inversion == id;
}

InputFunction Terminals::functionOf(const TerminalsDefinition::Input& input) const {
  const auto known = definition_.functions.find(static_cast<std::int64_t>(number(input.function)));
  return known == definition_.functions.end() ? InputFunction::none : known->second;
}

/// A terminal may be an output instead.
bool Terminals::isInput(const TerminalsDefinition::Input& input) const {
  return !input.is_output || number(*input.is_output) == 0;
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

/// Where an input stands in digital_inputs, if it has a place of its own there.
std::optional<unsigned> Terminals::bitOf(std::size_t input) const {
  if (input >= definition_.bits.size()) return std::nullopt;
  return definition_.bits[input];
}

void Terminals::connect(AxisSwitches& switches) const {
  std::vector<AxisSwitches::Terminal> terminals;
  const bool by_bits = definition_.inversion.has_value();
  const std::uint64_t turned =
      by_bits ? number(*definition_.inversion) ^ definition_.normally_closed : 0;
  for (const auto& input : definition_.with_terminal) {
    const HomingInput at = isInput(input) ? switchOf(functionOf(input)) : HomingInput::none;
    const std::optional<unsigned> bit = bitOf(terminals.size());
    const bool low = !by_bits && !bit && number(input.logic) == kLogicLow;
    const bool high = !definition_.bits.empty() && number(input.logic) == kLogicHigh;
    const bool reversed = ((turned >> terminals.size()) & 1U) != 0 || high;
    terminals.push_back({at, low, reversed, bit});
  }
  if (definition_.empty()) return;
  if (!definition_.bits.empty()) switches.showBits();
  switches.connect(std::move(terminals));
  if (by_bits) switches.showFunctions(definition_.first_bit);
}

std::uint64_t Terminals::levels() const {
  const bool enabled = !definition_.enabled || number(*definition_.enabled) != 0;
  return enabled && definition_.levels ? number(*definition_.levels) : 0;
}

void Terminals::start(DriveCore& core) {
  levels_ = levels();
  inputs_ = core.obstacle().inputs();
  doubled_ = false;
  connect(core.motion().switches());
  core.motion().parts().maker.setInputs(active(InputFunction::motor_enable),
                                        active(InputFunction::pause));
}

bool Terminals::active(InputFunction function) const {
  for (std::size_t i = 0; i < definition_.with_terminal.size(); ++i) {
    const auto& input = definition_.with_terminal[i];
    const bool high = ((inputs_ >> bitOf(i).value_or(i)) & 1U) != 0;
    const std::uint64_t logic = number(input.logic);
    const bool on =
        bitOf(i) ? high : (logic == kLogicLow && !high) || (logic == kLogicHigh && high);
    if (on && isInput(input) && functionOf(input) == function) return true;
  }
  for (std::size_t i = 0; i < definition_.without.size(); ++i) {
    const auto& input = definition_.without[i];
    const bool on = ((levels_ >> i) & 1U) != 0 && number(input.logic) == kLogicLow;  // active high
    if (on && functionOf(input) == function) return true;
  }
  return false;
}

/// Of inputs with a terminal.
void Terminals::addEdges(std::uint32_t inputs, Change& change) const {
  for (std::size_t i = 0; i < definition_.with_terminal.size(); ++i) {
    const auto& input = definition_.with_terminal[i];
    const std::size_t bit = bitOf(i).value_or(i);
    const bool was = ((inputs_ >> bit) & 1U) != 0, is = ((inputs >> bit) & 1U) != 0;
    const std::uint64_t logic = number(input.logic);
    const bool by_edge = logic == kTerminalRising || logic == kTerminalBoth;
    const bool rises = is && !was && (by_edge || bitOf(i));
    const bool falls = was && !is && (logic == kTerminalFalling || logic == kTerminalBoth);
    const InputFunction function = isInput(input) ? functionOf(input) : InputFunction::none;
    if ((rises || falls) && function != InputFunction::none) change.edges.push_back(function);
  }
}

Terminals::Change Terminals::look(AxisSwitches& switches, std::uint32_t inputs) {
  Change change;
  addEdges(inputs, change);
  inputs_ = inputs;
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
  change.enabled = active(InputFunction::motor_enable);
  change.paused = active(InputFunction::pause);
  return change;
}

void obey(Terminals& terminals, DriveCore& core, ObjectDictionary& dictionary,
          const FaultDefinition* doubled) {
  const Terminals::Change change =
      terminals.look(core.motion().switches(), core.obstacle().inputs());
  MakerModes& maker = core.motion().parts().maker;
  maker.setInputs(change.enabled, change.paused);
  for (const InputFunction function : change.edges) {
    if (function == InputFunction::set_home) core.onWrite(Role::save_zero);
    if (function == InputFunction::fault_reset) core.resetFault();
    if (function == InputFunction::step) maker.trigger();
    if (function == InputFunction::emergency_stop) core.onWrite(Role::emergency_stop);
    Entry* history = dictionary.find(kErrorsKept);
    if (function == InputFunction::clear_history && history != nullptr) history->number = 0;
  }
  if (change.doubled && doubled != nullptr) core.raise(*doubled);
  if (change.mended && (core.statusword() & kTerminalStateBits) != kInFault) core.resetFault();
}

}  // namespace cia402::sim
