// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/heartbeat.h"

#include <algorithm>

#include "sim/device/frame.h"

namespace cia402::sim {

using canopen::NmtState;

namespace {

constexpr std::uint32_t kErrorControl = 0x700;
constexpr std::uint16_t kConsumerTimes = 0x1016;
constexpr ObjectId kProducerTime{0x1017, 0};
constexpr std::uint16_t kHeartbeatLost = 0x8130;
constexpr std::uint32_t kParameterIncompatible = 0x06040043;

canopen::NodeId consumerNode(std::uint64_t number) {
  return static_cast<canopen::NodeId>(number >> 16U);
}

Duration consumerTime(std::uint64_t number) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(number & 0xFFFF));
}

bool isUsed(std::uint64_t number) {
  const canopen::NodeId node = consumerNode(number);
  return node >= 1 && node <= 127 && consumerTime(number) > Duration::zero();
}

}  // namespace

void SlaveHeartbeat::serveObjects() {
  context_.serveWrites(kProducerTime, nullptr, [this](const Entry&) {
    next_ = period() > Duration::zero() ? context_.now : kNever;
  });
  consumers_.clear();
  for (std::uint8_t sub = 1; sub <= 127; ++sub) {
    const ObjectId id{kConsumerTimes, sub};
    if (context_.dictionary.find(id) == nullptr) break;
    Consumer consumer;
    consumer.id = id;
    consumers_.push_back(consumer);
    const std::size_t place = consumers_.size() - 1;
    context_.serveWrites(
        id,
        [this](const Entry& entry, std::uint64_t number) { return checkConsumer(entry, number); },
        [this, place](const Entry&) { configure(consumers_[place]); });
  }
}

void SlaveHeartbeat::reset() {
  next_ = kNever;
  for (Consumer& consumer : consumers_) {
    consumer.lost = false;
    consumer.time = Duration::zero();
    consumer.deadline = kNever;
  }
}

void SlaveHeartbeat::start() {
  if (context_.behaviour.boot_up_message) {
    context_.sink.send(can::Frame(kErrorControl + context_.node, {0x00}));
  }
  next_ = period() > Duration::zero() ? context_.now + period() : kNever;
  for (Consumer& consumer : consumers_) configure(consumer);
}

Duration SlaveHeartbeat::period() const {
  return std::chrono::milliseconds(static_cast<std::int64_t>(context_.value(kProducerTime)));
}

void SlaveHeartbeat::sendHeartbeat() {
  context_.sink.send(
      can::Frame(kErrorControl + context_.node, {static_cast<std::uint8_t>(context_.state)}));
  next_ += period();
  if (next_ <= context_.now) next_ = context_.now + period();
}

// One node is watched by one entry (CiA 301, 7.5.2.19).
std::uint32_t SlaveHeartbeat::checkConsumer(const Entry& entry, std::uint64_t number) const {
  if (!isUsed(number)) return 0;
  for (const Consumer& other : consumers_) {
    const std::uint64_t value = context_.value(other.id);
    if (other.id != entry.id && isUsed(value) && consumerNode(value) == consumerNode(number)) {
      return kParameterIncompatible;
    }
  }
  return 0;
}

void SlaveHeartbeat::configure(Consumer& consumer) {
  const std::uint64_t number = context_.value(consumer.id);
  consumer.node = consumerNode(number);
  consumer.time = isUsed(number) ? consumerTime(number) : Duration::zero();
  consumer.deadline = kNever;
  emergency_.resolve(consumer.lost);
}

void SlaveHeartbeat::receive(canopen::NodeId node, const can::Frame& frame) {
  if (frame.remote || frame.size != 1) return;
  if (static_cast<NmtState>(frame.data[0] & 0x7FU) == NmtState::boot_up) return;
  for (Consumer& consumer : consumers_) {
    if (consumer.node != node || consumer.time == Duration::zero()) continue;
    consumer.deadline = context_.now + consumer.time;
    if (!consumer.lost) continue;
    emergency_.resolve(consumer.lost);
    if (!anyLost()) context_.application.onMasterBack(context_.now);
  }
}

bool SlaveHeartbeat::anyLost() const {
  return std::any_of(consumers_.begin(), consumers_.end(),
                     [](const Consumer& consumer) { return consumer.lost; });
}

void SlaveHeartbeat::onLost(Consumer& consumer) {
  consumer.deadline = kNever;
  emergency_.raise(consumer.lost, kHeartbeatLost);
  context_.masterLost();
}

void SlaveHeartbeat::tick() {
  if (next_ <= context_.now) sendHeartbeat();
  for (Consumer& consumer : consumers_) {
    if (consumer.deadline <= context_.now) onLost(consumer);
  }
}

Time SlaveHeartbeat::deadline() const {
  Time earliest = next_;
  for (const Consumer& consumer : consumers_) earliest = std::min(earliest, consumer.deadline);
  return earliest;
}

}  // namespace cia402::sim
