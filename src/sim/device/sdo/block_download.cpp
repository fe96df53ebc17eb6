// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo/block_download.h"

#include <algorithm>

#include "fieldbus/abort_code.h"
#include "sim/device/frame.h"
#include "sim/device/sdo/block_crc.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr unsigned kMostSegments = 127;

// First byte of a segment.
constexpr std::uint8_t kNoMoreSegments = 0x80;
constexpr std::uint8_t kSequenceNumber = 0x7F;

// First byte of a request.
constexpr std::uint8_t kEnd = 0x01;
constexpr std::uint8_t kClientCrc = 0x04;
constexpr std::uint8_t kClientSize = 0x02;

// Answers: server command specifier and subcommand in place.
constexpr std::uint8_t kDownloadAccepted = 0xA0;
constexpr std::uint8_t kDownloadEnded = 0xA1;
constexpr std::uint8_t kBlockTaken = 0xA2;
constexpr std::uint8_t kServerCrc = 0x04;

}  // namespace

bool SdoBlockDownload::running() const { return channel_.transfer == SdoTransfer::block_download; }

// How many segments the next sub-block of a download shall have.
unsigned SdoBlockDownload::nextBlockSize() {
  const unsigned most = static_cast<unsigned>(
      std::clamp<std::int64_t>(channel_.context.behaviour.sdo_block_size, 1, kMostSegments));
  if (!channel_.context.behaviour.sdo_block_size_varies) return most;
  block_turn_ = (block_turn_ + 5) % most;
  return most - block_turn_;
}

void SdoBlockDownload::request(const can::Frame& frame) {
  (frame.data[0] & kEnd) != 0 ? end(frame) : begin(frame);
}

void SdoBlockDownload::begin(const can::Frame& request) {
  channel_.begin(request);
  if (!channel_.context.behaviour.sdo_block) return channel_.abortInvalid();
  channel_.announced_size.reset();
  if ((request.data[0] & kClientSize) != 0) channel_.announced_size = takeBytes(request, 4, 4);
  if (const auto refused =
          channel_.context.dictionary.checkWritable(channel_.object, channel_.announced_size)) {
    return channel_.abort(refused);
  }
  if (channel_.announced_size.value_or(0) > kSdoMemory)
    return channel_.abort(abort_code::kOutOfMemory);
  crc_ = channel_.context.behaviour.sdo_block_crc && (request.data[0] & kClientCrc) != 0;
  block_turn_ = 0;
  block_size_ = nextBlockSize();
  segment_ = 0;
  ended_ = false;
  channel_.data.clear();
  channel_.transfer = SdoTransfer::block_download;
  can::Frame frame = emptyFrame(channel_.answer_id, 8);
  frame.data[0] = static_cast<std::uint8_t>(kDownloadAccepted | (crc_ ? kServerCrc : 0));
  putBytes(frame, 1, 2, channel_.object.index);
  frame.data[3] = channel_.object.subindex;
  frame.data[4] = static_cast<std::uint8_t>(block_size_);
  channel_.context.sink.send(frame);
}

// Segments are taken by the receive interrupt; only the answer to a sub-block takes its time.
bool SdoBlockDownload::takesAtOnce(const can::Frame& frame) const {
  if (channel_.transfer != SdoTransfer::block_download || ended_) return false;
  const unsigned number = frame.data[0] & kSequenceNumber;
  return number != 0 && number != block_size_ && (frame.data[0] & kNoMoreSegments) == 0;
}

void SdoBlockDownload::takeSegment(const can::Frame& frame) {
  const unsigned number = frame.data[0] & kSequenceNumber;
  const bool no_more = (frame.data[0] & kNoMoreSegments) != 0;
  if (number == segment_ + 1) {
    if (channel_.data.size() + kSdoSegment > kSdoMemory + kSdoSegment) {
      return channel_.abort(abort_code::kOutOfMemory);
    }
    channel_.data.insert(channel_.data.end(), frame.data.begin() + 1, frame.data.end());
    segment_ = number;
    ended_ = no_more;
    last_segment_ = frame;
  } else if (frame == last_segment_) {
    return;  // the wire gave it twice
  }
  if (number != block_size_ && !no_more) return;
  can::Frame taken = emptyFrame(channel_.answer_id, 8);
  taken.data[0] = kBlockTaken;
  taken.data[1] = static_cast<std::uint8_t>(segment_);
  block_size_ = nextBlockSize();
  taken.data[2] = static_cast<std::uint8_t>(block_size_);
  segment_ = 0;
  channel_.context.sink.send(taken);
}

void SdoBlockDownload::end(const can::Frame& request) {
  if (channel_.transfer != SdoTransfer::block_download || !ended_) {
    channel_.transfer = SdoTransfer::none;
    return channel_.abortInvalid();
  }
  const std::size_t unused = (request.data[0] >> 2U) & 7U;
  if (unused > kSdoSegment || unused > channel_.data.size())
    return channel_.abort(abort_code::kLengthMismatch);
  channel_.data.resize(channel_.data.size() - unused);
  if (crc_ && takeBytes(request, 1, 2) != sdoBlockCrc(channel_))
    return channel_.abort(abort_code::kCrcError);
  if (channel_.announced_size && channel_.data.size() != *channel_.announced_size) {
    const bool long_one = channel_.data.size() > *channel_.announced_size;
    return channel_.abort(long_one ? abort_code::kLengthTooHigh : abort_code::kLengthTooLow);
  }
  if (const auto refused = channel_.context.dictionary.write(channel_.object, channel_.data))
    return channel_.abort(refused);
  channel_.transfer = SdoTransfer::none;
  can::Frame frame = emptyFrame(channel_.answer_id, 8);
  frame.data[0] = kDownloadEnded;
  channel_.context.sink.send(frame);
}

}  // namespace cia402::sim
