// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "bus/fixed_text.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// What is said of an axis in words; changes seldom.
struct AxisWords {
  std::uint32_t version = 0;  ///< grows with every change
  FixedText<160> stale;       ///< TPDOs overdue at present; empty if none
  FixedText<96> step;         ///< of the procedure or of the node's boot
  FixedText<160> waiting_for;
  FixedText<256> history;  ///< the drive's own error list, read after its last fault
  FixedText<384> problem;  ///< fault, warning or node problem; empty if well
  FixedText<192> stream;   ///< a stream of set-points that has dried up, while it lasts
  FixedText<384> boot;     ///< what the last boot that succeeded found, its warnings first
  FixedText<384> last;  ///< the last problem, or what the axis did by itself; stays when it is over
  Time last_at{};       ///< when that began

  template <std::size_t N>
  void say(FixedText<N> AxisWords::*what, std::string_view text) {
    const FixedText<N> said(text);
    if (this->*what == said.view()) return;
    this->*what = said;
    ++version;
  }
  /// It has got a problem.
  void remember(std::string_view text, Time now) {
    last.assign(text);
    last_at = now;
    ++version;
  }
};

}  // namespace cia402::bus
