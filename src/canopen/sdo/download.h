// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "canopen/sdo/exchange.h"
#include "canopen/sdo/reaction.h"
#include "canopen/sdo/transfer.h"

namespace cia402::canopen {

/// A download on the wire: 1 to 4 bytes expedited, others in segments (CiA 301, 7.2.4.2.2 to
/// 7.2.4.2.4).
class SdoDownload {
 public:
  /// Both must outlive it.
  SdoDownload(SdoExchange& exchange, SdoTransfer& transfer)
      : exchange_(exchange), transfer_(transfer) {}

  /// Can so many bytes go with the request itself?
  static bool isExpedited(std::size_t size);
  /// The request of an expedited download. @pre isExpedited(data.size())
  static void sendExpedited(SdoExchange& exchange, ObjectId object, const Bytes& data);

  /// Sends the request that begins the transfer.
  void initiate(Time now);
  /// Takes an SDO of the server (eight bytes) and sends what follows from it.
  SdoReaction receive(const can::Frame& frame, Time now);

 private:
  SdoReaction onInitiated(const can::Frame& frame, Time now);
  SdoReaction onSegment(const can::Frame& frame, Time now);
  void sendSegment(Time now);

  SdoExchange& exchange_;
  SdoTransfer& transfer_;
  bool initiated_ = false;
  bool toggle_ = false;
  std::size_t offset_ = 0;  ///< bytes already sent
};

}  // namespace cia402::canopen
