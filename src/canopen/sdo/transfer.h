// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "canopen/object.h"
#include "canopen/sdo/options.h"
#include "fieldbus/object_access.h"

namespace cia402::canopen {

/// One transfer by SDO: what is asked for and how, and in the end what came of it. Whoever asked
/// sees it as a fieldbus::Transfer.
class SdoTransfer final : public fieldbus::Transfer {
 public:
  /// @param name of the object for messages, may be empty. @param data in wire order; none of an
  /// upload. @param urgent it waits for no other transfer that is not
  SdoTransfer(Direction direction, ObjectId object, std::string name, Bytes data,
              const SdoOptions& options, bool urgent);

  const SdoOptions& options() const { return options_; }
  bool urgent() const { return urgent_; }
  bool isUpload() const { return direction_ == Direction::upload; }

  /// What an upload has brought; it is not done by that.
  void setData(Bytes data) { data_ = std::move(data); }
  /// Done, and well.
  void succeed() { done_ = true; }
  /// Done, but it came to nothing. @param code the abort code (CiA 301, table 22); 0: none
  /// @param reason the last part of message(), which names node, object and data as well
  void fail(NodeId node, Failure failure, std::uint32_t code, std::string reason);

 private:
  SdoOptions options_;
  bool urgent_;
};
/// How whoever asked for a transfer watches it.
using SdoTicket = fieldbus::Ticket;

}  // namespace cia402::canopen
