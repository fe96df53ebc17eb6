// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "can/bus.h"
#include "canopen/object.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// Guards one node as NMT master (CiA 301, 7.2.8.3.2.1): asks for its state by a remote frame every
/// guard time, checks the toggle bit of each answer, and takes the node for lost when none was
/// right for its life time. Asleep until start().
class NodeGuard {
 public:
  /// @param guard_time > 0. @param life_time_factor at least 1; the life time is the product.
  NodeGuard(NodeId node, Duration guard_time, std::uint8_t life_time_factor);

  /// Asks for the first time. @param after_reset the node has booted since it was guarded last: its
  /// first answer has toggle bit 0. Otherwise the first answer may have either.
  void start(bool after_reset, can::Sink& sink, Time now);
  void stop();
  /// It has answered since start().
  bool answered() const { return answered_; }
  bool active() const { return life_end_ != kNever; }

  /// The remote frame that asks a node for its NMT state.
  static can::Frame request(NodeId node);
  /// Asks now, ahead of time; the next request follows a guard time later.
  void ask(can::Sink& sink, Time now);
  /// Asks if it is time.
  void tick(can::Sink& sink, Time now);
  /// An answer came. @param answer its only byte. @return false if its toggle bit is that of the
  /// answer before: it counts as not received.
  bool receive(std::uint8_t answer, Time now);

  bool expired(Time now) const { return now >= life_end_; }
  /// When tick() or expired() has something to say: the next request or the end of the life time.
  Time deadline() const;
  Duration lifeTime() const { return guard_time_ * factor_; }
  /// "no answer to node guarding for 0.3 s (asked every 0.1 s)", and what was wrong with the
  /// answers that came.
  std::string loss() const;

 private:
  NodeId node_;
  Duration guard_time_;
  std::uint8_t factor_;
  std::optional<bool> expected_;  ///< toggle bit of the next answer; none: either
  unsigned wrong_toggles_ = 0;    ///< since the last answer that counted
  bool answered_ = false;
  Time next_ = kNever, life_end_ = kNever;
};

}  // namespace cia402::canopen
