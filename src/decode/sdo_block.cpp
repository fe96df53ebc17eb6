// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SDO block transfer in words (CiA 301, 7.2.4.3.9 to 7.2.4.3.16).
#include "cia402_driver/decode/sdo_decoder.h"

namespace cia402::decode {
namespace {

using can::Frame;

std::string sizeText(const Frame& frame, bool indicated) {
  if (!indicated) return ", size unknown";
  const unsigned long size = frame.data[4] | static_cast<unsigned long>(frame.data[5]) << 8 |
                             static_cast<unsigned long>(frame.data[6]) << 16 |
                             static_cast<unsigned long>(frame.data[7]) << 24;
  return ", " + std::to_string(size) + (size == 1 ? " byte" : " bytes");
}

const char* checksumText(const Frame& frame) {
  return (frame.data[0] & 4) != 0 ? ", with CRC" : ", without CRC";
}

std::string perBlock(unsigned count) { return std::to_string(count) + " segments a block"; }

/// "segments up to 127 taken, 127 segments a block".
std::string acknowledged(const Frame& frame) {
  return "segments up to " + std::to_string(frame.data[1]) + " taken, " + perBlock(frame.data[2]);
}

}  // namespace

/// The end of a block transfer: how many bytes of the last segment do not count, and the CRC.
std::string SdoDecoder::endOfBlocks(const Frame& frame) {
  const std::size_t unused = frame.data[0] >> 2 & 7U;
  in_block_ = false;
  if (received_ >= unused) {
    received_ -= unused;
    if (data_.size() > received_) data_.resize(received_);
  }
  const unsigned crc = frame.data[1] | static_cast<unsigned>(frame.data[2]) << 8;
  return "end of blocks " + current() + ", CRC " + hexNumber(crc, 2) + whole();
}

std::string SdoDecoder::blockDownloadRequest(const Frame& frame) {
  if ((frame.data[0] & 1) != 0) return endOfBlocks(frame);
  begin(frame, Transfer::block_download);
  return "block write " + title(object_) + sizeText(frame, (frame.data[0] & 2) != 0) +
         checksumText(frame);
}

std::string SdoDecoder::blockDownloadAnswer(const Frame& frame) {
  switch (frame.data[0] & 3U) {
    case 0:
      in_block_ = transfer_ == Transfer::block_download;
      return "block write accepted " + current() + ", " + perBlock(frame.data[4]) +
             checksumText(frame);
    case 1:
      transfer_ = Transfer::none;
      return "block write complete " + current();
    case 2:
      // What was not taken comes again; without the last segment the next block follows.
      forgetUnacknowledged(frame.data[1]);
      return acknowledged(frame);
    default:
      return "no block write answer: " + hexNumber(frame.data[0], 1);
  }
}

std::string SdoDecoder::blockUploadRequest(const Frame& frame) {
  switch (frame.data[0] & 3U) {
    case 0:
      begin(frame, Transfer::block_upload);
      return "block read " + title(object_) + ", " + perBlock(frame.data[4]) + checksumText(frame);
    case 1:
      transfer_ = Transfer::none;
      return "block read complete " + current();
    case 2:
      forgetUnacknowledged(frame.data[1]);
      return acknowledged(frame);
    default:
      in_block_ = transfer_ == Transfer::block_upload;
      return "block read begins " + current();
  }
}

std::string SdoDecoder::blockUploadAnswer(const Frame& frame) {
  if ((frame.data[0] & 1) != 0) return endOfBlocks(frame);
  return "block read accepted " + current() + sizeText(frame, (frame.data[0] & 2) != 0) +
         checksumText(frame);
}

}  // namespace cia402::decode
