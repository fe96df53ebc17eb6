// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/time_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cia402::motion {
namespace {

JointLimits limitsOf(std::optional<double> velocity, std::optional<double> acceleration) {
  JointLimits limits;
  limits.velocity = velocity;
  limits.acceleration = acceleration;
  return limits;
}

/// A path and its limits, with the states that a law makes of it.
struct LawBench {
  std::vector<SplineSegment> segments;
  std::vector<JointLimits> limits;
  bool from_rest = true;
  std::optional<TimeLaw> law;

  std::size_t joints() const { return limits.size(); }
  double length() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < segments.size(); i += joints()) sum += segments[i].duration();
    return sum;
  }
  bool make() {
    law = TimeLaw::of({segments, limits, from_rest});
    return law.has_value();
  }
  double lasts() const { return length() + law->delay(); }
  MotionState onPath(std::size_t joint, double along_s) const {
    std::size_t first = 0;
    for (; first + joints() < segments.size() && along_s > segments[first].duration();
         first += joints()) {
      along_s -= segments[first].duration();
    }
    return segments[first + joint].sample(along_s);
  }
  double position(std::size_t joint, double time_s) const {
    return onPath(joint, law->at(time_s).along_s).position;
  }
  MotionState state(std::size_t joint, double time_s) const {
    const TimeLaw::Moment moment = law->at(time_s);
    const MotionState path = onPath(joint, moment.along_s);
    return {path.position, path.velocity * moment.rate,
            path.acceleration * moment.rate * moment.rate + path.velocity * moment.change};
  }
  /// Joint 0 goes on to a state.
  void add(const MotionState& from, const MotionState& to, double duration_s) {
    segments.push_back(SplineSegment::cubic(from, to, duration_s));
  }
};

TEST(TimeLaw, IsTheTimeAskedForWhereNothingIsExceeded) {
  LawBench bench;
  bench.limits = {limitsOf(1.5001, 6.0001)};
  bench.add({0, 0, 0}, {1, 0, 0}, 1.0);  // 1.5 rad/s in the middle, 6 rad/s² at both ends
  ASSERT_TRUE(bench.make());
  EXPECT_TRUE(bench.law->asAsked());
  EXPECT_EQ(bench.law->delay(), 0.0);
  EXPECT_EQ(bench.law->at(0.3).along_s, 0.3);
  EXPECT_EQ(bench.law->at(0.3).rate, 1.0);
  EXPECT_EQ(bench.law->at(0.3).change, 0.0);
}

// A straight line from rest to rest: 1 rad with 1 rad/s and 4 rad/s² take 1 s + 0.25 s.
TEST(TimeLaw, MakesATrapezoidOfAStraightLine) {
  LawBench bench;
  bench.limits = {limitsOf(1.0, 4.0)};
  bench.segments = {SplineSegment::linear(0.0, 1.0, 1.0)};
  ASSERT_TRUE(bench.make());
  EXPECT_NEAR(bench.law->delay(), 0.25, 1e-3);
  EXPECT_NEAR(bench.state(0, 0.1).velocity, 0.4, 1e-3);
  EXPECT_NEAR(bench.state(0, 0.6).velocity, 1.0, 1e-9);
  EXPECT_EQ(bench.law->at(0.0).rate, 0.0);
  EXPECT_NEAR(bench.position(0, bench.lasts()), 1.0, 1e-12);
  EXPECT_NEAR(bench.state(0, bench.lasts()).velocity, 0.0, 1e-9);
}

// Twice as fast as permitted: twice the time, where the velocity alone binds.
TEST(TimeLaw, SlowsAVelocityDownToItsLimit) {
  LawBench bench;
  bench.limits = {limitsOf(1.0, std::nullopt)};
  bench.segments = {SplineSegment::linear(0.0, 2.0, 1.0)};
  ASSERT_TRUE(bench.make());
  EXPECT_NEAR(bench.law->delay(), 1.0, 1e-6);
  EXPECT_NEAR(bench.position(0, 0.5), 0.5, 1e-6);
}

TEST(TimeLaw, IsAsAskedAgainBehindAPlaceThatIsTooFast) {
  LawBench bench;
  bench.limits = {limitsOf(2.0, 4.0)};
  bench.add({0.0, 0.0, 0}, {0.25, 0.5, 0}, 1.0);
  bench.add({0.25, 0.5, 0}, {0.4, 0.5, 0}, 0.2);  // 15 rad/s² at both ends
  bench.add({0.4, 0.5, 0}, {0.65, 0.0, 0}, 1.0);
  ASSERT_TRUE(bench.make());
  EXPECT_GT(bench.law->delay(), 0.0);
  EXPECT_LT(bench.law->at(1.1).rate, 1.0);
  EXPECT_EQ(bench.law->at(0.3).rate, 1.0) << "before it";
  EXPECT_EQ(bench.law->at(bench.lasts() - 0.3).rate, 1.0) << "and behind it";
}

TEST(TimeLaw, BeginsAtFullRateInMotionOrNotAtAll) {
  LawBench bench;
  bench.from_rest = false;
  bench.limits = {limitsOf(1.0, 4.0)};
  bench.add({0, 0.5, 0}, {1, 0.5, 0}, 2.0);
  bench.add({1, 0.5, 0}, {2, 0, 0}, 0.7);  // too fast
  ASSERT_TRUE(bench.make());
  EXPECT_EQ(bench.law->at(0.0).rate, 1.0);
  EXPECT_GT(bench.law->delay(), 0.0);
  bench.segments.clear();
  bench.add({0, 0.9, 0}, {0.02, 0, 0}, 0.03);  // at 4 rad/s² it comes to rest after 0.1 rad
  EXPECT_FALSE(bench.make()) << "it would have to be slower from the beginning";
}

/// Random ways of up to four joints, of every order, with limits that are often exceeded.
struct RandomLaw : LawBench {
  explicit RandomLaw(unsigned seed) : random(seed) {
    const std::size_t count = 1 + random() % 4;
    for (std::size_t j = 0; j < count; ++j) {
      limits.push_back(limitsOf(uniform(0.3, 3.0), uniform(0.5, 20.0)));
      if (random() % 5 == 0) limits.back().velocity.reset();
    }
    std::vector<MotionState> from(count);
    const std::size_t points = 1 + random() % 8;
    for (std::size_t i = 0; i < points; ++i) {
      const double duration_s = std::pow(10.0, uniform(-2.0, 0.7));
      const bool quintic = random() % 2 == 0, last = i + 1 == points;
      for (std::size_t j = 0; j < count; ++j) {
        MotionState to{uniform(-1, 1), last ? 0.0 : uniform(-2, 2), last ? 0.0 : uniform(-8, 8)};
        segments.push_back(quintic ? SplineSegment::quintic(from[j], to, duration_s)
                                   : SplineSegment::cubic(from[j], to, duration_s));
        from[j] = to;
      }
    }
  }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  std::mt19937 random;
};

/// What may be missed between the places that are looked at, where a velocity changes its sign
/// within a step or more than doubles; ways that anybody plans are nowhere near that.
constexpr double kExtreme = 1.005;

TEST(TimeLawProperty, KeepsTheLimitsOfEveryJointAndThePath) {
  int slowed = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    RandomLaw bench(seed);
    ASSERT_TRUE(bench.make()) << seed;
    if (bench.law->asAsked()) continue;
    ++slowed;
    double before_s = 0.0;
    for (double time_s = 0.0; time_s < bench.lasts(); time_s += 0.004) {
      const TimeLaw::Moment moment = bench.law->at(time_s);
      ASSERT_LE(moment.rate, 1.0 + 1e-12) << seed;
      ASSERT_GE(moment.along_s, before_s) << seed;
      ASSERT_LE(moment.along_s - before_s, 0.004 + 1e-12) << seed;
      before_s = moment.along_s;
      for (std::size_t j = 0; j < bench.joints(); ++j) {
        const MotionState state = bench.state(j, time_s);
        const JointLimits& limits = bench.limits[j];
        if (limits.velocity) {
          ASSERT_LE(std::abs(state.velocity), *limits.velocity * kExtreme)
              << "seed " << seed << " joint " << j << " at " << time_s;
        }
        ASSERT_LE(std::abs(state.acceleration), *limits.acceleration * kExtreme)
            << "seed " << seed << " joint " << j << " at " << time_s;
      }
    }
    ASSERT_NEAR(bench.law->at(bench.lasts()).along_s, bench.length(), 1e-9) << seed;
  }
  EXPECT_GT(slowed, 200);
}

/// What a drive gets are positions every 4 ms: their differences keep the limits as well.
TEST(TimeLawProperty, KeepsTheLimitsInDifferencesOfSetPoints) {
  constexpr double kStepS = 0.004;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    RandomLaw bench(seed);
    ASSERT_TRUE(bench.make()) << seed;
    for (std::size_t j = 0; j < bench.joints(); ++j) {
      double velocity = 0.0;
      for (double time_s = 0.0; time_s < bench.lasts() + 3 * kStepS; time_s += kStepS) {
        const double next = (bench.position(j, std::min(time_s + kStepS, bench.lasts())) -
                             bench.position(j, std::min(time_s, bench.lasts()))) /
                            kStepS;
        const double limit = *bench.limits[j].acceleration * kExtreme + 1e-7 / kStepS;
        ASSERT_LE(std::abs(next - velocity) / kStepS, limit) << seed << " at " << time_s;
        velocity = next;
      }
    }
  }
}

/// Slowed down where it has to be alone, it takes no longer than slowed down everywhere.
TEST(TimeLawProperty, IsNoSlowerThanScalingTheWholePath) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    RandomLaw bench(seed);
    ASSERT_TRUE(bench.make()) << seed;
    double factor = 1.0;
    for (std::size_t i = 0; i < bench.segments.size(); ++i) {
      const JointLimits& limits = bench.limits[i % bench.joints()];
      const double velocity = std::abs(bench.segments[i].velocityRange().largest().value);
      const double acceleration = std::abs(bench.segments[i].accelerationRange().largest().value);
      if (limits.velocity) factor = std::max(factor, velocity / *limits.velocity);
      factor = std::max(factor, std::sqrt(acceleration / *limits.acceleration));
    }
    EXPECT_LE(bench.lasts(), bench.length() * factor * 1.15) << seed;
  }
}

}  // namespace
}  // namespace cia402::motion
