// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "config/node_pdos.h"
#include "config/robot_parts.h"
#include "drive/axis/state_machine.h"
#include "drive/profile/named_write.h"

namespace cia402::config {
namespace {

using canopen::DeviceConfig;
using canopen::NodeConfig;
using drive::AxisConfig;

enum class AskedBy { profile, user };

void addWrites(const std::vector<drive::NamedWrite>& writes, AskedBy who, const AxisConfig& axis,
               const std::string& path, NodeConfig& node, Problems& problems) {
  for (const drive::NamedWrite& write : writes) {
    if (who == AskedBy::profile && drive::saidToLack(axis, write.object)) continue;
    // The axis does that once it is homed; one that need not be is so from the start.
    if (write.when_homed && axis.homing && axis.homing->required) continue;
    const auto resolved = drive::resolveWrite(write, axis);
    if (!resolved) {
      problems.add(path, resolved.error().message);
      continue;
    }
    if (!*resolved || (*resolved)->copied_from) continue;
    canopen::StartupWrite start;
    start.object = (*resolved)->object;
    const drive::ObjectSpec* object = drive::findObject(*axis.profile, write.object);
    if (object != nullptr) start.name = object->name;
    start.data = drive::wireBytes((*resolved)->raw, (*resolved)->type);
    start.optional = (*resolved)->optional;
    start.before_pdos = write.before_pdos;
    start.after_power = axis.profile->after_power.find(start.object) != nullptr;
    start.by_default = who == AskedBy::profile && !(*resolved)->asked_for;
    node.writes.push_back(start);
  }
}

/// A drive that is still enabled from before must not be configured under way, and many refuse it:
/// it is told to stop and switch off first (controlword: quick stop).
void addStop(const drive::DriveProfile& profile, NodeConfig& node) {
  const drive::ObjectSpec* controlword = profile.find("controlword");
  if (controlword == nullptr) return;
  canopen::StartupWrite stop;
  stop.object = controlword->id;
  stop.name = controlword->name;
  stop.data = drive::wireBytes(drive::controlword::kQuickStopCommand, controlword->type);
  stop.optional = true;
  stop.only_if_different = false;  // one answer sooner
  stop.always = true;
  node.writes.push_back(stop);
}

/// A number of one means the same in the other.
bool alike(const drive::ObjectSpec& a, const drive::ObjectSpec& b) {
  return a.quantity == b.quantity && a.type == b.type && a.encoding == b.encoding &&
         a.factor == b.factor && !a.unit && !b.unit;
}

/// A motor that turns as a driver has told it that is gone is stopped before all else: by the mode
/// that brakes such ones, where a stop would only let it go.
void addBrakes(const drive::AxisConfig& axis, canopen::NodeConfig& node) {
  const drive::DriveProfile& profile = *axis.profile;
  const drive::ObjectSpec* const statusword = profile.find("statusword");
  const drive::ObjectSpec* const shown = profile.find("mode_display");
  const drive::ObjectSpec* const mode = profile.find("mode_of_operation");
  const drive::ObjectSpec* const velocity = profile.find("velocity_actual");
  if (!statusword) return;
  canopen::BootBrake plain;
  plain.statusword = statusword->id;
  if (!shown || !mode || !velocity) return node.brakes.push_back(std::move(plain));
  const std::size_t before = node.brakes.size();
  for (const drive::ModeSpec& brake : profile.modes) {
    const drive::ObjectSpec* const target = profile.find(brake.target);
    if (target == nullptr || !alike(*velocity, *target)) continue;
    canopen::BootBrake found{statusword->id, shown->id, mode->id,   velocity->id,
                             target->id,     {},        brake.value};
    for (const drive::ModeSpec& pushing : profile.modes) {
      if (pushing.stop_mode == brake.name) found.pushing.push_back(pushing.value);
    }
    if (!found.pushing.empty()) node.brakes.push_back(std::move(found));
  }
  if (node.brakes.size() == before) node.brakes.push_back(std::move(plain));
}

void setSupervision(const BusConfig& bus, const DeviceConfig& device, NodeConfig& node) {
  const ErrorControlPlan plan = planErrorControl(bus, device);
  const bool guarding = plan.kind == canopen::ErrorControl::guarding;
  node.error_control = plan.kind;
  node.heartbeat = guarding ? Duration(0) : plan.period;
  node.heartbeat_timeout = guarding ? Duration(0) : plan.timeout;
  node.master_timeout = plan.master_timeout;
  if (!guarding) return;
  node.guard_time = plan.period;
  node.life_time_factor = static_cast<std::uint8_t>(plan.timeout / plan.period);
}

/// Only what arrives within the window after SYNC is synchronous (CiA 301, 7.5.2.9).
void addSyncWindow(const BusConfig& bus, NodeConfig& node) {
  if (!bus.sync_window) return;
  canopen::StartupWrite write;
  write.object = {0x1007, 0};
  write.name = "synchronous window length";
  write.data = fieldbus::toBytes(static_cast<std::uint64_t>(bus.sync_window->count() / 1000), 4);
  write.optional = true;  // few drives have it
  node.writes.push_back(write);
}

/// "parameter_protection (2002:16) may be why: parameters are locked; unlock them", of a family
/// that has such a setting.
std::string lockOf(const drive::DriveProfile& profile) {
  const auto lock = std::find_if(profile.checks.begin(), profile.checks.end(),
                                 [](const drive::SettingCheck& check) { return check.locks; });
  if (lock == profile.checks.end()) return {};
  const drive::ObjectSpec* object = profile.find(lock->objects.front());
  return object->name + " (" + fieldbus::toString(object->id) + ") may be why: " + lock->text +
         "; " + lock->remedy;
}

void setSync(const BusConfig& bus, const canopen::DeviceProfile& profile, NodeConfig& node) {
  // Without a counter on the bus only drives that expect one must be told so.
  if (profile.has_sync_counter_object && (bus.sync_counter != 0 || profile.sync_counter)) {
    node.sync_counter = bus.sync_counter;
  }
  if (profile.has_sync_period_object) {
    node.sync_period_us = static_cast<std::uint32_t>(bus.sync_period.count() / 1000);
  }
}

void addAxis(const AxisConfig& axis, NodeConfig& node, Problems& problems) {
  const std::string path = "axes/" + axis.name;
  addWrites(axis.profile->startup, AskedBy::profile, axis, path, node, problems);
  addWrites(axis.writes, AskedBy::user, axis, path + "/write", node, problems);
}

/// What the profile leaves open of lengths.
void addWidths(const AxisConfig& axis, NodeConfig& node) {
  for (const drive::ObjectSpec& object : axis.profile->objects) {
    if (object.widest == 0 || drive::saidToLack(axis, object.name)) continue;
    node.widths.push_back({object.id, object.name, fieldbus::sizeBits(object.type) / 8,
                           object.widest / 8, fieldbus::isSigned(object.type)});
  }
}

/// @param axes that sit in the device, at least one
NodeConfig makeNode(const BusConfig& bus, const DeviceConfig& device,
                    const std::vector<const AxisConfig*>& axes, Problems& problems) {
  const canopen::DeviceProfile& family = *device.profile;
  NodeConfig node;
  node.node_id = device.node_id;
  node.name = device.name;
  node.title = device.title;
  node.device_type = family.device_type;
  node.vendor_id = device.vendor_id ? device.vendor_id : family.vendor_id;
  node.product_code = device.product_code ? device.product_code : family.product_code;
  node.known_products = family.known_products;
  node.if_silent = family.if_silent;
  node.revision = device.revision;
  node.serial = device.serial;
  node.boot = device.boot;
  setSupervision(bus, device, node);
  setSync(bus, family, node);
  node.map_count_may_be_read_only = family.pdo_map_count_may_be_read_only;
  node.fixed_map_entries = family.fixed_pdo_entries;
  for (const AxisConfig* axis : axes) {
    addPdos(*axis, device, node, problems);
    addHalfFloats(*axis, device, node);
  }
  if (device.axes[axes.front()->device_axis].by_sdo) carryBySdo(bus.bitrate, node);
  static_cast<fieldbus::AccessOptions&>(node.sdo) = family.sdo;
  node.sdo_channel = device.sdo;
  node.boot_timeout = family.boot_time;
  node.reset_node_allowed = family.nmt_reset_node;
  node.reset_does_nothing = family.nmt_reset_does_nothing;
  node.reads_back = axes.front()->profile->reads_back;
  for (const AxisConfig* axis : axes) addWidths(*axis, node);
  for (const AxisConfig* axis : axes) addStop(*axis->profile, node);
  for (const AxisConfig* axis : axes) addBrakes(*axis, node);
  addSyncWindow(bus, node);
  for (const AxisConfig* axis : axes) addAxis(*axis, node, problems);
  node.lock = lockOf(*axes.front()->profile);
  node.lacking_remedy = "`lacks` of axes/" + device.name + " says that this is right";
  return node;
}

/// Those in one device, in their order; empty where one has no profile.
std::vector<const AxisConfig*> axesIn(const RobotConfig& robot, std::size_t device) {
  std::vector<const AxisConfig*> axes;
  for (const AxisConfig& axis : robot.axes) {
    if (axis.device == device && axis.profile) axes.push_back(&axis);
  }
  return axes;
}

}  // namespace

canopen::MasterConfig makeMasterConfig(const RobotConfig& robot, Problems& problems) {
  canopen::MasterConfig master;
  master.node_id = robot.bus.node_id;
  master.heartbeat = robot.bus.heartbeat;
  master.sync_period = robot.bus.sync_period;
  master.sync_counter = robot.bus.sync_counter;
  master.bitrate = robot.bus.bitrate;
  master.external_sync = robot.bus.external_sync;
  // Those that LSS gives another node-ID take it at a reset, which finds them by the old one.
  const bool lss = std::any_of(robot.devices.begin(), robot.devices.end(),
                               [](const DeviceConfig& device) { return device.lss.has_value(); });
  master.reset_all = robot.bus.reset_all || lss;
  master.time_interval = robot.bus.time_interval;
  for (std::size_t i = 0; i < robot.devices.size(); ++i) {
    const std::vector<const AxisConfig*> axes = axesIn(robot, i);
    if (axes.empty() || !robot.devices[i].profile) continue;
    master.nodes.push_back(makeNode(robot.bus, robot.devices[i], axes, problems));
  }
  assignSyncStarts(master);
  assignCobIds(master, problems);
  checkSdoChannels(master, problems);
  checkCobIds(master, problems);
  return master;
}

}  // namespace cia402::config
