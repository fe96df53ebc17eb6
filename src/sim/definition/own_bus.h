// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "fieldbus/object.h"

namespace cia402::sim {

/// Node-ID and bit rate that objects of the maker's own hold.
struct OwnBusDefinition {
  std::optional<fieldbus::ObjectId> node_id;     ///< nothing: LSS says it
  std::optional<fieldbus::ObjectId> bit_rate;    ///< nothing: it has that of the bus
  std::map<std::uint64_t, std::uint32_t> rates;  ///< its numbers, and bit/s
  bool at_once = false;  ///< they count as soon as the write was answered, else from the next start
};

}  // namespace cia402::sim
