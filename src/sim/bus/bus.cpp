// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/bus.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/bus/bit_timing.h"

namespace cia402::sim {
namespace {

constexpr unsigned kEndOfFrameBits = 7;
constexpr unsigned kErrorFlagBits = 6;
constexpr unsigned kSuperposedErrorFlagBits = 12;  // the longest: the echo of the other nodes
constexpr unsigned kErrorDelimiterBits = 8;
constexpr unsigned kSuspendBits = 8;         // an error passive node after its own frame
constexpr unsigned kRecessiveSequence = 11;  // the unit in which bus-off recovery counts
constexpr std::int64_t kSlot = 100'000'000;  // ns

can::Frame errorFrame(bool missing_acknowledge) {
  // linux/can/error.h: bus error with protocol violation, or without acknowledge.
  can::Frame frame(missing_acknowledge ? 0xA0U : 0x88U, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.error = true;
  if (missing_acknowledge) {
    frame.data[3] = 0x19;  // location: ACK slot
  } else {
    frame.data[2] = 0x01;  // single bit error
  }
  return frame;
}

}  // namespace

Bus::Bus(double bitrate, std::uint64_t seed) : bitrate_(bitrate), faults_(seed) {
  if (!(bitrate > 0)) throw std::invalid_argument("sim::Bus: the bit rate must be positive");
  for (std::size_t count = 0; count < bit_times_.size(); ++count) {
    bit_times_[count] = std::llround(static_cast<double>(count) * 1e9 / bitrate);
  }
  slot_number_.fill(-1);
}

Port& Bus::attach(Listener& listener, std::string name, std::size_t queue_capacity) {
  ports_.push_back(std::make_unique<Port>(*this, listener, std::move(name), queue_capacity));
  ports_.back()->listening_since_ = started_ ? now_ : Time::min();
  return *ports_.back();
}

Duration Bus::bits(unsigned count) const {
  if (count < bit_times_.size()) return Duration(bit_times_[count]);
  return Duration(std::llround(static_cast<double>(count) * 1e9 / bitrate_));
}

void Bus::setTime(Time now) {
  if (!started_) {
    started_ = true;
    now_ = start_time_ = idle_at_ = now;
  }
  now_ = std::max(now_, now);
}

void Bus::jam(Time until) { idle_at_ = std::max(idle_at_, until); }

void Bus::setMonitor(std::function<void(const can::Frame&, Time)> monitor) {
  monitor_ = std::move(monitor);
}

Time Bus::nextEvent() const {
  if (transmitting_) return wire_.end;
  Time next = kNever;
  const Candidate winner = arbitrate();
  if (winner.port != nullptr) next = winner.start + bits(winner.entry->bits - kInterframeBits);
  Time recovered = kNever;
  if (recovering_ > 0 && nextRecovery(recovered) != nullptr) next = std::min(next, recovered);
  return next;
}

void Bus::advance(Time now) {
  if (!started_) setTime(now);
  for (;;) {
    if (transmitting_) {
      if (wire_.end > now) break;
      finish();
      continue;
    }
    const Candidate winner = arbitrate();
    Time recovered = kNever;
    Port* const port = recovering_ > 0 ? nextRecovery(recovered) : nullptr;
    if (port != nullptr && recovered <= std::min(now, winner.start)) {
      now_ = std::max(now_, recovered);
      port->recovered(recovered);
      continue;
    }
    if (winner.port == nullptr || winner.start >= now) break;
    start(winner);
  }
  setTime(now);
}

Bus::Candidate Bus::winnerAmongReady(Time start) const {
  Candidate winner;
  for (const auto& port : ports_) {
    if (!port->canTransmit()) continue;
    const Port::Entry* const entry = port->bestReadyAt(start);
    if (entry == nullptr) continue;
    if (winner.entry == nullptr || entry->key < winner.entry->key) {
      winner = {port.get(), start, entry};
    }
  }
  return winner;
}

Bus::Candidate Bus::arbitrate() const {
  Candidate winner;
  Time earliest = kNever;  // of those who are not ready by then
  for (const auto& port : ports_) {
    if (!port->canTransmit()) continue;
    if (const Port::Entry* const entry = port->bestReadyAt(idle_at_); entry == nullptr) {
      earliest = std::min(earliest, port->earliestReady());
    } else if (winner.entry == nullptr || entry->key < winner.entry->key) {
      winner = {port.get(), idle_at_, entry};
    }
  }
  return winner.port != nullptr || earliest == kNever ? winner : winnerAmongReady(earliest);
}

bool Bus::acknowledged(const Port& sender) const {
  if (analyser_) return true;
  return std::any_of(ports_.begin(), ports_.end(),
                     [&](const auto& port) { return port.get() != &sender && port->on_bus_; });
}

void Bus::start(const Candidate& winner) {
  if (recovering_ > 0) countRecessiveUntil(winner.start);
  transmitting_ = true;
  wire_.sender = winner.port;
  wire_.entry = *winner.entry;
  wire_.start = winner.start;
  wire_.outcome = Outcome::success;
  auto& queue = winner.port->queue_;
  queue.erase(queue.begin() + (winner.entry - queue.data()));

  wire_.bits = wire_.entry.bits;
  if (!acknowledged(*winner.port)) {
    wire_.outcome = Outcome::unacknowledged;
    wire_.bits += kErrorFlagBits + kErrorDelimiterBits - kEndOfFrameBits - 1;  // 1: ACK delimiter
  } else if (faults_.active() && faults_.corrupts(wire_.entry.frame)) {
    wire_.outcome = Outcome::corrupted;
    const double positions = wire_.entry.bits - kInterframeBits;
    const unsigned good_bits = 1 + static_cast<unsigned>(faults_.uniform() * positions);
    wire_.bits = good_bits + kSuperposedErrorFlagBits + kErrorDelimiterBits + kInterframeBits;
  }
  wire_.end = wire_.start + bits(wire_.bits - kInterframeBits);
}

void Bus::abort(const Port& sender) {
  if (!transmitting_ || wire_.sender != &sender || wire_.outcome == Outcome::aborted) return;
  const double good_bits =
      std::ceil(toSeconds(std::max(now_, wire_.start) - wire_.start) * bitrate_);
  wire_.outcome = Outcome::aborted;
  wire_.bits = static_cast<unsigned>(good_bits) + kSuperposedErrorFlagBits + kErrorDelimiterBits +
               kInterframeBits;
  wire_.end = wire_.start + bits(wire_.bits - kInterframeBits);
}

void Bus::finish() {
  transmitting_ = false;
  now_ = std::max(now_, wire_.end);
  idle_at_ = wire_.start + bits(wire_.bits);
  account();
  if (recovering_ > 0) countRecessiveSequence();
  if (wire_.sender->state_ == can::BusState::error_passive) {
    wire_.sender->suspended_until_ = idle_at_ + bits(kSuspendBits);
  }
  if (wire_.outcome == Outcome::success) {
    deliver();
  } else {
    fail();
  }
}

void Bus::deliver() {
  ++traffic_.frames;
  const Transmission& wire = wire_;  // no other starts before the listeners return
  const can::Frame& frame = wire.entry.frame;
  const bool faulty = faults_.active();
  const bool lost_for_all = faulty && faults_.losesForAll(frame);
  const bool duplicated = faulty && !wire.entry.repeated && faults_.duplicates(frame);
  if (duplicated) {
    Port::Entry again = wire.entry;
    again.repeated = true;
    wire.sender->insert(again, true);
  }
  if (monitor_) monitor_(frame, wire.end);
  for (const auto& port : ports_) {
    if (port.get() == wire.sender || !port->on_bus_ || port->listening_since_ > wire.start)
      continue;
    if (faulty && (faults_.losesAt(port->name_, frame) || lost_for_all)) {
      ++port->counters_.lost;
      continue;
    }
    port->receiveSucceeded(wire.end);
    port->listener_.onFrame(frame, wire.end);
  }
  if (duplicated) return;
  wire.sender->transmitSucceeded(wire.end);
  wire.sender->listener_.onSent(frame, wire.end);
}

void Bus::fail() {
  ++traffic_.error_frames;
  const Transmission& wire = wire_;  // no other starts before the listeners return
  const bool missing_acknowledge = wire.outcome == Outcome::unacknowledged;
  if (monitor_) monitor_(errorFrame(missing_acknowledge), wire.end);
  if (!missing_acknowledge) {
    for (const auto& port : ports_) {
      if (port.get() != wire.sender && port->on_bus_) port->receiveFailed(wire.end);
    }
  }
  Port& sender = *wire.sender;
  if (sender.powered_ && sender.state_ != can::BusState::bus_off) {
    sender.transmitFailed(missing_acknowledge || !sender.attached_, wire.end);
  }
  if (sender.powered_ && sender.state_ != can::BusState::bus_off) {
    sender.insert(wire.entry, true);
  } else {
    ++sender.counters_.dropped;
  }
}

Port* Bus::nextRecovery(Time& when) const {
  Port* first = nullptr;
  when = kNever;
  for (const auto& port : ports_) {
    if (!port->recovering_) continue;
    const Time done = port->recovery_since_ + bits(port->recovery_left_ * kRecessiveSequence);
    if (first == nullptr || done < when) {
      first = port.get();
      when = done;
    }
  }
  return first;
}

void Bus::countRecessiveUntil(Time start) {
  for (const auto& port : ports_) {
    if (!port->recovering_ || start <= port->recovery_since_) continue;
    const auto seen = (start - port->recovery_since_) / bits(kRecessiveSequence);
    port->recovery_left_ -= std::min(port->recovery_left_, static_cast<unsigned>(seen));
  }
}

// ACK or error delimiter, end of frame and intermission are eleven recessive bits together.
void Bus::countRecessiveSequence() {
  for (const auto& port : ports_) {
    if (!port->recovering_) continue;
    if (port->recovery_left_ > 0) --port->recovery_left_;
    port->recovery_since_ = idle_at_;
  }
}

void Bus::account() {
  const Duration busy = idle_at_ - wire_.start;
  busy_ += busy;
  traffic_.busy_bits += wire_.bits;
  const std::int64_t number = wire_.end.time_since_epoch().count() / kSlot;
  const auto slot = static_cast<std::size_t>(number) % kSlots;
  if (slot_number_[slot] != number) {
    slot_number_[slot] = number;
    slot_busy_[slot] = Duration::zero();
  }
  slot_busy_[slot] += busy;
}

double Bus::load() const {
  const Duration elapsed = now_ - start_time_;
  if (elapsed <= Duration::zero()) return 0;
  return std::min(1.0, toSeconds(busy_) / toSeconds(elapsed));
}

double Bus::recentLoad() const {
  const std::int64_t running = now_.time_since_epoch().count() / kSlot;
  const std::int64_t full_slots = kSlots - 1;
  if (start_time_.time_since_epoch().count() > (running - full_slots) * kSlot) return load();
  Duration busy{};
  for (std::size_t i = 0; i < kSlots; ++i) {
    if (slot_number_[i] < running && slot_number_[i] >= running - full_slots) busy += slot_busy_[i];
  }
  return std::min(1.0, toSeconds(busy) / (static_cast<double>(full_slots * kSlot) * 1e-9));
}

}  // namespace cia402::sim
