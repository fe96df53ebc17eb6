// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "cia402_driver/common/time.h"

namespace cia402::drive {

/// Tells from measured positions whether a motor runs away: whether it moves away from where it is
/// led, and faster and faster. So does one whose phases are swapped or whose encoder counts the
/// other way round (each correction pushes it further), and one that its load drags along.
///
/// What only comes to rest late, overshoots, turns back, coasts or is pushed by hand gets slower,
/// or goes slowly, and is left alone.
class RunawayWatch {
 public:
  /// @param standstill below that the axis stands, rad/s or m/s
  /// @param resolution of the measured position, rad or m
  /// @param acceleration with which the axis may set off and turn back, rad/s^2 or m/s^2, > 0
  RunawayWatch(double standstill, double resolution, double acceleration, Duration cycle);

  /// Speeds are means over so long: positions do not lie as drives' velocity values do.
  Duration window() const { return window_; }

  /// Where the motor is led.
  struct Led {
    double velocity = 0.0;  ///< rad/s or m/s; what goes that way, and little faster, is led
    /// The same a window ago, where it is led by velocities alone: in between it may have been led
    /// faster than at both ends. NaN: by others
    double velocity_before = std::numeric_limits<double>::quiet_NaN();
    double speed = 0.0;  ///< so fast, or slower, it may go either way
    /// rad or m; what goes towards one of them is led, too; NaN: to no position
    double lowest = std::numeric_limits<double>::quiet_NaN();
    double highest = std::numeric_limits<double>::quiet_NaN();
    /// It is led on, or was just now. Else it is held: by hand, or by its load, it is moved slowly
    /// without being out of control.
    bool on = false;
  };
  /// @param position rad or m, with the time that it was on the wire
  /// @return true at the end of a window: the motor is to be judged
  bool measure(double position, Time stamp);
  /// It goes with the set-points, whose velocity this is, or is as good as standing.
  bool follows(double velocity) {
    const double speed = std::fabs(velocity_);
    const bool along =
        velocity_ * velocity > 0.0 && speed <= kAhead * std::fabs(velocity) + clearly_;
    if (!along && speed > clearly_) return false;
    way_ = 0.0;
    return true;
  }
  /// @return true: it runs away
  bool runsAway(const Led& led);

  /// A quick stop begins. @param runs_away because the motor does: it has to get slower at once
  void beginStop(Time now, bool runs_away);
  /// While that lasts, or a fault reaction. @return true: the motor does not get slower by it, but
  /// faster
  bool escapes();

  /// Nothing is known any more: of other coordinates, or not heard of.
  void forget();
  /// Mean over the last window, rad/s or m/s; 0 before there was one.
  double velocity() const { return velocity_; }

 private:
  double fastestLed(const Led& led, double way) const;
  bool leaps();
  /// @param windows up to kSlowest
  double meanSpeed(std::size_t windows) const;

  /// Faster than it is led by more than that it is not led.
  static constexpr double kAhead = 1.25;
  /// A quick stop is judged by the mean of the last windows against the slowest such mean, of more
  /// windows: where frames are late, one window tells of half as much or twice as much as the motor
  /// does.
  static constexpr std::size_t kLately = 3, kSlowest = 6;

  Duration window_;
  double clearly_;                           ///< what is faster moves, rad/s or m/s
  double fast_;                              ///< what nobody moves by hand, rad/s or m/s
  double distance_;                          ///< that an error of control may take, rad or m
  double acceleration_;                      ///< rad/s^2 or m/s^2
  bool started_ = false, measured_ = false;  ///< a window has begun; one has ended
  bool leapt_ = false;                       ///< in the one that was judged last
  double position_ = 0.0, position_before_ = 0.0, velocity_ = 0.0, velocity_before_ = 0.0;
  Time stamp_{};
  double way_ = 0.0;    ///< 1 or -1 while it moves away, which way; else 0
  double from_ = 0.0;   ///< it moves away from there, rad or m,
  double speed_ = 0.0;  ///< and was so fast then, or was slowest in a quick stop
  Time stop_{};         ///< beginning of a quick stop,
  double began_ = 0.0;  ///< when it was so fast, rad/s or m/s
  bool ran_away_ = false;
  int judged_ = 0;  ///< windows of that
  struct Place {
    double position;
    Time stamp;
  };
  std::array<Place, kSlowest + 1> places_{};  ///< of the last windows of a quick stop,
  std::size_t placed_ = 0;                    ///< so many of them in all
};

}  // namespace cia402::drive
