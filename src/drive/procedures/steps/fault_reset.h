// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Fault reset (transition 15) with a proper edge: controlword bit 7 low on the wire, then high
/// until the drive has left the fault or the time is over, then low again, then a moment in which
/// the fault may come back. A motor that a warning stops rests before. Edges are at least kInterval
/// apart, whoever asks for them. Where the profile says so the error history is cleared before
/// (`fault_reset_clears_history`), it is tried several times (`fault_reset_tries`), once more after
/// a write (`fault_reset_object`), and once more after the device was taken out of operation and
/// into it again (FaultReset::pause).
class FaultResetStep {
 public:
  static constexpr Duration kInterval{std::chrono::seconds(1)};
  static constexpr Duration kWatch{std::chrono::milliseconds(300)};

  Outcome advance(const Context& context);
  /// The longest that this and the first feedback after it may take.
  static Duration pause(const DriveProfile& profile);

 private:
  enum class Phase { begin, resting, clearing, reacting, low, high, low_again, watching, paused };
  void enter(Phase phase, const Context& context);
  static bool turns(const Context& context);
  Outcome fail(const Context& context, const std::string& why) const;
  Outcome begin(const Context& context);
  Outcome awaitRest(const Context& context);
  Outcome awaitReaction(const Context& context);
  Outcome cameBack(const Context& context);
  Outcome awaitReset(const Context& context);
  Outcome awaitNews(const Context& context);
  bool tryAgain(const Context& context);
  bool mayWrite(const Context& context) const;
  void beginWrite(const Context& context);
  bool mayPause(const Context& context) const;
  void beginPause(const Context& context);
  Outcome awaitPause(const Context& context);

  Phase phase_ = Phase::begin;
  int tries_ = 1;         ///< begun
  bool written_ = false;  ///< FaultReset::object is
  bool paused_ = false;   ///< that is behind it, or under way
  std::uint16_t code_ = 0;
  std::uint64_t frames_ = 0;
  Time since_{};
  fieldbus::Ticket clearing_;
};

/// Something that a fault reset could clear.
bool clearable(const AxisCore& axis);
/// What the drive says of its state is of now: what it said before it fell silent, or before the
/// host stood still, tells of no fault that is there, or gone.
bool tellsState(const AxisCore& axis, Time now);

}  // namespace cia402::drive
