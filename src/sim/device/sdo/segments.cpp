// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo/segments.h"

#include <algorithm>

#include "fieldbus/abort_code.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

// Bits of the first byte.
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeIndicated = 0x01;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLastSegment = 0x01;

// Server command specifiers in place.
constexpr std::uint8_t kDownloadSegmentDone = 0x20;
constexpr std::uint8_t kDownloadInitiated = 0x60;
constexpr std::uint8_t kUploadInitiated = 0x40;

constexpr std::uint32_t kRubbish = 0x8FAF;  // in the bytes that mean nothing
constexpr std::size_t kExpeditedSize = 4;

}  // namespace

void SdoSegments::initiateDownload(const can::Frame& request) {
  channel_.begin(request);
  if ((request.data[0] & kExpedited) != 0) return downloadExpedited(request);
  channel_.announced_size.reset();
  if ((request.data[0] & kSizeIndicated) != 0) channel_.announced_size = takeBytes(request, 4, 4);
  if (const auto refused =
          channel_.context.dictionary.checkWritable(channel_.object, channel_.announced_size)) {
    return channel_.abort(refused);
  }
  if (channel_.announced_size.value_or(0) > kSdoMemory)
    return channel_.abort(abort_code::kOutOfMemory);
  channel_.transfer = SdoTransfer::download;
  toggle_ = false;
  channel_.data.clear();
  channel_.answer(kDownloadInitiated);
}

void SdoSegments::downloadExpedited(const can::Frame& request) {
  std::size_t size = kExpeditedSize;
  if ((request.data[0] & kSizeIndicated) != 0) {
    size -= (request.data[0] >> 2U) & 3U;
  } else if (const Entry* entry = channel_.context.dictionary.find(channel_.object)) {
    const std::size_t width = (widthBits(entry->type) + 7U) / 8U;
    if (width >= 1 && width <= kExpeditedSize) size = width;
  }
  channel_.data.assign(request.data.begin() + 4,
                       request.data.begin() + 4 + static_cast<std::ptrdiff_t>(size));
  finishDownload();
}

void SdoSegments::downloadSegment(const can::Frame& request) {
  if (channel_.transfer != SdoTransfer::download) {
    channel_.transfer = SdoTransfer::none;
    return channel_.abortInvalid();
  }
  if (!toggleFits(request)) return;
  const std::size_t size = kSdoSegment - ((request.data[0] >> 1U) & 7U);
  channel_.data.insert(channel_.data.end(), request.data.begin() + 1,
                       request.data.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (channel_.data.size() > kSdoMemory) return channel_.abort(abort_code::kOutOfMemory);
  if (channel_.announced_size && channel_.data.size() > *channel_.announced_size) {
    return channel_.abort(abort_code::kLengthTooHigh);
  }
  if ((request.data[0] & kLastSegment) != 0) return finishDownload();
  confirmSegment();
}

// The whole value is in channel_.data: takes it, then confirms in the form the client waits for.
void SdoSegments::finishDownload() {
  const bool segmented = channel_.transfer == SdoTransfer::download;
  if (segmented && channel_.announced_size && channel_.data.size() != *channel_.announced_size) {
    return channel_.abort(abort_code::kLengthTooLow);
  }
  if (const auto refused = channel_.context.dictionary.write(channel_.object, channel_.data))
    return channel_.abort(refused);
  channel_.transfer = SdoTransfer::none;
  if (segmented) return confirmSegment();
  std::uint32_t echo = 0;
  for (std::size_t i = channel_.data.size(); i-- > 0;) echo = (echo << 8U) | channel_.data[i];
  channel_.answer(kDownloadInitiated, channel_.context.behaviour.echoes_writes ? echo : 0);
}

void SdoSegments::confirmSegment() {
  can::Frame frame = emptyFrame(channel_.answer_id, 8);
  frame.data[0] = static_cast<std::uint8_t>(kDownloadSegmentDone | (toggle_ ? 0 : kToggle));
  channel_.context.sink.send(frame);
}

void SdoSegments::initiateUpload(const can::Frame& request) {
  channel_.begin(request);
  if (const auto refused = channel_.context.dictionary.read(channel_.object, channel_.data))
    return channel_.abort(refused);
  answerUpload();
}

// The value is in channel_.data: in the answer itself, or in segments to be asked for.
void SdoSegments::answerUpload() {
  const bool tell_size = !channel_.context.behaviour.upload_without_size;
  if (!channel_.data.empty() && channel_.data.size() <= kExpeditedSize) {
    std::uint32_t value = 0;
    const bool all_mean_something = channel_.context.behaviour.answers_four_bytes;
    if (channel_.context.behaviour.leaves_rubbish && !all_mean_something) value = kRubbish;
    for (std::size_t i = channel_.data.size(); i-- > 0;) value = (value << 8U) | channel_.data[i];
    if (channel_.context.behaviour.answers_four_bytes) channel_.data.resize(kExpeditedSize);
    const auto unused = static_cast<std::uint8_t>((kExpeditedSize - channel_.data.size()) << 2U);
    const auto sized = static_cast<std::uint8_t>(unused | kSizeIndicated);
    return channel_.answer(
        static_cast<std::uint8_t>(kUploadInitiated | kExpedited | (tell_size ? sized : 0)), value);
  }
  channel_.transfer = SdoTransfer::upload;
  toggle_ = false;
  channel_.sent = 0;
  if (!tell_size) return channel_.answer(kUploadInitiated);
  const bool truly = !channel_.context.behaviour.announces_four_bytes;
  const std::size_t announced = truly ? channel_.data.size() : kExpeditedSize;
  channel_.answer(kUploadInitiated | kSizeIndicated, static_cast<std::uint32_t>(announced));
}

void SdoSegments::uploadSegment(const can::Frame& request) {
  if (channel_.transfer != SdoTransfer::upload) {
    channel_.transfer = SdoTransfer::none;
    return channel_.abortInvalid();
  }
  if (!toggleFits(request)) return;
  const std::size_t size = std::min(kSdoSegment, channel_.data.size() - channel_.sent);
  can::Frame frame = emptyFrame(channel_.answer_id, 8);
  for (std::size_t i = 0; i < size; ++i) frame.data[1 + i] = channel_.data[channel_.sent + i];
  channel_.sent += size;
  const bool last = channel_.sent == channel_.data.size();
  frame.data[0] = static_cast<std::uint8_t>((toggle_ ? 0 : kToggle) | (kSdoSegment - size) << 1U |
                                            (last ? kLastSegment : 0));
  if (last) channel_.transfer = SdoTransfer::none;
  channel_.context.sink.send(frame);
}

// The toggle bit alternates from 0 on; `toggle_` is the one expected next.
bool SdoSegments::toggleFits(const can::Frame& request) {
  if (((request.data[0] & kToggle) != 0) != toggle_) {
    channel_.abort(abort_code::kToggleBit);
    return false;
  }
  toggle_ = !toggle_;
  return true;
}

}  // namespace cia402::sim
