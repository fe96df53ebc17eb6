// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/node_pdos.h"

#include <algorithm>
#include <map>
#include <set>

#include "common/text.h"
#include "drive/profile/outputs.h"

namespace cia402::config {
namespace {

using canopen::DeviceConfig;
using canopen::NodeConfig;
using canopen::PdoConfig;
using canopen::PdoDirection;
using drive::AxisConfig;

constexpr unsigned kPredefinedPdos = 4;  // of each direction have a COB-ID of their own

constexpr unsigned kFirstFreeCobId = 0x680, kLastFreeCobId = 0x6DF;  // no device's by default
constexpr std::uint16_t kUnassigned = 0xFFFF;  // to be chosen by assignCobIds()

unsigned predefinedCobId(PdoDirection direction, unsigned number, canopen::NodeId node) {
  return (direction == PdoDirection::rpdo ? 0x200 : 0x180) + 0x100 * (number - 1) + node;
}

/// May a PDO have this identifier (CiA 301, 7.3.5, restricted CAN-IDs)?
bool isPdoCobId(unsigned cob_id) {
  return (cob_id >= 0x181 && cob_id <= 0x57F) ||
         (cob_id >= kFirstFreeCobId && cob_id <= kLastFreeCobId);
}

/// 0: the drive's own.
unsigned cobId(const canopen::PdoLayout& layout, const DeviceConfig& device) {
  using Kind = canopen::CobIdSpec::Kind;
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
  return predefinedCobId(layout.direction, layout.number, device.node_id);  // up to the fourth
}

PdoConfig makePdo(const canopen::PdoLayout& layout, unsigned first, const AxisConfig& axis,
                  const DeviceConfig& device) {
  const canopen::PdoSet& set = device.axes[axis.device_axis];
  PdoConfig pdo;
  pdo.direction = layout.direction;
  pdo.number = first + layout.number;
  pdo.cob_id = static_cast<std::uint16_t>(cobId(layout, device));
  pdo.transmission = layout.transmission;
  pdo.inhibit = layout.inhibit;
  pdo.event_timer = layout.event_timer;
  pdo.stale_after = device.stale_after;
  pdo.request_every = layout.request_every;
  pdo.refresh_every = layout.refresh_every;
  if (device.profile->sync_starts && layout.direction == PdoDirection::tpdo) {
    pdo.sync_start = layout.sync_start.value_or(0);
  }
  pdo.enabled = !layout.objects.empty();
  for (const std::string& name : layout.objects) {
    const drive::ObjectSpec* object = drive::findObject(*axis.profile, name);
    if (object == nullptr) continue;  // refused by readPdos() already
    const auto& defaults = set.default_objects;
    const auto& riders = set.riders;
    const bool optional = std::find(defaults.begin(), defaults.end(), name) != defaults.end();
    const bool if_room = std::find(riders.begin(), riders.end(), name) != riders.end();
    const bool kept = layout.direction == PdoDirection::rpdo &&
                      drive::isKept(*axis.profile, axis.modes, object->name);
    pdo.entries.push_back({object->id, static_cast<std::uint8_t>(fieldbus::sizeBits(object->type)),
                           object->name, optional, if_room, kept});
  }
  return pdo;
}

std::string nameOf(const canopen::PdoLayout& layout) {
  return (layout.direction == PdoDirection::rpdo ? "rpdo" : "tpdo") + std::to_string(layout.number);
}

/// Makes the PDOs of an axis.
class PdoMaker {
 public:
  PdoMaker(const DeviceConfig& device, NodeConfig& node, Problems& problems)
      : device_(device), node_(node), problems_(problems) {}

  /// The layout's PDOs; all others that the axis has are made invalid.
  void add(const AxisConfig& axis) {
    const canopen::DeviceProfile& family = *device_.profile;
    const bool shared = family.pdos_per_axis == 0;
    for (const PdoDirection direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
      const unsigned count = direction == PdoDirection::rpdo ? family.max_rpdos : family.max_tpdos;
      for (unsigned number = 1; number <= count; ++number) {
        canopen::PdoLayout layout;
        layout.direction = direction;
        layout.number = number;
        for (const canopen::PdoLayout& entry : device_.axes[axis.device_axis].pdos) {
          if (entry.direction == direction && entry.number == number) layout = entry;
        }
        if (shared && !keepsPlace(layout)) continue;
        add(layout, axis);
      }
    }
  }

 private:
  /// One that axes share is listed once, by the axis that has it, or by the first.
  bool keepsPlace(const canopen::PdoLayout& layout) {
    const auto known = std::find_if(node_.pdos.begin(), node_.pdos.end(), [&](const PdoConfig& p) {
      return p.direction == layout.direction && p.number == layout.number;
    });
    if (known == node_.pdos.end()) return true;
    if (layout.objects.empty()) return false;
    node_.pdos.erase(known);
    return true;
  }

  void add(const canopen::PdoLayout& layout, const AxisConfig& axis) {
    const canopen::PdoSet& set = device_.axes[axis.device_axis];
    const unsigned first = device_.profile->pdos_per_axis * axis.device_axis;
    const bool predefined = layout.cob_id.kind == canopen::CobIdSpec::Kind::predefined &&
                            !device_.profile->cob_ids_of_drive;
    const bool beyond = predefined && first + layout.number > kPredefinedPdos;
    const std::string path = "axes/" + axis.name + "/pdos";
    const std::string name = nameOf(layout);
    if (!layout.objects.empty() && beyond && !set.planned && first == 0) {
      problems_.add(path, name + " has no COB-ID: the predefined connection set ends with the " +
                              "fourth; give it a `cob_id`");
      return;
    }
    node_.pdos.push_back(makePdo(layout, first, axis, device_));
    PdoConfig& pdo = node_.pdos.back();
    if (beyond) pdo.cob_id = pdo.enabled ? kUnassigned : 0;
    if (!pdo.enabled || pdo.cob_id == 0 || pdo.cob_id == kUnassigned) return;
    const std::string would = name + " would have the COB-ID " + hexText(pdo.cob_id, 3);
    if (!isPdoCobId(pdo.cob_id)) {
      problems_.add(path, would + ", which CiA 301 keeps for something else");
    } else if (device_.profile->cob_ids_of_node && pdo.cob_id % 0x80 != device_.node_id) {
      problems_.add(path, would + ", but this drive takes those of its own node-ID only, as " +
                              hexText(pdo.cob_id / 0x80 * 0x80 + device_.node_id, 3));
    }
  }

  const DeviceConfig& device_;
  NodeConfig& node_;
  Problems& problems_;
};

}  // namespace

void addPdos(const AxisConfig& axis, const DeviceConfig& device, NodeConfig& node,
             Problems& problems) {
  PdoMaker(device, node, problems).add(axis);
}

void assignCobIds(canopen::MasterConfig& master, Problems& problems) {
  std::set<unsigned> used;
  for (const NodeConfig& node : master.nodes) {
    used.insert({node.sdo_channel.request, node.sdo_channel.answer});
    for (const PdoConfig& pdo : node.pdos) {
      if (pdo.enabled) used.insert(pdo.cob_id);
    }
  }
  for (NodeConfig& node : master.nodes) {
    for (PdoConfig& pdo : node.pdos) {
      if (pdo.cob_id != kUnassigned) continue;
      std::vector<unsigned> candidates;
      for (unsigned i = 0; i < kPredefinedPdos; ++i) {
        candidates.push_back(predefinedCobId(pdo.direction, i + 1, node.node_id));
      }
      for (unsigned id = kFirstFreeCobId; id <= kLastFreeCobId; ++id) candidates.push_back(id);
      const auto free = std::find_if(candidates.begin(), candidates.end(),
                                     [&](unsigned id) { return used.count(id) == 0; });
      if (free == candidates.end()) {
        problems.add("axes/" + node.name,
                     "no COB-ID is left for one of its PDOs; give the axes "
                     "`pdos`, each with a `cob_id`");
        return;
      }
      pdo.cob_id = static_cast<std::uint16_t>(*free);
      used.insert(*free);
    }
  }
}

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

}  // namespace cia402::config
