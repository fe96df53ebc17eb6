// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo/block_upload.h"

#include <algorithm>

#include "fieldbus/abort_code.h"
#include "sim/device/frame.h"
#include "sim/device/sdo/block_crc.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr unsigned kMostSegments = 127;
constexpr std::uint8_t kNoMoreSegments = 0x80;  // first byte of a segment

// Client subcommands, bits 0 and 1 of the first byte of a request.
constexpr std::uint8_t kSubcommand = 0x03;
constexpr unsigned kUploadInitiate = 0;
constexpr unsigned kUploadEnd = 1;
constexpr unsigned kUploadResponse = 2;
constexpr unsigned kUploadStart = 3;
constexpr std::uint8_t kClientCrc = 0x04;

// Answers: server command specifier and subcommand in place.
constexpr std::uint8_t kUploadAccepted = 0xC0;
constexpr std::uint8_t kUploadEnding = 0xC1;
constexpr std::uint8_t kServerCrc = 0x04;
constexpr std::uint8_t kServerSize = 0x02;

}  // namespace

bool SdoBlockUpload::running() const { return channel_.transfer == SdoTransfer::block_upload; }

void SdoBlockUpload::request(const can::Frame& frame) {
  switch (frame.data[0] & kSubcommand) {
    case kUploadInitiate:
      return begin(frame);
    case kUploadStart:
      if (running() && channel_.sent == 0 && segment_ == 0) return sendSubBlock();
      break;
    case kUploadResponse:
      if (running() && ended_ && segment_ == 0) return;  // repeated
      if (running() && segment_ > 0) return acknowledged(frame);
      break;
    case kUploadEnd:
      if (!running() || !ended_) break;
      channel_.transfer = SdoTransfer::none;
      return;
  }
  channel_.transfer = SdoTransfer::none;
  channel_.abortInvalid();
}

void SdoBlockUpload::begin(const can::Frame& request) {
  channel_.begin(request);
  if (!channel_.context.behaviour.sdo_block) return channel_.abortInvalid();
  block_size_ = request.data[4];
  if (block_size_ == 0 || block_size_ > kMostSegments)
    return channel_.abort(abort_code::kInvalidBlockSize);
  if (const auto refused = channel_.context.dictionary.read(channel_.object, channel_.data))
    return channel_.abort(refused);
  if (channel_.data.size() <= request.data[5]) return segments_.answerUpload();
  crc_ = channel_.context.behaviour.sdo_block_crc && (request.data[0] & kClientCrc) != 0;
  ended_ = false;
  channel_.sent = 0;
  segment_ = 0;
  channel_.transfer = SdoTransfer::block_upload;
  const bool tell_size = !channel_.context.behaviour.upload_without_size;
  channel_.answer(static_cast<std::uint8_t>(kUploadAccepted | (crc_ ? kServerCrc : 0) |
                                            (tell_size ? kServerSize : 0)),
                  tell_size ? static_cast<std::uint32_t>(channel_.data.size()) : 0);
}

// From the byte `channel_.sent` on, as many segments as the client wants.
void SdoBlockUpload::sendSubBlock() {
  std::size_t from = channel_.sent;
  for (segment_ = 0; segment_ < block_size_;) {
    const std::size_t count = std::min(kSdoSegment, channel_.data.size() - from);
    const bool no_more = from + count == channel_.data.size();
    can::Frame frame = emptyFrame(channel_.answer_id, 8);
    frame.data[0] = static_cast<std::uint8_t>(++segment_ | (no_more ? kNoMoreSegments : 0U));
    for (std::size_t i = 0; i < count; ++i) frame.data[1 + i] = channel_.data[from + i];
    from += count;
    channel_.context.sink.send(frame);
    if (no_more) break;
  }
}

void SdoBlockUpload::acknowledged(const can::Frame& request) {
  const unsigned taken = request.data[1];
  if (taken > segment_) return channel_.abort(abort_code::kInvalidSequence);
  const std::size_t left = channel_.data.size() - channel_.sent;
  const bool all = taken == segment_ && left <= taken * kSdoSegment;
  channel_.sent += std::min(taken * kSdoSegment, left);
  if (!all) {
    block_size_ = request.data[2];
    if (block_size_ == 0 || block_size_ > kMostSegments) {
      return channel_.abort(abort_code::kInvalidBlockSize);
    }
    return sendSubBlock();
  }
  ended_ = true;
  segment_ = 0;
  const std::size_t rest = channel_.data.size() % kSdoSegment;
  std::size_t unused = rest == 0 ? 0 : kSdoSegment - rest;
  if (channel_.data.empty()) unused = kSdoSegment;
  can::Frame frame = emptyFrame(channel_.answer_id, 8);
  frame.data[0] = static_cast<std::uint8_t>(kUploadEnding | unused << 2U);
  putBytes(frame, 1, 2, crc_ ? sdoBlockCrc(channel_) : 0);
  channel_.context.sink.send(frame);
}

}  // namespace cia402::sim
