// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/cyclic_identifiers.h"

namespace cia402::canopen {

std::vector<std::uint32_t> cyclicIdentifiers(const MasterConfig& master) {
  std::vector<std::uint32_t> identifiers = {0x080, 0x100, 0x700U + master.node_id};
  for (const NodeConfig& node : master.nodes) {
    for (const std::uint32_t rpdo : {0x200U, 0x300U, 0x400U, 0x500U}) {
      identifiers.push_back(rpdo + node.node_id);
    }
    for (const PdoConfig& pdo : node.pdos) {
      if (pdo.direction == PdoDirection::rpdo && pdo.cob_id != 0) {
        identifiers.push_back(pdo.cob_id);
      }
    }
  }
  return identifiers;
}

}  // namespace cia402::canopen
