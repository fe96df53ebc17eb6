// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/config.h"

#include <algorithm>

namespace cia402::drive {
namespace {

constexpr double kDefaultDeceleration = 5.0;        // rad/s²
constexpr double kDefaultLinearDeceleration = 0.5;  // m/s²

bool hasAlias(const AxisConfig& axis) { return !axis.joint.empty() && axis.joint != axis.name; }

}  // namespace

void tune(AxisConfig& axis, const AxisConfig& next) {
  axis.command_timeout = next.command_timeout;
  axis.position_loop = next.position_loop;
}

void adopt(AxisConfig& axis, const AxisConfig& next) {
  axis.limits = next.limits;
  axis.homing = next.homing;
}

motion::JointLimits limitsOf(const AxisConfig& axis) {
  motion::JointLimits limits = axis.limits;
  limits.continuous = axis.geometry.type == AxisGeometry::Type::continuous;
  return limits;
}

motion::Joint jointOf(const AxisConfig& axis) {
  motion::Joint joint;
  joint.name = axis.joint;
  joint.limits = limitsOf(axis);
  joint.unit = axis.geometry.prismatic() ? motion::JointUnit::metre : motion::JointUnit::radian;
  joint.deceleration = stopDeceleration(axis);
  return joint;
}

double stopDeceleration(const AxisConfig& axis) {
  if (axis.limits.acceleration) return *axis.limits.acceleration;
  return axis.geometry.prismatic() ? kDefaultLinearDeceleration : kDefaultDeceleration;
}

std::string jointName(const AxisConfig& axis) {
  return hasAlias(axis) ? axis.joint + " (axis " + axis.name + ")" : axis.name;
}

std::string whoIs(const AxisConfig& axis) { return whoIs(axis, axis.place); }

std::string whoIs(const AxisConfig& axis, const std::string& place) {
  return hasAlias(axis) ? axis.joint + " (axis " + axis.name + ", " + place + ")"
                        : axis.name + " (" + place + ")";
}

bool saidToLack(const AxisConfig& axis, const std::string& object) {
  if (axis.lacks.empty()) return false;
  const ObjectSpec* known = findObject(*axis.profile, object);
  const std::string& name = known != nullptr ? known->name : object;
  return std::find(axis.lacks.begin(), axis.lacks.end(), name) != axis.lacks.end();
}

std::string doubtOf(const AxisConfig& axis, ObjectId id) {
  const std::string* doubt = axis.profile->doubtful.find(id);
  if (doubt == nullptr) return {};
  if (std::find(axis.trusted.begin(), axis.trusted.end(), id) != axis.trusted.end()) return {};
  return "it is not known what a number in it means (" + *doubt + "); whoever does gives axes/" +
         axis.name + " `trusted: [\"" + fieldbus::toString(id) + "\"]`";
}

const ModeSpec* trajectoryMode(const AxisConfig& axis) {
  const DriveProfile& profile = *axis.profile;
  const auto sent = [&](const std::string& target) {
    return std::find(axis.outputs.begin(), axis.outputs.end(), target) != axis.outputs.end();
  };
  const auto follows = [&](const ModeSpec& mode) {
    return mode.cyclic && mode.kind == ControlKind::position && sent(mode.target) &&
           (!mode.set_point_stream || sent(mode.set_point_stream->speed));
  };
  const ModeSpec* start = profile.mode(axis.mode);
  if (start != nullptr && follows(*start)) return start;
  const auto found = std::find_if(profile.modes.begin(), profile.modes.end(), follows);
  return found == profile.modes.end() ? nullptr : &*found;
}

}  // namespace cia402::drive
