// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/device/context.h"

namespace cia402::sim {

/// TIME consumer (CiA 301, 7.2.6): 1012h, bit 31 of which lets it listen.
class SlaveTime {
 public:
  explicit SlaveTime(SlaveContext& context) : context_(context) {}

  /// Takes writes of its objects, where the dictionary has them.
  void serveObjects();
  void reset() { last_.reset(); }
  /// Takes the object over.
  void start();
  /// CAN-ID to listen to, or a value no frame has.
  std::uint32_t cobId() const { return cob_id_; }
  /// A TIME message (CiA 301, 7.2.6).
  void receive(const can::Frame& frame);
  const std::optional<ReceivedTime>& last() const { return last_; }

 private:
  static constexpr std::uint32_t kNoCanId = 0xFFFFFFFF;

  SlaveContext& context_;
  std::uint32_t cob_id_ = kNoCanId;
  std::optional<ReceivedTime> last_;
};

}  // namespace cia402::sim
