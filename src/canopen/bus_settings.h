// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace cia402::canopen {

/// An object of the maker that holds what the bus wants of a device.
struct BusSetting {
  /// When another number counts.
  enum class Counts : std::uint8_t { at_once, after_reset, after_power_cycle };
  std::string object;  ///< by its name in the profile of the drive; empty: there is none
  Counts counts = Counts::at_once;
  std::map<std::uint32_t, std::int64_t> numbers;  ///< bit/s to what the object says; else as it is
};

/// How a device without LSS gets another node-ID or bit rate.
struct BusSettings {
  BusSetting node_id, bit_rate;
  /// Object that must say a number while that is written, so that it stays without power.
  std::string memory;
  std::int64_t memory_on = 1, memory_off = 0;
  bool saved_apart = false;  ///< it stays only once the parameters are saved
  /// Bit/s to the share of a bit after which the device reads it, what it best has first.
  std::map<std::uint32_t, std::vector<double>> sample_points;
};

}  // namespace cia402::canopen
