// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "config/robot_parts.h"
#include "config/tuned_mode.h"

namespace cia402::config {

using drive::AxisConfig;
using drive::ModeSpec;

void readFeedForward(yaml::Section& axis_section, AxisConfig& axis) {
  const auto value = axis_section.get("feed_forward");
  if (!value) return;
  yaml::Section section(*value);
  section.read("velocity", axis.feed_forward.velocity, yaml::Range{0.0, 2.0, false});
  section.read("inertia", axis.feed_forward.inertia, yaml::Range{0.0, 1e6, false});
  section.finish();
}

void checkFeedForward(yaml::Section& axis_section, const AxisConfig& axis) {
  const auto value = axis_section.get("feed_forward");
  if (!value || !axis.profile || !axis.feed_forward.any()) return;
  const drive::DriveProfile& profile = *axis.profile;
  const auto served = [&](const ModeSpec& mode) {
    return canBeIn(axis, mode) && !drive::offsetsSent(mode.offsets, axis.feed_forward).empty();
  };
  bool any = false;
  for (const ModeSpec& mode : profile.modes) {
    if (!served(mode)) continue;
    any = true;
    for (const std::string& name : drive::offsetsSent(mode.offsets, axis.feed_forward)) {
      const bool sent =
          std::find(axis.outputs.begin(), axis.outputs.end(), name) != axis.outputs.end();
      if (!sent) {
        value->problem("mode `" + mode.name + "` needs `" + name +
                       "` in an RPDO; add it to `pdos`, or leave `feed_forward` out");
      }
    }
  }
  if (!any) {
    value->problem("no mode of the axis has objects for it (`offsets` of profile " + profile.name +
                   "): leave it out");
  }
  if (axis.feed_forward.inertia != 0.0 && axis.geometry.rated_torque <= 0.0) {
    value->problem("`inertia` needs `rated_torque` (N m at the motor shaft)");
  }
}

}  // namespace cia402::config
