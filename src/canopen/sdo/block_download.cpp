// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/block_download.h"

#include <algorithm>
#include <string>

#include "canopen/sdo/frames.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {

using namespace sdo;

namespace {

constexpr std::uint8_t kRequestBlockDownload = 0xC6;  // CRC supported, size indicated
constexpr std::uint8_t kEnd = 0xC1;
constexpr std::uint8_t kSubcommand = 0x03;  // of a server's answer
constexpr unsigned kInitiated = 0, kEnded = 1, kAcknowledged = 2;

}  // namespace

void SdoBlockDownload::initiate(Time now) {
  exchange_.sendRequest(kRequestBlockDownload, transfer_.object(),
                        static_cast<std::uint32_t>(transfer_.data().size()));
  await(Phase::initiate, now);
}

void SdoBlockDownload::await(Phase phase, Time now) {
  phase_ = phase;
  exchange_.await(transfer_.options().timeout, now);
}

SdoReaction SdoBlockDownload::receive(const can::Frame& frame, Time now) {
  if (frame.data[0] == kAbort) return serverAbort(frame, transfer_.object());
  if (commandOf(frame) != kBlockDownload) return SdoReaction::stray();
  const unsigned subcommand = frame.data[0] & kSubcommand;
  switch (phase_) {
    case Phase::initiate:
      return subcommand == kInitiated ? onInitiated(frame, now) : SdoReaction::stray();
    case Phase::segments:
    case Phase::acknowledge:
      return subcommand == kAcknowledged ? onAcknowledged(frame, now) : SdoReaction::stray();
    case Phase::end:
      return subcommand == kEnded ? onEnd(now) : SdoReaction::stray();
  }
  return SdoReaction::stray();
}

SdoReaction SdoBlockDownload::onInitiated(const can::Frame& frame, Time now) {
  if (!names(frame, transfer_.object())) return SdoReaction::stray();
  exchange_.answered(now);
  checksum_.used = (frame.data[0] & kCrcSupported) != 0;
  return beginSubBlock(frame.data[4], now);
}

SdoReaction SdoBlockDownload::beginSubBlock(unsigned size, Time now) {
  if (size == 0 || size > kMostSegments) {
    return SdoReaction::broken(
        abort_code::kInvalidBlockSize,
        "the server asks for sub-blocks of " + std::to_string(size) + " segments");
  }
  size_ = size;
  sequence_ = 0;
  last_ = false;
  await(Phase::segments, now);
  feed(now);
  return SdoReaction::taken();
}

void SdoBlockDownload::feed(Time now) {
  while (sequence_ < size_ && !last_) {
    const can::Frame frame = nextSegment();
    if (const auto later = exchange_.sendBulk(frame, now)) {
      feed_at_ = *later;
      return;
    }
    ++sequence_;
    last_ = (frame.data[0] & kLastSegment) != 0;
    await(Phase::segments, now);
  }
  await(Phase::acknowledge, now);
}

can::Frame SdoBlockDownload::nextSegment() {
  const Bytes& data = transfer_.data();
  const std::size_t from = begin_ + sequence_ * kSegmentBytes;
  const std::size_t count = std::min(kSegmentBytes, data.size() - from);
  const bool last = from + count == data.size();
  if (checksum_.used) checksum_.extend(data.data(), from + count);
  return exchange_.segment(static_cast<std::uint8_t>((sequence_ + 1) | (last ? kLastSegment : 0U)),
                           data.data() + from, count);
}

SdoReaction SdoBlockDownload::onAcknowledged(const can::Frame& frame, Time now) {
  const bool sending = phase_ == Phase::segments;
  if (sending && exchange_.isRepetition(frame)) return SdoReaction::stray();
  const unsigned taken = frame.data[1];
  if (taken > sequence_) {
    return SdoReaction::broken(abort_code::kInvalidSequence,
                               "segment " + std::to_string(taken) + " was acknowledged, " +
                                   std::to_string(sequence_) + " were sent");
  }
  if (!sending) exchange_.answered(now);
  vain_ = taken == 0 ? vain_ + 1 : 0;
  if (taken < sequence_) ++exchange_.counters().retries;
  const bool finished = last_ && taken == sequence_;
  begin_ += taken * kSegmentBytes;
  if (finished) {
    sendEnd(now);
    return SdoReaction::taken();
  }
  if (vain_ > kMostVain) {
    return SdoReaction::broken(
        abort_code::kInvalidSequence,
        "the server took nothing of a sub-block " + std::to_string(vain_) + " times in a row");
  }
  return beginSubBlock(frame.data[2], now);
}

void SdoBlockDownload::sendEnd(Time now) {
  const std::size_t rest = transfer_.data().size() % kSegmentBytes;
  const std::size_t unused = rest == 0 ? 0 : kSegmentBytes - rest;
  exchange_.send(static_cast<std::uint8_t>(kEnd | unused << 2U),
                 static_cast<std::uint8_t>(checksum_.value & 0xFFU),
                 static_cast<std::uint8_t>(checksum_.value >> 8U));
  await(Phase::end, now);
}

SdoReaction SdoBlockDownload::onEnd(Time now) {
  exchange_.answered(now);
  return SdoReaction::completed();
}

}  // namespace cia402::canopen
