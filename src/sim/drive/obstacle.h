// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/drive/state_machine.h"

namespace cia402::sim {

/// What keeps an axis from being switched on, and the inputs that somebody has set.
class Obstacle {
 public:
  /// @param definition nullptr: nothing does any more
  void put(const ObstacleDefinition* definition) { definition_ = definition; }
  void setInput(unsigned bit, bool on) {
    const std::uint32_t mask = std::uint32_t{1} << bit;
    inputs_ = on ? inputs_ | mask : inputs_ & ~mask;
  }
  /// Transitions 2, 3 and 4 do not happen.
  bool forbids(const PdsTransition& transition) const {
    return definition_ != nullptr && transition.number >= 2 && transition.number <= 4;
  }
  bool stands() const { return definition_ != nullptr; }
  bool voltage() const { return definition_ == nullptr || definition_->voltage; }
  bool remote() const { return definition_ == nullptr || definition_->remote; }
  std::int64_t reason() const { return definition_ == nullptr ? 0 : definition_->reason; }
  /// Bits of 60FDh.
  std::uint32_t inputs() const {
    return inputs_ | (definition_ == nullptr ? 0U : definition_->inputs);
  }

 private:
  const ObstacleDefinition* definition_ = nullptr;
  std::uint32_t inputs_ = 0;
};

}  // namespace cia402::sim
