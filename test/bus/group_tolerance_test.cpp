// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How trajectories end: a group of its own on the robot's axes, to see the codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "bus/group.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using namespace std::chrono_literals;

struct GroupToleranceTest : testing::Test {
  GroupToleranceTest() { world.enable(); }
  Group make(config::JointTolerance elbow) {
    config::GroupConfig config;
    config.name = "test";
    config.joints = {"shoulder", "elbow"};
    config.goal_time = 0.5;
    config.tolerances["elbow"] = elbow;
    Joints& joints = world.network.cycle().joints();
    return Group(config, {joints.find("shoulder"), joints.find("elbow")}, test::kPeriod);
  }
  TrajectoryOutcome start(Group& group, double shoulder, double elbow) {
    return group.start(world.trajectory("arm", {{{shoulder, elbow}, 1.0}}), world.now);
  }
  /// The outcome and, in `took`, after how long.
  TrajectoryOutcome follow(Group& group) {
    const Time begun = world.now;
    while (world.now < begun + 5s) {
      world.run(test::kPeriod);
      const auto& ended = group.step(world.now);
      took = world.now - begun;
      if (!ended.empty()) return ended.front();
    }
    return {TrajectoryErrorCode::successful, "never ended"};
  }
  RobotWorld world;
  Duration took{};
};

TEST_F(GroupToleranceTest, EndsWithSuccessWithinTheTolerances) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(outcome.code, TrajectoryErrorCode::successful);
  EXPECT_EQ(outcome.message, "test: goal reached");
  EXPECT_NEAR(toSeconds(took), 1.06, 0.02) << "the motor has stood for 50 ms";
  EXPECT_EQ(world.unit(1).axis.leader(), nullptr);
}

TEST_F(GroupToleranceTest, EndsWithMinus4OffThePathAndStopsByARamp) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.run(test::kPeriod);
  world.drives[1].disturbance = 5100;  // 0.051 rad off
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(static_cast<int>(outcome.code), -4);
  EXPECT_THAT(outcome.message, AllOf(HasSubstr("test: trajectory stopped: elbow is 0.05"),
                                     HasSubstr("s, the tolerance is 0.05 rad")));
  EXPECT_LT(took, 600ms);
  EXPECT_LT(world.drives[0].radians(), 0.3);
}

TEST_F(GroupToleranceTest, AFailureOnTheWayTellsWhenItWasAndByHowMuch) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  for (const Time until = world.now + 300ms; world.now < until;) {
    world.run(test::kPeriod);
    ASSERT_TRUE(group.step(world.now).empty());
  }
  world.drives[1].disturbance = 5100;  // 0.051 rad, and what its path takes in two cycles
  EXPECT_THAT(follow(group).message,
              MatchesRegex("test: trajectory stopped: elbow is 0\\.05[0-9]* rad off its path at "
                           "0\\.3[01]?[0-9]* s, the tolerance is 0\\.05 rad"));
}

TEST_F(GroupToleranceTest, EndsWithMinus5WhenTheGoalIsMissedAfterTheGoalTime) {
  Group group = make({0.0, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.drives[1].disturbance = 2000;  // 0.02 rad off
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(static_cast<int>(outcome.code), -5);
  EXPECT_EQ(
      outcome.message,
      "test: goal missed: elbow is 0.02 rad away 0.5 s after the end, the tolerance is 0.01 rad");
  EXPECT_NEAR(toSeconds(took), 1.5, 0.02);
}

TEST_F(GroupToleranceTest, CallsASetPointBackThatRunsAwayFromAMotorThatStands) {
  Group group = make({0.0, 0.01});
  world.drives[1].blocked = true;
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(static_cast<int>(outcome.code), -4);
  EXPECT_THAT(outcome.message, AllOf(HasSubstr("test: trajectory stopped: elbow (node 2)"),
                                     HasSubstr("the motor stands while its set-points run")));
  world.run(100ms);
  EXPECT_EQ(world.drives[1].targets.back(), 0);
  EXPECT_LT(world.drives[0].radians(), 0.1);
}

TEST_F(GroupToleranceTest, SucceedsWhenTheGoalIsReachedWithinTheGoalTime) {
  Group group = make({0.0, 0.01});
  world.drives[1].disturbance = 2000;  // 0.02 rad off
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.drives[1].blocked = false;
  const Time begun = world.now;
  std::optional<TrajectoryOutcome> outcome;
  while (!outcome && world.now < begun + 3s) {
    world.run(test::kPeriod);
    if (world.now > begun + 1200ms) world.drives[1].disturbance = 0;
    const auto& ended = group.step(world.now);
    if (!ended.empty()) outcome = ended.front();
  }
  ASSERT_TRUE(outcome.has_value());
  EXPECT_EQ(outcome->code, TrajectoryErrorCode::successful);
  EXPECT_NEAR(toSeconds(world.now - begun), 1.26, 0.03) << "the motor has stood for 50 ms";
}

TEST_F(GroupToleranceTest, DoesNotJudgeTheFirstCycleByAnEarlierTrajectory) {
  Group group = make({0.05, 0.01});
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  ASSERT_EQ(follow(group).code, TrajectoryErrorCode::successful);
  world.run(2 * test::kPeriod);
  // Meanwhile the elbow moves on by other means.
  ASSERT_TRUE(world.move({0.5, 0.5}, 1.0).success);
  world.run(1100ms);
  world.run(1ms);  // so that feedback comes between the start and the first cycle
  ASSERT_EQ(start(group, 0.5, 0.0).code, TrajectoryErrorCode::successful);
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(outcome.code, TrajectoryErrorCode::successful) << outcome.message;
}

TEST_F(GroupToleranceTest, GivesTheCodesOfRefusals) {
  Group group = make({});
  EXPECT_EQ(group.start({}, world.now).code, TrajectoryErrorCode::successful);  // a stop
  TrajectoryCommand command = world.trajectory("arm", {{{0.5, 0.5}, 1.0}});
  const std::vector<std::string> both = std::exchange(command.joints, {"shoulder"});
  EXPECT_EQ(group.start(command, world.now).code, TrajectoryErrorCode::invalid_joints);
  EXPECT_EQ(start(group, 99.0, 0.0).code, TrajectoryErrorCode::invalid_goal);
  command.joints = both;
  command.start_time = world.now - 2s;
  EXPECT_EQ(group.start(command, world.now).code, TrajectoryErrorCode::invalid_goal);
  EXPECT_FALSE(group.executing());
}

TEST_F(GroupToleranceTest, DoesNotJudgeByWhatWasMeasuredBeforeItBegan) {
  Group group = make({0.05, 0.01});
  world.drives[1].disturbance = 6000;  // 0.06 rad off
  world.run(3 * test::kPeriod);
  ASSERT_EQ(start(group, 0.5, -0.5).code, TrajectoryErrorCode::successful);
  world.drives[1].disturbance = 0;
  EXPECT_TRUE(group.step(world.now).empty());
  EXPECT_TRUE(group.executing());
  const TrajectoryOutcome outcome = follow(group);
  EXPECT_EQ(outcome.message, "test: goal reached");
}

}  // namespace
}  // namespace cia402::bus
