// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "sim/bus/bit_timing.h"
#include "sim/bus/bus.h"

namespace cia402::sim {
namespace {

constexpr unsigned kWarningLimit = 96;   // ISO 11898-1: heavily disturbed
constexpr unsigned kPassiveLimit = 128;  // error passive from here on
constexpr unsigned kBusOffLimit = 256;   // transmit errors only
constexpr unsigned kRecoverySequences = 128;
constexpr unsigned kReceiveErrorsAfterPassive = 119;  // 119..127 after a good frame

bool hasForm(const can::Frame& frame) {
  if (frame.error || frame.size > 8) return false;
  return frame.id <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU);
}

// The arbitration field from the first identifier bit on, a standard one filled up with zeros:
// 11 bits base, RTR or SRR, IDE, 18 bits extension, RTR.
std::uint32_t arbitrationKey(const can::Frame& frame) {
  const std::uint32_t remote = frame.remote ? 1 : 0;
  if (!frame.extended) return frame.id << 21 | remote << 20;
  return (frame.id >> 18) << 21 | 3U << 19 | (frame.id & 0x3FFFFU) << 1 | remote;
}

}  // namespace

Port::Port(Bus& bus, Listener& listener, std::string name, std::size_t capacity)
    : bus_(bus), listener_(listener), name_(std::move(name)), capacity_(capacity) {
  queue_.reserve(capacity + 1);  // a frame that lost its attempt comes back even to a full queue
}

bool Port::send(const can::Frame& frame) { return send(frame, bus_.now()); }

bool Port::send(const can::Frame& frame, Time now) {
  const bool can_take = powered_ && state_ != can::BusState::bus_off && queue_.size() < capacity_;
  if (!can_take || !hasForm(frame)) {
    ++counters_.dropped;
    return false;
  }
  if (!bus_.started_) bus_.setTime(now);
  Entry entry;
  entry.key = arbitrationKey(frame);
  entry.bits = static_cast<std::uint16_t>(exactBits(frame));
  entry.ready = std::max(now, bus_.now_);
  entry.frame = frame;
  if (bus_.faults_.active()) {
    if (const auto delay = bus_.faults_.delayOf(frame)) entry.ready += *delay;
  }
  insert(entry, false);
  // Nobody acknowledges on a pulled cable: 16 vain attempts make a controller error passive, and
  // there it stays (ISO 11898-1, exception for a missing acknowledge).
  if (!attached_ && tec_ < kPassiveLimit) {
    tec_ = kPassiveLimit;
    updateState(bus_.now_);
  }
  return true;
}

void Port::append(const Entry& entry, bool ahead_of_all) {
  const Time previous_ready = queue_.empty() || ahead_of_all ? entry.ready : queue_.front().ready;
  const auto inserted = queue_.insert(ahead_of_all ? queue_.end() : queue_.begin(), entry);
  inserted->ready = std::max(entry.ready, previous_ready);
}

void Port::insert(const Entry& entry, bool ahead_of_equals) {
  if (fifo_) return append(entry, ahead_of_equals);
  const auto place = std::partition_point(queue_.begin(), queue_.end(), [&](const Entry& other) {
    return ahead_of_equals ? other.key >= entry.key : other.key > entry.key;
  });
  const bool behind_equal = place != queue_.end() && place->key == entry.key;
  const Time previous_ready = behind_equal ? place->ready : entry.ready;
  const auto inserted = queue_.insert(place, entry);
  inserted->ready = std::max(entry.ready, previous_ready);  // none overtakes within an identifier
}

const Port::Entry* Port::bestReadyAt(Time time) const {
  if (suspended_until_ > time) return nullptr;
  if (fifo_) return !queue_.empty() && queue_.back().ready <= time ? &queue_.back() : nullptr;
  for (auto entry = queue_.rbegin(); entry != queue_.rend(); ++entry) {
    if (entry->ready <= time) return &*entry;
  }
  return nullptr;
}

Time Port::earliestReady() const {
  Time earliest = kNever;
  if (fifo_ && !queue_.empty()) return std::max(queue_.back().ready, suspended_until_);
  for (const Entry& entry : queue_) earliest = std::min(earliest, entry.ready);
  return std::max(earliest, suspended_until_);
}

void Port::discardQueue() {
  counters_.dropped += queue_.size();
  queue_.clear();
}

void Port::setAttached(bool attached) {
  attached_ = attached;
  refreshOnBus(bus_.now_);
}

void Port::setPowered(bool powered) {
  if (powered == powered_) return;
  powered_ = powered;
  tec_ = rec_ = 0;
  stopRecovery();
  if (!powered) discardQueue();
  state_ = can::BusState::down;  // so that the new state is no longer bus-off, whatever it was
  updateState(bus_.now_);
}

void Port::forceBusOff() {
  if (!powered_ || state_ == can::BusState::bus_off) return;
  tec_ = kBusOffLimit;
  updateState(bus_.now_);
}

void Port::requestRecovery() {
  if (state_ != can::BusState::bus_off || recovering_) return;
  recovering_ = true;
  ++bus_.recovering_;
  recovery_left_ = kRecoverySequences;
  recovery_since_ = std::max(bus_.now_, bus_.idle_at_);
}

void Port::stopRecovery() {
  if (recovering_) --bus_.recovering_;
  recovering_ = false;
}

void Port::recovered(Time now) {
  stopRecovery();
  tec_ = rec_ = 0;
  updateState(now);
}

void Port::refreshOnBus(Time now) {
  const bool on_bus = powered_ && attached_ && state_ != can::BusState::bus_off;
  if (on_bus == on_bus_) return;
  on_bus_ = on_bus;
  if (on_bus) {
    listening_since_ = now;
    suspended_until_ = std::max(suspended_until_, now);
  } else {
    bus_.abort(*this);
  }
}

void Port::transmitFailed(bool missing_acknowledge, Time now) {
  ++counters_.failed_attempts;
  if (missing_acknowledge && tec_ >= kPassiveLimit) return;
  tec_ += 8;
  updateState(now);
}

void Port::transmitSucceeded(Time now) {
  ++counters_.sent;
  if (tec_ == 0) return;
  --tec_;
  updateState(now);
}

void Port::receiveFailed(Time now) {
  if (rec_ < kPassiveLimit) ++rec_;
  updateState(now);
}

void Port::receiveSucceeded(Time now) {
  ++counters_.received;
  if (rec_ == 0) return;
  rec_ = rec_ >= kPassiveLimit ? kReceiveErrorsAfterPassive : rec_ - 1;
  updateState(now);
}

void Port::updateState(Time now) {
  can::BusState state = can::BusState::error_active;
  if (!powered_) {
    state = can::BusState::down;
  } else if (tec_ >= kBusOffLimit) {
    state = can::BusState::bus_off;
  } else if (std::max(tec_, rec_) >= kPassiveLimit) {
    state = can::BusState::error_passive;
  } else if (std::max(tec_, rec_) >= kWarningLimit) {
    state = can::BusState::error_warning;
  }
  if (state == state_) return refreshOnBus(now);
  state_ = state;
  if (state == can::BusState::bus_off) {
    ++counters_.bus_off_events;
    discardQueue();
  }
  refreshOnBus(now);
  listener_.onStateChange(state, now);
}

}  // namespace cia402::sim
