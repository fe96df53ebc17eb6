// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/cyclic_identifiers.h"

#include <bitset>

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kIdentifiers = 2048;
constexpr std::uint32_t kLssRequest = 0x7E5;  // CiA 305

}  // namespace

std::vector<std::uint32_t> cyclicIdentifiers(const MasterConfig& master) {
  std::bitset<kIdentifiers> once;
  once.set(0x000).set(kLssRequest);
  for (std::uint32_t node = 1; node <= 127; ++node) once.set(0x600 + node);
  for (const NodeConfig& node : master.nodes) {
    if (node.sdo_channel.request < kIdentifiers) once.set(node.sdo_channel.request);
  }
  for (const NodeConfig& node : master.nodes) {
    for (const PdoConfig& pdo : node.pdos) {
      const bool rpdo = pdo.direction == PdoDirection::rpdo && pdo.cob_id != 0;
      if (rpdo && pdo.cob_id < kIdentifiers) once.reset(pdo.cob_id);
    }
  }
  std::vector<std::uint32_t> identifiers;
  for (std::uint32_t id = 0; id < kIdentifiers; ++id) {
    if (!once[id]) identifiers.push_back(id);
  }
  return identifiers;
}

}  // namespace cia402::canopen
