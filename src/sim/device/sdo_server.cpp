// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo_server.h"

#include <algorithm>

#include "cia402_driver/fieldbus/abort_code.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

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

// Bits of the first byte.
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeIndicated = 0x01;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLastSegment = 0x01;

// Server command specifiers in place.
constexpr std::uint8_t kDownloadSegmentDone = 0x20;
constexpr std::uint8_t kDownloadInitiated = 0x60;
constexpr std::uint32_t kRubbish = 0x8FAF;  // in the bytes that mean nothing
constexpr std::uint8_t kUploadInitiated = 0x40;
constexpr std::uint8_t kAborted = 0x80;

constexpr std::size_t kSegmentSize = 7;
constexpr std::size_t kExpeditedSize = 4;
constexpr std::size_t kMemory = 1U << 20U;

unsigned commandOf(const can::Frame& frame) { return frame.data[0] >> 5U; }

}  // namespace

ObjectId SdoServer::objectOf(const can::Frame& frame) {
  return {static_cast<std::uint16_t>(takeBytes(frame, 1, 2)), frame.data[3]};
}

SdoServer::SdoServer(SlaveContext& context, std::uint16_t parameter)
    : context_(context), parameter_(parameter), request_id_(kNoId), answer_id_(kNoId) {
  data_.reserve(64);
}

void SdoServer::serveObjects() {
  for (const std::uint8_t subindex : {std::uint8_t{1}, std::uint8_t{2}}) {
    context_.serveWrites({parameter_, subindex}, nullptr, [this](const Entry&) { configure(); });
  }
}

void SdoServer::configure() {
  if (parameter_ == 0) {
    request_id_ = kRequestId + context_.node;
    answer_id_ = kAnswerId + context_.node;
    return;
  }
  const auto request = static_cast<std::uint32_t>(context_.value({parameter_, 1}, kNotValid));
  const auto answer_cob = static_cast<std::uint32_t>(context_.value({parameter_, 2}, kNotValid));
  const bool valid = ((request | answer_cob) & kNotValid) == 0;
  request_id_ = valid ? request & 0x7FFU : kNoId;
  answer_id_ = answer_cob & 0x7FFU;
}

void SdoServer::reset() {
  head_ = 0;
  waiting_ = 0;
  transfer_ = Transfer::none;
}

void SdoServer::receive(const can::Frame& frame) {
  if (frame.remote || !context_.communicating() || waiting_ == kQueueSize) return;
  if (frame.size < 8 && !context_.behaviour.accepts_short_sdo) return;
  Request& request = queue_[(head_ + waiting_) % kQueueSize];
  request.frame = frame;
  std::fill(request.frame.data.begin() + frame.size, request.frame.data.end(), std::uint8_t{0});
  if (takesAtOnce(request.frame)) return blockSegment(request.frame);
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
  if (transfer_ == Transfer::block_download) {
    const bool aborted = request.data[0] == kAborted;
    if (!aborted && !block_ended_) return blockSegment(request);
    if (block_ended_ && request == last_segment_) return;  // the wire gave it twice
  }
  switch (commandOf(request)) {
    case kDownloadSegment:
      return downloadSegment(request);
    case kInitiateDownload:
      return initiateDownload(request);
    case kInitiateUpload:
      return initiateUpload(request);
    case kUploadSegment:
      return uploadSegment(request);
    case kAbort:
      transfer_ = Transfer::none;
      return;
    case kBlockUpload:
      return blockUpload(request);
    case kBlockDownload:
      return blockDownload(request);
    default:
      object_ = objectOf(request);
      return abort(abort_code::kInvalidCommand);
  }
}

void SdoServer::initiateDownload(const can::Frame& request) {
  object_ = objectOf(request);
  transfer_ = Transfer::none;
  if ((request.data[0] & kExpedited) != 0) return downloadExpedited(request);
  announced_size_.reset();
  if ((request.data[0] & kSizeIndicated) != 0) announced_size_ = takeBytes(request, 4, 4);
  if (const auto refused = context_.dictionary.checkWritable(object_, announced_size_)) {
    return abort(refused);
  }
  if (announced_size_.value_or(0) > kMemory) return abort(abort_code::kOutOfMemory);
  transfer_ = Transfer::download;
  toggle_ = false;
  data_.clear();
  answer(kDownloadInitiated);
}

void SdoServer::downloadExpedited(const can::Frame& request) {
  std::size_t size = kExpeditedSize;
  if ((request.data[0] & kSizeIndicated) != 0) {
    size -= (request.data[0] >> 2U) & 3U;
  } else if (const Entry* entry = context_.dictionary.find(object_)) {
    const std::size_t width = (widthBits(entry->type) + 7U) / 8U;
    if (width >= 1 && width <= kExpeditedSize) size = width;
  }
  data_.assign(request.data.begin() + 4,
               request.data.begin() + 4 + static_cast<std::ptrdiff_t>(size));
  finishDownload();
}

void SdoServer::downloadSegment(const can::Frame& request) {
  if (transfer_ != Transfer::download) {
    transfer_ = Transfer::none;
    return abort(abort_code::kInvalidCommand);
  }
  if (!toggleFits(request)) return;
  const std::size_t size = kSegmentSize - ((request.data[0] >> 1U) & 7U);
  data_.insert(data_.end(), request.data.begin() + 1,
               request.data.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (data_.size() > kMemory) return abort(abort_code::kOutOfMemory);
  if (announced_size_ && data_.size() > *announced_size_) {
    return abort(abort_code::kLengthTooHigh);
  }
  if ((request.data[0] & kLastSegment) != 0) return finishDownload();
  confirmSegment();
}

// The whole value is in data_: takes it, then confirms in the form the client waits for.
void SdoServer::finishDownload() {
  const bool segmented = transfer_ == Transfer::download;
  if (segmented && announced_size_ && data_.size() != *announced_size_) {
    return abort(abort_code::kLengthTooLow);
  }
  if (const auto refused = context_.dictionary.write(object_, data_)) return abort(refused);
  transfer_ = Transfer::none;
  if (segmented) return confirmSegment();
  std::uint32_t echo = 0;
  for (std::size_t i = data_.size(); i-- > 0;) echo = (echo << 8U) | data_[i];
  answer(kDownloadInitiated, context_.behaviour.echoes_writes ? echo : 0);
}

void SdoServer::confirmSegment() {
  can::Frame frame = emptyFrame(answer_id_, 8);
  frame.data[0] = static_cast<std::uint8_t>(kDownloadSegmentDone | (toggle_ ? 0 : kToggle));
  context_.sink.send(frame);
}

void SdoServer::initiateUpload(const can::Frame& request) {
  object_ = objectOf(request);
  transfer_ = Transfer::none;
  if (const auto refused = context_.dictionary.read(object_, data_)) return abort(refused);
  answerUpload();
}

// The value is in data_: in the answer itself, or in segments to be asked for.
void SdoServer::answerUpload() {
  const bool tell_size = !context_.behaviour.upload_without_size;
  if (!data_.empty() && data_.size() <= kExpeditedSize) {
    std::uint32_t value = 0;
    const bool all_mean_something = context_.behaviour.answers_four_bytes;
    if (context_.behaviour.leaves_rubbish && !all_mean_something) value = kRubbish;
    for (std::size_t i = data_.size(); i-- > 0;) value = (value << 8U) | data_[i];
    if (context_.behaviour.answers_four_bytes) data_.resize(kExpeditedSize);
    const auto unused = static_cast<std::uint8_t>((kExpeditedSize - data_.size()) << 2U);
    const auto sized = static_cast<std::uint8_t>(unused | kSizeIndicated);
    return answer(
        static_cast<std::uint8_t>(kUploadInitiated | kExpedited | (tell_size ? sized : 0)), value);
  }
  transfer_ = Transfer::upload;
  toggle_ = false;
  sent_ = 0;
  if (!tell_size) return answer(kUploadInitiated);
  const bool truly = !context_.behaviour.announces_four_bytes;
  const std::size_t announced = truly ? data_.size() : kExpeditedSize;
  answer(kUploadInitiated | kSizeIndicated, static_cast<std::uint32_t>(announced));
}

void SdoServer::uploadSegment(const can::Frame& request) {
  if (transfer_ != Transfer::upload) {
    transfer_ = Transfer::none;
    return abort(abort_code::kInvalidCommand);
  }
  if (!toggleFits(request)) return;
  const std::size_t size = std::min(kSegmentSize, data_.size() - sent_);
  can::Frame frame = emptyFrame(answer_id_, 8);
  for (std::size_t i = 0; i < size; ++i) frame.data[1 + i] = data_[sent_ + i];
  sent_ += size;
  const bool last = sent_ == data_.size();
  frame.data[0] = static_cast<std::uint8_t>((toggle_ ? 0 : kToggle) | (kSegmentSize - size) << 1U |
                                            (last ? kLastSegment : 0));
  if (last) transfer_ = Transfer::none;
  context_.sink.send(frame);
}

// The toggle bit alternates from 0 on; `toggle_` is the one expected next.
bool SdoServer::toggleFits(const can::Frame& request) {
  if (((request.data[0] & kToggle) != 0) != toggle_) {
    abort(abort_code::kToggleBit);
    return false;
  }
  toggle_ = !toggle_;
  return true;
}

void SdoServer::answer(std::uint8_t command, std::uint32_t value) {
  can::Frame frame = emptyFrame(answer_id_, 8);
  frame.data[0] = command;
  putBytes(frame, 1, 2, object_.index);
  frame.data[3] = object_.subindex;
  putBytes(frame, 4, 4, value);
  context_.sink.send(frame);
}

void SdoServer::abort(std::uint32_t code) {
  transfer_ = Transfer::none;
  const bool missing = code == abort_code::kNoSuchObject || code == abort_code::kNoSuchSubindex;
  if (missing && context_.behaviour.silent_on_missing) return;
  const bool length = code == abort_code::kLengthTooHigh || code == abort_code::kLengthTooLow;
  answer(kAborted,
         length && context_.behaviour.generic_length_abort ? abort_code::kLengthMismatch : code);
}

}  // namespace cia402::sim
