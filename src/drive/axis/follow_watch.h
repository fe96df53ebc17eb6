// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "drive/axis/axis.h"
#include "drive/axis/feedback.h"

namespace cia402::drive {

/// A drive that never shows that it follows its set-points is waited for so long, once.
inline constexpr Duration kFollowPatience{std::chrono::seconds(1)};

/// Watches whether the motor follows what it is sent. What is sent must not run away from a motor
/// that stands, held by its brake, at a limit switch, blocked: it would leap after that when it is
/// let go.
class FollowWatch {
 public:
  /// @param standstill below that the axis stands, rad/s or m/s
  FollowWatch(double standstill, Duration cycle)
      : clearly_(kClearlyMoving * standstill), reaction_(kReactionCycles * cycle) {}

  /// What is looked at once a cycle while the axis is in operation.
  struct Look {
    const SetPoint& sent;
    const Standstill& standstill;
    const AxisState& state;
    /// Does the mode have a bit that says that the drive follows, and is it set?
    bool has_bit, bit;
    /// Something explains that the bit is not set: the halt bit, a limit, another mode still.
    bool held;
    bool warned;        ///< the drive holds the motor by a warning, and may tell "target reached"
    bool handing_over;  ///< the drive has not taken the set-point yet, which is waited for
  };

  /// A motor that moves has nothing called back. @return true: that is all there is to see
  bool leaves(bool moving, bool has_bit, Time now) {
    if (!moving || !(shown_ || (follows_ && !has_bit))) return false;
    if (!has_bit) began_ = now;
    noteMotion();
    return true;
  }
  /// The axis came into operation. @param when the drive can begin to follow
  void begin(Time when);
  /// It left operation, or what was sent has been called back.
  void end() { running_since_ = apart_since_ = rests_since_ = kNever; }
  /// The drive follows its set-points, as far as the mode that was looked at last shows that.
  bool follows() const { return follows_; }
  /// @return true: what was sent is to be called back to where the motor stands, and given up.
  bool watch(const Look& look, Time now) {
    if (!shown_) lookForBit(look, now);
    if (!look.standstill.moving()) return watchStanding(look, now);
    noteMotion();
    return false;
  }
  /// What was called back. @return true for the first time since the motor moved: people are told.
  bool isNews() { return !std::exchange(told_, true); }

 private:
  /// Only set-points that are so many times faster than standstill tell that a motor stays behind.
  static constexpr double kClearlyMoving = 3.0;

  void noteMotion() {
    end();
    told_ = false;
  }
  void lookForBit(const Look& look, Time now);
  bool watchStanding(const Look& look, Time now);
  bool runsAway(const Look& look, double ahead, Time now) const;
  [[gnu::cold]] bool goesNowhere(const Look& look, double ahead, Time now);  // goals only
  bool restsAhead(const Look& look, double ahead, Time now) const;
  bool apart(const Look& look, double ahead) const;
  bool staysApart(const Look& look, double ahead, Time now);

  double clearly_;     ///< per s
  Duration reaction_;  ///< of the drive
  bool follows_ = false;
  bool shown_ = false;        ///< the mode's bit was set since the axis is in operation
  bool never_shown_ = false;  ///< it never was, this drive does not use it
  bool excused_ = false;      ///< something explained since then that it was not set
  bool told_ = false;
  Time began_{};                 ///< since then the bit is waited for
  Time running_since_ = kNever;  ///< set-points of a stream move since then
  Time rests_since_ = kNever;    ///< a drive that goes to a goal by itself, far from it
  Time apart_since_ = kNever;    ///< they are ahead of a motor that a limit holds since then
};

}  // namespace cia402::drive
