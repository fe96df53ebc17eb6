// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/pdo/config.h"

namespace cia402::canopen {

/// Where a PDO's COB-ID comes from.
struct CobIdSpec {
  /// What `value` means.
  enum class Kind : std::uint8_t {
    predefined,  ///< of the predefined connection set, PDOs 1 to 4
    absolute,    ///< `value`
    node_id,     ///< `value` plus the node-ID
    drive,       ///< whatever the drive has, read when it boots
  };
  Kind kind = Kind::predefined;
  std::uint16_t value = 0;
};

/// One PDO of a layout.
struct PdoLayout {
  PdoDirection direction = PdoDirection::tpdo;
  unsigned number = 1;
  std::uint8_t transmission = 1;
  std::uint16_t inhibit = 0;        ///< 100 us
  std::uint16_t event_timer = 0;    ///< ms
  std::uint16_t request_every = 1;  ///< cycles; TPDO of type 252, 253
  std::uint16_t refresh_every = 1;  ///< cycles; RPDO whose content does not change
  /// TPDO of types 1 to 240: counter of the SYNC at which it begins to count; absent: any.
  std::optional<std::uint8_t> sync_start;
  CobIdSpec cob_id;
  std::vector<std::string> objects;  ///< profile names or "6041:00"
};

}  // namespace cia402::canopen
