// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/sdo_decoder.h"

#include "common/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::decode {
namespace {

using can::Frame;
using fieldbus::Bytes;
using fieldbus::ObjectId;
using Transfer = SdoTrace::Transfer;

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

std::string unknown(const Frame& frame) { return "no SDO command: " + hexText(frame.data[0], 2); }

std::string announced(const Frame& frame) {
  return (frame.data[0] & 2) != 0 ? ", " + bytes(longOf(frame)) : ", size unknown";
}

const char* checksumText(const Frame& frame) {
  return (frame.data[0] & 4) != 0 ? ", with CRC" : ", without CRC";
}

std::string perBlock(unsigned count) { return std::to_string(count) + " segments a block"; }

}  // namespace

std::string SdoDecoder::title(ObjectId object) const {
  return values_ != nullptr ? values_->title(object) : fieldbus::toString(object);
}

std::string SdoDecoder::current() const {
  return trace_.known() ? title(trace_.object()) : "of a transfer that began before";
}

std::string SdoDecoder::value(ObjectId object, const Bytes& data) const {
  return values_ != nullptr ? values_->describe(object, data) : bytesText(data);
}

/// What the transfer brought, once it is complete.
std::string SdoDecoder::whole() const {
  if (!trace_.known()) return "";
  const std::string all = ": " + bytes(trace_.received()) + " in all: ";
  if (trace_.received() > trace_.data().size())
    return all + bytesText(trace_.data()) + " and so on";
  const bool listed = values_ != nullptr && values_->lists(trace_.object());
  return all + (listed ? value(trace_.object(), trace_.data()) : bytesText(trace_.data()));
}

std::string SdoDecoder::request(const Frame& frame) {
  if (frame.size < 8) return "too short for an SDO: " + bytes(frame.size);
  if (frame.data[0] == kAbort) return abort(frame);
  if (trace_.inBlock() && trace_.transfer() == Transfer::block_download) return blockSegment(frame);
  switch (command(frame)) {
    case client::kDownloadSegment:
      return segment(frame);
    case client::kInitiateDownload:
      return initiate(frame, "write", Transfer::download);
    case client::kInitiateUpload:
      trace_.begin(objectOf(frame), Transfer::upload);
      return "read " + current();
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
  if (trace_.inBlock() && trace_.transfer() == Transfer::block_upload) return blockSegment(frame);
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

std::string SdoDecoder::abort(const Frame& frame) {
  trace_.abort();
  return "abort " + title(objectOf(frame)) + ": " + fieldbus::abortText(longOf(frame));
}

/// The first frame of an expedited or segmented transfer that carries its object and data or size.
std::string SdoDecoder::initiate(const Frame& frame, const char* verb, Transfer transfer) {
  trace_.begin(objectOf(frame), transfer);
  const std::string text = verb + (" " + current());
  if ((frame.data[0] & 2) != 0) {
    if (transfer != Transfer::download) trace_.end();
    return text + " = " + value(trace_.object(), expedited(frame));
  }
  return text + ((frame.data[0] & 1) != 0 ? ", " + bytes(longOf(frame)) + " in segments"
                                          : ", in segments");
}

/// The data of a segment (download by the client, upload by the server).
std::string SdoDecoder::segment(const Frame& frame) {
  const std::size_t count = 7U - (frame.data[0] >> 1 & 7U);
  const bool last = (frame.data[0] & 1) != 0;
  trace_.collect(frame, count);
  std::string text = "segment " + current() + ", " + toggle(frame) + ", " + bytes(count);
  if (last) {
    text += ", the last" + whole();
    if (trace_.transfer() == Transfer::upload) trace_.end();
  }
  return text;
}

// --- Block transfer (CiA 301, 7.2.4.3.9 to 7.2.4.3.16) -------------------------------------------

std::string SdoDecoder::blockDownloadRequest(const Frame& frame) {
  if ((frame.data[0] & 1) != 0) return endOfBlocks(frame);
  trace_.begin(objectOf(frame), Transfer::block_download);
  return "block write " + current() + announced(frame) + checksumText(frame);
}

std::string SdoDecoder::blockDownloadAnswer(const Frame& frame) {
  switch (frame.data[0] & 3U) {
    case 0:
      trace_.startBlocks(Transfer::block_download);
      return "block write accepted " + current() + ", " + perBlock(frame.data[4]) +
             checksumText(frame);
    case 1:
      trace_.end();
      return "block write complete " + current();
    case 2:
      return acknowledged(frame);
    default:
      return "no block write answer: " + hexText(frame.data[0], 2);
  }
}

std::string SdoDecoder::blockUploadRequest(const Frame& frame) {
  switch (frame.data[0] & 3U) {
    case 0:
      trace_.begin(objectOf(frame), Transfer::block_upload);
      return "block read " + current() + ", " + perBlock(frame.data[4]) + checksumText(frame);
    case 1:
      trace_.end();
      return "block read complete " + current();
    case 2:
      return acknowledged(frame);
    default:
      trace_.startBlocks(Transfer::block_upload);
      return "block read begins " + current();
  }
}

std::string SdoDecoder::blockUploadAnswer(const Frame& frame) {
  if ((frame.data[0] & 1) != 0) return endOfBlocks(frame);
  return "block read accepted " + current() + announced(frame) + checksumText(frame);
}

/// A segment of a block: sequence number and seven bytes.
std::string SdoDecoder::blockSegment(const Frame& frame) {
  const bool last = (frame.data[0] & 0x80) != 0;
  trace_.collectBlockSegment(frame, last);
  return "block segment " + std::to_string(frame.data[0] & 0x7F) + " " + current() +
         (last ? ", the last" : "");
}

/// "segments up to 127 taken, 127 segments a block".
std::string SdoDecoder::acknowledged(const Frame& frame) {
  trace_.acknowledge(frame.data[1]);
  return "segments up to " + std::to_string(frame.data[1]) + " taken, " + perBlock(frame.data[2]);
}

/// The end of a block transfer: how many bytes of the last segment do not count, and the CRC.
std::string SdoDecoder::endOfBlocks(const Frame& frame) {
  trace_.endBlocks(frame.data[0] >> 2 & 7U);
  const unsigned crc = frame.data[1] | static_cast<unsigned>(frame.data[2]) << 8;
  return "end of blocks " + current() + ", CRC " + hexText(crc, 4) + whole();
}

}  // namespace cia402::decode
