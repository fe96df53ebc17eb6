// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>

#include "fieldbus/object.h"

namespace cia402::sim {

/// When the drive goes by the number that was written into an object; it shows it at once, but for
/// `never`.
enum class Effect : std::uint8_t {
  power,  ///< once its power was off
  stop,   ///< once no motor of it has power
  never,  ///< while a motor of it has power: the write is taken and changes nothing
};

/// Of integers; all others count at once.
using Effects = std::map<fieldbus::ObjectId, Effect>;

}  // namespace cia402::sim
