// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/sdo/segments.h"

namespace cia402::sim {

/// Block uploads of a simulated SDO server (CiA 301, 7.2.4.3.12 to 7.2.4.3.16). Small values go by
/// the other protocol where the client allows it.
class SdoBlockUpload {
 public:
  SdoBlockUpload(SdoChannel& channel, SdoSegments& segments)
      : channel_(channel), segments_(segments) {}

  /// A request with the command specifier of block uploads.
  void request(const can::Frame& frame);

 private:
  bool running() const;
  void begin(const can::Frame& request);
  void sendSubBlock();
  void acknowledged(const can::Frame& request);

  SdoChannel& channel_;
  SdoSegments& segments_;
  bool crc_ = false;    ///< both sides want it
  bool ended_ = false;  ///< the last segment was acknowledged
  unsigned block_size_ = 0;
  unsigned segment_ = 0;  ///< last one of the sub-block that was sent
};

}  // namespace cia402::sim
