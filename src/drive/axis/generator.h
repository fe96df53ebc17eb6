// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "drive/axis/commands.h"
#include "drive/axis/control.h"
#include "drive/axis/follow_watch.h"
#include "drive/modes/mode_control.h"

namespace cia402::drive {

/// Makes the set-points that the drive gets: the only part of an axis that knows what was sent
/// last, and the only one that a stop talks to.
class Generator {
 public:
  /// All must outlive this.
  Generator(AxisBasis& axis, const Coordinates& coordinates, const Feedback& feedback,
            const ActiveMode& mode, Control& control);

  /// What was sent last, and how it moves.
  const SetPoint& sent() const { return sent_; }
  double target() const { return sent_.value(); }
  /// What the active mode makes of set-points.
  const ModeControl& mode() const { return *mode_; }

  /// Another mode was selected: begins with its neutral target.
  void enter();
  /// The axis leaves operation: nothing is sent any more.
  void leave();
  /// Target := actual in position modes, 0 in the others.
  void neutralize();
  /// Puts a neutral target of another mode into its output, before that mode becomes active.
  void preset(const ModeChannel& channel);
  /// How often the active mode's target (or the controlword where it has none) was sent so far.
  std::uint64_t targetFrames() const;
  /// The joint's zero has moved by so much, rad or m.
  void shiftZero(double moved);

  /// Positions mean what they say: the zero is known, or the mode needs none.
  bool homedEnough() const {
    return axis_.state.homed || !mode_->positions() || coordinates_.absolute();
  }
  /// Takes the set-point of this cycle, see Axis::setTarget(). @return false: nothing changes
  bool take(double value);
  /// Whose set-points they are.
  Commands& commands() { return commands_; }
  const Commands& commands() const { return commands_; }
  /// Takes a streamed command, see Axis::command().
  Result<void> command(double value, Time now) { return commands_.take(value, *mode_, sent_, now); }
  /// Brings the set-points to rest, by a ramp where they move, whoever gave them.
  /// @param over see SetPoint::stop()
  void stop(Duration over = Duration::zero());
  /// Takes over a motor that turns: begins at its velocity, per s, and ramps that to rest.
  void arrest(double velocity);
  /// Cycles were missed: nothing of them is made good.
  [[gnu::cold]] void lateCycle(Time now);

  /// Once a cycle, before all that follows: the stream of commands gives its set-point.
  void stepCommands(Time now);
  /// This cycle came late: some were missed before it.
  bool late() const { return late_; }

  // The cycle in operation: makes the set-point, then sends it.
  void advance(Time now);
  /// @return what the drive did not answer to in time, so that the set-point is dropped; else
  /// nullptr
  const char* send(Time now);
  /// The cycle out of operation: every target is neutral.
  [[gnu::cold]] void sendNeutral();
  /// The drive may move by itself, which counts as motion; after advance() or sendNeutral().
  void watchDrive(Time now);
  /// The motor does not follow what is sent, and that is called back to where it stands.
  /// @param warned the drive holds the motor by a warning
  void watchFollowing(Time now, bool warned);
  /// @param when the drive can begin to follow: its brake has had its time then
  void beginFollowing(Time when) { following_.begin(when); }
  /// The drive shows that it follows, as far as its mode has a bit for that.
  bool followed() const { return following_.follows(); }

  /// Has been seen to move, or is being moved.
  bool moving() const;
  /// The drive goes to a position by itself and has not come to it.
  bool goalAhead() const { return mode_->goalAhead(); }
  /// A set-point is being handed over to the drive.
  bool handingOver() const { return mode_->handsOver() && mode_->handingOver(); }
  /// What is commanded as a position in operation, rad or m; NaN: nothing.
  double commandedPosition() const {
    return control_.inOperation() && mode_->positions() ? target() : kUnknown;
  }

  /// An effort is being streamed, or was and is not braked yet.
  bool pushes() const { return pushes_; }
  void endPushing() { pushes_ = false; }

  /// Takes a target that an enabled axis at rest has not come to back to where it stands: what
  /// holds the motor may let go. @return how long the drive may take to come back from it; nothing
  /// if there was none.
  std::optional<Duration> withdraw();
  /// Replaces the set-point by "stay here", which the drive gets even while it is halted.
  void takeBack();
  /// A standing axis whose drive still goes to a position by itself, which something holds or which
  /// has yet to set off, gets where it stands for that. @return whether that was so
  bool giveUpGoal();
  // The axis is halted while its set-points end, see ModeControl.
  void setHalted(bool halted) {
    axis_.ends_at_stop_point = halted;
    halted ? mode_->beginHalt() : mode_->endHalt();
  }
  /// The drive has come to its last goal, and stands there.
  void goalReached() { sent_.forgetGoals(); }

 private:
  void encode();
  [[gnu::cold]] void callBack(bool warned);
  [[gnu::cold]] void giveUpLate();
  bool movesItself() const;
  ModeControl& controlOf(const ModeChannel& channel);

  AxisBasis& axis_;
  const Coordinates& coordinates_;
  const Feedback& feedback_;
  const ActiveMode& active_;
  Control& control_;
  SetPoint sent_;
  FollowWatch following_;
  std::vector<std::unique_ptr<ModeControl>> modes_;  ///< of AxisObjects::modes
  ModeControl* mode_;
  double given_ = kUnknown;  ///< the last set-point that was taken, and its raw number
  std::uint64_t given_raw_ = 0, target_raw_ = 0;
  Commands commands_;
  bool pushes_ = false;
  bool late_ = false;
  Time seen_moving_ = Time::min();   ///< by the drive itself: not seen to stand until then
  Time moved_itself_ = Time::min();  ///< the drive may have moved by itself until then
};

}  // namespace cia402::drive
