// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "can/frame.h"
#include "decode/node_values.h"
#include "decode/sdo_trace.h"

namespace cia402::decode {

/// Words for the frames of one SDO channel (CiA 301, 7.2.4.3): expedited, segmented and block
/// transfers, aborts. Fed with all of them in their order.
class SdoDecoder {
 public:
  /// @param values of the server, nullptr if it is not known; must outlive the decoder.
  explicit SdoDecoder(const NodeValues* values) : values_(values) {}

  std::string request(const can::Frame& frame);  ///< a frame of the client
  std::string answer(const can::Frame& frame);   ///< a frame of the server

 private:
  std::string initiate(const can::Frame& frame, const char* verb, SdoTrace::Transfer transfer);
  std::string segment(const can::Frame& frame);
  std::string abort(const can::Frame& frame);
  std::string blockDownloadRequest(const can::Frame& frame);
  std::string blockUploadRequest(const can::Frame& frame);
  std::string blockDownloadAnswer(const can::Frame& frame);
  std::string blockUploadAnswer(const can::Frame& frame);
  std::string blockSegment(const can::Frame& frame);
  std::string acknowledged(const can::Frame& frame);
  std::string endOfBlocks(const can::Frame& frame);
  std::string title(fieldbus::ObjectId object) const;
  std::string current() const;
  std::string whole() const;
  std::string value(fieldbus::ObjectId object, const fieldbus::Bytes& data) const;

  const NodeValues* values_;
  SdoTrace trace_;
};

}  // namespace cia402::decode
