// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canopen/sdo/transfer.h"

namespace cia402::canopen {

/// Decides which transfers are done in blocks: as their options say, unless the server does not
/// know block transfer.
class SdoBlockUse {
 public:
  /// Is it to be tried in blocks?
  bool wanted(const SdoTransfer& transfer) const;
  /// Another transfer begins.
  void begin() { fell_back_ = false; }
  /// The server aborted when a block transfer was initiated. @return true: not for good, it is to
  /// be done in segments
  bool refused(std::uint32_t code);
  /// Nothing came when one was initiated: servers without block transfer should refuse it, but some
  /// do not answer at all.
  void unanswered() { fell_back_ = true; }
  /// The transfer has succeeded; if only in segments, the next ones are not tried in blocks.
  void succeeded() { refused_ = refused_ || fell_back_; }
  /// The server has booted: perhaps it is another one.
  void serverRestarted() { refused_ = false; }

 private:
  bool refused_ = false;    ///< by this server
  bool fell_back_ = false;  ///< the present transfer from blocks to segments
};

}  // namespace cia402::canopen
