// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "canopen/sdo/exchange.h"
#include "canopen/sdo/reaction.h"
#include "canopen/sdo/transfer.h"

namespace cia402::canopen {

/// An upload on the wire, expedited or in segments as the server chooses (CiA 301, 7.2.4.2.5 to
/// 7.2.4.2.7).
class SdoUpload {
 public:
  /// Both must outlive it.
  SdoUpload(SdoExchange& exchange, SdoTransfer& transfer)
      : exchange_(exchange), transfer_(transfer) {}

  /// Sends the request that begins the transfer.
  void initiate(Time now);
  /// Takes an SDO of the server (eight bytes) and sends what follows from it.
  SdoReaction receive(const can::Frame& frame, Time now);
  /// Nothing has been answered yet.
  bool initiating() const { return !initiated_; }

 private:
  SdoReaction onInitiated(const can::Frame& frame, Time now);
  SdoReaction onSegment(const can::Frame& frame, Time now);
  void requestSegment(Time now);

  SdoExchange& exchange_;
  SdoTransfer& transfer_;
  bool initiated_ = false;
  bool toggle_ = false;
  std::optional<std::uint32_t> announced_;  ///< size that the server announced, bytes
  Bytes received_;
};

}  // namespace cia402::canopen
