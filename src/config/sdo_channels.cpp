// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Whether SDO channels of other COB-IDs than the predefined ones are free for that.
#include <map>

#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

constexpr std::uint32_t kSync = 0x080, kTime = 0x100, kLssAnswer = 0x7E4, kLssRequest = 0x7E5;
constexpr std::uint32_t kEmergency = 0x080, kErrorControl = 0x700;
constexpr std::uint32_t kSdoAnswer = 0x580, kSdoRequest = 0x600;

/// Who has an identifier.
using Owners = std::map<std::uint32_t, std::string>;

Owners everybody(const canopen::MasterConfig& master) {
  Owners owners{
      {0x000, "NMT"},       {kSync, "SYNC"},
      {kTime, "TIME"},      {kLssAnswer, "LSS"},
      {kLssRequest, "LSS"}, {kErrorControl + master.node_id, "the heartbeat of this program"}};
  for (const canopen::NodeConfig& node : master.nodes) {
    owners[kEmergency + node.node_id] = "EMCY of " + node.name;
    owners[kErrorControl + node.node_id] = "error control of " + node.name;
    if (node.sdo_channel.request == 0) owners[kSdoRequest + node.node_id] = "SDO of " + node.name;
    if (node.sdo_channel.answer == 0) owners[kSdoAnswer + node.node_id] = "SDO of " + node.name;
    for (const canopen::PdoConfig& pdo : node.pdos) {
      if (!pdo.enabled) continue;
      const bool to_node = pdo.direction == canopen::PdoDirection::rpdo;
      owners[pdo.cob_id] =
          (to_node ? "RPDO " : "TPDO ") + std::to_string(pdo.number) + " of " + node.name;
    }
  }
  return owners;
}

}  // namespace

void checkSdoChannels(const canopen::MasterConfig& master, Problems& problems) {
  Owners owners = everybody(master);
  for (const canopen::NodeConfig& node : master.nodes) {
    const auto claim = [&](const char* key, std::uint32_t id) {
      if (id == 0) return;
      const auto [owner, free] = owners.emplace(id, "the SDO channel of " + node.name);
      if (free) return;
      problems.add("axes/" + node.name + "/sdo/" + key,
                   "COB-ID " + hexText(id, 3) + " belongs to " + owner->second +
                       " already; an identifier has one meaning on a bus");
    };
    claim("request", node.sdo_channel.request);
    claim("answer", node.sdo_channel.answer);
  }
}

}  // namespace cia402::config
