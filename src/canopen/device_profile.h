// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/bus_settings.h"
#include "canopen/pdo/layout.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/float_codec.h"
#include "fieldbus/object_access.h"

namespace cia402::canopen {

/// A drive family as data: what it is as a device on a CANopen bus (docs/drive_profiles.md).
struct DeviceProfile {
  std::optional<std::uint32_t> device_type, vendor_id, product_code;  ///< 1000h, 1018h:01, :02
  std::vector<std::uint32_t> known_products;  ///< 1018h:02; another one is told of, empty: none is
  std::string if_silent;  ///< why a drive of the family may not answer at all, and what to do then
  /// A layout for all devices of the family; empty: each gets one that suits its modes.
  std::vector<PdoLayout> pdos;
  unsigned max_rpdos = 4, max_tpdos = 4;  ///< of each axis, where each has its own
  /// Numbers of the PDOs from one axis of the device to the next; 0: all axes share those of the
  /// device.
  unsigned pdos_per_axis = 64;
  unsigned max_pdo_entries = 8;
  unsigned fixed_pdo_entries = 0;  ///< every mapping has so many, unused ones are 0; 0: as needed
  std::vector<PdoLayout> fixed_pdos;  ///< with a mapping that the drive does not let change
  bool cob_ids_of_drive = false;      ///< COB-IDs of PDOs are fixed: read and used
  bool cob_ids_of_node = false;       ///< bits 0 to 6 of a PDO's COB-ID must be the node-ID
  bool remote_requests = true;        ///< TPDOs of types 252 and 253 exist
  bool rpdo_deadline = false;         ///< the drive reacts when RPDOs stay away (1400h:05)
  bool type_255_by_timer = false;     ///< TPDOs of that type come by event timer only
  bool sync_starts = false;           ///< TPDOs have a SYNC start value (1800h:06)
  /// Objects, by name, that may be of 16 bits instead of 32, and how these are encoded then.
  std::vector<std::string> half_floats;
  fieldbus::Encoding half_float_encoding = fieldbus::Encoding::bfloat16;
  bool pdo_map_count_may_be_read_only = false;
  std::optional<std::uint8_t> sync_counter;  ///< overflow value wanted in 1019h; none: no counter
  bool has_sync_counter_object = true;       ///< 1019h exists
  bool has_sync_period_object = true;        ///< 1006h exists
  Duration sync_period_step{std::chrono::microseconds(1)};  ///< 1006h takes multiples of this
  /// Shortest and longest SYNC period that the drive follows.
  Duration sync_period_min{0}, sync_period_max{Duration::max()};
  /// The maker's rule for the shortest sensible SYNC period, where it gives one: so many PDOs fill
  /// a millisecond at 1 Mbit/s, they may take that share, and the rest needs some time.
  struct SyncAdvice {
    double pdos_per_ms = 0.0, share = 1.0;
    Duration margin{0};
  };
  std::optional<SyncAdvice> sync_advice;
  bool heartbeat_supported = true, heartbeat_consumer_supported = true;
  Duration error_control_min{0};  ///< shortest heartbeat and guard time that the drive stands
  bool node_guarding_supported = false;  ///< 100Ch and 100Dh; used where there is no heartbeat
  /// NMT reset node must not be sent: the drive disturbs the bus while it starts, or does not come
  /// back. Its communication is reset instead.
  bool nmt_reset_node = true;
  bool nmt_reset_does_nothing = false;          ///< then it may be sent, where somebody asks for it
  Duration boot_time{std::chrono::seconds(5)};  ///< from a reset until the drive answers
  fieldbus::AccessOptions sdo;                  ///< `timeout` and `retries` of transfers
  BusSettings bus_settings;
};

}  // namespace cia402::canopen
