// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drive/axis/basis.h"
#include "drive/axis/runaway.h"

namespace cia402::drive {

class AxisCore;

/// Brings an axis to rest that stays in operation, by what its mode has for it (stopBy()).
class Stops {
 public:
  explicit Stops(AxisCore& axis);  ///< @param axis must outlive this; its other parts exist

  /// Stops and stays stopped until endHalt(). Where nothing but a quick stop brakes, the axis
  /// leaves operation.
  void halt(Time now);
  /// The same where the drive stops and holds the motor by itself: what was commanded is given up,
  /// so that nothing is gone on to when the drive lets the motor go.
  void hold(Time now);
  /// Brings the set-points to rest, see SetPoint::stop(). A goal that the drive goes to by itself
  /// ends as by a halt, but the axis is not halted: once it stands, that place is its goal.
  void endMotion(Duration over);
  /// Such a goal is being ended.
  bool endsGoal() const { return unfinished_ == Unfinished::goal; }
  /// Replaces the set-point that a halted drive would go on to by "stay here". The halt itself is
  /// released once that is on the wire and nothing is handed over any more.
  void replaceHaltedTarget();
  void endHalt();
  /// Another mode brakes the active one.
  bool byMode() const { return how() == StopBy::mode; }

  /// Quick stop by a write that waits for nothing: what travels in cycles does not reach the drive.
  /// Where another mode brakes the present one the drive is told to take that first.
  /// @param why in words
  void stopUrgently(const std::string& why);
  /// Once a cycle: where that failed as well, nothing but the drive itself can stop the motor; an
  /// axis that hold() or endMotion() has stopped gets where it stands as its set-point; and a motor
  /// that runs away gets a quick stop, where that does not brake it its power is switched off, and
  /// where the drive does not do that it is reset.
  void watch(Time now) {
    runaway_.watch(now);
    if (urgent_ticket_ && urgent_ticket_->done()) judgeUrgent();
    if (unfinished_ != Unfinished::nothing) finish(now);
  }

  /// Once a cycle while efforts are streamed, or were: a torque that is nobody's any more is braked
  /// (command_timeout_action), and what is to brake it is kept ready.
  void watchEffort(Time now);
  /// Once a cycle while another mode brakes: a drive that does not take that gets a quick stop.
  void watchBrakeMode(Time now);
  /// Nothing is heard of a drive that is commanded: where another mode brakes the present one, and
  /// travels in the cycle, that comes first, for a quick stop would let the motor go.
  /// @return false: a quick stop has to do it
  bool brakeUnheard(Time now);
  /// Once a cycle then. @return false when the time for that is over
  bool brakesUnheard(Time now);
  /// Another mode was selected by somebody else.
  void forgetBrakeMode();

 private:
  StopBy how() const;
  const ModeChannel* brakeMode() const;
  void followByBrakeMode();
  bool brakeByMode(Time now);
  void takeOver(const ModeChannel& brake, double velocity, Time now);
  void writeBrakeMode();
  bool brakeUrgently();
  void quickStopUrgently();
  void brakeEffort(Time now);
  [[gnu::cold]] void judgeUrgent();
  [[gnu::cold]] void finish(Time now);
  void finishHold();
  void finishGoal(Time now);
  void giveUpEnding();

  AxisCore& axis_;
  Time braked_at_{};
  bool brake_mode_shown_ = false;
  double followed_ = 0.0;        ///< while it pushes: velocity at which the mode that brakes begins
  Time quick_stop_at_ = kNever;  ///< at the latest, after braking unheard
  bool urgent_ = false;          ///< a quick stop by a write follows once the mode brakes
  enum class Unfinished : std::uint8_t { nothing, hold, goal };
  Unfinished unfinished_ = Unfinished::nothing;  ///< hold(), endMotion(): it has yet to stand
  Time ends_until_ = kNever;  ///< a goal that does not end until then is ended by a quick stop
  std::optional<std::uint64_t> replaced_;  ///< frames of its target by then: by where it stands
  fieldbus::Ticket brake_ticket_, urgent_ticket_;
  Runaway runaway_;
};

}  // namespace cia402::drive
