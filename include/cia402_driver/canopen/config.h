// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/canopen/object.h"
#include "cia402_driver/canopen/pdo.h"
#include "cia402_driver/canopen/sdo_client.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// A write to the drive's object dictionary during boot.
struct StartupWrite {
  ObjectId object;
  std::string name;               ///< for messages
  Bytes data;                     ///< wire order
  bool optional = false;          ///< an abort by the drive is noted, not an error
  bool only_if_different = true;  ///< read first, write only what differs
};

/// Everything the master must know of one node.
struct NodeConfig {
  NodeId node_id = 0;
  std::string name;  ///< for messages: the axis or joint
  /// Identity the node must have where given: 1000h, 1018h:01..04.
  std::optional<std::uint32_t> device_type, vendor_id, product_code, revision, serial;
  /// Heartbeat asked of the node (1017h); zero: none, the node cannot be supervised.
  Duration heartbeat{std::chrono::milliseconds(100)};
  /// Without a heartbeat for this long the node is lost.
  Duration heartbeat_timeout{std::chrono::milliseconds(300)};
  /// The node shall watch the master's heartbeat (1016h:01) with this time-out; zero: not written.
  Duration master_timeout{std::chrono::milliseconds(300)};
  std::optional<std::uint8_t> sync_counter;     ///< 1019h to write; none: not written
  std::optional<std::uint32_t> sync_period_us;  ///< 1006h to write; none: not written
  bool map_count_may_be_read_only = false;      ///< quirk: sub0 of 16xxh/1Axxh aborts 0x06010002
  std::vector<PdoConfig> pdos;
  std::vector<StartupWrite> writes;  ///< after the PDOs, in this order
  SdoOptions sdo;
  Duration boot_timeout{std::chrono::seconds(5)};  ///< from reset to boot-up or an SDO answer
};

/// Configuration of the master itself.
struct MasterConfig {
  NodeId node_id = 127;
  Duration heartbeat{std::chrono::milliseconds(100)};  ///< produced; zero: none
  Duration sync_period{std::chrono::milliseconds(4)};
  std::uint8_t sync_counter = 0;  ///< overflow value of the SYNC counter (1019h): 0 or 2..240
  bool external_sync = false;     ///< another device produces SYNC, the master follows it
  Duration time_interval{0};      ///< of the TIME message; zero: none
  std::vector<NodeConfig> nodes;
};

}  // namespace cia402::canopen
