// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/received_identifiers.h"

#include <cstddef>
#include <utility>

namespace cia402::canopen {
namespace {

using Identifiers = std::bitset<2048>;

// First and last identifier of what is heard of every node.
constexpr std::pair<std::size_t, std::size_t> kServices[] = {
    {0x000, 0x000},  // NMT
    {0x080, 0x0FF},  // SYNC, emergencies
    {0x100, 0x100},  // TIME
    {0x580, 0x67F},  // SDO, answers and requests
    {0x700, 0x77F},  // boot-up, heartbeat, node guarding
    {0x7E4, 0x7E5},  // LSS
};
constexpr std::size_t kFirstPdo = 0x180, kLastPdo = 0x57F, kPdoStep = 0x80;

void add(std::size_t identifier, Identifiers& identifiers) {
  if (identifier < identifiers.size()) identifiers.set(identifier);
}

/// @return false if it may have any COB-ID.
bool addPdos(const NodeConfig& node, Identifiers& identifiers) {
  for (std::size_t first = kFirstPdo; first <= kLastPdo; first += kPdoStep) {
    identifiers.set(first + node.node_id);  // the predefined ones
  }
  for (const PdoConfig& pdo : node.pdos) {
    if (!pdo.enabled) continue;
    if (pdo.cob_id == 0) return false;
    add(pdo.cob_id, identifiers);
  }
  return true;
}

}  // namespace

std::bitset<2048> receivedIdentifiers(const MasterConfig& master) {
  Identifiers identifiers;
  for (const auto& [first, last] : kServices) {
    for (std::size_t id = first; id <= last; ++id) identifiers.set(id);
  }
  for (const NodeConfig& node : master.nodes) {
    if (!addPdos(node, identifiers)) return identifiers.set();
    add(node.sdo_channel.request, identifiers);
    add(node.sdo_channel.answer, identifiers);
  }
  return identifiers;
}

}  // namespace cia402::canopen
