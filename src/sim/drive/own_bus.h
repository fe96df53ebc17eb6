// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "canopen/object.h"
#include "cia402_driver/common/time.h"
#include "sim/definition/own_bus.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// What objects of the maker's own say of the bus: node-ID and bit rate.
class OwnBus {
 public:
  /// Both must outlive it.
  OwnBus(const OwnBusDefinition& definition, ObjectDictionary& dictionary)
      : definition_(definition), dictionary_(dictionary) {}

  /// The bit rate of the bus that it hangs on; without this call each is that of the bus.
  void hangOn(std::uint32_t bit_rate) { of_bus_ = bit_rate; }
  /// Somebody has set it to the bit rate of its bus, where it has that.
  void setUp();
  /// From the next start on; nothing: LSS says it.
  std::optional<canopen::NodeId> nodeId() const;
  /// It speaks another bit rate than its bus.
  bool foreign() const;
  /// The object is one of them.
  bool holds(ObjectId id) const { return id == definition_.node_id || id == definition_.bit_rate; }
  /// An object was written, which may count as soon as that was answered.
  void written(const Entry& entry, Time now);
  /// When it does; kNever if nothing was written.
  Time due() const { return due_; }
  /// It does. @return the node-ID has changed: it resets its communication.
  bool count(canopen::NodeId present);
  void powerOff();

 private:
  const OwnBusDefinition& definition_;
  ObjectDictionary& dictionary_;
  std::uint32_t of_bus_ = 0;
  Time due_ = kNever;
};

}  // namespace cia402::sim
