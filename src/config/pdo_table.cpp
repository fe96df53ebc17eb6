// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "cia402_driver/config/robot.h"

namespace cia402::config {
namespace {

std::string when(const canopen::PdoConfig& pdo) {
  const unsigned type = pdo.transmission;
  if (type == 0) return "sync, on change";
  if (type == 1) return "sync";
  if (type <= 240) return "sync / " + std::to_string(type);
  return "event";
}

}  // namespace

std::string pdoTable(const canopen::MasterConfig& master) {
  std::string table = "axis              node  pdo    cob-id  when             bits  objects\n";
  for (const canopen::NodeConfig& node : master.nodes) {
    for (const canopen::PdoConfig& pdo : node.pdos) {
      if (!pdo.enabled) continue;
      unsigned bits = 0;
      std::string objects;
      for (const canopen::PdoEntry& entry : pdo.entries) {
        bits += entry.bits;
        objects += (objects.empty() ? "" : ", ") + entry.name + " " + toString(entry.object);
      }
      const char* kind = pdo.direction == canopen::PdoDirection::rpdo ? "rpdo" : "tpdo";
      char start[96];
      std::snprintf(start, sizeof start, "%-16s  %4u  %s%u  0x%03X   %-15s  %4u  ",
                    node.name.c_str(), unsigned{node.node_id}, kind, pdo.number,
                    unsigned{pdo.cob_id}, when(pdo).c_str(), bits);
      table += start + objects + "\n";
    }
  }
  return table;
}

}  // namespace cia402::config
