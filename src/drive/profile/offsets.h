// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace cia402::drive {

/// Objects that a cyclic mode adds to what its loops demand (CiA 402-2, 60B1h and 60B2h), by name;
/// empty: it has none.
struct OffsetObjects {
  std::string velocity;  ///< of a mode of positions only: added to the demand of the velocity loop
  std::string torque;    ///< added to the demand of the torque
};

/// What an axis sends in them: known of the set-point, so that the drive need not wait for an
/// error.
struct FeedForward {
  double velocity = 0.0;  ///< 0 to 2; of the velocity of the set-point
  double inertia = 0.0;   ///< kg m^2, or kg: times the set-point's acceleration it is the effort
  bool any() const { return velocity != 0.0 || inertia != 0.0; }
};

/// Of the objects of a mode those in which something is sent.
inline std::vector<std::string> offsetsSent(const OffsetObjects& objects,
                                            const FeedForward& feed_forward) {
  std::vector<std::string> sent;
  if (feed_forward.velocity != 0.0 && !objects.velocity.empty()) sent.push_back(objects.velocity);
  if (feed_forward.inertia != 0.0 && !objects.torque.empty()) sent.push_back(objects.torque);
  return sent;
}

}  // namespace cia402::drive
