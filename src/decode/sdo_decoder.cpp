// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/decode/sdo_decoder.h"

#include <algorithm>

#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::decode {
namespace {

using can::Frame;
using fieldbus::Bytes;
using fieldbus::ObjectId;

constexpr std::size_t kKept = 64;  // bytes of a transfer that are remembered for its text
constexpr std::uint8_t kAbort = 0x80;

/// Command specifiers, bits 7..5 of the first byte (CiA 301, 7.2.4.3).
namespace client {
constexpr unsigned kDownloadSegment = 0, kInitiateDownload = 1, kInitiateUpload = 2,
                   kUploadSegment = 3, kBlockUpload = 5, kBlockDownload = 6;
}
namespace server {
constexpr unsigned kUploadSegment = 0, kDownloadSegment = 1, kInitiateUpload = 2,
                   kInitiateDownload = 3, kBlockDownload = 5, kBlockUpload = 6;
}

unsigned command(const Frame& frame) { return frame.data[0] >> 5U; }

ObjectId objectOf(const Frame& frame) {
  return {static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8), frame.data[3]};
}

std::uint32_t longOf(const Frame& frame) {
  return static_cast<std::uint32_t>(frame.data[4]) |
         static_cast<std::uint32_t>(frame.data[5]) << 8 |
         static_cast<std::uint32_t>(frame.data[6]) << 16 |
         static_cast<std::uint32_t>(frame.data[7]) << 24;
}

/// Expedited data: 1 to 4 bytes as bits 3..2 say; all 4 where the size is not indicated.
Bytes expedited(const Frame& frame) {
  const bool sized = (frame.data[0] & 1) != 0;
  const std::size_t count = sized ? 4U - (frame.data[0] >> 2 & 3U) : 4U;
  return {frame.data.begin() + 4, frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(count)};
}

std::string bytes(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " byte" : " bytes");
}

std::string toggle(const Frame& frame) {
  return std::string("toggle ") + ((frame.data[0] & 0x10) != 0 ? "1" : "0");
}

std::string unknown(const Frame& frame) { return "no SDO command: " + hexNumber(frame.data[0], 1); }

}  // namespace

std::string SdoDecoder::title(ObjectId object) const {
  return values_ != nullptr ? values_->title(object) : fieldbus::toString(object);
}

std::string SdoDecoder::current() const {
  return known_ ? title(object_) : "of a transfer that began before";
}

std::string SdoDecoder::value(ObjectId object, const Bytes& data) const {
  return values_ != nullptr ? values_->describe(object, data) : bytesText(data);
}

/// What the transfer brought, once it is complete.
std::string SdoDecoder::whole() const {
  if (!known_) return "";
  const std::string all = ": " + bytes(received_) + " in all: ";
  if (received_ > data_.size()) return all + bytesText(data_) + " and so on";
  const bool listed = values_ != nullptr && values_->lists(object_);
  return all + (listed ? values_->describe(object_, data_) : bytesText(data_));
}

void SdoDecoder::begin(const Frame& frame, Transfer transfer) {
  transfer_ = transfer;
  object_ = objectOf(frame);
  known_ = true;
  in_block_ = false;
  data_.clear();
  received_ = block_began_ = 0;
  last_segment_seen_ = false;
}

void SdoDecoder::collect(const Frame& frame, std::size_t count) {
  received_ += count;
  for (std::size_t i = 1; i <= count && data_.size() < kKept; ++i) data_.push_back(frame.data[i]);
}

std::string SdoDecoder::abort(const Frame& frame) {
  transfer_ = Transfer::none;
  in_block_ = known_ = false;
  return "abort " + title(objectOf(frame)) + ": " + fieldbus::abortText(longOf(frame));
}

/// The data of a segment (download by the client, upload by the server).
std::string SdoDecoder::segment(const Frame& frame) {
  const std::size_t count = 7U - (frame.data[0] >> 1 & 7U);
  const bool last = (frame.data[0] & 1) != 0;
  collect(frame, count);
  std::string text = "segment " + current() + ", " + toggle(frame) + ", " + bytes(count);
  if (last) {
    text += ", the last" + whole();
    if (transfer_ == Transfer::upload) transfer_ = Transfer::none;
  }
  return text;
}

/// A segment of a block: sequence number and seven bytes, of which the end of the transfer tells
/// how many of the last segment count.
std::string SdoDecoder::blockSegment(const Frame& frame) {
  const bool last = (frame.data[0] & 0x80) != 0;
  collect(frame, 7);
  last_segment_seen_ = last_segment_seen_ || last;
  return "block segment " + std::to_string(frame.data[0] & 0x7F) + " " + current() +
         (last ? ", the last" : "");
}

/// The receiver has taken the segments of a block up to a number; the others come again.
void SdoDecoder::forgetUnacknowledged(std::uint8_t acknowledged) {
  const std::size_t taken =
      std::min<std::size_t>(received_, block_began_ + std::size_t{7} * acknowledged);
  const bool complete = taken == received_;
  in_block_ = in_block_ && !(complete && last_segment_seen_);
  last_segment_seen_ = last_segment_seen_ && complete;
  received_ = block_began_ = taken;
  if (data_.size() > received_) data_.resize(received_);
}

/// The first frame of an expedited or segmented transfer that carries its object and data or size.
std::string SdoDecoder::initiate(const Frame& frame, const char* verb, Transfer transfer) {
  begin(frame, transfer);
  const std::string text = verb + (" " + title(object_));
  if ((frame.data[0] & 2) != 0) {
    transfer_ = transfer == Transfer::download ? transfer : Transfer::none;
    return text + " = " + value(object_, expedited(frame));
  }
  return text + ((frame.data[0] & 1) != 0 ? ", " + bytes(longOf(frame)) + " in segments"
                                          : ", in segments");
}

std::string SdoDecoder::request(const Frame& frame) {
  if (frame.size < 8) return "too short for an SDO: " + bytes(frame.size);
  if (frame.data[0] == kAbort) return abort(frame);
  if (in_block_ && transfer_ == Transfer::block_download) return blockSegment(frame);
  switch (command(frame)) {
    case client::kDownloadSegment:
      return segment(frame);
    case client::kInitiateDownload:
      return initiate(frame, "write", Transfer::download);
    case client::kInitiateUpload:
      begin(frame, Transfer::upload);
      return "read " + title(object_);
    case client::kUploadSegment:
      return "next segment " + current() + ", " + toggle(frame);
    case client::kBlockUpload:
      return blockUploadRequest(frame);
    case client::kBlockDownload:
      return blockDownloadRequest(frame);
    default:
      return unknown(frame);
  }
}

std::string SdoDecoder::answer(const Frame& frame) {
  if (frame.size < 8) return "too short for an SDO: " + bytes(frame.size);
  if (frame.data[0] == kAbort) return abort(frame);
  if (in_block_ && transfer_ == Transfer::block_upload) return blockSegment(frame);
  switch (command(frame)) {
    case server::kUploadSegment:
      return segment(frame);
    case server::kDownloadSegment:
      return "segment taken " + current() + ", " + toggle(frame);
    case server::kInitiateUpload:
      return initiate(frame, "read", Transfer::upload);
    case server::kInitiateDownload:
      return "written " + title(objectOf(frame));
    case server::kBlockDownload:
      return blockDownloadAnswer(frame);
    case server::kBlockUpload:
      return blockUploadAnswer(frame);
    default:
      return unknown(frame);
  }
}

}  // namespace cia402::decode
