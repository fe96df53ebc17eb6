// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "can/bus.h"
#include "can/frame.h"
#include "canopen/half_floats.h"
#include "canopen/pdo/config.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/process_image.h"

namespace cia402::canopen {

/// The process image of one node, packed into PDOs. Built once, then free of allocation.
class PdoImage : public fieldbus::ProcessImage {
 public:
  /// @param pdos the node's PDOs; each entry of an enabled one gets a slot (one per object and
  /// direction; an object mapped twice shares its slot).
  explicit PdoImage(const std::vector<PdoConfig>& pdos);

  /// Unpacks a TPDO. @return false if its length is not the mapped one (too short: nothing is
  /// taken; too long: the mapped part is taken, CiA 301, 7.2.2.6); counted either way.
  bool receive(std::size_t tpdo, const can::Frame& frame, Time stamp);
  /// Packs an RPDO.
  void pack(std::size_t rpdo, can::Frame& frame) const;
  /// Packs an RPDO if it is due in this cycle: its content changed, or it was not sent for
  /// PdoConfig::refresh_every cycles. Counts it as sent then.
  bool packDue(std::size_t rpdo, can::Frame& frame, Time now);
  void sendAgain(fieldbus::Slot slot) override { rpdos_[carrierOf(slot)].sent_once = false; }
  /// Sends every RPDO for which packDue() gives a frame; what `sink` refuses is due again.
  void sendDue(can::Sink& sink, Time now);
  /// One cycle more without the TPDOs that did not come: counts, and marks what is stale. Once a
  /// cycle, when SYNC goes out, while the node is in operation.
  void age(Time now);
  /// The remote frame that asks for TPDO `tpdo`, if it is due at this SYNC; to be called for each
  /// number in requested() at each SYNC.
  bool requestDue(std::size_t tpdo, can::Frame& frame);
  /// Indices of the TPDOs that remote frames ask for.
  const std::vector<std::size_t>& requested() const { return requested_; }
  /// The drive has another COB-ID than configured. No effect for a PDO that is not enabled.
  void setCobId(PdoDirection direction, unsigned number, std::uint16_t cob_id);
  /// The drive has been configured without this entry of a PDO: what stands behind it moves up. A
  /// PDO without entries is neither sent nor expected. Its value is not fresh, what is set is not
  /// sent. No effect for what is not mapped.
  void leaveOut(PdoDirection direction, unsigned number, ObjectId object);
  /// The drive has the floats of `halves` in 16 bits, and the others of `known` in 32.
  void setHalfFloats(const std::vector<HalfFloat>& known, const HalfFloats& halves);
  /// A value that came without a PDO stands for the whole TPDO, whose only one it is.
  void takeAlone(std::size_t tpdo, std::uint64_t raw, Time now);
  /// The only value of an RPDO has left without it.
  void leftAlone(std::size_t rpdo) { countSent(rpdo); }
  /// The drive holds the object in so many bits: what stands behind it moves. Its value stays as
  /// wide as constructed, negative numbers remain what they are.
  void widen(ObjectId object, unsigned bits, bool is_signed);
  /// All entries are there again, as constructed.
  void includeAll();
  /// Marks every input as unknown and sets every output to 0 (the node rebooted or was lost), so
  /// that no set-point or controlword of before is ever sent again.
  void invalidate();

  /// A PDO, and what has become of it since the image exists.
  struct Pdo {
    PdoDirection direction;
    unsigned number;
    std::uint16_t cob_id;
    std::uint8_t transmission;
    std::uint8_t size;                                        ///< bytes
    Time last{};                                              ///< last reception or transmission
    std::uint64_t received = 0, too_short = 0, too_long = 0;  ///< TPDO
    std::uint8_t wrong_size = 0;     ///< bytes of the last one that was too short or too long
    bool last_too_short = false;     ///< nothing that could be taken came since
    bool stale = false;              ///< TPDO: due for too long; see PdoConfig::stale_after
    std::uint64_t stale_count = 0;   ///< how often it became stale
    std::uint32_t silent = 0;        ///< SYNCs since the last reception or transmission
    std::uint32_t silent_limit = 0;  ///< stale beyond; 0: its silence means nothing
    Duration age_limit{0};           ///< the same for an event timer; 0: none
    std::uint8_t start_wait = 0;     ///< SYNCs more that the first one may take
    bool begun = false;              ///< it came since invalidate()
    std::uint16_t every = 1;         ///< SYNCs from one TPDO to the next, where these are limited
    Duration event_interval{0};      ///< of event-driven ones: event timer and inhibit time
    std::uint16_t request_every = 1, refresh_every = 1;
    std::uint16_t since_request = 0;
    std::string carrier;     ///< in words, where it is no PDO that carries its value; else empty
    std::uint64_t sent = 0;  ///< content of the last transmission
    bool sent_once = false;
    bool recoded = false;  ///< a value is another on the wire than in its slot
    /// Where the value of a slot lies in the data, as one little-endian number of 64 bits.
    struct Field {
      fieldbus::Slot slot;
      std::uint8_t shift;
      std::uint8_t bits;
      fieldbus::Encoding half;  ///< of a float in 16 bits, of which the slot has 32; else integer
      std::uint64_t mask;       ///< of the value, not shifted
      /// Of an RPDO's value that travels in more bits than it has: its sign, and what that becomes.
      std::uint64_t sign, extension;
    };
    std::vector<Field> fields;      ///< without those that are left out
    std::vector<Field> all_fields;  ///< as constructed
  };
  /// Enabled TPDOs / RPDOs, in order of their number.
  const std::vector<Pdo>& tpdos() const { return tpdos_; }
  /// The same of the other direction.
  const std::vector<Pdo>& rpdos() const { return rpdos_; }
  /// Frames of a wrong length, all TPDOs together.
  std::uint64_t wrongLengths() const { return wrong_lengths_; }
  /// How often a TPDO became stale, all together.
  std::uint64_t staleCount() const { return stale_count_; }
  /// Grows with both.
  std::uint64_t troubles() const { return wrong_lengths_ + stale_count_; }

 private:
  void add(const PdoConfig& config);
  static void layOut(Pdo& pdo);
  [[gnu::cold]] void recode(const Pdo& pdo);
  [[gnu::cold]] std::uint64_t packRecoded(const Pdo& pdo) const;
  void describeSlots();
  void noteLeftOut(PdoDirection direction, fieldbus::Slot slot);
  std::vector<Pdo>& pdosOf(PdoDirection direction) {
    return direction == PdoDirection::tpdo ? tpdos_ : rpdos_;
  }
  bool packDue(Pdo& pdo, can::Frame& frame, Time now);
  std::uint64_t pack(const Pdo& pdo) const;
  void fillFrame(const Pdo& pdo, std::uint64_t word, can::Frame& frame) const;

  std::vector<Pdo> tpdos_, rpdos_;
  std::vector<std::size_t> requested_;
  std::uint64_t wrong_lengths_ = 0, stale_count_ = 0;
};

}  // namespace cia402::canopen
