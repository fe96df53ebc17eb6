// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cia402::drive {

/// A bit of the statusword without which the drive does not do what it is told.
struct StatusNeed {
  unsigned bit = 0;
  bool set = true;            ///< what it must be
  bool in_operation = false;  ///< it says something only in operation enabled
  std::string text, remedy;   ///< what it means otherwise, and what to do then
};

/// A number of the drive that people are warned of while it is out of its range.
struct ValueWatch {
  std::string object;            ///< by its name in the profile, with a quantity
  double low = 0.0, high = 0.0;  ///< in the joint's units
  std::string text, remedy;
};

/// What of a drive is looked at while it works, by its profile.
struct Supervision {
  std::vector<StatusNeed> needs;         ///< before any motion
  std::vector<ValueWatch> watches;       ///< read once a second
  std::vector<std::string> fault_reads;  ///< once at each fault: by name, or "1001:00"
  std::vector<std::string> boot_reads;   ///< once at each boot: by name

  /// What forbids motion; nullptr: nothing does. @param operating in operation enabled
  const StatusNeed* unmet(std::uint16_t statusword, bool operating) const {
    for (const StatusNeed& need : needs) {
      if (need.in_operation && !operating) continue;
      if ((((statusword >> need.bit) & 1U) != 0) != need.set) return &need;
    }
    return nullptr;
  }
};

}  // namespace cia402::drive
