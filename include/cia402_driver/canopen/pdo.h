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
  bool optional = false;  ///< left out where the drive does not have it or cannot map it
  /// Wanted only where it costs nothing: left out where the drive refuses the mapping for whatever
  /// reason, and no cause for a warning.
  bool if_room = false;
};

/// Transmission types (CiA 301, 7.5.2.35 and 7.5.2.37).
constexpr bool isCyclic(std::uint8_t type) { return type >= 1 && type <= 240; }
/// The drive sends the TPDO only when a remote frame asks for it: 252 sampled at SYNC, 253 at once.
constexpr bool isRequested(std::uint8_t type) { return type == 252 || type == 253; }
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
  std::vector<PdoEntry> entries;  ///< at most 64 bits in all

  /// A TPDO that is due and fails to come so many times in a row is stale; 0: never.
  std::uint16_t stale_after = 10;
  /// TPDO of type 252 or 253: a remote frame asks for it after every so many SYNCs.
  std::uint16_t request_every = 1;
  /// RPDO: sent in a cycle in which its content changed, and at least every so many cycles.
  std::uint16_t refresh_every = 1;
};

/// A value in a node's process image: a raw little-endian number as wide as its mapping entry.
struct ProcessValue {
  std::uint64_t raw = 0;  ///< zero-extended
  Time stamp{};           ///< when the frame that brought it was on the wire
  bool valid = false;     ///< false until the first reception since boot
  bool fresh = false;     ///< valid, and what brings it comes as it should
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
  /// Packs an RPDO if it is due in this cycle: its content changed, or it was not sent for
  /// PdoConfig::refresh_every cycles. Counts it as sent then.
  bool packDue(std::size_t rpdo, can::Frame& frame, Time now);
  /// The frame of packDue() did not leave: it is due again in the next cycle.
  void repeat(std::size_t rpdo) { rpdos_[rpdo].sent_once = false; }
  /// One cycle more without the TPDOs that did not come: counts, and marks what is stale. Once a
  /// cycle, when SYNC goes out, while the node is in operation.
  void age(Time now);
  /// The remote frame that asks for TPDO `tpdo`, if it is due at this SYNC; to be called for each
  /// number in requested() at each SYNC.
  bool requestDue(std::size_t tpdo, can::Frame& frame);
  /// Indices of the TPDOs that remote frames ask for.
  const std::vector<std::size_t>& requested() const { return requested_; }
  /// Has the value come, and in time? A slot of an object that is not mapped is not fresh.
  bool fresh(Slot slot) const { return slot != kNoSlot && inputs_[slot].fresh; }
  /// Does the value come at a known rate, whether it changes or not? @pre slot is that of an input
  bool regular(Slot slot) const {
    const Pdo& pdo = tpdos_[input_tpdos_[slot]];
    return pdo.silent_limit != 0 || pdo.age_limit != Duration::zero();
  }
  /// The longest time between two receptions of a value that comes regularly; of another one, the
  /// time for which its change may be withheld (inhibit time).
  /// @param sync SYNC period  @pre slot is that of an input
  Duration interval(Slot slot, Duration sync) const {
    const Pdo& pdo = tpdos_[input_tpdos_[slot]];
    return pdo.silent_limit != 0 ? pdo.every * sync : pdo.event_interval;
  }
  /// The TPDO (index in tpdos()) that brings an input. @pre slot is that of an input
  std::size_t tpdoOf(Slot slot) const { return input_tpdos_[slot]; }
  /// The drive has another COB-ID than configured. No effect for a PDO that is not enabled.
  void setCobId(PdoDirection direction, unsigned number, std::uint16_t cob_id);
  /// The drive has been configured without this entry of a PDO: what stands behind it moves up. A
  /// PDO without entries is neither sent nor expected. Its value is not fresh, what is set is not
  /// sent. No effect for what is not mapped.
  void leaveOut(PdoDirection direction, unsigned number, ObjectId object);
  /// All entries are there again, as constructed.
  void includeAll();
  /// Has an entry of this slot been left out, of all PDOs of that direction?
  bool isLeftOut(PdoDirection direction, Slot slot) const;
  /// The value of an input is unknown until it comes again. @pre slot is that of an input
  void forget(Slot slot) { inputs_[slot].valid = inputs_[slot].fresh = false; }
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
    std::uint64_t count = 0, too_short = 0, too_long = 0;
    std::uint8_t wrong_size = 0;     ///< bytes of the last one that was too short or too long
    bool last_too_short = false;     ///< nothing that could be taken came since
    bool stale = false;              ///< TPDO: due for too long; see PdoConfig::stale_after
    std::uint64_t stale_count = 0;   ///< how often it became stale
    std::uint32_t silent = 0;        ///< SYNCs since the last reception or transmission
    std::uint32_t silent_limit = 0;  ///< stale beyond; 0: its silence means nothing
    Duration age_limit{0};           ///< the same for an event timer; 0: none
    std::uint16_t every = 1;         ///< SYNCs from one TPDO to the next, where these are limited
    Duration event_interval{0};      ///< of event-driven ones: event timer and inhibit time
    std::uint16_t request_every = 1, refresh_every = 1;
    std::uint16_t since_request = 0;
    std::uint64_t sent = 0;  ///< content of the last transmission
    bool sent_once = false;
    struct Field {
      Slot slot;
      std::uint8_t shift;
      std::uint8_t bits;
      std::uint64_t mask;  ///< as wide, not shifted
    };
    std::vector<Field> fields;      ///< without those that are left out
    std::vector<Field> all_fields;  ///< as constructed
  };
  /// Enabled TPDOs / RPDOs, in order of their number.
  const std::vector<Pdo>& tpdos() const { return tpdos_; }
  const std::vector<Pdo>& rpdos() const { return rpdos_; }
  /// Frames of a wrong length, all TPDOs together.
  std::uint64_t wrongLengths() const { return wrong_lengths_; }
  /// How often a TPDO became stale, all together.
  std::uint64_t staleCount() const { return stale_count_; }
  /// Grows with both.
  std::uint64_t troubles() const { return wrong_lengths_ + stale_count_; }

 private:
  void add(const PdoConfig& config);
  std::vector<Pdo>& pdosOf(PdoDirection direction) {
    return direction == PdoDirection::tpdo ? tpdos_ : rpdos_;
  }
  std::uint64_t pack(const Pdo& pdo) const;
  void fillFrame(const Pdo& pdo, std::uint64_t word, can::Frame& frame) const;

  std::vector<Pdo> tpdos_, rpdos_;
  std::vector<std::size_t> requested_, input_tpdos_;
  std::uint64_t wrong_lengths_ = 0, stale_count_ = 0;
  std::vector<ProcessValue> inputs_;
  std::vector<std::uint64_t> outputs_;
  std::vector<ObjectId> input_objects_, output_objects_;
};

}  // namespace cia402::canopen
