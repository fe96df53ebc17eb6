// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/exchange.h"

#include <algorithm>

namespace cia402::canopen {
namespace {

constexpr Duration kQueueFull = std::chrono::milliseconds(1);

}  // namespace

void SdoExchange::send(std::uint8_t command, std::uint8_t byte1, std::uint8_t byte2) {
  sink_.send(can::Frame(request_id_, {command, byte1, byte2, 0, 0, 0, 0, 0}));
}

void SdoExchange::sendRequest(std::uint8_t command, ObjectId object, std::uint32_t data) {
  sink_.send(can::Frame(
      request_id_, {command, static_cast<std::uint8_t>(object.index),
                    static_cast<std::uint8_t>(object.index >> 8), object.subindex,
                    static_cast<std::uint8_t>(data), static_cast<std::uint8_t>(data >> 8),
                    static_cast<std::uint8_t>(data >> 16), static_cast<std::uint8_t>(data >> 24)}));
}

can::Frame SdoExchange::segment(std::uint8_t command, const std::uint8_t* data,
                                std::size_t size) const {
  can::Frame frame(request_id_, {command, 0, 0, 0, 0, 0, 0, 0});
  std::copy_n(data, size, frame.data.begin() + 1);
  return frame;
}

void SdoExchange::sendSegment(std::uint8_t command, const std::uint8_t* data, std::size_t size) {
  sink_.send(segment(command, data, size));
}

std::optional<Time> SdoExchange::sendBulk(const can::Frame& frame, Time now) {
  if (pacer_ != nullptr) {
    const Time room = pacer_->roomFor(frame, now);
    if (room > now) return room;
  }
  const bool sent = pacer_ != nullptr ? pacer_->sendBulk(frame) : sink_.send(frame);
  if (!sent) return now + kQueueFull;
  return std::nullopt;
}

void SdoExchange::await(Duration timeout, Time now) {
  asked_at_ = now;
  deadline_ = now + timeout;
}

void SdoExchange::answered(Time now) {
  const Duration latency = std::max(now - asked_at_, Duration::zero());
  ++counters_.answers;
  counters_.last_latency = latency;
  counters_.longest_latency = std::max(counters_.longest_latency, latency);
  counters_.total_latency += latency;
  repetition_seen_ = false;
}

bool SdoExchange::excuseRepetition(const can::Frame& frame) {
  if (!isRepetition(frame) || repetition_seen_) return false;
  repetition_seen_ = true;
  return true;
}

}  // namespace cia402::canopen
