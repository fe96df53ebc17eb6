// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/bus_listener.h"

#include <algorithm>

#include "common/text.h"

namespace cia402::bus {
namespace {

// CAN-IDs of CiA 301, 7.3.5, and CiA 305.
constexpr std::uint32_t kNmt = 0x000, kSync = 0x080, kSdoRequest = 0x600, kErrorControl = 0x700;
constexpr std::uint32_t kLssRequest = 0x7E5;
constexpr std::uint32_t kFunctionCode = 0x780;
constexpr std::size_t kMostKinds = 3;  // in a sentence

std::string withId(const std::string& what, std::uint32_t id) {
  return what + " (COB-ID " + hexText(id, 3) + ")";
}

}  // namespace

BusListener::BusListener(const canopen::MasterConfig& master, Duration duration)
    : duration_(duration), node_(master.node_id), external_sync_(master.external_sync) {
  for (const canopen::NodeConfig& node : master.nodes) {
    for (const canopen::PdoConfig& pdo : node.pdos) {
      const bool rpdo = pdo.direction == canopen::PdoDirection::rpdo && pdo.enabled;
      if (!rpdo || pdo.cob_id == 0) continue;
      identifiers_[pdo.cob_id] = "RPDO " + std::to_string(pdo.number) + " of " + node.name;
    }
    const std::uint16_t request = node.sdo_channel.request;
    if (request != 0) identifiers_[request] = "an SDO request to " + node.name;
  }
}

void BusListener::start(Time now) {
  heard_.clear();
  end_ = duration_ > Duration::zero() ? now + duration_ : kNever;
}

bool BusListener::receive(const can::Frame& frame, Time now) {
  if (!listening()) return false;
  const std::string kind = kindOf(frame);
  if (kind.empty()) return false;
  end_ = now + duration_;
  if (heard_.size() >= kMostKinds) return false;
  if (std::find(heard_.begin(), heard_.end(), kind) != heard_.end()) return false;
  heard_.push_back(kind);
  return true;
}

std::string BusListener::kindOf(const can::Frame& frame) const {
  if (frame.error || frame.extended) return {};
  const std::uint32_t id = frame.id;
  const std::uint32_t node = id & ~kFunctionCode;
  if (frame.remote) {
    const bool guarding = (id & kFunctionCode) == kErrorControl && node != 0;
    return guarding ? withId("node guarding of node " + std::to_string(node), id) : std::string();
  }
  if (id == kNmt) return withId("NMT", id);
  if (id == kSync) return external_sync_ ? std::string() : withId("SYNC", id);
  if (id == kErrorControl + node_) return withId("a heartbeat with the master's node-ID", id);
  if (id == kLssRequest) return withId("an LSS request", id);
  const auto known = identifiers_.find(id);
  if (known != identifiers_.end()) return withId(known->second, id);
  const bool request = (id & kFunctionCode) == kSdoRequest && node != 0;
  return request ? withId("an SDO request to node " + std::to_string(node), id) : std::string();
}

std::string BusListener::text() const {
  if (!heard()) return {};
  return "another master is on the bus, heard: " + joined(heard_, ", ") +
         "; nothing is sent until none for " + secondsText(duration_) + "; stop the other one";
}

}  // namespace cia402::bus
