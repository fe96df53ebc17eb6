// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cia402_driver/can/frame.h"
#include "cia402_driver/canopen/object.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// Direction as the drive sees it (CiA 301): an RPDO is sent by the master, a TPDO by the drive.
enum class PdoDirection : std::uint8_t { rpdo, tpdo };

/// One entry of a PDO mapping.
struct PdoEntry {
  ObjectId object;
  std::uint8_t bits = 0;  ///< 1..64
  std::string name;       ///< for messages
};

/// The wanted configuration of one PDO of a node (CiA 301, objects 1400h/1600h, 1800h/1A00h).
struct PdoConfig {
  PdoDirection direction = PdoDirection::tpdo;
  unsigned number = 1;            ///< 1..512; communication parameters at 1400h/1800h + number - 1
  std::uint16_t cob_id = 0;       ///< 11-bit CAN-ID
  std::uint8_t transmission = 1;  ///< transmission type 0..240, 254, 255
  std::uint16_t inhibit = 0;      ///< inhibit time, 100 us (TPDO only)
  std::uint16_t event_timer = 0;  ///< ms
  bool enabled = true;            ///< false: only made invalid (bit 31)
  std::vector<PdoEntry> entries;  ///< at most 64 bits in all
};

/// A value in a node's process image: a raw little-endian number as wide as its mapping entry.
struct ProcessValue {
  std::uint64_t raw = 0;  ///< zero-extended
  Time stamp{};           ///< when the frame that brought it was on the wire
  bool valid = false;     ///< false until the first reception since boot
};

/// Index into a node's process image; kNoSlot if the object is not mapped.
using Slot = std::uint16_t;
inline constexpr Slot kNoSlot = 0xFFFF;

/// The values that travel by PDO between the master and one node, both ways. Built once, then free
/// of allocation.
class ProcessImage {
 public:
  /// @param pdos the node's PDOs; each entry of an enabled one gets a slot (one per object and
  /// direction; an object mapped twice shares its slot).
  explicit ProcessImage(const std::vector<PdoConfig>& pdos);

  Slot inputSlot(ObjectId object) const;   ///< object that a TPDO brings, or kNoSlot
  Slot outputSlot(ObjectId object) const;  ///< object that an RPDO takes, or kNoSlot
  const ProcessValue& input(Slot slot) const { return inputs_[slot]; }
  void setOutput(Slot slot, std::uint64_t raw) { outputs_[slot] = raw; }
  std::uint64_t output(Slot slot) const { return outputs_[slot]; }

  /// Unpacks a TPDO. @return false if its length is not the mapped one (too short: nothing is
  /// taken; too long: the mapped part is taken, CiA 301, 7.2.2.6); counted either way.
  bool receive(std::size_t tpdo, const can::Frame& frame, Time stamp);
  /// Packs an RPDO.
  void pack(std::size_t rpdo, can::Frame& frame) const;
  /// Marks every input as unknown and sets every output to 0 (the node rebooted or was lost), so
  /// that no set-point or controlword of before is ever sent again.
  void invalidate();

  struct Pdo {
    PdoDirection direction;
    unsigned number;
    std::uint16_t cob_id;
    std::uint8_t transmission;
    std::uint8_t size;  ///< bytes
    Time last{};        ///< last reception or transmission
    std::uint64_t count = 0, wrong_length = 0;
    struct Field {
      Slot slot;
      std::uint8_t shift;
      std::uint8_t bits;
    };
    std::vector<Field> fields;
  };
  /// Enabled TPDOs / RPDOs, in order of their number.
  const std::vector<Pdo>& tpdos() const { return tpdos_; }
  const std::vector<Pdo>& rpdos() const { return rpdos_; }
  std::vector<Pdo>& rpdos() { return rpdos_; }

 private:
  void add(const PdoConfig& config);

  std::vector<Pdo> tpdos_, rpdos_;
  std::vector<ProcessValue> inputs_;
  std::vector<std::uint64_t> outputs_;
  std::vector<ObjectId> input_objects_, output_objects_;
};

}  // namespace cia402::canopen
