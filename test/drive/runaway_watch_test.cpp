// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/runaway_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;

constexpr double kStandstill = 0.01;   // rad/s
constexpr double kCount = 1e-4;        // rad
constexpr double kAcceleration = 4.0;  // rad/s^2
constexpr Duration kCycle = 4ms;

double seconds(Time time) { return toSeconds(time.time_since_epoch()); }

/// A joint that is looked at as an axis does, and moves as is said.
struct Watched {
  RunawayWatch watch{kStandstill, kCount, kAcceleration, kCycle};
  /// @return where it is, in whole counts, when that is noticed; nothing: it is not, within 3 s
  std::optional<double> noticed(const std::function<double(double)>& position,
                                const std::function<RunawayWatch::Led(double)>& led) {
    for (Time now{}; now < Time{} + 3s; now += kCycle) {
      const double at = std::round(position(seconds(now)) / kCount) * kCount;
      if (now < next_) continue;
      next_ = now + watch.window();
      if (watch.measure(at, now) && watch.runsAway(led(seconds(now)))) return at;
    }
    return {};
  }

 private:
  Time next_{};
};

RunawayWatch::Led turning(double velocity) {
  RunawayWatch::Led led;
  led.velocity = velocity;
  led.on = true;
  return led;
}
RunawayWatch::Led to(double lowest, double highest, bool on = true) {
  RunawayWatch::Led led;
  led.lowest = lowest;
  led.highest = highest;
  led.on = on;
  return led;
}
RunawayWatch::Led to(double place) { return to(place, place); }

/// Where a motor is that accelerates from rest, rad/s^2.
std::function<double(double)> accelerating(double acceleration) {
  return [=](double t) { return 0.5 * acceleration * t * t; };
}

/// A quick stop in which the joint moves so; one that runs away was looked at just before it.
std::optional<double> escapesAt(const std::function<double(double)>& position, bool runs_away) {
  RunawayWatch watch{kStandstill, kCount, kAcceleration, kCycle};
  const auto measure = [&](Duration later) {
    return watch.measure(position(toSeconds(later)), Time{} + 1s + later);
  };
  (void)measure(-40ms);
  (void)measure(-20ms);
  Duration later{};
  if (runs_away) {
    (void)measure(later);
    later += watch.window();
  }
  watch.beginStop(Time{} + 1s, runs_away);
  for (; later < 2s; later += watch.window()) {
    if (measure(later) && watch.escapes()) return toSeconds(later);
  }
  return {};
}

TEST(RunawayWatch, NoticesAMotorThatTurnsTheOtherWay) {
  for (const double acceleration : {1.0, 10.0, 100.0}) {
    Watched joint;
    const auto at = joint.noticed(accelerating(-acceleration), [](double) { return turning(0.3); });
    ASSERT_TRUE(at) << acceleration;
    // Twice the 0.03 rad that may be an error, or three windows, whichever is more.
    EXPECT_GE(*at, -std::max(0.07, 0.5 * acceleration * 0.06 * 0.06) - kCount) << acceleration;
  }
}

TEST(RunawayWatch, NoticesAMotorThatGoesAwayFromWhereItIsLed) {
  for (const double place : {0.3, 0.0}) {
    Watched joint;
    const auto at = joint.noticed(accelerating(-20.0), [=](double) { return to(place); });
    ASSERT_TRUE(at) << place;
    EXPECT_GT(*at, -0.1);
  }
}

TEST(RunawayWatch, LeavesOneAloneThatIsLedThere) {
  Watched to_a_place, on;
  EXPECT_FALSE(to_a_place.noticed(accelerating(20.0), [](double) { return to(100.0); }));
  EXPECT_FALSE(on.noticed([](double t) { return 0.5 * t; }, [](double) { return turning(0.45); }));
}

// A tap that is shorter than two windows: at the end of neither it is led as fast as between them.
TEST(RunawayWatch, LeavesOneAloneThatVelocitiesLeadForAMoment) {
  constexpr double kHard = 21.0, kTop = 0.8;
  constexpr double kRamp = kTop / kHard;  // s
  const auto speed = [](double t) { return std::max(0.0, kTop - kHard * std::fabs(t - kRamp)); };
  for (int begin = 0; begin < 60; ++begin) {
    RunawayWatch watch(kStandstill, kCount, kHard, 10ms);
    double position = 0.0, told_before = 0.0;
    Time next{};
    for (int i = 0; i < 500; ++i) {
      const double t = 1e-3 * (i - 100 - begin);
      position += 1e-3 * speed(t - 0.015);  // so much the motor is late
      const Time now = Time{} + i * 1ms;
      if (now < next) continue;
      next = now + watch.window();
      RunawayWatch::Led led = turning(speed(t));
      led.velocity_before = std::exchange(told_before, led.velocity);
      const bool judged = watch.measure(position, now);
      EXPECT_FALSE(judged && watch.runsAway(led)) << begin << " ms, at " << t;
    }
  }
}

TEST(RunawayWatch, NoticesOneThatGoesOnAfterAMomentOfVelocity) {
  RunawayWatch watch(kStandstill, kCount, 21.0, 10ms);
  bool noticed = false;
  double told_before = 0.0;
  for (int i = 0; i < 10 && !noticed; ++i) {
    const double t = 0.05 * i;
    RunawayWatch::Led led = turning(i == 1 ? 0.3 : 0.0);
    led.velocity_before = std::exchange(told_before, led.velocity);
    const double at = 5.0 * std::max(0.0, t - 0.05);  // as fast as it can at once
    noticed = watch.measure(at, Time{} + i * 50ms) && watch.runsAway(led);
  }
  EXPECT_TRUE(noticed);
}

// A drive that takes its goals one by one goes to each of them.
TEST(RunawayWatch, LeavesOneAloneThatGoesToAnEarlierGoal) {
  Watched joint;
  EXPECT_FALSE(joint.noticed([](double t) { return -0.5 * std::min(t, 1.0); },
                             [](double) { return to(-0.5, 0.5); }));
}

// From 2 rad/s to where it came from: it brakes first.
TEST(RunawayWatch, LeavesOneAloneThatTurnsBack) {
  const auto back = [](double t) {
    const double braked = std::min(std::max(0.0, t - 0.5), 1.0);  // for 1 s, to -2 rad/s
    const double gone_back = 2.0 * std::max(0.0, t - 1.5);
    return 2.0 * std::min(t, 0.5) + 2.0 * braked - 0.5 * kAcceleration * braked * braked -
           gone_back;
  };
  Watched by_velocity, to_a_place;
  EXPECT_FALSE(by_velocity.noticed(back, [](double t) { return turning(t < 0.5 ? 2.0 : -2.0); }));
  EXPECT_FALSE(to_a_place.noticed(back, [](double t) { return to(t < 0.5 ? 2.0 : -9.0); }));
}

TEST(RunawayWatch, LeavesOneAloneThatCoasts) {
  Watched joint;
  EXPECT_FALSE(joint.noticed([](double t) { return 2.0 * (1.0 - std::exp(-t)); },
                             [](double) { return turning(0.0); }));
}

// It swings by 0.2 rad around its place, with 3 rad/s there.
TEST(RunawayWatch, LeavesOneAloneThatSwings) {
  Watched joint;
  EXPECT_FALSE(joint.noticed([](double t) { return 0.2 * std::exp(-t) * std::sin(15.0 * t); },
                             [](double) { return to(0.0); }));
}

TEST(RunawayWatch, LeavesOneAloneThatIsPushedByHand) {
  Watched slowly, on_its_way;
  const auto pushed = [](double t) { return 0.25 * t * t; };  // 1 rad/s after 2 s
  EXPECT_FALSE(slowly.noticed([&](double t) { return pushed(std::min(t, 2.0)); },
                              [](double) { return to(0.0, 0.0, false); }));
  EXPECT_TRUE(on_its_way.noticed(pushed, [](double) { return to(0.0, 0.0, true); }));
}

TEST(RunawayWatch, NoticesAHeldOneThatIsFast) {
  Watched joint;
  const auto at = joint.noticed(accelerating(-40.0), [](double) { return to(0.0, 0.0, false); });
  ASSERT_TRUE(at);
  EXPECT_LT(*at, -0.1);
  EXPECT_GT(*at, -0.3);
}

TEST(RunawayWatch, LeavesASearchForHomeAloneThatIsNoFasterThanItMayBe) {
  RunawayWatch::Led search;
  search.on = true;
  search.speed = 0.6;
  Watched within, beyond;
  EXPECT_FALSE(within.noticed([](double t) { return -0.5 * t; }, [&](double) { return search; }));
  EXPECT_TRUE(beyond.noticed(accelerating(-5.0), [&](double) { return search; }));
}

// Other coordinates, and a frame that is wrong once.
TEST(RunawayWatch, TakesALeapForNoMotion) {
  Watched joint;
  EXPECT_FALSE(
      joint.noticed([](double t) { return t < 1.0 ? 0.0 : 3.0; }, [](double) { return to(0.0); }));
}

// It comes to rest from a search for home that was cancelled, and the drive sets its zero still.
TEST(RunawayWatch, TakesALeapOfOneThatComesToRestForNoMotion) {
  for (int late = 0; late < 40; ++late) {  // when, in the windows of 20 ms
    const double zero = 0.3 + 1e-3 * late;
    const auto position = [=](double t) {
      const double braked = std::min(t, 0.25);
      return 1.6 - 0.25 * braked + 0.5 * braked * braked - (t < zero ? 0.0 : 1.6);
    };
    const auto slow = [=](double t) { return position(t) - 0.05 * std::min(t, 0.6); };
    const auto nowhere = [](double) { return turning(0.0); };
    Watched rests, creeps;
    EXPECT_FALSE(rests.noticed(position, nowhere)) << zero;
    EXPECT_FALSE(creeps.noticed(slow, nowhere)) << zero;
    EXPECT_FALSE(escapesAt([&](double t) { return slow(t + 0.1); }, false)) << zero;
    EXPECT_FALSE(escapesAt([&](double t) { return slow(t + 0.1); }, true)) << zero;
  }
}

// The host was late for 0.15 s: the motor went on with the velocity that it had been told last,
// while a stop was to bring it to rest. It is braked then, or it is not.
TEST(RunawayWatch, LeavesOneAloneThatIsBrakedAfterALateCycle) {
  for (const bool braked : {true, false}) {
    RunawayWatch watch{kStandstill, kCount, 7.0, 10ms};
    const Time from = Time{} + 1s;
    EXPECT_FALSE(watch.measure(0.3223, from));
    EXPECT_TRUE(watch.measure(0.3218, from + 50ms));
    EXPECT_TRUE(watch.measure(0.2803, from + 240ms));
    RunawayWatch::Led stopping = to(0.3112);
    stopping.velocity = -0.14;
    ASSERT_FALSE(watch.follows(stopping.velocity));
    EXPECT_FALSE(watch.runsAway(stopping)) << "it is seen once";
    EXPECT_TRUE(watch.measure(braked ? 0.276 : 0.269, from + 290ms));
    EXPECT_EQ(watch.runsAway(to(0.2767)), !braked);
  }
}

TEST(RunawayWatch, KnowsNothingAcrossAGap) {
  RunawayWatch watch{kStandstill, kCount, kAcceleration, kCycle};
  EXPECT_FALSE(watch.measure(0.0, Time{} + 1s));
  EXPECT_FALSE(watch.measure(-2.0, Time{} + 2s));
  EXPECT_EQ(watch.velocity(), 0.0);
}

TEST(RunawayWatch, AQuickStopThatBrakesIsLeftAlone) {
  const auto braked = [](double t) { return 2.0 * t - std::max(0.0, t) * std::max(0.0, t); };
  const auto rested = [&](double t) { return braked(std::min(t, 1.0)); };
  EXPECT_FALSE(escapesAt(rested, false));
  EXPECT_FALSE(escapesAt(rested, true));
}

TEST(RunawayWatch, AQuickStopByWhichTheMotorGetsFasterDoesNotBrakeIt) {
  const auto faster = [](double t) { return 2.0 * t + 10.0 * t * t; };
  const auto plain = escapesAt(faster, false), after = escapesAt(faster, true);
  ASSERT_TRUE(plain);
  EXPECT_LE(*plain, 0.121);
  ASSERT_TRUE(after);
  EXPECT_LE(*after, 0.041);
}

// Braked for 0.3 s, then driven on.
TEST(RunawayWatch, AQuickStopThatLetsTheMotorGoDoesNotBrakeIt) {
  const auto lets_go = [](double t) {
    const double braked = std::min(std::max(t, 0.0), 0.3), on = std::max(0.0, t - 0.3);
    return 2.0 * std::min(t, 0.3) - 2.0 * braked * braked + 0.8 * on + 10.0 * on * on;
  };
  const auto at = escapesAt(lets_go, false);
  ASSERT_TRUE(at);
  EXPECT_GT(*at, 0.3);
  EXPECT_LE(*at, 0.381) << "four windows; it has a speed of 2.4 rad/s by then";
}

// A frame that comes late says where the motor was: one window is seen too slow, the next too fast.
TEST(RunawayWatch, AQuickStopThatBrakesIsLeftAloneThoughPositionsComeLate) {
  const auto braked = [](double t) {
    const double braking = std::clamp(t, 0.0, 1.0);
    return 2.0 * std::min(t, 1.0) - braking * braking;
  };
  for (int one = 0; one < 40; ++one) {
    for (int other = one; other < 40; ++other) {
      const auto late = [&](double t) {
        const long window = std::lround(t / 0.02);
        return braked(window == one || window == other ? t - 0.008 : t);
      };
      EXPECT_FALSE(escapesAt(late, false)) << "the windows " << one << " and " << other;
    }
  }
}

// A drive may take its time; a motor that ran away before may not.
TEST(RunawayWatch, AQuickStopByWhichAMotorThatRunsAwayGetsNoSlowerDoesNotBrakeIt) {
  const auto steady = [](double t) { return 2.0 * t; };
  EXPECT_FALSE(escapesAt(steady, false));
  EXPECT_TRUE(escapesAt(steady, true));
}

}  // namespace
}  // namespace cia402::drive
