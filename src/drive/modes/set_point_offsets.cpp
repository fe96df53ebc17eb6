// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/set_point_offsets.h"

#include <algorithm>

namespace cia402::drive {

void SetPointOffsets::put(const ModeChannel::Offset& offset, double value) {
  if (!offset.output.mapped()) return;
  const Conversion& conversion = offset.conversion;
  std::uint64_t raw = 0;
  const double fits = std::clamp(value, conversion.lowest(), conversion.highest());
  axis_.image.setOutput(offset.output.slot, conversion.toDevice(fits, raw) ? raw : 0);
}

void SetPointOffsets::set(double velocity) {
  const FeedForward& feed = axis_.config.feed_forward;
  put(velocity_, feed.velocity * velocity);
  put(torque_, feed.inertia * (velocity - before_) / toSeconds(axis_.config.cycle));
  before_ = velocity;
}

void SetPointOffsets::clear() {
  put(velocity_, 0.0);
  put(torque_, 0.0);
  before_ = 0.0;
}

}  // namespace cia402::drive
