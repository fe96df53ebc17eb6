// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "canopen/sdo/crc.h"
#include "canopen/sdo/exchange.h"
#include "canopen/sdo/reaction.h"
#include "canopen/sdo/transfer.h"

namespace cia402::canopen {

/// A block download on the wire (CiA 301, 7.2.4.2.9 to 7.2.4.2.12): up to 127 segments in a row, as
/// many as the server asks for, are acknowledged together; from the first missing one on they are
/// sent again.
class SdoBlockDownload {
 public:
  /// Both must outlive it.
  SdoBlockDownload(SdoExchange& exchange, SdoTransfer& transfer)
      : exchange_(exchange), transfer_(transfer) {}

  /// Sends the request that begins the transfer.
  void initiate(Time now);
  /// Takes an SDO of the server (eight bytes) and sends what follows from it.
  SdoReaction receive(const can::Frame& frame, Time now);
  /// Sends as much of the sub-block as the queue of the interface may take now.
  void feed(Time now);
  /// When to call feed(): kNever while no sub-block is being sent.
  Time feedAt() const { return phase_ == Phase::segments ? feed_at_ : kNever; }

  /// The server has not said yet whether it knows block download.
  bool initiating() const { return phase_ == Phase::initiate; }

 private:
  /// What the server is expected to answer.
  enum class Phase : std::uint8_t {
    initiate,
    segments,  ///< we send; an answer is not due before the last one
    acknowledge,
    end,
  };

  SdoReaction onInitiated(const can::Frame& frame, Time now);
  SdoReaction onAcknowledged(const can::Frame& frame, Time now);
  SdoReaction onEnd(Time now);
  SdoReaction beginSubBlock(unsigned size, Time now);
  can::Frame nextSegment();
  void sendEnd(Time now);
  void await(Phase phase, Time now);

  SdoExchange& exchange_;
  SdoTransfer& transfer_;
  Phase phase_ = Phase::initiate;
  SdoChecksum checksum_;
  unsigned size_ = 0;      ///< segments of this sub-block
  unsigned sequence_ = 0;  ///< last one sent
  bool last_ = false;      ///< that is the last of all
  std::size_t begin_ = 0;  ///< bytes before this sub-block
  unsigned vain_ = 0;      ///< sub-blocks in a row of which the server took nothing
  Time feed_at_ = kNever;  ///< when more of a sub-block may be sent
};

}  // namespace cia402::canopen
