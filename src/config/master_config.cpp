// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cia402_driver/drive/named_write.h"
#include "cia402_driver/drive/profile_reader.h"
#include "robot_parts.h"

namespace cia402::config {
namespace {

constexpr std::uint64_t kQuickStopCommand = 0x0002;  // enable voltage without "no quick stop"

using canopen::NodeConfig;
using canopen::PdoConfig;
using canopen::PdoDirection;
using drive::AxisConfig;

// COB-ID of the first four PDOs (CiA 301, predefined connection set).
std::uint16_t cobId(PdoDirection direction, unsigned number, canopen::NodeId node) {
  const unsigned base = direction == PdoDirection::rpdo ? 0x200 : 0x180;
  return static_cast<std::uint16_t>(base + 0x100 * (number - 1) + node);
}

PdoConfig makePdo(const drive::PdoLayout& layout, const AxisConfig& axis) {
  PdoConfig pdo;
  pdo.direction = layout.direction;
  pdo.number = layout.number;
  pdo.cob_id = cobId(layout.direction, layout.number, axis.node_id);
  pdo.transmission = layout.transmission;
  pdo.inhibit = layout.inhibit;
  pdo.event_timer = layout.event_timer;
  pdo.enabled = !layout.objects.empty();
  for (const std::string& name : layout.objects) {
    const drive::ObjectSpec* object = drive::findObject(*axis.profile, name);
    if (object == nullptr) continue;  // refused by readPdos() already
    pdo.entries.push_back(
        {object->id, static_cast<std::uint8_t>(canopen::sizeBits(object->type)), object->name});
  }
  return pdo;
}

// The layout's PDOs; all others that the drive has are made invalid.
std::vector<PdoConfig> makePdos(const AxisConfig& axis, Problems& problems) {
  std::vector<PdoConfig> pdos;
  for (const PdoDirection direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
    for (unsigned number = 1; number <= std::min(axis.profile->max_pdos, 4U); ++number) {
      drive::PdoLayout unused;
      unused.direction = direction;
      unused.number = number;
      const auto layout =
          std::find_if(axis.pdos.begin(), axis.pdos.end(), [&](const drive::PdoLayout& entry) {
            return entry.direction == direction && entry.number == number;
          });
      pdos.push_back(makePdo(layout == axis.pdos.end() ? unused : *layout, axis));
    }
  }
  for (const drive::PdoLayout& layout : axis.pdos) {
    if (layout.number <= 4) continue;
    problems.add("axes/" + axis.name + "/pdos",
                 "PDO " + std::to_string(layout.number) +
                     " has no COB-ID: the predefined connection set ends with the fourth");
  }
  return pdos;
}

void addWrites(const std::vector<drive::NamedWrite>& writes, const AxisConfig& axis,
               const std::string& path, NodeConfig& node, Problems& problems) {
  for (const drive::NamedWrite& write : writes) {
    const auto resolved = drive::resolveWrite(write, axis);
    if (!resolved) {
      problems.add(path, resolved.error().message);
      continue;
    }
    if (!*resolved || (*resolved)->copied_from) continue;
    canopen::StartupWrite start;
    start.object = (*resolved)->object;
    start.name = (*resolved)->name;
    start.data = drive::wireBytes((*resolved)->raw, (*resolved)->type);
    start.optional = (*resolved)->optional;
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
  stop.data = drive::wireBytes(kQuickStopCommand, controlword->type);
  stop.optional = true;
  node.writes.push_back(stop);
}

void setSupervision(const BusConfig& bus, const drive::DriveProfile& profile, NodeConfig& node) {
  const Duration timeout = 3 * bus.heartbeat;
  const Duration none{0};
  node.heartbeat = profile.heartbeat_supported ? bus.heartbeat : none;
  node.heartbeat_timeout = profile.heartbeat_supported ? timeout : none;
  node.master_timeout = profile.heartbeat_consumer_supported ? timeout : none;
}

/// Only what arrives within the window after SYNC is synchronous (CiA 301, 7.5.2.9).
void addSyncWindow(const BusConfig& bus, NodeConfig& node) {
  if (!bus.sync_window) return;
  canopen::StartupWrite write;
  write.object = {0x1007, 0};
  write.name = "synchronous window length";
  write.data = canopen::toBytes(static_cast<std::uint64_t>(bus.sync_window->count() / 1000), 4);
  write.optional = true;  // few drives have it
  node.writes.push_back(write);
}

void setSync(const BusConfig& bus, const drive::DriveProfile& profile, NodeConfig& node) {
  // Without a counter on the bus only drives that expect one must be told so.
  if (profile.has_sync_counter_object && (bus.sync_counter != 0 || profile.sync_counter)) {
    node.sync_counter = bus.sync_counter;
  }
  if (profile.has_sync_period_object) {
    node.sync_period_us = static_cast<std::uint32_t>(bus.sync_period.count() / 1000);
  }
}

NodeConfig makeNode(const RobotConfig& robot, const AxisConfig& axis, Problems& problems) {
  const drive::DriveProfile& profile = *axis.profile;
  NodeConfig node;
  node.node_id = axis.node_id;
  node.name = axis.name;
  node.device_type = profile.device_type;
  node.vendor_id = axis.vendor_id ? axis.vendor_id : profile.vendor_id;
  node.product_code = axis.product_code ? axis.product_code : profile.product_code;
  node.revision = axis.revision;
  node.serial = axis.serial;
  setSupervision(robot.bus, profile, node);
  setSync(robot.bus, profile, node);
  node.map_count_may_be_read_only = profile.pdo_map_count_may_be_read_only;
  node.pdos = makePdos(axis, problems);
  node.sdo.timeout = profile.timing.sdo;
  node.sdo.retries = profile.timing.sdo_retries;
  node.boot_timeout = profile.timing.boot;
  addStop(profile, node);
  addSyncWindow(robot.bus, node);
  addWrites(profile.startup, axis, "axes/" + axis.name, node, problems);
  addWrites(axis.writes, axis, "axes/" + axis.name + "/write", node, problems);
  return node;
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
  master.time_interval = robot.bus.time_interval;
  for (const AxisConfig& axis : robot.axes) {
    if (axis.profile) master.nodes.push_back(makeNode(robot, axis, problems));
  }
  return master;
}

}  // namespace cia402::config
