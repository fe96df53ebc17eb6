// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// By which transitions a drive is disabled.
#include <algorithm>
#include <array>

#include "config/profile/parts.h"

namespace cia402::config {

drive::Disabling readDisabling(const yaml::Value& value) {
  constexpr std::array<drive::Disabling, 4> kWays{{{5, 10}, {5, 6}, {8, 10}, {9, 10}}};
  std::vector<int> wanted;
  for (const yaml::Value& entry : value.list()) {
    const auto number = entry.integer(2, 16);
    if (number) wanted.push_back(static_cast<int>(*number));
  }
  const auto way = std::find_if(kWays.begin(), kWays.end(), [&](const drive::Disabling& known) {
    return known.transitions() == wanted;
  });
  if (way != kWays.end()) return *way;
  value.problem(
      "from operation enabled to switch on disabled there are the transitions [5, 10], "
      "[5, 6, 7], [8, 7] and [9]");
  return {};
}

}  // namespace cia402::config
