// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "sim/device/context.h"
#include "sim/device/emergency.h"

namespace cia402::sim {

/// SYNC consumer and producer (CiA 301, 7.2.5): 1005h, 1006h, 1007h, 1019h.
class SlaveSync {
 public:
  SlaveSync(SlaveContext& context, SlaveEmergency& emergency)
      : context_(context), emergency_(emergency) {}

  /// Takes writes of its objects, where the dictionary has them.
  void serveObjects();
  /// Forgets counter and time-outs.
  void reset();
  /// Takes the objects over.
  void start();
  std::uint32_t cobId() const { return cob_id_; }
  /// The counter of an accepted SYNC, 0 if it carried none; nothing if it must be ignored.
  std::optional<std::uint8_t> accept(const can::Frame& frame);
  void tick();
  Time deadline() const { return std::min(deadline_, next_); }
  /// Own SYNC since the last call; the device hears it like any other.
  std::optional<can::Frame> takeProduced();

 private:
  SlaveContext& context_;
  SlaveEmergency& emergency_;
  const Entry* overflow_ = nullptr;
  const Entry* period_ = nullptr;
  std::uint32_t cob_id_ = 0x80;
  std::uint32_t check(const Entry& entry, std::uint64_t number) const;
  Duration period() const;
  void produce();

  Time deadline_ = kNever;
  Time next_ = kNever;  // own SYNC
  std::uint8_t counter_ = 1;
  std::optional<can::Frame> produced_;
  bool wrong_length_ = false;
  bool timed_out_ = false;
};

}  // namespace cia402::sim
