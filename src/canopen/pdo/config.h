// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/object.h"

namespace cia402::canopen {

/// Direction as the drive sees it (CiA 301): an RPDO is sent by the master, a TPDO by the drive.
enum class PdoDirection : std::uint8_t { rpdo, tpdo };

/// One entry of a PDO mapping.
struct PdoEntry {
  ObjectId object;
  std::uint8_t bits = 0;  ///< 1..64
  std::string name;       ///< for messages
  bool optional = false;  ///< left out where the drive does not have it or cannot map it
  /// Wanted only where it costs nothing: left out where the drive refuses the mapping for whatever
  /// reason, and no cause for a warning.
  bool if_room = false;
  /// Of an RPDO: no cycle sets it. It carries what the drive holds when it boots, and later what
  /// was written to it last.
  bool kept = false;
};

/// Transmission types (CiA 301, 7.5.2.35 and 7.5.2.37).
constexpr bool isCyclic(std::uint8_t type) { return type >= 1 && type <= 240; }
/// The drive sends the TPDO only when a remote frame asks for it: 252 sampled at SYNC, 253 at once.
constexpr bool isRequested(std::uint8_t type) { return type == 252 || type == 253; }
/// Sent when its content changes or the event timer expires, SYNC or not.
constexpr bool isEventDriven(std::uint8_t type) { return type >= 254; }

/// The wanted configuration of one PDO of a node (CiA 301, objects 1400h/1600h, 1800h/1A00h).
struct PdoConfig {
  PdoDirection direction = PdoDirection::tpdo;
  unsigned number = 1;  ///< 1..512; communication parameters at 1400h/1800h + number - 1
  /// 11-bit CAN-ID; 0: the one that the drive has, read when it boots. Where the drive refuses
  /// another one as read-only, its own is taken, too.
  std::uint16_t cob_id = 0;
  std::uint8_t transmission = 1;  ///< transmission type 0..240, 252..255 (RPDO: without 252, 253)
  std::uint16_t inhibit = 0;      ///< inhibit time, 100 us (TPDO only)
  /// ms; of an RPDO: the drive reacts when none came for so long (the drive's own deadline).
  std::uint16_t event_timer = 0;
  bool enabled = true;            ///< false: only made invalid (bit 31)
  std::string carrier;            ///< what carries its entry instead of it (NodeConfig::by_sdo)
  std::vector<PdoEntry> entries;  ///< at most 64 bits in all

  /// A TPDO that is due and fails to come so many times in a row is stale; 0: never.
  std::uint16_t stale_after = 10;
  /// TPDO of type 252 or 253: a remote frame asks for it after every so many SYNCs.
  std::uint16_t request_every = 1;
  /// TPDO: SYNC start value (sub-index 6); absent: not looked at, as the drive may not have it.
  std::optional<std::uint8_t> sync_start;
  std::uint8_t sync_start_wait = 0;  ///< SYNCs until that comes at the latest
  /// RPDO: sent in a cycle in which its content changed, and at least every so many cycles.
  std::uint16_t refresh_every = 1;
};

}  // namespace cia402::canopen
