// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "campaign/random.h"

namespace cia402::campaign {

/// What an axis of the generic drive does otherwise, and what its profile says of that.
struct Habits {
  std::string simulation;  ///< keys of `with`: "quirks: {...}, communication: {...}"; empty: none
  std::string profile;     ///< keys on top of the profile, a flow mapping; empty: none
};

/// One to three habits of drives in the field that can be those of one drive.
Habits drawHabits(Random& random);

}  // namespace cia402::campaign
