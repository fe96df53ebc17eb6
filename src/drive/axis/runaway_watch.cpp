// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/runaway_watch.h"

#include <algorithm>
#include <cmath>

namespace cia402::drive {
namespace {

/// In multiples of the velocity below which an axis stands: what is faster is no noise, and what
/// nobody moves so fast by hand.
constexpr double kClearly = 3.0, kFast = 100.0;
/// It may be gone so far away, in standstill velocity times s; a held one farther.
constexpr double kFar = 3.0, kFarHeld = 10.0;
/// Faster than it was by more than that it is accelerated, for a window is a few positions long,
/// each of them late or early by a cycle.
constexpr double kFaster = 1.3;
/// So much slower than in the window before, it is braked, however fast it is still.
constexpr double kBraked = 0.6;
/// So many times as fast as in the window before, it is no motion as long as it is seen once: a
/// drive may set its zero late.
constexpr double kLeap = 5.0;
/// A motor that ran away, and gets faster by that in a quick stop, is not braked; nor one that has
/// not got slower by that in the end.
constexpr double kAgain = 1.1, kSlower = 0.95;
constexpr int kReactionWindows = 2, kBrakingWindows = 8;
/// s, until a drive does what it is told; it goes on with what it was told before.
constexpr double kReaction = 0.1;
constexpr Duration kShortest{std::chrono::milliseconds(20)};
constexpr int kCycles = 5, kWindows = 5;  ///< in a window; without a position nothing is known

}  // namespace

RunawayWatch::RunawayWatch(double standstill, double resolution, double acceleration,
                           Duration cycle)
    : window_(std::max(kShortest, kCycles * cycle)),
      clearly_(kClearly * standstill + 2.0 * resolution / toSeconds(window_)),
      fast_(kFast * standstill),
      distance_(kFar * standstill + 4.0 * resolution),
      acceleration_(acceleration) {}

void RunawayWatch::forget() {
  started_ = measured_ = leapt_ = false;
  way_ = velocity_ = velocity_before_ = 0.0;
  placed_ = 0;
}

bool RunawayWatch::measure(double position, Time stamp) {
  const Duration took = stamp - stamp_;
  if (started_ && took < window_ / 2) return false;
  const bool known = started_ && took <= kWindows * window_;
  if (!known) forget();
  velocity_before_ = velocity_;
  if (known) velocity_ = (position - position_) / toSeconds(took);
  if (known && !measured_) velocity_before_ = velocity_;
  measured_ = known;
  position_before_ = position_;
  position_ = position;
  stamp_ = stamp;
  started_ = true;
  return known;
}

/// How fast velocities may have led it that way within the last window, by its acceleration.
double RunawayWatch::fastestLed(const Led& led, double way) const {
  if (std::isnan(led.velocity_before)) return 0.0;
  const double ends = way * (led.velocity_before + led.velocity);
  return std::max(0.0, 0.5 * (ends + acceleration_ * toSeconds(window_)));
}

/// Once, in a window that is judged.
bool RunawayWatch::leaps() {
  leapt_ = !leapt_ && std::fabs(velocity_) > kLeap * std::fabs(velocity_before_) + clearly_;
  return leapt_;
}

bool RunawayWatch::runsAway(const Led& led) {
  const bool towards = velocity_ > 0.0 ? position_ < led.highest : position_ > led.lowest;
  if (follows(led.velocity)) return false;
  if (towards || std::fabs(velocity_) <= led.speed) {
    way_ = 0.0;
    return false;
  }
  const double way = std::copysign(1.0, velocity_);
  if (leaps() || way_ != way) {  // what is seen once may be a leap of what is measured
    way_ = way;
    from_ = position_before_;
    speed_ = std::max(way * velocity_before_, std::min(way * velocity_, fastestLed(led, way)));
    return false;
  }
  const double gone = std::fabs(position_ - from_), speed = std::fabs(velocity_);
  const double far = distance_ + kReaction * speed_, turn = speed_ * speed_ / acceleration_;
  const double faster = kFaster * speed_ + clearly_, sets_off = kReaction * acceleration_;
  const bool braked = speed < kBraked * std::fabs(velocity_before_);
  if (braked || (gone > far + turn && speed <= faster)) {  // it turns back, or coasts
    from_ = position_;
    speed_ = speed;
    return false;
  }
  const bool away = (gone > far && speed > faster + sets_off) || gone > far + turn;
  return away && (led.on || (gone > kFarHeld / kFar * distance_ && speed > fast_));
}

void RunawayWatch::beginStop(Time now, bool runs_away) {
  stop_ = now;
  ran_away_ = runs_away;
  leapt_ = false;
  judged_ = 0;
  placed_ = 0;
  speed_ = began_ = std::fabs(velocity_);
  way_ = 0.0;
}

/// Of the last windows of a quick stop, or of as many as there were.
double RunawayWatch::meanSpeed(std::size_t windows) const {
  const std::size_t over = std::min(windows, placed_ - 1);
  if (over == 0) return std::fabs(velocity_);
  const Place& last = places_[(placed_ - 1) % places_.size()];
  const Place& first = places_[(placed_ - 1 - over) % places_.size()];
  return std::fabs(last.position - first.position) / toSeconds(last.stamp - first.stamp);
}

bool RunawayWatch::escapes() {
  const bool leap = leaps();
  if (leap) placed_ = 0;
  places_[placed_++ % places_.size()] = {position_, stamp_};
  if (stamp_ < stop_ + kReactionWindows * window_) return false;
  if (leap) return false;
  const int judged = judged_++;
  if (ran_away_) {
    const double speed = std::fabs(velocity_);
    if (speed > kAgain * speed_) return true;
    speed_ = std::min(speed_, speed);
    return stamp_ >= stop_ + kBrakingWindows * window_ && speed > kSlower * began_;
  }
  if (judged > 1 && meanSpeed(kLately) > kFaster * speed_ + clearly_) return true;
  // The drive brakes by the second one.
  const double slowest = meanSpeed(kSlowest);
  speed_ = judged > 1 ? std::min(speed_, slowest) : slowest;
  return false;
}

}  // namespace cia402::drive
