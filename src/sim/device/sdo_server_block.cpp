// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Block transfer of the simulated SDO server (CiA 301, 7.2.4.3.8 to 7.2.4.3.16).
#include <algorithm>

#include "cia402_driver/fieldbus/abort_code.h"
#include "sim/device/frame.h"
#include "sim/device/sdo_server.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr std::size_t kSegmentSize = 7;
constexpr unsigned kMostSegments = 127;
constexpr std::size_t kMemory = 1U << 20U;

// First byte of a segment.
constexpr std::uint8_t kNoMoreSegments = 0x80;
constexpr std::uint8_t kSequenceNumber = 0x7F;

// Client subcommands of a block upload, bits 0 and 1; of a block download bit 0 tells the end.
constexpr unsigned kUploadInitiate = 0;
constexpr unsigned kUploadEnd = 1;
constexpr unsigned kUploadResponse = 2;
constexpr unsigned kUploadStart = 3;

constexpr std::uint8_t kClientCrc = 0x04;
constexpr std::uint8_t kClientSize = 0x02;

// Answers: server command specifier and subcommand in place.
constexpr std::uint8_t kDownloadAccepted = 0xA0;
constexpr std::uint8_t kDownloadEnded = 0xA1;
constexpr std::uint8_t kBlockTaken = 0xA2;
constexpr std::uint8_t kUploadAccepted = 0xC0;
constexpr std::uint8_t kUploadEnding = 0xC1;
constexpr std::uint8_t kServerCrc = 0x04;
constexpr std::uint8_t kServerSize = 0x02;

// The division as the standard shows it: bit after bit, by x^16 + x^12 + x^5 + 1.
std::uint16_t remainderOf(const std::vector<std::uint8_t>& bytes) {
  unsigned remainder = 0;
  for (const std::uint8_t byte : bytes) {
    for (unsigned mask = 0x80; mask != 0; mask >>= 1U) {
      const bool feedback = ((remainder & 0x8000U) != 0) != ((byte & mask) != 0);
      remainder = (remainder << 1U) & 0xFFFFU;
      if (feedback) remainder ^= 0x1021U;
    }
  }
  return static_cast<std::uint16_t>(remainder);
}

}  // namespace

// A device with a wrong CRC sends it, and finds its own different from the client's.
std::uint16_t SdoServer::blockCrc() const {
  const std::uint16_t crc = remainderOf(data_);
  return context_.behaviour.sdo_block_crc_error ? static_cast<std::uint16_t>(crc ^ 0x5A5AU) : crc;
}

// How many segments the next sub-block of a download shall have.
unsigned SdoServer::nextBlockSize() {
  const unsigned most = static_cast<unsigned>(
      std::clamp<std::int64_t>(context_.behaviour.sdo_block_size, 1, kMostSegments));
  if (!context_.behaviour.sdo_block_size_varies) return most;
  block_turn_ = (block_turn_ + 5) % most;
  return most - block_turn_;
}

void SdoServer::blockDownload(const can::Frame& request) {
  if ((request.data[0] & 1U) != 0) return endBlockDownload(request);
  object_ = objectOf(request);
  transfer_ = Transfer::none;
  if (!context_.behaviour.sdo_block) return abort(abort_code::kInvalidCommand);
  announced_size_.reset();
  if ((request.data[0] & kClientSize) != 0) announced_size_ = takeBytes(request, 4, 4);
  if (const auto refused = context_.dictionary.checkWritable(object_, announced_size_)) {
    return abort(refused);
  }
  if (announced_size_.value_or(0) > kMemory) return abort(abort_code::kOutOfMemory);
  block_crc_ = context_.behaviour.sdo_block_crc && (request.data[0] & kClientCrc) != 0;
  block_turn_ = 0;
  block_size_ = nextBlockSize();
  segment_ = 0;
  block_ended_ = false;
  data_.clear();
  transfer_ = Transfer::block_download;
  can::Frame frame = emptyFrame(answerId(), 8);
  frame.data[0] = static_cast<std::uint8_t>(kDownloadAccepted | (block_crc_ ? kServerCrc : 0));
  putBytes(frame, 1, 2, object_.index);
  frame.data[3] = object_.subindex;
  frame.data[4] = static_cast<std::uint8_t>(block_size_);
  context_.sink.send(frame);
}

// Segments are taken by the receive interrupt; only the answer to a sub-block takes its time.
bool SdoServer::takesAtOnce(const can::Frame& frame) const {
  if (transfer_ != Transfer::block_download || block_ended_ || waiting_ > 0) return false;
  const unsigned number = frame.data[0] & kSequenceNumber;
  return number != 0 && number != block_size_ && (frame.data[0] & kNoMoreSegments) == 0;
}

void SdoServer::blockSegment(const can::Frame& frame) {
  const unsigned number = frame.data[0] & kSequenceNumber;
  const bool no_more = (frame.data[0] & kNoMoreSegments) != 0;
  if (number == segment_ + 1) {
    if (data_.size() + kSegmentSize > kMemory + kSegmentSize) {
      return abort(abort_code::kOutOfMemory);
    }
    data_.insert(data_.end(), frame.data.begin() + 1, frame.data.end());
    segment_ = number;
    block_ended_ = no_more;
    last_segment_ = frame;
  } else if (frame == last_segment_) {
    return;  // the wire gave it twice
  }
  if (number != block_size_ && !no_more) return;
  can::Frame answer_frame = emptyFrame(answerId(), 8);
  answer_frame.data[0] = kBlockTaken;
  answer_frame.data[1] = static_cast<std::uint8_t>(segment_);
  block_size_ = nextBlockSize();
  answer_frame.data[2] = static_cast<std::uint8_t>(block_size_);
  segment_ = 0;
  context_.sink.send(answer_frame);
}

void SdoServer::endBlockDownload(const can::Frame& request) {
  if (transfer_ != Transfer::block_download || !block_ended_) {
    transfer_ = Transfer::none;
    return abort(abort_code::kInvalidCommand);
  }
  const std::size_t unused = (request.data[0] >> 2U) & 7U;
  if (unused > kSegmentSize || unused > data_.size()) return abort(abort_code::kLengthMismatch);
  data_.resize(data_.size() - unused);
  if (block_crc_ && takeBytes(request, 1, 2) != blockCrc()) return abort(abort_code::kCrcError);
  if (announced_size_ && data_.size() != *announced_size_) {
    const bool long_one = data_.size() > *announced_size_;
    return abort(long_one ? abort_code::kLengthTooHigh : abort_code::kLengthTooLow);
  }
  if (const auto refused = context_.dictionary.write(object_, data_)) return abort(refused);
  transfer_ = Transfer::none;
  can::Frame frame = emptyFrame(answerId(), 8);
  frame.data[0] = kDownloadEnded;
  context_.sink.send(frame);
}

void SdoServer::blockUpload(const can::Frame& request) {
  switch (request.data[0] & 3U) {
    case kUploadInitiate:
      return initiateBlockUpload(request);
    case kUploadStart:
      if (transfer_ == Transfer::block_upload && sent_ == 0 && segment_ == 0) return sendSubBlock();
      break;
    case kUploadResponse:
      if (transfer_ == Transfer::block_upload && block_ended_ && segment_ == 0) return;  // repeated
      if (transfer_ == Transfer::block_upload && segment_ > 0) return acknowledged(request);
      break;
    case kUploadEnd:
      if (transfer_ == Transfer::block_upload && block_ended_) {
        transfer_ = Transfer::none;
        return;
      }
      break;
  }
  transfer_ = Transfer::none;
  abort(abort_code::kInvalidCommand);
}

void SdoServer::initiateBlockUpload(const can::Frame& request) {
  object_ = objectOf(request);
  transfer_ = Transfer::none;
  if (!context_.behaviour.sdo_block) return abort(abort_code::kInvalidCommand);
  block_size_ = request.data[4];
  if (block_size_ == 0 || block_size_ > kMostSegments) return abort(abort_code::kInvalidBlockSize);
  if (const auto refused = context_.dictionary.read(object_, data_)) return abort(refused);
  if (data_.size() <= request.data[5]) return answerUpload();
  block_crc_ = context_.behaviour.sdo_block_crc && (request.data[0] & kClientCrc) != 0;
  block_ended_ = false;
  sent_ = 0;
  segment_ = 0;
  transfer_ = Transfer::block_upload;
  const bool tell_size = !context_.behaviour.upload_without_size;
  answer(static_cast<std::uint8_t>(kUploadAccepted | (block_crc_ ? kServerCrc : 0) |
                                   (tell_size ? kServerSize : 0)),
         tell_size ? static_cast<std::uint32_t>(data_.size()) : 0);
}

// From the byte `sent_` on, as many segments as the client wants.
void SdoServer::sendSubBlock() {
  std::size_t from = sent_;
  for (segment_ = 0; segment_ < block_size_;) {
    const std::size_t count = std::min(kSegmentSize, data_.size() - from);
    const bool no_more = from + count == data_.size();
    can::Frame frame = emptyFrame(answerId(), 8);
    frame.data[0] = static_cast<std::uint8_t>(++segment_ | (no_more ? kNoMoreSegments : 0U));
    for (std::size_t i = 0; i < count; ++i) frame.data[1 + i] = data_[from + i];
    from += count;
    context_.sink.send(frame);
    if (no_more) break;
  }
}

void SdoServer::acknowledged(const can::Frame& request) {
  const unsigned taken = request.data[1];
  if (taken > segment_) return abort(abort_code::kInvalidSequence);
  const std::size_t left = data_.size() - sent_;
  const bool all = taken == segment_ && left <= taken * kSegmentSize;
  sent_ += std::min(taken * kSegmentSize, left);
  if (!all) {
    block_size_ = request.data[2];
    if (block_size_ == 0 || block_size_ > kMostSegments) {
      return abort(abort_code::kInvalidBlockSize);
    }
    return sendSubBlock();
  }
  block_ended_ = true;
  segment_ = 0;
  const std::size_t rest = data_.size() % kSegmentSize;
  std::size_t unused = rest == 0 ? 0 : kSegmentSize - rest;
  if (data_.empty()) unused = kSegmentSize;
  can::Frame frame = emptyFrame(answerId(), 8);
  frame.data[0] = static_cast<std::uint8_t>(kUploadEnding | unused << 2U);
  putBytes(frame, 1, 2, block_crc_ ? blockCrc() : 0);
  context_.sink.send(frame);
}

}  // namespace cia402::sim
