// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "driver/open_socket.h"

#include "canopen/cyclic_identifiers.h"
#include "canopen/received_identifiers.h"

namespace cia402 {

std::unique_ptr<can::SocketCan> openSocket(const config::BusConfig& bus,
                                           const canopen::MasterConfig& master) {
  can::SocketCan::Options options;
  options.bitrate = static_cast<unsigned>(bus.bitrate);
  options.cyclic_lifetime = 2 * bus.sync_period;
  for (const std::uint32_t id : canopen::cyclicIdentifiers(master)) options.cyclic.set(id);
  if (!bus.receive_all) {
    options.filters = can::receiveFilters(canopen::receivedIdentifiers(master));
  }
  return std::make_unique<can::SocketCan>(bus.interface, options);
}

}  // namespace cia402
