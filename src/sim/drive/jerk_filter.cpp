// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/jerk_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "sim/drive/motor.h"

namespace cia402::sim {
namespace {

constexpr double kLongest = 10.0;  // s

}  // namespace

void JerkFilter::reset(double position) {
  positions_.assign(positions_.size(), position);
  last_ = position;
}

void JerkFilter::limit(double seconds) {
  const double wanted = std::clamp(seconds, kDriveStepS, kLongest);
  const auto steps = static_cast<std::size_t>(std::ceil(wanted / kDriveStepS));
  while (positions_.size() > steps) positions_.pop_front();
  while (positions_.size() < steps) positions_.push_front(positions_.front());
}

double JerkFilter::step(double position) {
  positions_.pop_front();
  positions_.push_back(position);
  const bool stands = position == last_ && positions_.front() == position;
  last_ = position;
  if (stands) return position;  // without the rounding of a mean
  return std::accumulate(positions_.begin(), positions_.end(), 0.0) /
         static_cast<double>(positions_.size());
}

}  // namespace cia402::sim
