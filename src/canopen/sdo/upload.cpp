// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/upload.h"

#include <string>
#include <utility>

#include "canopen/sdo/frames.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {

using namespace sdo;

namespace {

constexpr std::uint8_t kRequestSegment = 0x60;
// Bits e and s of the answer to the initiating request (CiA 301, 7.2.4.2.6).
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeInAnswer = 0x01;

}  // namespace

void SdoUpload::initiate(Time now) {
  exchange_.sendRequest(kRequestUpload, transfer_.object(), 0);
  exchange_.await(transfer_.options().timeout, now);
}

SdoReaction SdoUpload::receive(const can::Frame& frame, Time now) {
  const unsigned command = commandOf(frame);
  if (command >= kAborted) return noOrdinaryAnswer(frame, transfer_.object());
  // An answer that fits another phase is a repeated one.
  if (!initiated_) {
    return command == kUploadInitiated ? onInitiated(frame, now) : SdoReaction::stray();
  }
  return command == kUploadSegment ? onSegment(frame, now) : SdoReaction::stray();
}

SdoReaction SdoUpload::onInitiated(const can::Frame& frame, Time now) {
  if (!names(frame, transfer_.object())) return SdoReaction::stray();
  exchange_.answered(now);
  const std::uint8_t command = frame.data[0];
  const bool size_indicated = (command & kSizeInAnswer) != 0;
  if ((command & kExpedited) != 0) {
    const std::size_t size = size_indicated ? 4U - ((command >> 2) & 3U) : 4U;
    transfer_.setData(
        {frame.data.begin() + 4, frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(size)});
    return SdoReaction::completed();
  }
  if (size_indicated) {
    announced_ = dataOf(frame);
    const std::size_t allowed = transfer_.options().longest_upload;
    if (*announced_ > allowed) return tooMuchAnnounced(*announced_, allowed);
    received_.reserve(*announced_);  // memory is taken only for what is allowed
  }
  initiated_ = true;
  requestSegment(now);
  return SdoReaction::taken();
}

void SdoUpload::requestSegment(Time now) {
  exchange_.send(static_cast<std::uint8_t>(kRequestSegment | (toggle_ ? kToggle : 0)));
  exchange_.await(transfer_.options().timeout, now);
}

SdoReaction SdoUpload::onSegment(const can::Frame& frame, Time now) {
  if (toggleOf(frame) != toggle_) return wrongToggle(exchange_.excuseRepetition(frame));
  exchange_.answered(now);
  const std::size_t size = kSegmentBytes - ((frame.data[0] >> 1) & 7U);
  const bool last = (frame.data[0] & kNoMoreSegments) != 0;
  const std::size_t limit = announced_.value_or(transfer_.options().longest_upload);
  if (received_.size() + size > limit) {
    return SdoReaction::broken(announced_ ? abort_code::kLengthTooHigh : abort_code::kOutOfMemory,
                               "more than " + std::to_string(limit) + " bytes came");
  }
  received_.insert(received_.end(), frame.data.begin() + 1,
                   frame.data.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (!last) {
    toggle_ = !toggle_;
    requestSegment(now);
    return SdoReaction::taken();
  }
  if (announced_ && received_.size() < *announced_) {
    return SdoReaction::broken(abort_code::kLengthTooLow,
                               std::to_string(received_.size()) + " bytes came, " +
                                   std::to_string(*announced_) + " were announced");
  }
  transfer_.setData(std::move(received_));
  return SdoReaction::completed();
}

}  // namespace cia402::canopen
