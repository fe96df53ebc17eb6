// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// Limits of 2 rad/s and 10 rad/s², cycles of 4 ms.
struct SlowedGroup : test::GroupScene {
  explicit SlowedGroup(const config::RobotConfig& config = test::testRobot())
      : GroupScene(config) {}

  static motion::TrajectoryPoint point(double seconds, std::vector<double> positions,
                                       std::vector<double> velocities = {},
                                       std::vector<double> accelerations = {}) {
    return {std::move(positions), std::move(velocities), std::move(accelerations),
            fromSeconds(seconds)};
  }
  TrajectoryCommand command(const std::vector<motion::TrajectoryPoint>& points,
                            bool streamed = false) const {
    TrajectoryCommand made = world.trajectory("arm", {});
    made.points = points;
    made.streamed = streamed;
    return made;
  }
  /// 1 rad as fast as the limits permit, elbow the other way, each 0.1 s: 0.2 s up, 0.2 s down.
  static std::vector<motion::TrajectoryPoint> fastest() {
    std::vector<motion::TrajectoryPoint> points;
    constexpr double kAll = 1.0 / 2.0 + 0.2;
    for (int i = 1; i <= 7; ++i) {
      const double t = 0.1 * i, left = kAll - t;
      double x = 2.0 * (t - 0.1), v = 2.0, a = 0.0;
      if (t < 0.2 - 1e-9) x = 5.0 * t * t, v = 10.0 * t, a = 10.0;
      if (left < 0.2 - 1e-9) x = 1.0 - 5.0 * left * left, v = 10.0 * left, a = -10.0;
      points.push_back(point(t, {x, -0.5 * x}, {v, -0.5 * v}, {a, -0.5 * a}));
    }
    points.back() = point(kAll, {1.0, -0.5}, {0.0, 0.0}, {-10.0, 5.0});
    return points;
  }
};

TEST_F(SlowedGroup, FollowsTheFastestWayThatIsPlannedWithItsLimits) {
  const auto outcomes = send(command(fastest()));
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(answer.slowed);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("arm: trajectory accepted; slowed down, it ends 0."),
                                    HasSubstr(" s later than asked, for shoulder: on the way"),
                                    HasSubstr("beyond the limit 10 rad/s^2")));
  world.run(1s);
  EXPECT_EQ(position(0), 100000);
  EXPECT_EQ(position(1), -50000);
  expectSmooth(0);
  expectSmooth(1);
  ASSERT_EQ(outcomes->size(), 1u);
  EXPECT_EQ(outcomes->front().code, motion::TrajectoryErrorCode::successful);
  EXPECT_THAT(outcomes->front().message,
              AllOf(HasSubstr("arm: goal reached"), HasSubstr("s later than asked")));
}

struct StrictGroup : SlowedGroup {
  static config::RobotConfig strict() {
    config::RobotConfig config = test::testRobot();
    config.groups[0].strict = true;
    return config;
  }
  StrictGroup() : SlowedGroup(strict()) {}
};

TEST_F(StrictGroup, RefusesIt) {
  (void)send(command(fastest()));
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("beyond the limit 10 rad/s^2"));
  world.run(1s);
  EXPECT_EQ(position(0), 0);
}

TEST_F(SlowedGroup, RefusesWhatWouldTakeMuchLongerThanAsked) {
  (void)send(command({point(0.2, {1.0, 0.0}, {0.0, 0.0})}));
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("s instead of 0.2 s, and may take 0.62 s"));
}

TEST_F(SlowedGroup, EndsInMotionOnATopicAlone) {
  const auto points = {point(0.5, {0.2, 0.0}, {0.5, 0.0})};
  (void)send(command(points));
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("has velocity 0.5 rad/s; it must be 0"));
  const auto outcomes = send(command(points, true));
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_FALSE(answer.slowed);
  world.run(1s);
  // 0.02 s further at 0.5 rad/s, then 0.05 s of braking
  EXPECT_NEAR(position(0), 20000 + 1000 + 1250, 1);
  expectSmooth(0);
  ASSERT_EQ(outcomes->size(), 1u);
  EXPECT_THAT(outcomes->front().message,
              HasSubstr("arm: goal reached; brought to rest behind its last point"));
}

/// MoveIt Servo at 100 Hz: a point 10 ms ahead, and in the end one at 1 ns where the joint is.
TEST_F(SlowedGroup, FollowsAStreamOfOnePointTrajectoriesAndItsHalt) {
  for (int k = 1; k <= 100; ++k) {
    const double t = 0.01 * k, v = std::min(1.9, 8.0 * t);
    const double x = v < 1.9 ? 4.0 * t * t : 1.9 * (t - 0.5 * 1.9 / 8.0);
    (void)send(command({point(0.01, {x, -0.5 * x}, {v, -0.5 * v})}, true));
    ASSERT_TRUE(answer.success) << answer.message << " at " << t;
    world.run(k % 3 == 0 ? 12ms : k % 3 == 1 ? 8ms : 10ms);
    const double behind = k > 5 ? x - world.drives[0].target_position / 1e5 : 0.0;
    ASSERT_NEAR(behind, 0.0, 0.03) << "at " << t;
  }
  const double halted_at = world.drives[0].radians();
  (void)send(command({point(1e-9, {halted_at, -0.5 * halted_at}, {0.0, 0.0})}, true));
  ASSERT_TRUE(answer.success) << answer.message;
  world.run(3s);
  EXPECT_NEAR(world.drives[0].radians(), halted_at, 2e-5);
  expectSmooth(0);
  expectSmooth(1);
  EXPECT_EQ(world.eventsWith("goal reached"), 1u) << world.allEvents();
}

// What is streamed is refused or comes too late: the joints come to rest by themselves.
TEST_F(SlowedGroup, ComesToRestWhereTheStreamBreaksOffAndTakesTheNextPointUp) {
  for (int k = 1; k <= 50; ++k) {
    const double t = 0.01 * k, v = std::min(1.0, 8.0 * t);
    const double x = v < 1.0 ? 4.0 * t * t : t - 0.5 / 8.0;
    (void)send(command({point(0.01, {x, 0.0}, {v, 0.0})}, true));
    ASSERT_TRUE(answer.success) << answer.message;
    world.run(10ms);
  }
  const int from = position(0);
  world.run(60ms);  // 0.02 s on, and on the ramp
  (void)send(command({point(0.5, {0.6, 0.0})}, true));
  ASSERT_TRUE(answer.success) << answer.message;
  world.run(2s);
  EXPECT_GT(60000, from);
  EXPECT_EQ(position(0), 60000);
  expectSmooth(0);
}

TEST_F(SlowedGroup, TakesPositionsAloneAsRqtSendsThem) {
  // every 100 ms where the slider is, as long ahead as the way takes at full speed
  for (int k = 1; k <= 10; ++k) {
    const double x = 0.1 * k, way = std::abs(x - world.drives[0].radians());
    (void)send(command({point(std::max(way / 2.0, 0.1), {x, 0.0})}, true));
    ASSERT_TRUE(answer.success) << answer.message;
    world.run(100ms);
  }
  world.run(1s);
  EXPECT_EQ(position(0), 100000);
  expectSmooth(0);
}

}  // namespace
}  // namespace cia402::bus
