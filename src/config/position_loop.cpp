// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "config/profile/parts.h"
#include "config/robot_parts.h"
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
  const auto& modes = axis.profile->modes;
  const auto mode = std::find_if(modes.begin(), modes.end(), [](const ModeSpec& candidate) {
    return candidate.position_loop.has_value();
  });
  if (mode == modes.end()) {
    if (!value) return;
    value->problem("profile " + axis.profile->name +
                   " has no mode whose position loop the driver closes; remove the section");
    return;
  }
  axis.position_loop = value ? readPositionLoop(*value, *mode->position_loop) : mode->position_loop;
  const bool used = axis.mode == mode->name ||
                    std::find(axis.modes.begin(), axis.modes.end(), mode->name) != axis.modes.end();
  const double cycle = toSeconds(axis.cycle), most = PositionLoop::kLargestStep / cycle;
  if (!used || axis.position_loop->gain <= most * (1.0 + 1e-9)) return;
  value.value_or(section.value())
      .problem("position_loop/gain " + motion::formatNumber(axis.position_loop->gain) +
               " 1/s would oscillate with a cycle of " + motion::formatNumber(cycle) +
               " s: what is sent shows in the feedback three cycles later; give at most " +
               motion::formatNumber(most) + ", or make sync_period shorter");
}

}  // namespace cia402::config
