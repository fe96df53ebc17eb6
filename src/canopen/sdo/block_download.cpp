// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Block download (CiA 301, 7.2.4.2.9 to 7.2.4.2.12, 7.2.4.3.8 to 7.2.4.3.11): up to 127 segments in
// a row, as many as the server asks for, are acknowledged together; from the first missing one on
// they are sent again.
#include <algorithm>
#include <string>

#include "canopen/sdo/block.h"
#include "cia402_driver/canopen/sdo/client.h"
#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::canopen {

using namespace sdo_block;

namespace {

constexpr std::uint8_t kSubcommand = 0x03;  // of a server's answer
constexpr unsigned kInitiated = 0, kEnded = 1, kAcknowledged = 2;
constexpr std::uint8_t kEnd = 0xC1;
constexpr Duration kQueueFull = std::chrono::milliseconds(1);

/// Whether a server says by this code that it has no block transfer. Real ones use general codes,
/// too; those that speak of the object would not be other ones for segments.
bool refusesBlocks(std::uint32_t code) {
  switch (code) {
    case abort_code::kTimeout:
    case abort_code::kInvalidCommand:
    case abort_code::kInvalidBlockSize:
    case abort_code::kInvalidSequence:
    case abort_code::kUnsupportedAccess:
    case abort_code::kNoConnection:
    case abort_code::kGeneral:
    case 0:
      return true;
    default:
      return false;
  }
}

}  // namespace

/// The server aborted. @return true: not for good, the transfer goes on in segments.
bool SdoClient::fallsBack(std::uint32_t code, Time now) {
  const bool initiating =
      phase_ == Phase::block_upload_initiate || phase_ == Phase::block_download_initiate;
  if (!initiating || !refusesBlocks(code)) return false;
  fell_back_ = true;
  block_refused_ = block_refused_ || code == abort_code::kInvalidCommand;
  initiate(now);
  return true;
}

SdoClient::Outcome SdoClient::onBlockDownloadInitiated(const can::Frame& frame, Time now) {
  if ((frame.data[0] & kSubcommand) != kInitiated || !namesCurrentObject(frame)) {
    return Outcome::stray;
  }
  answered(now);
  block_.crc = (frame.data[0] & kCrcSupported) != 0;
  beginSubBlock(frame.data[4], now);
  return Outcome::taken;
}

void SdoClient::beginSubBlock(unsigned size, Time now) {
  if (size == 0 || size > kMostSegments) {
    abortTransfer(abort_code::kInvalidBlockSize,
                  "the server asks for sub-blocks of " + std::to_string(size) + " segments", now);
    return;
  }
  block_.size = size;
  block_.sequence = 0;
  block_.last = false;
  await(Phase::block_download_segments, now);
  feedBlock(now);
}

/// Sends as much of the sub-block as the queue of the interface may take now.
void SdoClient::feedBlock(Time now) {
  while (block_.sequence < block_.size && !block_.last) {
    const can::Frame frame = nextBlockSegment();
    if (pacer_ != nullptr) {
      feed_at_ = pacer_->roomFor(frame, now);
      if (feed_at_ > now) return;
    }
    if (!(pacer_ != nullptr ? pacer_->sendBulk(frame) : sink_.send(frame))) {
      feed_at_ = now + kQueueFull;
      return;
    }
    ++block_.sequence;
    block_.last = (frame.data[0] & kLastSegment) != 0;
    await(Phase::block_download_segments, now);
  }
  await(Phase::block_download_acknowledge, now);
}

can::Frame SdoClient::nextBlockSegment() {
  const Bytes& data = queue_.front()->data_;
  const std::size_t from = block_.begin + block_.sequence * kSegmentBytes;
  const std::size_t count = std::min(kSegmentBytes, data.size() - from);
  const bool last = from + count == data.size();
  can::Frame frame(request_id_, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.data[0] = static_cast<std::uint8_t>((block_.sequence + 1) | (last ? kLastSegment : 0U));
  std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(from), count, frame.data.begin() + 1);
  if (block_.crc) checkBlock(from + count);
  return frame;
}

SdoClient::Outcome SdoClient::onBlockAcknowledged(const can::Frame& frame, Time now) {
  if ((frame.data[0] & kSubcommand) != kAcknowledged) return Outcome::stray;
  const bool sending = phase_ == Phase::block_download_segments;
  if (sending && frame == last_answer_) return Outcome::stray;  // the last one came twice
  const unsigned taken = frame.data[1];
  if (taken > block_.sequence) {
    abortTransfer(abort_code::kInvalidSequence,
                  "segment " + std::to_string(taken) + " was acknowledged, " +
                      std::to_string(block_.sequence) + " were sent",
                  now);
    return Outcome::taken;
  }
  if (!sending) answered(now);
  block_.vain = taken == 0 ? block_.vain + 1 : 0;
  if (taken < block_.sequence) ++counters_.retries;
  const bool finished = block_.last && taken == block_.sequence;
  block_.begin += taken * kSegmentBytes;
  if (finished) {
    sendBlockEnd(now);
  } else if (block_.vain > kMostVain) {
    abortTransfer(
        abort_code::kInvalidSequence,
        "the server took nothing of a sub-block " + std::to_string(block_.vain) + " times in a row",
        now);
  } else {
    beginSubBlock(frame.data[2], now);
  }
  return Outcome::taken;
}

void SdoClient::sendBlockEnd(Time now) {
  const std::size_t rest = queue_.front()->data_.size() % kSegmentBytes;
  const std::size_t unused = rest == 0 ? 0 : kSegmentBytes - rest;
  sink_.send(
      can::Frame(request_id_, {static_cast<std::uint8_t>(kEnd | unused << 2U),
                               static_cast<std::uint8_t>(block_.checksum & 0xFFU),
                               static_cast<std::uint8_t>(block_.checksum >> 8U), 0, 0, 0, 0, 0}));
  await(Phase::block_download_end, now);
}

SdoClient::Outcome SdoClient::onBlockDownloadEnd(const can::Frame& frame, Time now) {
  if ((frame.data[0] & kSubcommand) != kEnded) return Outcome::stray;
  answered(now);
  succeed(now);
  return Outcome::taken;
}

}  // namespace cia402::canopen
