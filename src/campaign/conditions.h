// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::campaign {

/// What is wrong with the world, and until when it counts. Each entry excuses one narrow thing;
/// docs/campaign.md says which and why.
struct Conditions {
  /// What is wrong with one axis.
  struct Axis {
    Time may_coast{};  ///< until then its power may go by itself: a fault that coasts, no supply
    Time blocked{};    ///< until then rotor and demand may lie apart: blocked, or just let go
    Time unheard{};    ///< until then the driver may not hear it
    Time cut_off{};    ///< until then commands may not reach it, or its answers not the driver
  };
  std::vector<Axis> axes;
  Time lossy{};        ///< until then frames may be lost, late or doubled
  Time foreign{};      ///< until then others send SYNC or NMT
  Time host_late{};    ///< until then the host stands still or is late, a little longer
  Time ended{};        ///< until then the driver is shutting down, or has ended
  Duration stalled{};  ///< how long the host has stood still or been dead so far

  static void extend(Time& what, Time until) { what = std::max(what, until); }
  bool quiet(std::size_t axis, Time now) const {
    return now >= lossy && now >= foreign && now >= host_late && now >= axes[axis].cut_off &&
           now >= axes[axis].blocked;
  }
};

}  // namespace cia402::campaign
