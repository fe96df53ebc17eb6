// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "cia402_driver/can/frame.h"
#include "cia402_driver/decode/value_text.h"

namespace cia402::decode {

/// Words for the frames of one SDO channel (CiA 301, 7.2.4.3): expedited, segmented and block
/// transfers, aborts. Remembers the transfer under way, for segments do not name their object.
class SdoDecoder {
 public:
  /// @param values of the server, nullptr if it is not known; must outlive the decoder.
  explicit SdoDecoder(const ValueText* values) : values_(values) {}

  std::string request(const can::Frame& frame);  ///< a frame of the client
  std::string answer(const can::Frame& frame);   ///< a frame of the server

 private:
  enum class Transfer : std::uint8_t { none, upload, download, block_upload, block_download };

  std::string blockDownloadRequest(const can::Frame& frame);
  std::string blockUploadRequest(const can::Frame& frame);
  std::string blockDownloadAnswer(const can::Frame& frame);
  std::string blockUploadAnswer(const can::Frame& frame);
  std::string abort(const can::Frame& frame);
  std::string segment(const can::Frame& frame);
  std::string blockSegment(const can::Frame& frame);
  std::string endOfBlocks(const can::Frame& frame);
  void forgetUnacknowledged(std::uint8_t acknowledged);
  std::string initiate(const can::Frame& frame, const char* verb, Transfer transfer);
  void begin(const can::Frame& frame, Transfer transfer);
  void collect(const can::Frame& frame, std::size_t count);
  std::string title(fieldbus::ObjectId object) const;
  std::string current() const;
  std::string whole() const;
  std::string value(fieldbus::ObjectId object, const fieldbus::Bytes& data) const;

  const ValueText* values_;
  Transfer transfer_ = Transfer::none;
  bool in_block_ = false;  ///< frames of the sender are segments without a command
  bool known_ = false;     ///< object_ is that of the transfer under way
  fieldbus::ObjectId object_;
  fieldbus::Bytes data_;  ///< of the transfer so far, the beginning only
  std::size_t received_ = 0;
  std::size_t block_began_ = 0;  ///< received_ at the beginning of the block
  bool last_segment_seen_ = false;
};

}  // namespace cia402::decode
