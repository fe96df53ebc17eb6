// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cia402_driver/can/frame.h"

namespace cia402::canopen {

/// Produces SYNC messages (CiA 301, 7.2.5), with a counter where 1019h asks for one.
class SyncProducer {
 public:
  /// @param overflow value of 1019h: 0 for SYNC without data; otherwise the highest counter value,
  /// 2..240, after which it starts at 1 again.
  explicit SyncProducer(std::uint8_t overflow) : overflow_(overflow) {}

  /// The next SYNC message.
  can::Frame next();
  /// The next counter is 1 again (CiA 301, 7.2.5.3.1: after reset communication).
  void restart() { counter_ = 0; }

 private:
  std::uint8_t overflow_;
  std::uint8_t counter_ = 0;
};

}  // namespace cia402::canopen
