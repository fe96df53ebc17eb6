// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "system/families_motion.h"

namespace cia402 {

constexpr FamilyMode kId286InPp{kId286Cnfa, "10000", "pp"}, kId286InPv{kId286Cnfa, "10000", "pv"},
    kId286InPt{kId286Cnfa, "10000", "pt"};

/// Each number once, as long as it stays the same.
inline void appendChange(std::vector<std::uint64_t>& words, std::uint64_t word) {
  if (words.empty() || words.back() != word) words.push_back(word);
}

/// The controlwords and statuswords of node 1 as they cross the bus by PDO or SDO, and what stands
/// in the drive at every millisecond.
struct Id286Trace : Scene {
  explicit Id286Trace(const std::string& yaml) : Scene(loadText(yaml)) {
    watch([this] { look(); });
  }
  void look() {
    appendChange(controlwords, number(0x6040));
    appendChange(statuswords, truth("joint").statusword);
  }
  std::uint64_t number(std::uint16_t index, std::uint8_t subindex = 0) {
    return drive("joint").dictionary().find({index, subindex})->number;
  }
  /// From now on.
  void clear() {
    controlwords.clear();
    statuswords.clear();
  }

  std::vector<std::uint64_t> controlwords, statuswords;
};

}  // namespace cia402
