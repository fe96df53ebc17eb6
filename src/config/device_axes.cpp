// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Several axes in one device (CiA 402-2).
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

/// What an axis says of the device that it sits in.
constexpr const char* kDeviceKeys[] = {"drive",
                                       "eds",
                                       "identity",
                                       "lss",
                                       "error_control",
                                       "sdo",
                                       "optional",
                                       "restore_before_configure",
                                       "configuration_check",
                                       "boot",
                                       "stale_after",
                                       "rpdo_timeout",
                                       "half_floats"};

/// Another axis in the same device, nullptr if there is none. @param same_number that has the very
/// `device_axis`
const drive::AxisConfig* neighbour(const RobotConfig& robot, const AxisDraft& draft,
                                   bool same_number) {
  for (const drive::AxisConfig& other : robot.axes) {
    if (robot.deviceOf(other).node_id != draft.device.node_id) continue;
    if (!same_number || other.device_axis == draft.axis.device_axis) return &other;
  }
  return nullptr;
}

}  // namespace

void readPlace(yaml::Section& section, AxisDraft& draft, const RobotConfig& robot) {
  drive::AxisConfig& axis = draft.axis;
  canopen::DeviceConfig& device = draft.device;
  axis.device = robot.devices.size();
  const bool numbered = section.has("device_axis");
  section.readInteger("device_axis", axis.device_axis, 0, drive::kDeviceAxes - 1);
  const auto value = section.require("node_id", "the drive's CANopen node-ID, 1 to 127");
  const auto id = value ? value->integer(1, 127) : std::nullopt;
  if (id) device.node_id = static_cast<canopen::NodeId>(*id);
  axis.place = "node " + std::to_string(device.node_id);
  if (numbered) axis.place += ", axis " + std::to_string(axis.device_axis);
  if (!id) return;
  if (device.node_id == robot.bus.node_id) {
    value->problem(std::to_string(*id) + " is the master's own node-ID (bus/node_id)");
  }
  const drive::AxisConfig* other = neighbour(robot, draft, true);
  if (other != nullptr) {
    value->problem(std::to_string(device.node_id) + " is the node-ID of `" + other->name +
                   "` already; `device_axis`, 0 to 7, tells the axes of one drive apart");
    return;
  }
  other = neighbour(robot, draft, false);
  if (other == nullptr) return;
  draft.first = false;
  axis.device = other->device;
  device = robot.deviceOf(axis);
}

void checkDeviceKeys(yaml::Section& section, const AxisDraft& draft, AxisReading& reading) {
  auto& told = reading.device_keys[draft.axis.device];
  for (const char* key : kDeviceKeys) {
    const auto value = section.get(key);
    if (!value) continue;
    const std::string text = YAML::Dump(value->node());
    if (draft.first) {
      told[key] = text;
    } else if (told[key] != text) {
      value->problem("is of the whole device, and `" + draft.device.name +
                     "`, which sits in it, too, " +
                     (told[key].empty() ? "does not say so: give it there"
                                        : "says something else: say it there only"));
    }
  }
}

}  // namespace cia402::config
