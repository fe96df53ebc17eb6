// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/image.h"

#include <algorithm>

namespace cia402::canopen {
namespace {

constexpr unsigned kMaxBits = 64;

std::uint64_t maskOf(unsigned bits) {
  return bits >= kMaxBits ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

std::uint64_t loadLittleEndian(const std::array<std::uint8_t, 8>& data) {
  return static_cast<std::uint64_t>(data[0]) | static_cast<std::uint64_t>(data[1]) << 8 |
         static_cast<std::uint64_t>(data[2]) << 16 | static_cast<std::uint64_t>(data[3]) << 24 |
         static_cast<std::uint64_t>(data[4]) << 32 | static_cast<std::uint64_t>(data[5]) << 40 |
         static_cast<std::uint64_t>(data[6]) << 48 | static_cast<std::uint64_t>(data[7]) << 56;
}

void storeLittleEndian(std::uint64_t word, std::array<std::uint8_t, 8>& data) {
  data[0] = static_cast<std::uint8_t>(word);
  data[1] = static_cast<std::uint8_t>(word >> 8);
  data[2] = static_cast<std::uint8_t>(word >> 16);
  data[3] = static_cast<std::uint8_t>(word >> 24);
  data[4] = static_cast<std::uint8_t>(word >> 32);
  data[5] = static_cast<std::uint8_t>(word >> 40);
  data[6] = static_cast<std::uint8_t>(word >> 48);
  data[7] = static_cast<std::uint8_t>(word >> 56);
}

}  // namespace

PdoImage::PdoImage(const std::vector<PdoConfig>& pdos) {
  for (const PdoConfig& config : pdos) {
    if (config.enabled) add(config);
  }
  const auto by_number = [](const Pdo& a, const Pdo& b) { return a.number < b.number; };
  std::stable_sort(tpdos_.begin(), tpdos_.end(), by_number);
  std::stable_sort(rpdos_.begin(), rpdos_.end(), by_number);
  describeSlots();
  for (std::size_t i = 0; i < tpdos_.size(); ++i) {
    if (isRequested(tpdos_[i].transmission)) requested_.push_back(i);
  }
}

/// Of two PDOs that carry an object, the first counts.
void PdoImage::describeSlots() {
  for (std::size_t i = tpdos_.size(); i-- > 0;) {
    const Pdo& pdo = tpdos_[i];
    const bool by_cycles = pdo.silent_limit != 0;
    for (const Pdo::Field& field : pdo.fields) {
      setDelivery(field.slot, {by_cycles || pdo.age_limit != Duration::zero(),
                               by_cycles ? pdo.every : std::uint16_t{0}, pdo.event_interval});
    }
  }
  for (std::size_t i = rpdos_.size(); i-- > 0;) {
    for (const Pdo::Field& field : rpdos_[i].fields) setCarrier(field.slot, i);
  }
}

void PdoImage::add(const PdoConfig& config) {
  const bool input = config.direction == PdoDirection::tpdo;
  Pdo pdo{};
  pdo.direction = config.direction;
  pdo.number = config.number;
  pdo.cob_id = config.cob_id;
  pdo.transmission = config.transmission;
  pdo.carrier = config.carrier;
  pdo.start_wait = config.sync_start_wait;
  unsigned shift = 0;
  for (const PdoEntry& entry : config.entries) {
    if (entry.bits == 0 || shift + entry.bits > kMaxBits) break;  // refused when the node boots
    const fieldbus::Slot slot = input ? addInput(entry.object) : addOutput(entry.object);
    pdo.fields.push_back({slot, static_cast<std::uint8_t>(shift), entry.bits,
                          fieldbus::Encoding::integer, maskOf(entry.bits), 0, 0});
    shift += entry.bits;
  }
  pdo.size = static_cast<std::uint8_t>((shift + 7) / 8);
  pdo.all_fields = pdo.fields;
  pdo.request_every = std::max<std::uint16_t>(config.request_every, 1);
  pdo.refresh_every = std::max<std::uint16_t>(config.refresh_every, 1);
  if (isCyclic(config.transmission)) {
    pdo.every = config.transmission;
    pdo.silent_limit = std::uint32_t{config.stale_after} * pdo.every;
  } else if (isRequested(config.transmission)) {
    pdo.every = pdo.request_every;
    pdo.silent_limit = std::uint32_t{config.stale_after} * pdo.every;
  } else if (isEventDriven(config.transmission)) {
    pdo.event_interval = std::chrono::milliseconds(config.event_timer) +
                         std::chrono::microseconds(100) * config.inhibit;
    if (config.event_timer != 0) pdo.age_limit = config.stale_after * pdo.event_interval;
  }
  (input ? tpdos_ : rpdos_).push_back(std::move(pdo));
}

bool PdoImage::receive(std::size_t tpdo, const can::Frame& frame, Time stamp) {
  Pdo& pdo = tpdos_[tpdo];
  const bool exact = frame.size == pdo.size;
  if (!exact) {
    ++wrong_lengths_;
    pdo.wrong_size = frame.size;
    pdo.last_too_short = frame.size < pdo.size;
    ++(pdo.last_too_short ? pdo.too_short : pdo.too_long);
    if (pdo.last_too_short) return false;
  }
  pdo.last_too_short = false;
  pdo.begun = true;
  ++pdo.received;
  pdo.last = stamp;
  pdo.silent = 0;
  pdo.stale = false;
  const std::uint64_t word = loadLittleEndian(frame.data);
  fieldbus::ProcessValue* const values = inputs();
  for (const Pdo::Field& field : pdo.fields) {
    values[field.slot] = {(word >> field.shift) & field.mask, stamp, true, true};
  }
  if (pdo.recoded) recode(pdo);
  return exact;
}

/// Of what has come as it is on the wire.
void PdoImage::recode(const Pdo& pdo) {
  for (const Pdo::Field& field : pdo.fields) {
    if (field.half == fieldbus::Encoding::integer) continue;
    std::uint64_t& raw = inputs()[field.slot].raw;
    raw = wholeOf(field.half, static_cast<std::uint16_t>(raw));
  }
}

void PdoImage::age(Time now) {
  for (Pdo& pdo : tpdos_) {
    ++pdo.silent;
    // As it should be, and most often: it comes by the cycle, it came, and is not overdue.
    if (pdo.silent <= pdo.silent_limit && pdo.last != Time()) continue;
    if (pdo.stale || pdo.fields.empty()) continue;
    if (pdo.silent_limit == 0 && pdo.age_limit == Duration::zero()) continue;
    if (pdo.last == Time()) pdo.last = now;  // it is expected from now on
    const std::uint32_t limit = pdo.silent_limit + (pdo.begun ? 0U : pdo.start_wait);
    const bool overdue =
        pdo.silent_limit != 0 ? pdo.silent > limit : now - pdo.last > pdo.age_limit;
    if (!overdue) continue;
    pdo.stale = true;
    for (const Pdo::Field& field : pdo.fields) outdate(field.slot);
    ++pdo.stale_count;
    ++stale_count_;
  }
}

bool PdoImage::requestDue(std::size_t tpdo, can::Frame& frame) {
  Pdo& pdo = tpdos_[tpdo];
  if (++pdo.since_request < pdo.request_every || pdo.fields.empty()) return false;
  pdo.since_request = 0;
  frame = can::Frame();
  frame.id = pdo.cob_id;
  frame.size = pdo.size;
  frame.remote = true;
  return true;
}

std::uint64_t PdoImage::pack(const Pdo& pdo) const {
  if (pdo.recoded) return packRecoded(pdo);
  std::uint64_t word = 0;
  for (const Pdo::Field& field : pdo.fields) {
    word |= (output(field.slot) & field.mask) << field.shift;
  }
  return word;
}

std::uint64_t PdoImage::packRecoded(const Pdo& pdo) const {
  std::uint64_t word = 0;
  for (const Pdo::Field& field : pdo.fields) {
    const std::uint64_t raw = output(field.slot);
    const bool whole = field.half == fieldbus::Encoding::integer;
    const std::uint64_t wire = whole ? raw : halfOf(field.half, static_cast<std::uint32_t>(raw));
    std::uint64_t value = wire & field.mask;
    if ((value & field.sign) != 0) value |= field.extension;
    word |= value << field.shift;
  }
  return word;
}

void PdoImage::fillFrame(const Pdo& pdo, std::uint64_t word, can::Frame& frame) const {
  frame.id = pdo.cob_id;
  frame.size = pdo.size;
  frame.extended = frame.remote = frame.error = false;
  storeLittleEndian(word, frame.data);
}

void PdoImage::pack(std::size_t rpdo, can::Frame& frame) const {
  fillFrame(rpdos_[rpdo], pack(rpdos_[rpdo]), frame);
}

bool PdoImage::packDue(Pdo& pdo, can::Frame& frame, Time now) {
  if (pdo.fields.empty()) return false;
  const std::uint64_t word = pack(pdo);
  if (++pdo.silent < pdo.refresh_every && pdo.sent_once && word == pdo.sent) return false;
  fillFrame(pdo, word, frame);
  pdo.sent = word;
  pdo.sent_once = true;
  pdo.silent = 0;
  pdo.last = now;
  return true;
}

bool PdoImage::packDue(std::size_t rpdo, can::Frame& frame, Time now) {
  if (!packDue(rpdos_[rpdo], frame, now)) return false;
  countSent(rpdo);
  return true;
}

void PdoImage::sendDue(can::Sink& sink, Time now) {
  can::Frame frame;
  std::size_t rpdo = 0;
  for (Pdo& pdo : rpdos_) {
    if (packDue(pdo, frame, now)) {
      countSent(rpdo);
      if (!sink.send(frame)) pdo.sent_once = false;
    }
    ++rpdo;
  }
}

void PdoImage::setCobId(PdoDirection direction, unsigned number, std::uint16_t cob_id) {
  for (Pdo& pdo : pdosOf(direction)) {
    if (pdo.number == number) pdo.cob_id = cob_id;
  }
}

void PdoImage::leaveOut(PdoDirection direction, unsigned number, ObjectId object) {
  const bool input = direction == PdoDirection::tpdo;
  const fieldbus::Slot slot = input ? inputSlot(object) : outputSlot(object);
  for (Pdo& pdo : pdosOf(direction)) {
    if (pdo.number != number) continue;
    const auto gone = std::find_if(pdo.fields.begin(), pdo.fields.end(),
                                   [slot](const Pdo::Field& field) { return field.slot == slot; });
    if (gone == pdo.fields.end()) continue;
    pdo.fields.erase(gone);
    layOut(pdo);
    noteLeftOut(direction, slot);
  }
}

/// One field behind the other.
void PdoImage::layOut(Pdo& pdo) {
  unsigned shift = 0;
  for (Pdo::Field& field : pdo.fields) {
    field.shift = static_cast<std::uint8_t>(shift);
    shift += field.bits;
  }
  pdo.size = static_cast<std::uint8_t>((shift + 7) / 8);
  pdo.recoded = std::any_of(pdo.fields.begin(), pdo.fields.end(), [](const Pdo::Field& field) {
    return field.half != fieldbus::Encoding::integer || field.sign != 0;
  });
}

void PdoImage::setHalfFloats(const std::vector<HalfFloat>& known, const HalfFloats& halves) {
  for (std::vector<Pdo>* pdos : {&tpdos_, &rpdos_}) {
    for (Pdo& pdo : *pdos) {
      const bool input = pdo.direction == PdoDirection::tpdo;
      pdo.fields = pdo.all_fields;
      for (const HalfFloat& half : known) {
        const fieldbus::Slot slot = input ? inputSlot(half.object) : outputSlot(half.object);
        for (Pdo::Field& field : pdo.fields) {
          if (field.slot != slot) continue;
          const bool narrow = halves.has(half.object);
          field.half = narrow ? half.encoding : fieldbus::Encoding::integer;
          field.bits = narrow ? 16 : 32;
          field.mask = maskOf(field.bits);
        }
      }
      layOut(pdo);
      pdo.all_fields = pdo.fields;
    }
  }
}

void PdoImage::widen(ObjectId object, unsigned bits, bool is_signed) {
  for (std::vector<Pdo>* pdos : {&tpdos_, &rpdos_}) {
    const bool input = pdos == &tpdos_;
    const fieldbus::Slot slot = input ? inputSlot(object) : outputSlot(object);
    for (Pdo& pdo : *pdos) {
      for (Pdo::Field& field : pdo.fields) {
        if (field.slot != slot) continue;
        const unsigned value_bits = field.bits;
        field.bits = static_cast<std::uint8_t>(bits);
        if (!input && is_signed) {
          field.sign = std::uint64_t{1} << (value_bits - 1);
          field.extension = maskOf(bits) & ~field.mask;
        }
      }
      layOut(pdo);
    }
  }
}

void PdoImage::takeAlone(std::size_t tpdo, std::uint64_t raw, Time now) {
  Pdo& pdo = tpdos_[tpdo];
  pdo.last = now;
  pdo.silent = 0;
  pdo.stale = false;
  ++pdo.received;
  take(pdo.fields.front().slot, raw, now);
}

/// Left out is what no PDO of that direction carries any more.
void PdoImage::noteLeftOut(PdoDirection direction, fieldbus::Slot slot) {
  const std::vector<Pdo>& pdos = pdosOf(direction);
  const bool left_out = std::none_of(pdos.begin(), pdos.end(), [slot](const Pdo& pdo) {
    return std::any_of(pdo.fields.begin(), pdo.fields.end(),
                       [slot](const Pdo::Field& field) { return field.slot == slot; });
  });
  if (direction == PdoDirection::tpdo) {
    leaveOutInput(slot, left_out);
  } else {
    leaveOutOutput(slot, left_out);
  }
}

void PdoImage::includeAll() {
  for (std::vector<Pdo>* pdos : {&tpdos_, &rpdos_}) {
    for (Pdo& pdo : *pdos) {
      pdo.fields = pdo.all_fields;
      layOut(pdo);
      for (const Pdo::Field& field : pdo.fields) noteLeftOut(pdo.direction, field.slot);
    }
  }
}

void PdoImage::invalidate() {
  clear();
  for (Pdo& pdo : tpdos_) {
    pdo.stale = pdo.last_too_short = pdo.begun = false;
    pdo.silent = pdo.since_request = 0;
    pdo.last = Time();
  }
  for (Pdo& pdo : rpdos_) pdo.sent_once = false;
}

}  // namespace cia402::canopen
