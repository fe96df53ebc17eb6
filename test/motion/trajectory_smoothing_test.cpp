// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include "motion/trajectory_fixture.h"

namespace cia402::motion {
namespace {

using testing::AllOf;
using testing::HasSubstr;
constexpr double kCycleS = 0.004;

/// Two joints of 1 rad/s and 4 rad/s² that are slowed down where they exceed that.
class TrajectorySmoothing : public TrajectoryFixture {
 protected:
  TrajectorySmoothing() {
    for (Joint& joint : joints) {
      joint.limits.velocity = 1.0;
      joint.limits.acceleration = 4.0;
    }
    rules.strict = false;
    rules.longer_s = 0.4;
    rules.longer_share = 0.1;
  }
  TrajectoryResult make(const std::vector<TrajectoryPoint>& points) const {
    return Trajectory::create(joints, commanded, points, start, rules);
  }
  /// What a drive gets, cycle by cycle, keeps the limits and comes to rest at the goal.
  void expectWithinLimits(const Trajectory& trajectory) const {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      double velocity = commanded[j].velocity;
      Time time = trajectory.startTime();
      for (; time < trajectory.endTime() + fromSeconds(3 * kCycleS); time += fromSeconds(kCycleS)) {
        const double from = trajectory.sample(j, time).position;
        const double to = trajectory.sample(j, time + fromSeconds(kCycleS)).position;
        const double next = (to - from) / kCycleS;
        ASSERT_LE(std::abs(next), *joints[j].limits.velocity * (1 + 1e-5)) << j;
        ASSERT_LE(std::abs(next - velocity) / kCycleS,
                  *joints[j].limits.acceleration * (1 + 1e-4) + 1e-3)
            << "joint " << j << " at " << toSeconds(time - trajectory.startTime());
        velocity = next;
      }
      ASSERT_NEAR(velocity, 0.0, 1e-6);
    }
  }
  /// Samples of the fastest way from 0 to `goals` with the limits, each 0.1 s, as MoveIt makes
  /// them: all joints on one straight line.
  std::vector<TrajectoryPoint> fastest(double first, double second) const {
    const double way = std::max(std::abs(first), std::abs(second));
    const double up_s = std::min(1.0 / 4.0, std::sqrt(way / 4.0)), top = 4.0 * up_s;
    const double all_s = way / top + up_s;
    std::vector<TrajectoryPoint> points;
    for (double time = 0.1;; time += 0.1) {
      const double t = std::min(time, all_s), left = all_s - t;
      MotionState s{top * (t - 0.5 * up_s), top, 0.0};
      if (t < up_s) s = {2.0 * t * t, 4.0 * t, 4.0};
      if (left < up_s) s = {way - 2.0 * left * left, 4.0 * left, -4.0};
      const double a = first / way, b = second / way;
      points.push_back(point(t, {a * s.position, b * s.position}, {a * s.velocity, b * s.velocity},
                             {a * s.acceleration, b * s.acceleration}));
      if (t == all_s) return points;
    }
  }

  TrajectoryRules rules;
};

TEST_F(TrajectorySmoothing, TakesTheFastestWayThatMoveItPlansWithTheSameLimits) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> way(-2.0, 2.0), offset(-2e-3, 2e-3);
  double longest = 0.0;
  int slowed = 0;
  for (int i = 0; i < 200; ++i) {
    const auto points = fastest(way(random), way(random));
    commanded[0].position = offset(random);
    commanded[1].position = offset(random);
    const auto trajectory = make(points);
    ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
    expectWithinLimits(*trajectory);
    EXPECT_EQ(trajectory->goal(), points.back().positions);
    longest = std::max(longest, trajectory->delay());
    if (trajectory->delay() > 0.0) ++slowed;
  }
  EXPECT_GT(slowed, 150) << "else nothing is tried here";
  EXPECT_LT(longest, 0.2) << "s";
}

TEST_F(TrajectorySmoothing, SaysWhatWouldHaveBeenBeyondALimitAndHowMuchLaterItEnds) {
  const auto trajectory = make(fastest(1.0, -0.5));
  ASSERT_TRUE(trajectory.ok());
  EXPECT_THAT(trajectory->excess(),
              AllOf(HasSubstr("shoulder: on the way from the present state to point 0"),
                    HasSubstr("the acceleration reaches"), HasSubstr("the limit 4 rad/s^2")));
  EXPECT_NEAR(toSeconds(trajectory->endTime() - trajectory->startTime()),
              1.25 + trajectory->delay(), 1e-6);
}

TEST_F(TrajectorySmoothing, LeavesAloneWhatKeepsTheLimits) {
  const auto trajectory = make({point(2.0, {1, 0.5}, {0, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_EQ(trajectory->delay(), 0.0);
  EXPECT_EQ(trajectory->excess(), "");
  EXPECT_EQ(trajectory->endTime(), at(2.0));
  EXPECT_NEAR(trajectory->sample(0, at(1.0)).velocity, 0.9375, 1e-12);
}

TEST_F(TrajectorySmoothing, StrictRefusesWhatIsBeyondALimit) {
  rules.strict = true;
  const auto refused = make(fastest(1.0, -0.5));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("the acceleration reaches"));
  const auto straight = make({point(5, {1, 0})});
  ASSERT_FALSE(straight.ok());
  EXPECT_EQ(straight.error().message,
            "shoulder: the present state is to be left with 0.2 rad/s at once, without "
            "accelerating by its limit 4 rad/s^2");
}

TEST_F(TrajectorySmoothing, RefusesWhatWouldTakeMuchLongerAndSaysHowLong) {
  const auto refused = make({point(1, {2, 0}, {0, 0})});
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message,
              AllOf(HasSubstr("the velocity reaches 3 rad/s, beyond the limit 1 rad/s; within the "
                              "limits it takes 2."),
                    HasSubstr(" s instead of 1 s, and may take 1.5 s")));
}

TEST_F(TrajectorySmoothing, RefusesPointsThatAreBeyondALimitThemselves) {
  const auto fast = make({point(1, {0.5, 0}, {1.02, 0}), point(3, {1, 0}, {0, 0})});
  ASSERT_FALSE(fast.ok());
  EXPECT_EQ(fast.error().message,
            "shoulder: point 0 asks for the velocity 1.02 rad/s, beyond the limit 1 rad/s");
  EXPECT_TRUE(make({point(1, {0.4, 0}, {1.009, 0}), point(3, {1, 0}, {0, 0})}).ok());
  rules.margin = 0.1;
  EXPECT_TRUE(make({point(1, {0.4, 0}, {1.02, 0}), point(3, {1, 0}, {0, 0})}).ok());
}

TEST_F(TrajectorySmoothing, TheMarginLetsAccelerationsPass) {
  const auto points = {point(1.0, {0.6, 0.1}, {0, 0}), point(3.0, {0.7, 0}, {0, 0})};
  joints[0].limits.acceleration = 3.5;  // 6 * 0.6 / 1 s²
  EXPECT_NE(make(points)->excess(), "");
  rules.margin = 0.05;
  EXPECT_EQ(make(points)->excess(), "");
  EXPECT_EQ(make(points)->delay(), 0.0);
}

TEST_F(TrajectorySmoothing, NeverSmoothsAPositionBeyondItsLimit) {
  joints[0].limits.upper = 0.9;
  const auto refused = make(fastest(1.0, -0.5));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("beyond the upper limit 0.9 rad"));
}

// rqt_joint_trajectory_controller tells positions alone, as far ahead as the way takes at full
// speed.
TEST_F(TrajectorySmoothing, TakesAPositionAloneAtFullSpeed) {
  const auto trajectory = make({point(1.5, {1.5, 0.3})});
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  EXPECT_NEAR(trajectory->delay(), 0.25, 2e-3);
  expectWithinLimits(*trajectory);
  EXPECT_NEAR(trajectory->sample(1, at(0.8)).position,
              0.2 * trajectory->sample(0, at(0.8)).position, 1e-9)
      << "on a straight way";
}

TEST_F(TrajectorySmoothing, PassesPositionsAloneWithoutSwingingBeyondThem) {
  const auto trajectory = make(
      {point(1, {0.3, 0.1}), point(2, {0.8, 0.1}), point(3, {0.9, 0.5}), point(5, {0.2, 0.5})});
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  expectWithinLimits(*trajectory);
  double highest = 0.0;
  for (Time time = at(0); time < trajectory->endTime(); time += fromSeconds(kCycleS)) {
    highest = std::max(highest, trajectory->sample(0, time).position);
    EXPECT_LE(trajectory->sample(1, time).position, 0.5 + 1e-9);
  }
  EXPECT_NEAR(highest, 0.9, 1e-4);
}

TEST_F(TrajectorySmoothing, LeavesAMotionWithItsVelocityInTheTimeThatItNeeds) {
  commanded[0].velocity = 0.8;
  const auto trajectory = make({point(0.1, {0.2, 0}, {0.8, 0}), point(1.0, {0.6, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  EXPECT_GT(trajectory->delay(), 0.1);
  expectWithinLimits(*trajectory);
  EXPECT_NEAR(trajectory->sample(0, at(0)).velocity, 0.8, 1e-9);
}

TEST_F(TrajectorySmoothing, RefusesAMotionThatCannotBeLedOnInTime) {
  commanded[0].velocity = 1.0;
  const auto refused = make({point(0.1, {-0.5, 0}, {0, 0})});
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("cannot be slowed down in time"));
}

/// A topic, on which trajectories end in motion and near points are approached.
class TrajectoryStreaming : public TrajectorySmoothing {
 protected:
  TrajectoryStreaming() {
    rules.streamed = true;
    rules.coast_s = 0.02;
  }
  void take(double time_s, const TrajectoryPoint& point) {
    start.now = at(time_s);
    if (running) {
      for (std::size_t j = 0; j < 2; ++j) commanded[j] = running->sample(j, start.now);
    }
    const auto next = make({point});
    ASSERT_TRUE(next.ok()) << next.error().message << " at " << time_s;
    running = *next;
  }
  /// Gives out the cycles up to a time.
  void give(double until_s) {
    for (; cycle_s <= until_s; cycle_s += kCycleS) {
      const double next = running ? running->sample(0, at(cycle_s)).position : 0.0;
      const double next_velocity = (next - position) / kCycleS;
      fastest_seen = std::max(fastest_seen, std::abs(next_velocity));
      hardest_seen = std::max(hardest_seen, std::abs(next_velocity - velocity) / kCycleS);
      position = next;
      velocity = next_velocity;
    }
  }

  std::optional<Trajectory> running;
  double cycle_s = 0.0, position = 0.0, velocity = 0.0, fastest_seen = 0.0, hardest_seen = 0.0;
};

TEST_F(TrajectoryStreaming, EndsInMotionAndIsBroughtToRestBehindThat) {
  const auto trajectory = make({point(1, {0.4, 0.2}, {0.8, 0.4})});
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  EXPECT_TRUE(trajectory->endsInMotion());
  EXPECT_NEAR(trajectory->sample(0, at(1)).position, 0.4, 1e-9);
  EXPECT_NEAR(trajectory->sample(0, at(1.01)).velocity, 0.8, 1e-9) << "it waits for the next";
  // 0.02 s on, then 0.2 s of braking
  EXPECT_NEAR(trajectory->goal()[0], 0.4 + 0.016 + 0.08, 1e-9);
  EXPECT_NEAR(trajectory->goal()[1], 0.2 + 0.008 + 0.04, 1e-9);
  EXPECT_NEAR(toSeconds(trajectory->endTime() - trajectory->startTime()), 1.22, 1e-6);
  expectWithinLimits(*trajectory);
}

TEST_F(TrajectoryStreaming, RefusesAMotionThatItCannotEndBeforeALimit) {
  joints[0].limits.upper = 0.45;
  const auto refused = make({point(1, {0.4, 0.2}, {0.8, 0.4})});
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message,
              HasSubstr("shoulder: behind point 0, the last one, at 1.22 s on the way to rest, the "
                        "position reaches 0.496 rad, beyond the upper limit 0.45 rad"));
}

/// MoveIt Servo: every 10 ms where to be in 10 ms, with velocities, a little early or late.
TEST_F(TrajectoryStreaming, FollowsAStreamOfNearPointsWithVelocities) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.003, 0.003);
  double worst = 0.0;
  for (int k = 0; k < 300; ++k) {
    const double nominal_s = 0.01 * k, time_s = nominal_s + 0.005 + jitter(random);
    give(time_s);
    const double t = nominal_s + 0.01, w = 2.0;
    take(time_s, point(0.01, {0.2 * (1 - std::cos(w * t)), 0.0}, {0.2 * w * std::sin(w * t), 0.0}));
    if (k > 20) worst = std::max(worst, std::abs(position - 0.2 * (1 - std::cos(w * time_s))));
  }
  EXPECT_LT(worst, 0.02) << "rad off what is streamed";
  EXPECT_LE(fastest_seen, 1.0 + 1e-5);
  EXPECT_LE(hardest_seen, 4.0 * (1 + 1e-3));
}

TEST_F(TrajectoryStreaming, FollowsAStreamOfNearPointsAtTheLimitOfVelocityAndHalts) {
  for (int k = 1; k <= 100; ++k) {
    const double time_s = 0.01 * k;
    give(time_s);
    const double v = std::min(1.0, 3.9 * time_s);
    const double x = v < 1.0 ? 1.95 * time_s * time_s : time_s - 0.5 / 3.9;
    take(time_s, point(0.01, {x, 0.0}, {v, 0.0}));
  }
  EXPECT_GT(velocity, 0.99);
  give(1.005);
  const double halted_at = position;
  take(1.005, point(1e-9, {halted_at, 0.0}, {0.0, 0.0}));
  give(4.0);
  EXPECT_NEAR(position, halted_at, 1e-9) << "it comes to rest where the halt says";
  EXPECT_LE(fastest_seen, 1.0 + 1e-5);
  EXPECT_LE(hardest_seen, 4.0 * (1 + 1e-3));
}

TEST_F(TrajectoryStreaming, FollowsAStreamOfPositionsAlone) {
  for (int k = 1; k <= 200; ++k) {
    give(0.01 * k);
    take(0.01 * k, point(0.01, {std::min(0.005 * k, 0.6), 0.0}));
  }
  give(5.0);
  EXPECT_NEAR(position, 0.6, 1e-6);
  EXPECT_LE(fastest_seen, 1.0 + 1e-5);
  EXPECT_LE(hardest_seen, 4.0 * (1 + 1e-3));
}

TEST_F(TrajectoryStreaming, ApproachesANearPointFromRestAsFastAsTheLimitsPermit) {
  const auto trajectory = make({point(1e-9, {1.0, -0.5}, {0, 0})});
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  EXPECT_NEAR(toSeconds(trajectory->endTime() - trajectory->startTime()), 1.25, 0.1);
  expectWithinLimits(*trajectory);
  const auto straight = make({point(1e-9, {1.0, -0.5})});
  ASSERT_TRUE(straight.ok()) << straight.error().message;
  EXPECT_NEAR(toSeconds(straight->endTime() - straight->startTime()), 1.25, 0.01);
  expectWithinLimits(*straight);
}

/// Whatever is streamed, near or far, right or wrong: no limit is exceeded.
TEST_F(TrajectoryStreaming, KeepsTheLimitsWhateverIsStreamed) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-1.0, 1.0), ahead(-9.0, 0.3), gap(0.0, 0.2);
  double time_s = 0.0;
  for (int k = 0; k < 400; ++k) {
    time_s += gap(random);
    give(time_s);
    std::vector<double> velocities;
    if (random() % 2 == 0) velocities = {place(random), place(random)};
    start.now = at(time_s);
    if (running) {
      for (std::size_t j = 0; j < 2; ++j) commanded[j] = running->sample(j, start.now);
    }
    const auto next =
        make({point(std::pow(10.0, ahead(random)), {place(random), place(random)}, velocities)});
    if (next.ok()) running = *next;
  }
  give(time_s + 30.0);
  EXPECT_LE(fastest_seen, 1.0 + 1e-5);
  EXPECT_LE(hardest_seen, 4.0 * (1 + 2e-3));
  EXPECT_NEAR(velocity, 0.0, 1e-9);
}

}  // namespace
}  // namespace cia402::motion
