// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>

#include "cia402_driver/common/time.h"
#include "drive/profile/disabling.h"

namespace cia402::drive {

/// Does this transition of CiA 402-2 lead on the way out of operation? 5, and 8 to 12
bool endsOperation(int transition);

/// How long a drive may take for what it is told: `timing` of a profile.
struct DriveTiming {
  Duration state_change{std::chrono::seconds(2)};  ///< what is not named in `transitions`
  std::map<int, Duration> transitions;             ///< by their number in CiA 402-2, 2 to 16
  /// For a transition to be shown by the statusword. @param number -1: of whatever comes next
  Duration transition(int number) const;
  /// The same at the most, with `power_off` where that transition ends operation.
  Duration longest(int number) const;
  /// From operation enabled to switch on disabled, if that is one step; or one after the other.
  Duration disabling(const Disabling& by) const;
  Duration disablingInTurn(const Disabling& by) const;
  Duration mode_change{std::chrono::seconds(1)};
  /// Operation enabled until set-points are followed: 0 to 60 s. With `brake_object` the longest
  /// that this object may say, and what counts where it cannot be read.
  Duration brake_release{0};
  std::string brake_object;  ///< holds that time; by its name in the profile, quantity time
  /// How much longer than otherwise transitions 5 and 8 to 12 may take, as a brake closes first.
  Duration power_off{0};
  std::string power_object;  ///< holds that time, which is at most `power_off`
  std::array<const std::string*, 2> told() const { return {&brake_object, &power_object}; }
};

}  // namespace cia402::drive
