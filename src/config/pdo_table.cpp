// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "common/text.h"
#include "config/robot.h"

namespace cia402::config {
namespace {

std::string when(const canopen::PdoConfig& pdo) {
  const unsigned type = pdo.transmission;
  const bool rpdo = pdo.direction == canopen::PdoDirection::rpdo;
  if (rpdo && pdo.refresh_every > 1) {
    return "change, sync / " + std::to_string(pdo.refresh_every);
  }
  if (type == 0) return "sync, on change";
  if (type == 1) return "sync";
  if (type <= 240) return "sync / " + std::to_string(type);
  if (canopen::isRequested(pdo.transmission)) {
    return "asked, sync / " + std::to_string(pdo.request_every);
  }
  return "event";
}

std::string cobId(const canopen::PdoConfig& pdo) {
  return pdo.cob_id == 0 ? "drive" : hexText(pdo.cob_id, 3);
}

std::string percent(const BusLoad& load) {
  char text[32];
  std::snprintf(text, sizeof text, "%6.2f  %6.2f", 100.0 * load.nominal, 100.0 * load.worst);
  return text;
}

}  // namespace

std::string pdoTable(const canopen::MasterConfig& master, double bitrate) {
  std::string table =
      "axis              node  pdo     cob-id  when               bits  load %  worst %  objects\n";
  for (const canopen::NodeConfig& node : master.nodes) {
    for (const canopen::PdoConfig& pdo : node.pdos) {
      if (!pdo.enabled) continue;
      unsigned bits = 0;
      std::string objects;
      for (const canopen::PdoEntry& entry : pdo.entries) {
        bits += entry.bits;
        append(objects, entry.name + " " + toString(entry.object), ", ");
      }
      const bool rpdo = pdo.direction == canopen::PdoDirection::rpdo;
      const std::string name = (rpdo ? "rpdo" : "tpdo") + std::to_string(pdo.number);
      char start[128];
      std::snprintf(start, sizeof start, "%-16s  %4u  %-6s  %-6s  %-17s  %4u  %s  ",
                    node.name.c_str(), unsigned{node.node_id}, name.c_str(), cobId(pdo).c_str(),
                    when(pdo).c_str(), bits,
                    percent(pdoLoad(pdo, master.sync_period, bitrate)).c_str());
      table += start + objects + "\n";
    }
  }
  const BusLoad total = busLoad(master, bitrate);
  char end[160];
  std::snprintf(end, sizeof end,
                "total, with SYNC and heartbeats, at %.0f bit/s and %.0f Hz: %.2f %% without stuff "
                "bits, %.2f %% in the worst case\n",
                bitrate, 1.0 / toSeconds(master.sync_period), 100.0 * total.nominal,
                100.0 * total.worst);
  return table + end;
}

}  // namespace cia402::config
