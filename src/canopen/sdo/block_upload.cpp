// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/block_upload.h"

#include <algorithm>
#include <string>
#include <utility>

#include "canopen/sdo/frames.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {

using namespace sdo;

namespace {

constexpr std::uint8_t kRequestBlockUpload = 0xA4;  // CRC supported
constexpr std::uint8_t kStart = 0xA3;
constexpr std::uint8_t kAcknowledge = 0xA2;
constexpr std::uint8_t kEndAcknowledge = 0xA1;
constexpr std::uint8_t kSizeIndicated = 0x02;
constexpr std::uint8_t kSequence = 0x7F;
/// Up to here the server may answer a block upload by an ordinary one: that is fewer frames.
constexpr std::uint32_t kSwitchThreshold = 28;  // bytes

}  // namespace

void SdoBlockUpload::initiate(Time now) {
  exchange_.sendRequest(kRequestBlockUpload, transfer_.object(),
                        std::uint32_t{kMostSegments} | kSwitchThreshold << 8U);
  await(Phase::initiate, now);
}

void SdoBlockUpload::await(Phase phase, Time now) {
  phase_ = phase;
  exchange_.await(transfer_.options().timeout, now);
}

SdoReaction SdoBlockUpload::receive(const can::Frame& frame, Time now) {
  if (frame.data[0] == kAbort) return serverAbort(frame, transfer_.object());
  const unsigned command = commandOf(frame);
  switch (phase_) {
    case Phase::initiate:
      if (command == kUploadInitiated) {
        return names(frame, transfer_.object()) ? SdoReaction::ordinary() : SdoReaction::stray();
      }
      return command == kBlockUpload ? onInitiated(frame, now) : SdoReaction::stray();
    case Phase::segments:
      return onSegment(frame, now);
    case Phase::end:
      return command == kBlockUpload ? onEnd(frame) : SdoReaction::stray();
  }
  return SdoReaction::stray();
}

SdoReaction SdoBlockUpload::onInitiated(const can::Frame& frame, Time now) {
  const std::uint8_t command = frame.data[0];
  if ((command & 1U) != 0 || !names(frame, transfer_.object())) return SdoReaction::stray();
  exchange_.answered(now);
  checksum_.used = (command & kCrcSupported) != 0;
  if ((command & kSizeIndicated) != 0) {
    announced_ = dataOf(frame);
    const std::size_t allowed = transfer_.options().longest_upload;
    if (*announced_ > allowed) return tooMuchAnnounced(*announced_, allowed);
    received_.reserve(*announced_);  // memory is taken only for what is allowed
  }
  start(now);
  return SdoReaction::taken();
}

void SdoBlockUpload::start(Time now) {
  exchange_.send(kStart);
  await(Phase::segments, now);
}

SdoReaction SdoBlockUpload::onSegment(const can::Frame& frame, Time now) {
  if (exchange_.isRepetition(frame)) return SdoReaction::stray();
  const unsigned sequence = frame.data[0] & kSequence;
  const bool last = (frame.data[0] & kLastSegment) != 0;
  if (sequence == 0) {  // it has seven bits, so it is not above kMostSegments
    return SdoReaction::broken(abort_code::kInvalidSequence,
                               "segment number " + std::to_string(sequence) +
                                   " of a sub-block of " + std::to_string(kMostSegments));
  }
  if (sequence <= sequence_) return SdoReaction::stray();
  if (sequence == sequence_ + 1 && !gap_) {
    if (received_.size() >= std::max<std::size_t>(limit(), 1)) {
      return SdoReaction::broken(
          announced_ ? abort_code::kLengthMismatch : abort_code::kOutOfMemory,
          "more than " + std::to_string(limit()) + " bytes came");
    }
    append(frame);
    sequence_ = sequence;
    last_ = last;
    vain_ = 0;
  } else {
    gap_ = true;  // what follows is sent again, too
  }
  if (last || sequence == kMostSegments) return endSubBlock(now);
  await(Phase::segments, now);
  return SdoReaction::taken();
}

std::size_t SdoBlockUpload::limit() const {
  return announced_.value_or(transfer_.options().longest_upload);
}

void SdoBlockUpload::append(const can::Frame& frame) {
  // How much of the last segment counts is known at the end only.
  if (checksum_.used) checksum_.extend(received_.data(), received_.size());
  received_.insert(received_.end(), frame.data.begin() + 1, frame.data.end());
}

/// Whether a mix-up over what was acknowledged would be seen in the end. The CRC begins with 0: it
/// takes no notice of zeros more or less before the first other byte.
bool SdoBlockUpload::mayRepeatSegments() const {
  return announced_.has_value() || (checksum_.used && checksum_.value != 0);
}

SdoReaction SdoBlockUpload::endSubBlock(Time now) {
  const bool complete = last_ && !gap_;
  if (gap_) {
    ++exchange_.counters().retries;
    if (!mayRepeatSegments()) {
      return SdoReaction::broken(abort_code::kInvalidSequence,
                                 "a segment is missing, and without size and CRC nothing would "
                                 "show whether the repetition fits");
    }
    if (sequence_ == 0 && ++vain_ > kMostVain) {
      return SdoReaction::broken(
          abort_code::kInvalidSequence,
          "the first segment was missing " + std::to_string(vain_) + " times in a row");
    }
  }
  acknowledge(sequence_, now);
  if (complete) phase_ = Phase::end;
  return SdoReaction::taken();
}

/// Another sub-block, or what is missing of this one, may come.
void SdoBlockUpload::acknowledge(unsigned sequence, Time now) {
  sequence_ = 0;
  gap_ = false;
  acknowledged_ = sequence;
  exchange_.send(kAcknowledge, static_cast<std::uint8_t>(sequence),
                 static_cast<std::uint8_t>(kMostSegments));
  await(Phase::segments, now);
}

SdoReaction SdoBlockUpload::onEnd(const can::Frame& frame) {
  if ((frame.data[0] & 0x03U) != 1) return SdoReaction::stray();
  const std::size_t unused = frame.data[0] >> 2U & 7U;
  const std::size_t size = received_.size() - std::min(unused, received_.size());
  const auto crc = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  const std::size_t sure = std::min(checksum_.covered, size);  // all but the last segment
  const std::uint16_t checksum = sdoCrc(checksum_.value, received_.data() + sure, size - sure);
  const bool crc_wrong = checksum_.used && crc != checksum;
  const bool size_wrong = announced_ && size != *announced_;
  // The last segment once more can look like the end; only what proves itself is one.
  if (exchange_.isRepetition(frame) && (crc_wrong || size_wrong || !mayRepeatSegments())) {
    return SdoReaction::stray();
  }
  if (crc_wrong) {
    return SdoReaction::broken(abort_code::kCrcError, "the CRC does not fit the data");
  }
  if (size_wrong) {
    return SdoReaction::broken(
        abort_code::kLengthMismatch,
        std::to_string(size) + " bytes came, " + std::to_string(*announced_) + " were announced");
  }
  exchange_.send(kEndAcknowledge);
  received_.resize(size);
  transfer_.setData(std::move(received_));
  return SdoReaction::completed();
}

bool SdoBlockUpload::resume(Time now) {
  const Phase phase = phase_;
  if (phase == Phase::initiate || !mayRepeatSegments() || vain_ > 0) return false;
  ++vain_;
  ++exchange_.counters().retries;
  if (phase == Phase::segments && sequence_ > 0) {
    acknowledge(sequence_, now);
  } else if (acknowledged_) {
    exchange_.send(kAcknowledge, static_cast<std::uint8_t>(*acknowledged_),
                   static_cast<std::uint8_t>(kMostSegments));
    await(phase, now);
  } else {
    start(now);
  }
  return true;
}

}  // namespace cia402::canopen
