// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "common/text.h"
#include "config/robot_parts.h"
#include "drive/axis/state_machine.h"
#include "drive/profile/named_write.h"

namespace cia402::config {
namespace {

using canopen::DeviceConfig;
using canopen::NodeConfig;
using canopen::PdoConfig;
using canopen::PdoDirection;
using drive::AxisConfig;

constexpr unsigned kPredefinedPdos = 4;  // of each direction have a COB-ID of their own

/// May a PDO have this identifier (CiA 301, 7.3.5, restricted CAN-IDs)?
bool isPdoCobId(unsigned cob_id) {
  return (cob_id >= 0x181 && cob_id <= 0x57F) || (cob_id >= 0x680 && cob_id <= 0x6DF);
}

/// 0: the drive's own.
unsigned cobId(const canopen::PdoLayout& layout, const DeviceConfig& device) {
  using Kind = canopen::CobIdSpec::Kind;
  const unsigned base = layout.direction == PdoDirection::rpdo ? 0x200 : 0x180;
  switch (layout.cob_id.kind) {
    case Kind::absolute:
      return layout.cob_id.value;
    case Kind::node_id:
      return unsigned{layout.cob_id.value} + device.node_id;
    case Kind::drive:
      return 0;
    case Kind::predefined:
      break;
  }
  if (device.profile->cob_ids_of_drive) return 0;
  return base + 0x100 * (layout.number - 1) + device.node_id;  // only asked for up to the fourth
}

PdoConfig makePdo(const canopen::PdoLayout& layout, const AxisConfig& axis,
                  const DeviceConfig& device) {
  PdoConfig pdo;
  pdo.direction = layout.direction;
  pdo.number = layout.number;
  pdo.cob_id = static_cast<std::uint16_t>(cobId(layout, device));
  pdo.transmission = layout.transmission;
  pdo.inhibit = layout.inhibit;
  pdo.event_timer = layout.event_timer;
  pdo.stale_after = device.stale_after;
  pdo.request_every = layout.request_every;
  pdo.refresh_every = layout.refresh_every;
  pdo.enabled = !layout.objects.empty();
  for (const std::string& name : layout.objects) {
    const drive::ObjectSpec* object = drive::findObject(*axis.profile, name);
    if (object == nullptr) continue;  // refused by readPdos() already
    const auto& defaults = device.default_objects;
    const auto& riders = device.riders;
    const bool optional = std::find(defaults.begin(), defaults.end(), name) != defaults.end();
    const bool if_room = std::find(riders.begin(), riders.end(), name) != riders.end();
    pdo.entries.push_back({object->id, static_cast<std::uint8_t>(fieldbus::sizeBits(object->type)),
                           object->name, optional, if_room});
  }
  return pdo;
}

bool hasCobId(const canopen::PdoLayout& layout, const DeviceConfig& device) {
  return layout.number <= kPredefinedPdos || device.profile->cob_ids_of_drive ||
         layout.cob_id.kind != canopen::CobIdSpec::Kind::predefined;
}

// The layout's PDOs; all others that the drive has are made invalid.
std::vector<PdoConfig> makePdos(const AxisConfig& axis, const DeviceConfig& device,
                                Problems& problems) {
  std::vector<PdoConfig> pdos;
  const std::string path = "axes/" + axis.name + "/pdos";
  for (const PdoDirection direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
    const bool rpdo = direction == PdoDirection::rpdo;
    const unsigned count = rpdo ? device.profile->max_rpdos : device.profile->max_tpdos;
    for (unsigned number = 1; number <= count; ++number) {
      canopen::PdoLayout layout;
      layout.direction = direction;
      layout.number = number;
      for (const canopen::PdoLayout& entry : device.pdos) {
        if (entry.direction == direction && entry.number == number) layout = entry;
      }
      const std::string name = (rpdo ? "rpdo" : "tpdo") + std::to_string(number);
      if (!layout.objects.empty() && !hasCobId(layout, device)) {
        problems.add(path, name + " has no COB-ID: the predefined connection set ends with the " +
                               "fourth; give it a `cob_id`");
        continue;
      }
      pdos.push_back(makePdo(layout, axis, device));
      const unsigned cob_id = pdos.back().cob_id;
      if (pdos.back().enabled && cob_id != 0 && !isPdoCobId(cob_id)) {
        problems.add(path, name + " would have the COB-ID " + hexText(cob_id, 3) +
                               ", which CiA 301 keeps for something else");
      }
    }
  }
  return pdos;
}

/// No two PDOs on the bus share an identifier: a drive would take what is meant for another.
void checkCobIds(const canopen::MasterConfig& master, Problems& problems) {
  std::map<unsigned, std::string> users;
  for (const NodeConfig& node : master.nodes) {
    for (const PdoConfig& pdo : node.pdos) {
      if (!pdo.enabled || pdo.cob_id == 0) continue;
      const std::string name = (pdo.direction == PdoDirection::rpdo ? "rpdo" : "tpdo") +
                               std::to_string(pdo.number) + " of `" + node.name + "`";
      const auto [first, fresh] = users.emplace(pdo.cob_id, name);
      if (fresh) continue;
      problems.add("axes/" + node.name + "/pdos",
                   name + " has the COB-ID " + hexText(pdo.cob_id, 3) + ", which is that of " +
                       first->second + " already; give one of them another");
    }
  }
}

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

void setSync(const BusConfig& bus, const canopen::DeviceProfile& profile, NodeConfig& node) {
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
  const DeviceConfig& device = robot.deviceOf(axis);
  const canopen::DeviceProfile& family = *device.profile;
  NodeConfig node;
  node.node_id = device.node_id;
  node.name = device.name;
  node.title = device.title;
  node.device_type = family.device_type;
  node.vendor_id = device.vendor_id ? device.vendor_id : family.vendor_id;
  node.product_code = device.product_code ? device.product_code : family.product_code;
  node.revision = device.revision;
  node.serial = device.serial;
  node.boot = device.boot;
  setSupervision(robot.bus, device, node);
  setSync(robot.bus, family, node);
  node.map_count_may_be_read_only = family.pdo_map_count_may_be_read_only;
  node.fixed_map_entries = family.fixed_pdo_entries;
  node.pdos = makePdos(axis, device, problems);
  static_cast<fieldbus::AccessOptions&>(node.sdo) = family.sdo;
  node.sdo_channel = device.sdo;
  node.boot_timeout = family.boot_time;
  node.reset_node_allowed = family.nmt_reset_node;
  addStop(profile, node);
  addSyncWindow(robot.bus, node);
  const std::string path = "axes/" + axis.name;
  addWrites(profile.startup, AskedBy::profile, axis, path, node, problems);
  addWrites(axis.writes, AskedBy::user, axis, path + "/write", node, problems);
  node.lacking_remedy = "`lacks` of " + path + " says that this is right";
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
  // Those that LSS gives another node-ID take it at a reset, which finds them by the old one.
  const bool lss = std::any_of(robot.devices.begin(), robot.devices.end(),
                               [](const DeviceConfig& device) { return device.lss.has_value(); });
  master.reset_all = robot.bus.reset_all || lss;
  master.time_interval = robot.bus.time_interval;
  for (const AxisConfig& axis : robot.axes) {
    if (axis.profile) master.nodes.push_back(makeNode(robot, axis, problems));
  }
  checkSdoChannels(master, problems);
  checkCobIds(master, problems);
  return master;
}

}  // namespace cia402::config
