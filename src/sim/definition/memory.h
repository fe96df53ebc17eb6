// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "fieldbus/object.h"

namespace cia402::sim {

/// What a drive keeps without power, besides 1010h and 1011h, and what of it makes it silent.
struct MemoryDefinition {
  /// While this object is not 0, each write to an object of the maker stays.
  std::optional<fieldbus::ObjectId> keeps;
  /// Objects that bring the factory's values back at once, by these numbers.
  std::map<fieldbus::ObjectId, std::int64_t> reset;
  /// The factory's numbers, where `dictionary` has what a person sets before there is a bus.
  std::map<fieldbus::ObjectId, std::int64_t> factory;
  /// Switched on with other numbers in these, it is deaf and mute.
  std::map<fieldbus::ObjectId, std::int64_t> silent_unless;
};

}  // namespace cia402::sim
