// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/download.h"

#include <algorithm>

#include "canopen/sdo/frames.h"
#include "fieldbus/bytes.h"

namespace cia402::canopen {

using namespace sdo;

namespace {

constexpr std::uint8_t kRequestSegmented = 0x21;  // size indicated
constexpr std::uint8_t kRequestExpedited = 0x23;  // size indicated
constexpr std::size_t kMostExpedited = 4;         // bytes in the request itself

}  // namespace

bool SdoDownload::isExpedited(std::size_t size) { return size >= 1 && size <= kMostExpedited; }

void SdoDownload::sendExpedited(SdoExchange& exchange, ObjectId object, const Bytes& data) {
  const std::size_t unused = kMostExpedited - data.size();
  exchange.sendRequest(static_cast<std::uint8_t>(kRequestExpedited | unused << 2U), object,
                       static_cast<std::uint32_t>(toUnsigned(data)));
}

void SdoDownload::initiate(Time now) {
  const Bytes& data = transfer_.data();
  if (isExpedited(data.size())) {
    sendExpedited(exchange_, transfer_.object(), data);
  } else {
    exchange_.sendRequest(kRequestSegmented, transfer_.object(),
                          static_cast<std::uint32_t>(data.size()));
  }
  exchange_.await(transfer_.options().timeout, now);
}

SdoReaction SdoDownload::receive(const can::Frame& frame, Time now) {
  const unsigned command = commandOf(frame);
  if (command >= kAborted) return noOrdinaryAnswer(frame, transfer_.object());
  // An answer that fits another phase is a repeated one.
  if (!initiated_) {
    return command == kDownloadInitiated ? onInitiated(frame, now) : SdoReaction::stray();
  }
  return command == kDownloadSegment ? onSegment(frame, now) : SdoReaction::stray();
}

SdoReaction SdoDownload::onInitiated(const can::Frame& frame, Time now) {
  if (!names(frame, transfer_.object())) return SdoReaction::stray();
  exchange_.answered(now);
  if (isExpedited(transfer_.data().size())) return SdoReaction::completed();
  initiated_ = true;
  sendSegment(now);
  return SdoReaction::taken();
}

void SdoDownload::sendSegment(Time now) {
  const Bytes& data = transfer_.data();
  const std::size_t size = std::min(kSegmentBytes, data.size() - offset_);
  const bool last = offset_ + size == data.size();
  const std::size_t unused = (kSegmentBytes - size) << 1;
  exchange_.sendSegment(
      static_cast<std::uint8_t>((toggle_ ? kToggle : 0U) | unused | (last ? kNoMoreSegments : 0U)),
      data.data() + offset_, size);
  offset_ += size;
  exchange_.await(transfer_.options().timeout, now);
}

SdoReaction SdoDownload::onSegment(const can::Frame& frame, Time now) {
  if (toggleOf(frame) != toggle_) return wrongToggle(exchange_.excuseRepetition(frame));
  exchange_.answered(now);
  if (offset_ == transfer_.data().size()) return SdoReaction::completed();
  toggle_ = !toggle_;
  sendSegment(now);
  return SdoReaction::taken();
}

}  // namespace cia402::canopen
