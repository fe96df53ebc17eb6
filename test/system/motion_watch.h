// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <string>
#include <utility>

#include "system/scene.h"

namespace cia402 {

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
