// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that send their TPDOs with every n-th SYNC take turns, where SYNC has a counter.
#include <map>
#include <vector>

#include "config/node_pdos.h"

namespace cia402::config {

namespace {

/// TPDOs that may begin with any SYNC, by their type, of a SYNC counter that ends with a turn of
/// them.
using Turns = std::map<std::uint8_t, std::vector<canopen::PdoConfig*>>;

Turns turnsOf(canopen::MasterConfig& master) {
  Turns turns;
  for (canopen::NodeConfig& node : master.nodes) {
    for (canopen::PdoConfig& pdo : node.pdos) {
      const std::uint8_t every = pdo.transmission;
      const bool waits = pdo.enabled && pdo.sync_start == 0 && canopen::isCyclic(every);
      if (waits && every > 1 && master.sync_counter % every == 0) turns[every].push_back(&pdo);
    }
  }
  return turns;
}

}  // namespace

void assignSyncStarts(canopen::MasterConfig& master) {
  if (master.sync_counter == 0) return;
  for (const auto& [every, pdos] : turnsOf(master)) {
    if (pdos.size() < 2) continue;  // there is nobody to take turns with
    unsigned turn = 0;
    for (canopen::PdoConfig* pdo : pdos) {
      pdo->sync_start = static_cast<std::uint8_t>(1 + turn++ % every);
    }
  }
  for (canopen::NodeConfig& node : master.nodes) {
    for (canopen::PdoConfig& pdo : node.pdos) {
      if (pdo.sync_start.value_or(0) != 0) pdo.sync_start_wait = master.sync_counter;
    }
  }
}

}  // namespace cia402::config
