// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The server's answers to the SDO client, one function per answer of CiA 301, 7.2.4.3.
#include <algorithm>
#include <string>

#include "cia402_driver/canopen/sdo/client.h"
#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

// Server command specifiers, CiA 301, 7.2.4.3: the upper three bits of the first byte.
enum ServerCommand : unsigned {
  kUploadSegment = 0,
  kDownloadSegment = 1,
  kUploadInitiated = 2,
  kDownloadInitiated = 3,
  kAborted = 4,
  kBlockDownload = 5,
  kBlockUpload = 6,
};

constexpr std::uint8_t kAbortCommand = 0x80;
constexpr std::uint8_t kExpedited = 0x02;            // upload initiate answer, bit e
constexpr std::uint8_t kUploadSizeIndicated = 0x01;  // upload initiate answer, bit s
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kNoMoreSegments = 0x01;
constexpr std::size_t kSegmentData = 7;

std::uint32_t dataField(const can::Frame& frame) {
  return static_cast<std::uint32_t>(frame.data[4]) |
         static_cast<std::uint32_t>(frame.data[5]) << 8 |
         static_cast<std::uint32_t>(frame.data[6]) << 16 |
         static_cast<std::uint32_t>(frame.data[7]) << 24;
}

bool toggleOf(const can::Frame& frame) { return (frame.data[0] & kToggle) != 0; }

}  // namespace

void SdoClient::receive(const can::Frame& frame, Time now) {
  const bool ours = frame.id == answer_id_ && !frame.extended && !frame.remote && !frame.error;
  // CiA 301, 7.2.4.3: an SDO is always eight bytes long.
  if (!ours || frame.size != 8 || dispatch(frame, now) == Outcome::stray) {
    ++counters_.stray_frames;
    return;
  }
  last_answer_ = frame;
}

bool SdoClient::inBlockTransfer() const {
  switch (phase_) {
    case Phase::block_upload_initiate:
    case Phase::block_upload_segments:
    case Phase::block_upload_end:
    case Phase::block_download_initiate:
    case Phase::block_download_segments:
    case Phase::block_download_acknowledge:
    case Phase::block_download_end:
      return true;
    default:
      return false;
  }
}

SdoClient::Outcome SdoClient::dispatch(const can::Frame& frame, Time now) {
  if (phase_ == Phase::idle) return Outcome::stray;
  if (phase_ == Phase::fence) return onFenceAnswer(frame, now);
  if (phase_ == Phase::block_upload_segments && frame.data[0] != kAbortCommand) {
    return onBlockUploadSegment(frame, now);
  }
  if (!inBlockTransfer()) return dispatchSegmented(frame, now);
  if (frame.data[0] == kAbortCommand) return onServerAbort(frame, now);
  return dispatchBlock(frame, now);
}

SdoClient::Outcome SdoClient::dispatchSegmented(const can::Frame& frame, Time now) {
  const unsigned command = frame.data[0] >> 5;
  if (command == kAborted) return onServerAbort(frame, now);
  if (command > kAborted) {
    // Bits of block transfer or undefined: nothing we asked for can be answered so.
    if (!namesCurrentObject(frame)) return Outcome::stray;
    abortTransfer(abort_code::kInvalidCommand, "unknown command specifier", now);
    return Outcome::taken;
  }
  // An answer that fits another phase is a repeated one.
  switch (phase_) {
    case Phase::upload_initiate:
      return command == kUploadInitiated ? onUploadInitiated(frame, now) : Outcome::stray;
    case Phase::upload_segment:
      return command == kUploadSegment ? onUploadSegment(frame, now) : Outcome::stray;
    case Phase::download_initiate:
      return command == kDownloadInitiated ? onDownloadInitiated(frame, now) : Outcome::stray;
    case Phase::download_segment:
      return command == kDownloadSegment ? onDownloadSegment(frame, now) : Outcome::stray;
    default:
      return Outcome::stray;
  }
}

SdoClient::Outcome SdoClient::dispatchBlock(const can::Frame& frame, Time now) {
  const unsigned command = frame.data[0] >> 5;
  switch (phase_) {
    case Phase::block_upload_initiate:
      if (command == kUploadInitiated) return onUploadInitiated(frame, now);
      return command == kBlockUpload ? onBlockUploadInitiated(frame, now) : Outcome::stray;
    case Phase::block_upload_end:
      return command == kBlockUpload ? onBlockUploadEnd(frame, now) : Outcome::stray;
    case Phase::block_download_initiate:
      return command == kBlockDownload ? onBlockDownloadInitiated(frame, now) : Outcome::stray;
    case Phase::block_download_segments:
    case Phase::block_download_acknowledge:
      return command == kBlockDownload ? onBlockAcknowledged(frame, now) : Outcome::stray;
    case Phase::block_download_end:
      return command == kBlockDownload ? onBlockDownloadEnd(frame, now) : Outcome::stray;
    default:
      return Outcome::stray;
  }
}

bool SdoClient::names(const can::Frame& frame, ObjectId object) {
  return frame.data[1] == (object.index & 0xFFU) && frame.data[2] == object.index >> 8 &&
         frame.data[3] == object.subindex;
}

bool SdoClient::namesCurrentObject(const can::Frame& frame) const {
  return names(frame, queue_.front()->object_);
}

/// Everything that comes before it is the past of an abandoned transfer.
SdoClient::Outcome SdoClient::onFenceAnswer(const can::Frame& frame, Time now) {
  const bool answer = frame.data[0] >> 5 == kUploadInitiated || frame.data[0] == kAbortCommand;
  if (!answer || !names(frame, fenceObject())) return Outcome::stray;
  answered(now);
  if (--fences_left_ > 0) {
    sendFence(now);
  } else {
    abandoned_.reset();
    initiate(now);
  }
  return Outcome::taken;
}

SdoClient::Outcome SdoClient::onServerAbort(const can::Frame& frame, Time now) {
  if (!namesCurrentObject(frame)) return Outcome::stray;
  const std::uint32_t code = dataField(frame);
  answered(now);
  if (fallsBack(code, now)) return Outcome::taken;
  fail(SdoTransfer::Failure::aborted_by_server, code, "the drive refused: " + abortText(code), now);
  return Outcome::taken;
}

SdoClient::Outcome SdoClient::onUploadInitiated(const can::Frame& frame, Time now) {
  if (!namesCurrentObject(frame)) return Outcome::stray;
  answered(now);
  const std::uint8_t command = frame.data[0];
  const bool size_indicated = (command & kUploadSizeIndicated) != 0;
  if ((command & kExpedited) != 0) {
    const std::size_t size = size_indicated ? 4U - ((command >> 2) & 3U) : 4U;
    queue_.front()->data_.assign(frame.data.begin() + 4,
                                 frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(size));
    succeed(now);
    return Outcome::taken;
  }
  if (size_indicated && !acceptAnnounced(dataField(frame), now)) return Outcome::taken;
  requestSegment(now);
  return Outcome::taken;
}

/// Memory is taken only for what is allowed. @return false: aborted.
bool SdoClient::acceptAnnounced(std::uint32_t size, Time now) {
  announced_ = size;
  const std::size_t limit = queue_.front()->options_.longest_upload;
  if (size > limit) {
    abortTransfer(abort_code::kOutOfMemory,
                  "the announced " + std::to_string(size) + " bytes are more than the " +
                      std::to_string(limit) + " allowed",
                  now);
    return false;
  }
  received_.reserve(size);
  return true;
}

/// A frame that came twice is not a server that forgets to toggle; one that comes thrice is.
SdoClient::Outcome SdoClient::onWrongToggle(const can::Frame& frame, Time now) {
  if (frame == last_answer_ && !repetition_seen_) {
    repetition_seen_ = true;
    return Outcome::stray;
  }
  abortTransfer(abort_code::kToggleBit, "toggle bit not alternated", now);
  return Outcome::taken;
}

void SdoClient::requestSegment(Time now) {
  const auto command = static_cast<std::uint8_t>(0x60 | (toggle_ ? kToggle : 0));
  sink_.send(can::Frame(request_id_, {command, 0, 0, 0, 0, 0, 0, 0}));
  await(Phase::upload_segment, now);
}

SdoClient::Outcome SdoClient::onUploadSegment(const can::Frame& frame, Time now) {
  if (toggleOf(frame) != toggle_) return onWrongToggle(frame, now);
  answered(now);
  const std::size_t size = kSegmentData - ((frame.data[0] >> 1) & 7U);
  const bool last = (frame.data[0] & kNoMoreSegments) != 0;
  const std::size_t limit = announced_.value_or(queue_.front()->options_.longest_upload);
  if (received_.size() + size > limit) {
    abortTransfer(announced_ ? abort_code::kLengthTooHigh : abort_code::kOutOfMemory,
                  "more than " + std::to_string(limit) + " bytes came", now);
    return Outcome::taken;
  }
  received_.insert(received_.end(), frame.data.begin() + 1,
                   frame.data.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (!last) {
    toggle_ = !toggle_;
    requestSegment(now);
  } else if (announced_ && received_.size() < *announced_) {
    abortTransfer(abort_code::kLengthTooLow,
                  std::to_string(received_.size()) + " bytes came, " + std::to_string(*announced_) +
                      " were announced",
                  now);
  } else {
    queue_.front()->data_ = std::move(received_);
    succeed(now);
  }
  return Outcome::taken;
}

SdoClient::Outcome SdoClient::onDownloadInitiated(const can::Frame& frame, Time now) {
  if (!namesCurrentObject(frame)) return Outcome::stray;
  answered(now);
  const std::size_t size = queue_.front()->data_.size();
  if (size >= 1 && size <= 4) {
    succeed(now);
  } else {
    sendSegment(now);
  }
  return Outcome::taken;
}

void SdoClient::sendSegment(Time now) {
  const Bytes& data = queue_.front()->data_;
  const std::size_t size = std::min(kSegmentData, data.size() - offset_);
  const bool last = offset_ + size == data.size();
  const std::size_t unused = (kSegmentData - size) << 1;
  can::Frame frame(request_id_, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.data[0] =
      static_cast<std::uint8_t>((toggle_ ? kToggle : 0U) | unused | (last ? kNoMoreSegments : 0U));
  std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(offset_), size, frame.data.begin() + 1);
  offset_ += size;
  sink_.send(frame);
  await(Phase::download_segment, now);
}

SdoClient::Outcome SdoClient::onDownloadSegment(const can::Frame& frame, Time now) {
  if (toggleOf(frame) != toggle_) return onWrongToggle(frame, now);
  answered(now);
  if (offset_ == queue_.front()->data_.size()) {
    succeed(now);
  } else {
    toggle_ = !toggle_;
    sendSegment(now);
  }
  return Outcome::taken;
}

}  // namespace cia402::canopen
