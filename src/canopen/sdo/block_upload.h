// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "canopen/sdo/crc.h"
#include "canopen/sdo/exchange.h"
#include "canopen/sdo/reaction.h"
#include "canopen/sdo/transfer.h"

namespace cia402::canopen {

/// A block upload on the wire (CiA 301, 7.2.4.2.13 to 7.2.4.2.16): the server sends up to 127
/// segments in a row, the client acknowledges them together and asks for lost ones again.
class SdoBlockUpload {
 public:
  /// Both must outlive it.
  SdoBlockUpload(SdoExchange& exchange, SdoTransfer& transfer)
      : exchange_(exchange), transfer_(transfer) {}

  /// Sends the request that begins the transfer.
  void initiate(Time now);
  /// Takes an SDO of the server (eight bytes) and sends what follows from it.
  SdoReaction receive(const can::Frame& frame, Time now);
  /// Nothing came for the time-out: our last word may have been lost, or the end of a sub-block.
  /// @return false where that cannot be mended
  bool resume(Time now);

  /// The server has not said yet whether it knows block upload.
  bool initiating() const { return phase_ == Phase::initiate; }
  /// Frames of the server are data behind a first byte that can be any.
  bool looksLikeAnything() const { return phase_ != Phase::initiate; }

 private:
  /// What the server is expected to send.
  enum class Phase : std::uint8_t { initiate, segments, end };

  SdoReaction onInitiated(const can::Frame& frame, Time now);
  SdoReaction onSegment(const can::Frame& frame, Time now);
  SdoReaction onEnd(const can::Frame& frame);
  SdoReaction endSubBlock(Time now);
  void append(const can::Frame& frame);
  void start(Time now);
  void acknowledge(unsigned sequence, Time now);
  void await(Phase phase, Time now);
  /// Bytes that may come.
  std::size_t limit() const;
  bool mayRepeatSegments() const;

  SdoExchange& exchange_;
  SdoTransfer& transfer_;
  Phase phase_ = Phase::initiate;
  SdoChecksum checksum_;
  unsigned sequence_ = 0;                   ///< last segment received in order
  std::optional<unsigned> acknowledged_;    ///< told the server last
  bool last_ = false;                       ///< the segment `sequence_` is the last of all
  bool gap_ = false;                        ///< a segment of this sub-block is missing
  unsigned vain_ = 0;                       ///< sub-blocks or time-outs in a row without a segment
  std::optional<std::uint32_t> announced_;  ///< size that the server announced, bytes
  Bytes received_;
};

}  // namespace cia402::canopen
