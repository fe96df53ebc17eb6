// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an axis without PDOs reads and writes by SDO.
#include <algorithm>

#include "config/node_pdos.h"

namespace cia402::config {
namespace {

using canopen::PdoConfig;

constexpr double kTransferBits = 2 * 135.0;  // request and answer, with stuff bits
constexpr double kServerTime = 2e-3;         // s, of the drive for each
constexpr std::uint16_t kLeastTurn = 20;     // ms

/// The longest time, ms, until it is the turn of a value again.
std::uint16_t turnTime(std::size_t values, double bitrate) {
  const double transfer = kTransferBits / bitrate + kServerTime;
  return std::max(kLeastTurn,
                  static_cast<std::uint16_t>(1e3 * transfer * 2.0 * static_cast<double>(values)));
}

}  // namespace

void carryBySdo(double bitrate, canopen::NodeConfig& node) {
  std::vector<PdoConfig> alone;
  for (PdoConfig& pdo : node.pdos) {
    for (const canopen::PdoEntry& entry : pdo.entries) {
      PdoConfig value;
      value.direction = pdo.direction;
      value.number = static_cast<unsigned>(node.by_sdo.size() + alone.size() + 1);
      value.transmission = 255;
      value.stale_after = pdo.stale_after;
      value.entries = {entry};
      value.carrier = entry.name + " (" + fieldbus::toString(entry.object) + ") by SDO";
      const bool known = std::any_of(alone.begin(), alone.end(), [&](const PdoConfig& other) {
        return other.direction == value.direction && other.entries.front().object == entry.object;
      });
      if (!known) alone.push_back(value);
    }
    pdo.entries.clear();
    pdo.enabled = false;
  }
  for (PdoConfig& value : alone) value.event_timer = turnTime(alone.size(), bitrate);
  node.by_sdo.insert(node.by_sdo.end(), alone.begin(), alone.end());
}

}  // namespace cia402::config
