// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Trajectories for some of a group's joints: the others go on with what they do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;
using test::RobotWorld;
using testing::HasSubstr;
using namespace std::chrono_literals;
using test::Outcomes;

config::RobotConfig partialRobot(bool stop_group_on_fault = true) {
  config::RobotConfig robot = test::testRobot();
  robot.groups[0].allow_partial_joints_goal = true;
  robot.groups[0].stop_group_on_fault = stop_group_on_fault;
  return robot;
}

struct PartialGoals : test::GroupScene {
  explicit PartialGoals(const config::RobotConfig& config = partialRobot()) : GroupScene(config) {}
  TrajectoryCommand to(const std::vector<std::string>& joints, std::vector<double> positions,
                       double seconds) {
    TrajectoryCommand command = world.trajectory("arm", {{std::move(positions), seconds}});
    command.joints = joints;
    command.id = ++last_id;
    return command;
  }
  TrajectoryCommand both(double shoulder, double elbow, double seconds) {
    return to({"shoulder", "elbow"}, {shoulder, elbow}, seconds);
  }
  std::uint64_t last_id = 0;
};

TEST_F(PartialGoals, MoveTheirJointsAlone) {
  const Outcomes ended = send(to({"elbow"}, {0.5}, 1.0));
  ASSERT_TRUE(answer.success) << answer.message;
  world.run(1200ms);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(position(0), 0);
  EXPECT_EQ(position(1), 50000);
}

TEST(PartialGoalsOf, AGroupThatDoesNotAllowThemAreRefused) {
  RobotWorld world(test::testRobot());
  world.enable();
  TrajectoryCommand command = world.trajectory("arm", {{{0.5}, 1.0}});
  command.joints = {"elbow"};
  EXPECT_THAT(world.call(command).message, HasSubstr("lacks joint 'shoulder'"));
  world.run(1s);
  EXPECT_EQ(world.drives[1].position, 0);
}

TEST_F(PartialGoals, DoNotWaitForAxesOfOtherJoints) {
  ASSERT_TRUE(world.call(drive::ProcedureKind::disable, "shoulder").success);
  send(to({"elbow"}, {0.5}, 1.0));
  EXPECT_TRUE(answer.success) << answer.message;
  send(both(0.5, 0.5, 1.0));
  EXPECT_FALSE(answer.success);
  world.run(1200ms);
  EXPECT_EQ(position(1), 50000);
}

TEST_F(PartialGoals, TakeTheirJointsOutOfARunningTrajectoryThatTheOthersFollowToItsEnd) {
  const Outcomes first = send(both(1.0, -1.0, 1.0));
  world.run(400ms);
  const Outcomes second = send(to({"elbow"}, {0.5}, 2.0));
  world.run(20ms);
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
  world.run(700ms);
  EXPECT_EQ(position(0), 100000);
  EXPECT_NE(position(1), 50000);
  EXPECT_TRUE(second->empty());
  world.run(1400ms);
  EXPECT_EQ(position(1), 50000);
  ASSERT_EQ(second->size(), 1u);
  EXPECT_EQ(second->front().end, TrajectoryEnd::reached);
  expectSmooth(0);
  expectSmooth(1);
}

TEST_F(PartialGoals, OfDifferentJointsRunSideBySide) {
  const Outcomes shoulder = send(to({"shoulder"}, {1.0}, 1.0));
  world.run(300ms);
  const Outcomes elbow = send(to({"elbow"}, {-0.5}, 1.0));
  world.run(20ms);
  EXPECT_TRUE(shoulder->empty());
  world.run(800ms);
  ASSERT_EQ(shoulder->size(), 1u);
  EXPECT_EQ(shoulder->front().end, TrajectoryEnd::reached);
  EXPECT_TRUE(elbow->empty());
  EXPECT_TRUE(world.group().executing());
  world.run(300ms);
  ASSERT_EQ(elbow->size(), 1u);
  EXPECT_EQ(elbow->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(position(0), 100000);
  EXPECT_EQ(position(1), -50000);
  EXPECT_FALSE(world.group().executing() || world.group().stopping());
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 2u);
  expectSmooth(0);
  expectSmooth(1);
}

TEST_F(PartialGoals, AreCancelledAlone) {
  const Outcomes shoulder = send(to({"shoulder"}, {1.0}, 1.0));
  const Outcomes elbow = send(to({"elbow"}, {-1.0}, 1.0));
  world.run(500ms);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 2}).success);
  world.run(300ms);
  ASSERT_EQ(elbow->size(), 1u);
  EXPECT_EQ(elbow->front().end, TrajectoryEnd::stopped);
  const int stands = position(1);
  EXPECT_GT(stands, -70000);
  world.run(400ms);
  EXPECT_EQ(position(1), stands);
  ASSERT_EQ(shoulder->size(), 1u);
  EXPECT_EQ(shoulder->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(position(0), 100000);
}

TEST_F(PartialGoals, AllStopWhereOneFails) {
  TrajectoryCommand strict = to({"elbow"}, {-1.0}, 1.0);
  strict.tolerances.joints["elbow"].trajectory = 0.05;
  const Outcomes shoulder = send(to({"shoulder"}, {1.0}, 1.0));
  const Outcomes elbow = send(std::move(strict));
  world.run(500ms);
  world.drives[1].disturbance = 20000;  // 0.2 rad off
  world.run(20ms);
  world.drives[1].disturbance = 0;
  world.run(500ms);
  ASSERT_EQ(elbow->size(), 1u);
  EXPECT_EQ(elbow->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(elbow->front().joint, "elbow");
  ASSERT_EQ(shoulder->size(), 1u);
  EXPECT_EQ(shoulder->front().end, TrajectoryEnd::failed);
  EXPECT_THAT(shoulder->front().message, HasSubstr("elbow"));
  EXPECT_LT(position(0), 80000);
  EXPECT_GT(position(1), -80000);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped"), 1u);
  expectSmooth(0);
}

TEST_F(PartialGoals, WithoutPointsStopTheirJointsAlone) {
  const Outcomes first = send(both(1.0, -1.0, 1.0));
  world.run(500ms);
  TrajectoryCommand stop = world.trajectory("arm", {});
  stop.joints = {"elbow"};
  const Outcomes ended = send(std::move(stop));
  EXPECT_TRUE(ended->empty());
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 300ms));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  EXPECT_EQ(ended->front().message, "arm: stands");
  const int stands = position(1);
  world.run(500ms);
  EXPECT_EQ(position(1), stands);
  EXPECT_EQ(position(0), 100000) << "the other goes on";
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
  expectSmooth(0);
  expectSmooth(1);
}

TEST_F(PartialGoals, WithoutPointsNameJointsOfTheGroup) {
  TrajectoryCommand stop = world.trajectory("arm", {});
  stop.joints = {"knee"};
  send(std::move(stop));
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("'knee'"));
}

TEST_F(PartialGoals, ThatWaitTakeTheirJointsWhenTheirTimeHasCome) {
  const Outcomes first = send(both(1.0, -1.0, 2.0));
  world.run(200ms);
  TrajectoryCommand later = to({"elbow"}, {0.2}, 1.0);
  later.start_time = world.now + 600ms;
  const Outcomes second = send(std::move(later));
  world.run(500ms);
  EXPECT_TRUE(first->empty());
  world.run(120ms);
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
  world.run(1300ms);
  EXPECT_EQ(position(0), 100000);
  EXPECT_EQ(position(1), 20000);
  ASSERT_EQ(second->size(), 1u);
  EXPECT_EQ(second->front().end, TrajectoryEnd::reached);
  expectSmooth(0);
  expectSmooth(1);
}

TEST_F(PartialGoals, LeaveTheOtherJointsOfOneThatWaits) {
  TrajectoryCommand later = both(0.5, 0.5, 1.0);
  later.start_time = world.now + 500ms;
  const Outcomes waits = send(std::move(later));
  const Outcomes elbow = send(to({"elbow"}, {-0.5}, 1.0));
  world.run(20ms);
  ASSERT_EQ(waits->size(), 1u);
  EXPECT_EQ(waits->front().end, TrajectoryEnd::replaced);
  world.run(1700ms);
  EXPECT_EQ(position(0), 50000);
  EXPECT_EQ(position(1), -50000);
  expectSmooth(0);
  expectSmooth(1);
}

struct LoosePartialGoals : PartialGoals {
  LoosePartialGoals() : PartialGoals(partialRobot(false)) {}
};

// What is left of the first has no joint that is enabled: that is nobody's failure.
TEST_F(LoosePartialGoals, GoOnWhereOnlyAFaultyJointIsLeftOfTheOne) {
  const Outcomes first = send(both(1.0, -1.0, 2.0));
  world.run(300ms);
  world.drives[1].fault(0x8611);
  world.run(100ms);
  const Outcomes second = send(to({"shoulder"}, {0.5}, 1.0));
  ASSERT_TRUE(answer.success) << answer.message;
  world.run(1200ms);
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
  ASSERT_EQ(second->size(), 1u);
  EXPECT_EQ(second->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(position(0), 50000);
  EXPECT_EQ(world.unit(1).axis.leader(), nullptr) << "nobody leads the faulty one any more";
}

}  // namespace
}  // namespace cia402::bus
