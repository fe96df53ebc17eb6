// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "campaign/random.h"

namespace cia402::campaign {

struct AxisPlan;

/// Two axes that move joints together.
struct CouplingPlan {
  std::array<std::size_t, 2> axes{};
  bool gantry = false;
  std::vector<std::string> joints;
  std::string yaml;  ///< of `couplings:`, a flow mapping on one line
};

/// Joints of two axes, with limits that those of the axes permit: two by a random matrix, or the
/// one of a gantry.
/// @pre the axes are planned, those of a gantry alike
CouplingPlan planCoupling(Random& random, const std::vector<AxisPlan>& axes,
                          const std::array<std::size_t, 2>& members, bool gantry);

}  // namespace cia402::campaign
