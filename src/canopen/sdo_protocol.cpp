// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The server's answers to the SDO client, one function per answer of CiA 301, 7.2.4.3.
#include <algorithm>
#include <string>

#include "cia402_driver/canopen/abort_code.h"
#include "cia402_driver/canopen/sdo_client.h"

namespace cia402::canopen {
namespace {

// Server command specifiers, CiA 301, 7.2.4.3: the upper three bits of the first byte.
enum ServerCommand : unsigned {
  kUploadSegment = 0,
  kDownloadSegment = 1,
  kUploadInitiated = 2,
  kDownloadInitiated = 3,
  kAborted = 4,
};

constexpr std::uint8_t kExpedited = 0x02;      // upload initiate answer, bit e
constexpr std::uint8_t kSizeIndicated = 0x01;  // upload initiate answer, bit s
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLastSegment = 0x01;
constexpr std::size_t kSegmentBytes = 7;
/// An upload longer than this is refused: a server that never ends must not eat the memory.
constexpr std::size_t kMaxUpload = std::size_t{16} << 20;

std::uint32_t dataField(const can::Frame& frame) {
  return static_cast<std::uint32_t>(frame.data[4]) |
         static_cast<std::uint32_t>(frame.data[5]) << 8 |
         static_cast<std::uint32_t>(frame.data[6]) << 16 |
         static_cast<std::uint32_t>(frame.data[7]) << 24;
}

bool toggleOf(const can::Frame& frame) { return (frame.data[0] & kToggle) != 0; }

}  // namespace

void SdoClient::receive(const can::Frame& frame, Time now) {
  const bool ours = frame.id == 0x580U + node_ && !frame.extended && !frame.remote && !frame.error;
  // CiA 301, 7.2.4.3: an SDO is always eight bytes long.
  if (!ours || frame.size != 8 || dispatch(frame, now) == Outcome::stray) ++counters_.stray_frames;
}

SdoClient::Outcome SdoClient::dispatch(const can::Frame& frame, Time now) {
  if (phase_ == Phase::idle) return Outcome::stray;
  const unsigned command = frame.data[0] >> 5;
  if (command == kAborted) return onServerAbort(frame, now);
  if (command > kAborted) {
    // Bits of block transfer or undefined: nothing we asked for can be answered so.
    if (!namesCurrentObject(frame)) return Outcome::stray;
    abortTransfer(abort_code::kInvalidCommand, "unknown command specifier", now);
    return Outcome::taken;
  }
  // An answer that fits another phase is a late one to an abandoned request.
  switch (phase_) {
    case Phase::upload_initiate:
      return command == kUploadInitiated ? onUploadInitiated(frame, now) : Outcome::stray;
    case Phase::upload_segment:
      return command == kUploadSegment ? onUploadSegment(frame, now) : Outcome::stray;
    case Phase::download_initiate:
      return command == kDownloadInitiated ? onDownloadInitiated(frame, now) : Outcome::stray;
    case Phase::download_segment:
      return command == kDownloadSegment ? onDownloadSegment(frame, now) : Outcome::stray;
    case Phase::idle:
      break;
  }
  return Outcome::stray;
}

bool SdoClient::namesCurrentObject(const can::Frame& frame) const {
  const ObjectId object = queue_.front()->object_;
  return frame.data[1] == (object.index & 0xFFU) && frame.data[2] == object.index >> 8 &&
         frame.data[3] == object.subindex;
}

SdoClient::Outcome SdoClient::onServerAbort(const can::Frame& frame, Time now) {
  if (!namesCurrentObject(frame)) return Outcome::stray;
  const std::uint32_t code = dataField(frame);
  fail(SdoTransfer::Failure::aborted_by_server, code, "the drive refused: " + abortText(code), now);
  return Outcome::taken;
}

SdoClient::Outcome SdoClient::onUploadInitiated(const can::Frame& frame, Time now) {
  if (!namesCurrentObject(frame)) return Outcome::stray;
  const std::uint8_t command = frame.data[0];
  const bool size_indicated = (command & kSizeIndicated) != 0;
  if ((command & kExpedited) != 0) {
    const std::size_t size = size_indicated ? 4U - ((command >> 2) & 3U) : 4U;
    queue_.front()->data_.assign(frame.data.begin() + 4,
                                 frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(size));
    succeed(now);
    return Outcome::taken;
  }
  if (size_indicated) {
    announced_ = dataField(frame);
    if (*announced_ > kMaxUpload) {
      abortTransfer(abort_code::kOutOfMemory,
                    "the announced " + std::to_string(*announced_) + " bytes are too many", now);
      return Outcome::taken;
    }
    received_.reserve(*announced_);
  }
  requestSegment(now);
  return Outcome::taken;
}

void SdoClient::requestSegment(Time now) {
  const auto command = static_cast<std::uint8_t>(0x60 | (toggle_ ? kToggle : 0));
  sink_.send(can::Frame(0x600U + node_, {command, 0, 0, 0, 0, 0, 0, 0}));
  await(Phase::upload_segment, now);
}

SdoClient::Outcome SdoClient::onUploadSegment(const can::Frame& frame, Time now) {
  if (toggleOf(frame) != toggle_) {
    abortTransfer(abort_code::kToggleBit, "toggle bit not alternated", now);
    return Outcome::taken;
  }
  const std::size_t size = kSegmentBytes - ((frame.data[0] >> 1) & 7U);
  const bool last = (frame.data[0] & kLastSegment) != 0;
  received_.insert(received_.end(), frame.data.begin() + 1,
                   frame.data.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  const std::size_t limit = announced_.value_or(kMaxUpload);
  if (received_.size() > limit) {
    abortTransfer(announced_ ? abort_code::kLengthTooHigh : abort_code::kOutOfMemory,
                  "more than " + std::to_string(limit) + " bytes came", now);
  } else if (!last) {
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
  const std::size_t size = std::min(kSegmentBytes, data.size() - offset_);
  const bool last = offset_ + size == data.size();
  const std::size_t unused = (kSegmentBytes - size) << 1;
  can::Frame frame(0x600U + node_, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.data[0] =
      static_cast<std::uint8_t>((toggle_ ? kToggle : 0U) | unused | (last ? kLastSegment : 0U));
  std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(offset_), size, frame.data.begin() + 1);
  offset_ += size;
  sink_.send(frame);
  await(Phase::download_segment, now);
}

SdoClient::Outcome SdoClient::onDownloadSegment(const can::Frame& frame, Time now) {
  if (toggleOf(frame) != toggle_) {
    abortTransfer(abort_code::kToggleBit, "toggle bit not alternated", now);
    return Outcome::taken;
  }
  if (offset_ == queue_.front()->data_.size()) {
    succeed(now);
  } else {
    toggle_ = !toggle_;
    sendSegment(now);
  }
  return Outcome::taken;
}

}  // namespace cia402::canopen
