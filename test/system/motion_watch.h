// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "system/scene.h"

namespace cia402 {

/// The greatest change of acceleration over 20 ms, rad/s^3. @param speeds rad/s, one a millisecond
inline double greatestJerk(const std::vector<double>& speeds) {
  constexpr std::size_t kApart = 20;
  double most = 0.0;
  for (std::size_t i = 2 * kApart; i < speeds.size(); ++i) {
    const double change = speeds[i] - 2.0 * speeds[i - kApart] + speeds[i - 2 * kApart];
    most = std::max(most, std::fabs(change) / (0.02 * 0.02));
  }
  return most;
}

/// What the motor did, looked at every millisecond.
class Motion {
 public:
  Motion(Scene& scene, std::string axis) : scene_(scene), axis_(std::move(axis)) {
    scene_.watch([this] { look(); });
  }
  void forget() {
    fastest = hardest = strongest = 0.0;
    velocities_.clear();
  }
  double fastest = 0.0, hardest = 0.0;  // rad/s, rad/s^2 over 8 ms
  double strongest = 0.0;               // 6077h as its number

 private:
  void look() {
    const double velocity = scene_.velocity(axis_);
    velocities_.push_back(velocity);
    if (velocities_.size() > 9) velocities_.pop_front();
    fastest = std::max(fastest, std::abs(velocity));
    if (velocities_.size() == 9) {
      hardest = std::max(hardest, std::abs(velocity - velocities_.front()) / 0.008);
    }
    const auto* torque = scene_.drive(axis_).dictionary().find({0x6077, 0});
    if (torque == nullptr) return;
    if (torque->type == fieldbus::DataType::int16) {
      strongest = std::max(
          strongest, std::abs(static_cast<double>(static_cast<std::int16_t>(torque->number))));
    } else {
      float value = 0.0F;
      const auto bits = static_cast<std::uint32_t>(torque->number);
      std::memcpy(&value, &bits, sizeof value);
      strongest = std::max(strongest, std::abs(static_cast<double>(value)));
    }
  }
  Scene& scene_;
  std::string axis_;
  std::deque<double> velocities_;
};

}  // namespace cia402
