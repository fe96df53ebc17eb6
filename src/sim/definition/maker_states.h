// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "fieldbus/object.h"

namespace cia402::sim {

/// An object of the maker's own that tells the state of the first axis.
struct MakerStates {
  std::optional<fieldbus::ObjectId> object;
  std::int64_t not_ready = 0;  ///< it initialises itself
  std::int64_t ready = 1;      ///< it could be switched on, or is, without power at the motor
  std::int64_t running = 2;    ///< the motor has power
  std::int64_t fault = 12;
};

}  // namespace cia402::sim
