// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/profile/parts.h"
#include "config/robot_parts.h"
#include "config/tuned_mode.h"
#include "motion/joint.h"

namespace cia402::config {

using drive::AxisConfig;
using drive::ModeSpec;
using drive::PositionLoop;

PositionLoop readPositionLoop(const yaml::Value& value, PositionLoop loop) {
  yaml::Section section(value);
  section.read("gain", loop.gain, yaml::Range{0.0, 100.0, true});
  section.read("feed_forward", loop.feed_forward, yaml::Range{0.0, 2.0, false});
  section.finish();
  return loop;
}

void tunePositionLoop(yaml::Section& section, AxisConfig& axis) {
  const auto value = section.get("position_loop");
  if (!axis.profile) return;
  const ModeSpec* const mode =
      tunedMode(axis, &ModeSpec::position_loop, value, "whose position loop the driver closes");
  if (mode == nullptr) return;
  axis.position_loop = value ? readPositionLoop(*value, *mode->position_loop) : mode->position_loop;
  const double cycle = toSeconds(axis.cycle), most = PositionLoop::kLargestStep / cycle;
  if (!canBeIn(axis, *mode) || axis.position_loop->gain <= most * (1.0 + 1e-9)) return;
  value.value_or(section.value())
      .problem("position_loop/gain " + motion::formatNumber(axis.position_loop->gain) +
               " 1/s would oscillate with a cycle of " + motion::formatNumber(cycle) +
               " s: what is sent shows in the feedback three cycles later; give at most " +
               motion::formatNumber(most) + ", or make sync_period shorter");
}

}  // namespace cia402::config
