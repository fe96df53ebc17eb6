// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/device/context.h"

namespace cia402::sim {

/// Which way a PDO goes, seen from the device.
enum class PdoDirection { receive, transmit };

/// The objects of one PDO (CiA 301, 7.5.2.36, 7.5.2.38), resolved once: no look-up per frame.
class Mapping {
 public:
  /// Whether one mapping value can stand in a PDO. @return abort code or 0.
  static std::uint32_t checkEntry(const ObjectDictionary& dictionary, std::uint64_t value,
                                  PdoDirection direction);
  /// Whether the first `count` entries of the record `index` make a PDO. @return abort code or 0.
  static std::uint32_t check(const ObjectDictionary& dictionary, std::uint16_t index,
                             std::uint64_t count, PdoDirection direction);

  /// Takes the record `index` with its sub-index 0 over; an impossible one becomes empty.
  /// @param fillers entries at its end that are 0 are none.
  void build(ObjectDictionary& dictionary, std::uint16_t index, PdoDirection direction,
             bool fillers);

  /// Where the object lies in the data: its lowest bit. Nothing: it is not mapped.
  std::optional<unsigned> placeOf(ObjectId id) const;
  bool empty() const { return objects_.empty(); }
  /// Data bytes of the PDO.
  std::uint8_t size() const { return static_cast<std::uint8_t>((bits_ + 7U) / 8U); }
  /// The data as one number, first object in the lowest bits; asks the objects' read hooks.
  std::uint64_t pack() const;
  /// Writes the data into the objects. A value an object refuses is left out.
  void unpack(std::uint64_t data, ObjectDictionary& dictionary) const;

 private:
  struct Object {
    Entry* entry;  // null: dummy entry, a gap
    const ObjectDictionary::Hooks* hooks;
    std::uint64_t mask;
    unsigned shift;
  };
  std::vector<Object> objects_;
  unsigned bits_ = 0;
};

}  // namespace cia402::sim
