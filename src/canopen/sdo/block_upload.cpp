// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Block upload (CiA 301, 7.2.4.2.13 to 7.2.4.2.16, 7.2.4.3.12 to 7.2.4.3.15): the server sends up
// to 127 segments in a row, the client acknowledges them together and asks for lost ones again.
#include <algorithm>
#include <string>

#include "canopen/sdo/block.h"
#include "canopen/sdo/crc.h"
#include "cia402_driver/canopen/sdo/client.h"
#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::canopen {

using namespace sdo_block;

namespace {

constexpr std::uint8_t kSizeIndicated = 0x02;
constexpr std::uint8_t kSequence = 0x7F;
constexpr std::uint8_t kStart = 0xA3;
constexpr std::uint8_t kAcknowledge = 0xA2;
constexpr std::uint8_t kEndAcknowledge = 0xA1;

}  // namespace

SdoClient::Outcome SdoClient::onBlockUploadInitiated(const can::Frame& frame, Time now) {
  const std::uint8_t command = frame.data[0];
  if ((command & 1U) != 0 || !namesCurrentObject(frame)) return Outcome::stray;
  answered(now);
  block_.crc = (command & kCrcSupported) != 0;
  block_.size = kMostSegments;
  const auto size = static_cast<std::uint32_t>(frame.data[4]) |
                    static_cast<std::uint32_t>(frame.data[5]) << 8 |
                    static_cast<std::uint32_t>(frame.data[6]) << 16 |
                    static_cast<std::uint32_t>(frame.data[7]) << 24;
  if ((command & kSizeIndicated) != 0 && !acceptAnnounced(size, now)) return Outcome::taken;
  sink_.send(can::Frame(request_id_, {kStart, 0, 0, 0, 0, 0, 0, 0}));
  await(Phase::block_upload_segments, now);
  return Outcome::taken;
}

SdoClient::Outcome SdoClient::onBlockUploadSegment(const can::Frame& frame, Time now) {
  if (frame == last_answer_) return Outcome::stray;  // it came twice
  const unsigned sequence = frame.data[0] & kSequence;
  const bool last = (frame.data[0] & kLastSegment) != 0;
  if (sequence == 0 || sequence > block_.size) {
    abortTransfer(abort_code::kInvalidSequence,
                  "segment number " + std::to_string(sequence) + " of a sub-block of " +
                      std::to_string(block_.size),
                  now);
    return Outcome::taken;
  }
  if (sequence <= block_.sequence) return Outcome::stray;
  if (sequence == block_.sequence + 1 && !block_.gap) {
    if (!appendBlockSegment(frame, now)) return Outcome::taken;
    block_.sequence = sequence;
    block_.last = last;
    block_.vain = 0;
  } else {
    block_.gap = true;  // what follows is sent again, too
  }
  if (last || sequence == block_.size) {
    endSubBlock(now);
  } else {
    await(Phase::block_upload_segments, now);
  }
  return Outcome::taken;
}

/// @return false: aborted.
bool SdoClient::appendBlockSegment(const can::Frame& frame, Time now) {
  const std::size_t limit = announced_.value_or(queue_.front()->options_.longest_upload);
  if (received_.size() >= std::max<std::size_t>(limit, 1)) {
    abortTransfer(announced_ ? abort_code::kLengthMismatch : abort_code::kOutOfMemory,
                  "more than " + std::to_string(limit) + " bytes came", now);
    return false;
  }
  if (block_.crc)
    checkBlock(received_.size());  // how much of the last segment counts is known at the end only
  received_.insert(received_.end(), frame.data.begin() + 1, frame.data.end());
  return true;
}

void SdoClient::checkBlock(std::size_t until) {
  const Bytes& data = queue_.front()->direction_ == SdoTransfer::Direction::upload
                          ? received_
                          : queue_.front()->data_;
  if (until <= block_.checked) return;
  block_.checksum = sdoCrc(block_.checksum, data.data() + block_.checked, until - block_.checked);
  block_.checked = until;
}

/// Whether a mix-up over what was acknowledged would be seen in the end. The CRC begins with 0: it
/// takes no notice of zeros more or less before the first other byte.
bool SdoClient::mayRepeatSegments() const {
  return announced_.has_value() || (block_.crc && block_.checksum != 0);
}

void SdoClient::endSubBlock(Time now) {
  const bool complete = block_.last && !block_.gap;
  if (block_.gap) {
    ++counters_.retries;
    if (!mayRepeatSegments()) {
      abortTransfer(abort_code::kInvalidSequence,
                    "a segment is missing, and without size and CRC nothing would show whether "
                    "the repetition fits",
                    now);
      return;
    }
    if (block_.sequence == 0 && ++block_.vain > kMostVain) {
      abortTransfer(
          abort_code::kInvalidSequence,
          "the first segment was missing " + std::to_string(block_.vain) + " times in a row", now);
      return;
    }
  }
  const unsigned sequence = block_.sequence;
  block_.sequence = 0;
  block_.gap = false;
  sendBlockAcknowledge(sequence, now);
  if (complete) phase_ = Phase::block_upload_end;
}

void SdoClient::sendBlockAcknowledge(unsigned sequence, Time now) {
  block_.acknowledged = sequence;
  sink_.send(can::Frame(request_id_, {kAcknowledge, static_cast<std::uint8_t>(sequence),
                                      static_cast<std::uint8_t>(block_.size), 0, 0, 0, 0, 0}));
  await(Phase::block_upload_segments, now);
}

SdoClient::Outcome SdoClient::onBlockUploadEnd(const can::Frame& frame, Time now) {
  if ((frame.data[0] & 0x03U) != 1) return Outcome::stray;
  const std::size_t unused = frame.data[0] >> 2U & 7U;
  const std::size_t size = received_.size() - std::min(unused, received_.size());
  const auto crc = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  const std::size_t sure = std::min(block_.checked, size);  // all but the last segment
  const std::uint16_t checksum = sdoCrc(block_.checksum, received_.data() + sure, size - sure);
  const bool crc_wrong = block_.crc && crc != checksum;
  const bool size_wrong = announced_ && size != *announced_;
  // The last segment once more can look like the end; only what proves itself is one.
  if (frame == last_answer_ && (crc_wrong || size_wrong || !mayRepeatSegments())) {
    return Outcome::stray;
  }
  if (crc_wrong) {
    abortTransfer(abort_code::kCrcError, "the CRC does not fit the data", now);
  } else if (size_wrong) {
    abortTransfer(
        abort_code::kLengthMismatch,
        std::to_string(size) + " bytes came, " + std::to_string(*announced_) + " were announced",
        now);
  } else {
    sink_.send(can::Frame(request_id_, {kEndAcknowledge, 0, 0, 0, 0, 0, 0, 0}));
    received_.resize(size);
    queue_.front()->data_ = std::move(received_);
    succeed(now);
  }
  return Outcome::taken;
}

/// Nothing came for the time-out: our last word may have been lost, or the end of a sub-block.
/// @return false where that cannot be mended.
bool SdoClient::resumeBlockUpload(Time now) {
  const bool segments = phase_ == Phase::block_upload_segments;
  if (!segments && phase_ != Phase::block_upload_end) return false;
  if (!mayRepeatSegments() || block_.vain > 0) return false;
  const Phase phase = phase_;
  ++block_.vain;
  ++counters_.retries;
  if (segments && block_.sequence > 0) {
    sendBlockAcknowledge(block_.sequence, now);
    block_.sequence = 0;
    block_.gap = false;
  } else if (block_.acknowledged) {
    sendBlockAcknowledge(*block_.acknowledged, now);
    phase_ = phase;
  } else {
    sink_.send(can::Frame(request_id_, {kStart, 0, 0, 0, 0, 0, 0, 0}));
    await(Phase::block_upload_segments, now);
  }
  return true;
}

}  // namespace cia402::canopen
