// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/sdo/channel.h"

namespace cia402::sim {

/// Block downloads of a simulated SDO server (CiA 301, 7.2.4.3.8 to 7.2.4.3.11).
class SdoBlockDownload {
 public:
  explicit SdoBlockDownload(SdoChannel& channel) : channel_(channel) {}

  /// A request with the command specifier of block downloads: the beginning or the end of one.
  void request(const can::Frame& frame);
  /// Whether the next frame is a segment, whatever its command specifier reads.
  bool takesSegments() const { return running() && !ended_; }
  /// Segments are taken by the receive interrupt; only the answer to a sub-block takes its time.
  bool takesAtOnce(const can::Frame& frame) const;
  /// @pre takesSegments()
  void takeSegment(const can::Frame& frame);
  /// Whether the frame is the last segment, which the wire has given twice.
  bool repeats(const can::Frame& frame) const { return running() && frame == last_segment_; }

 private:
  bool running() const;
  void begin(const can::Frame& request);
  void end(const can::Frame& request);
  unsigned nextBlockSize();

  SdoChannel& channel_;
  bool crc_ = false;    ///< both sides want it
  bool ended_ = false;  ///< the last segment was taken
  unsigned block_size_ = 0;
  unsigned block_turn_ = 0;
  unsigned segment_ = 0;  ///< last one of the sub-block that was taken
  can::Frame last_segment_;
};

}  // namespace cia402::sim
