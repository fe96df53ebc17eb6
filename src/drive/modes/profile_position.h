// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/position_control.h"
#include "drive/modes/set_point_handshake.h"
#include "drive/modes/waiting_set_points.h"

namespace cia402::drive {

/// A position that the drive goes to by itself (profile position mode, CiA 402-2), handed over by
/// bits of the controlword where the mode has a handover.
///
/// Commands may have to wait for each other (Handover::oneByOne()): those that the drive queues,
/// and distances, which count from what was commanded before or from where the axis stands.
///
/// Where it is halted by its set-points, the drive gets the nearest point at which it can stop.
class ProfilePosition : public PositionControl {
 public:
  ProfilePosition(const ModeChannel& channel, const Context& context);

  void beginStream(const Stream& stream, Time at) override;
  bool takesMore() const override { return !waiting_.full(); }
  void takeCommand(Stream& stream) override;
  std::optional<double> follow(Stream& stream, Time now) override;
  void reset(std::uint64_t raw) override;
  void offer(std::uint64_t raw, bool twice) override;
  void accepted(std::uint64_t raw, bool same) override;
  void prepare(Time now) override;
  const char* handOver(std::uint64_t& raw, Time now) override;
  bool handingOver() const override { return handshake_.busy(); }
  unsigned bits() const override;

  bool goalAhead() const override;
  void beginHalt() override;
  void endHalt() override { stop_point_after_ = kNever; }
  void lateInHalt(Time now) override;
  /// A stop point may reach the drive late.
  bool mayTurnBack(Time now, Time seen_moving) const override {
    return comesBack(now, seen_moving);
  }
  Duration wayBack(double away) const override;

 private:
  double withinReach(double goal) const;
  std::optional<double> nextWaiting();
  bool countsFromKnown();
  std::uint64_t distance(std::uint64_t raw) const;
  void giveStopPoint(Time now);
  void renewStopPoint(Time now);

  bool by_hand_;  ///< has a handover
  SetPointHandshake handshake_;
  WaitingSetPoints waiting_;
  std::optional<std::uint64_t> command_;  ///< what is offered next is this command, which was taken
  /// What a distance counts from, as a number of the target; nothing: the drive has to be told it.
  std::optional<std::uint64_t> base_;
  bool flushes_ = false;            ///< the drive is halted, which empties its queue
  bool dropped_ = false;            ///< the drive does not have the set-point
  double halted_goal_ = kUnknown;   ///< to which the drive was going
  Time stop_point_after_ = kNever;  ///< feedback newer than this has the stop point judged anew
};

}  // namespace cia402::drive
