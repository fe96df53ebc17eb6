// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/timing.h"

#include <algorithm>

namespace cia402::drive {

bool endsOperation(int transition) {
  return transition == 5 || (transition > 7 && transition < 13);
}

Duration DriveTiming::transition(int number) const {
  const auto own = transitions.find(number);
  return own != transitions.end() ? own->second : state_change;
}

Duration DriveTiming::longest(int number) const {
  return transition(number) + (endsOperation(number) ? power_off : Duration(0));
}

Duration DriveTiming::disabling(const Disabling& by) const {
  Duration time{0};
  for (const int number : by.transitions()) time = std::max(time, longest(number));
  return time;
}

Duration DriveTiming::disablingInTurn(const Disabling& by) const {
  Duration time{0};
  for (const int number : by.transitions()) time += longest(number);
  return time;
}

}  // namespace cia402::drive
