// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo/server.h"

#include <algorithm>

namespace cia402::sim {

namespace {

constexpr std::uint32_t kRequestId = 0x600;
constexpr std::uint32_t kAnswerId = 0x580;
constexpr std::uint32_t kNoId = 0xFFFFFFFF;
constexpr std::uint32_t kNotValid = 0x80000000;  // bit of a COB-ID, CiA 301, 7.5.2.33

// Client command specifiers, bits 5..7 of the first byte.
constexpr unsigned kDownloadSegment = 0;
constexpr unsigned kInitiateDownload = 1;
constexpr unsigned kInitiateUpload = 2;
constexpr unsigned kUploadSegment = 3;
constexpr unsigned kAbort = 4;
constexpr unsigned kBlockUpload = 5;
constexpr unsigned kBlockDownload = 6;
constexpr std::uint8_t kAborted = 0x80;  // the whole byte of an abort

unsigned commandOf(const can::Frame& frame) { return frame.data[0] >> 5U; }

}  // namespace

SdoServer::SdoServer(SlaveContext& context, std::uint16_t parameter)
    : context_(context), parameter_(parameter), request_id_(kNoId), channel_(context) {
  channel_.answer_id = kNoId;
}

void SdoServer::serveObjects() {
  for (const std::uint8_t subindex : {std::uint8_t{1}, std::uint8_t{2}}) {
    context_.serveWrites({parameter_, subindex}, nullptr, [this](const Entry&) { configure(); });
  }
}

void SdoServer::configure() {
  if (parameter_ == 0) {
    request_id_ = kRequestId + context_.node;
    channel_.answer_id = kAnswerId + context_.node;
    return;
  }
  const auto request = static_cast<std::uint32_t>(context_.value({parameter_, 1}, kNotValid));
  const auto answer_cob = static_cast<std::uint32_t>(context_.value({parameter_, 2}, kNotValid));
  const bool valid = ((request | answer_cob) & kNotValid) == 0;
  request_id_ = valid ? request & 0x7FFU : kNoId;
  channel_.answer_id = answer_cob & 0x7FFU;
}

void SdoServer::reset() {
  head_ = 0;
  waiting_ = 0;
  channel_.transfer = SdoTransfer::none;
}

void SdoServer::receive(const can::Frame& frame) {
  if (frame.remote || !context_.communicating() || waiting_ == kQueueSize) return;
  if (frame.size < 8 && !context_.behaviour.accepts_short_sdo) return;
  Request& request = queue_[(head_ + waiting_) % kQueueSize];
  request.frame = frame;
  std::fill(request.frame.data.begin() + frame.size, request.frame.data.end(), std::uint8_t{0});
  if (waiting_ == 0 && block_download_.takesAtOnce(request.frame)) {
    return block_download_.takeSegment(request.frame);
  }
  Time begin = context_.now;
  if (waiting_ > 0) begin = queue_[(head_ + waiting_ - 1) % kQueueSize].due;
  request.due = begin + context_.answerTime(request.frame);
  ++waiting_;
  tick();
}

void SdoServer::tick() {
  while (deadline() <= context_.now) {
    const can::Frame request = queue_[head_].frame;
    head_ = (head_ + 1) % kQueueSize;
    --waiting_;
    if (!context_.behaviour.sdo_silent) process(request);
  }
}

void SdoServer::process(const can::Frame& request) {
  const bool aborted = request.data[0] == kAborted;
  if (!aborted && block_download_.takesSegments()) return block_download_.takeSegment(request);
  if (!block_download_.takesSegments() && block_download_.repeats(request)) return;
  switch (commandOf(request)) {
    case kDownloadSegment:
      return segments_.downloadSegment(request);
    case kInitiateDownload:
      return segments_.initiateDownload(request);
    case kInitiateUpload:
      return segments_.initiateUpload(request);
    case kUploadSegment:
      return segments_.uploadSegment(request);
    case kAbort:
      channel_.transfer = SdoTransfer::none;
      return;
    case kBlockUpload:
      return block_upload_.request(request);
    case kBlockDownload:
      return block_download_.request(request);
    default:
      channel_.object = sdoObjectOf(request);
      return channel_.abortInvalid();
  }
}

}  // namespace cia402::sim
