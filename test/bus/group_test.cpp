// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/group.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using motion::TrajectoryErrorCode;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using namespace std::chrono_literals;

/// The groups arm (shoulder, elbow) and head (elbow).
config::RobotConfig robotWith(bool stop_group_on_fault = true) {
  config::RobotConfig robot = test::testRobot();
  robot.groups[0].stop_group_on_fault = stop_group_on_fault;
  config::GroupConfig head;
  head.name = "head";
  head.joints = {"elbow"};
  robot.groups.push_back(head);
  return robot;
}

struct GroupTest : test::GroupScene {
  explicit GroupTest(const config::RobotConfig& config = robotWith()) : GroupScene(config) {}
};

TEST_F(GroupTest, FollowsATrajectoryToItsGoal) {
  ASSERT_EQ(world.move({1.0, -0.5}, 1.0).message, "arm: trajectory accepted");
  EXPECT_TRUE(world.group().executing());
  world.run(500ms);
  EXPECT_NEAR(world.drives[0].radians(), 0.5, 0.02);  // half-way, by symmetry
  EXPECT_NEAR(world.drives[1].radians(), -0.25, 0.01);
  world.run(600ms);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.drives[1].position, -50000);
  EXPECT_FALSE(world.group().executing());
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 1u);
  expectSmooth(0);
}

TEST_F(GroupTest, TakesPointsInTheOrderOfTheirNames) {
  TrajectoryCommand command = world.trajectory("arm", {{{-0.5, 1.0}, 1.0}});
  command.joints = {"elbow", "shoulder"};
  ASSERT_TRUE(world.call(command).success);
  world.run(1100ms);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.drives[1].position, -50000);
}

TEST_F(GroupTest, WaitsForAStartTimeInTheFuture) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  command.start_time = world.now + 500ms;
  ASSERT_TRUE(world.call(command).success);
  world.run(490ms);
  EXPECT_EQ(world.drives[0].position, 0);
  world.run(1100ms);
  EXPECT_EQ(world.drives[0].position, 100000);
}

TEST_F(GroupTest, RefusesUnknownJointsAndGroupsAndImpossibleTrajectories) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  command.joints = {"shoulder", "knee"};
  EXPECT_THAT(world.call(command).message,
              AllOf(StartsWith("arm: trajectory refused: the group has no joint 'knee'"),
                    HasSubstr("elbow")));
  EXPECT_THAT(world.move({1.0, 0.0}, 0.1).message,
              StartsWith("arm: trajectory refused: shoulder: "));
  EXPECT_EQ(world.move({9.0, 0.0}, 10.0).message,
            "arm: trajectory refused: shoulder: on the way from the present state to point 0, at "
            "10 s, the position reaches 9 rad, beyond the upper limit 3 rad");
  EXPECT_THAT(world.move({1.0}, 1.0).message,
              StartsWith("arm: trajectory refused: point 0 has 1 positions"));
  EXPECT_EQ(world.call(world.trajectory("leg", {{{}, 1.0}})).message, "there is no group \"leg\"");
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 0);
}

TEST_F(GroupTest, RefusesWhileAnAxisIsDisabled) {
  ASSERT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  const Answer refused = world.move({1.0, 0.0}, 1.0);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("arm: trajectory refused: elbow (node 2)"),
                                     HasSubstr("not enabled"), HasSubstr("call enable")));
}

TEST_F(GroupTest, RefusesWhileAnAxisIsInAModeThatFollowsNoTrajectory) {
  ASSERT_TRUE(world.call(ProcedureKind::set_mode, "elbow", "cyclic_velocity").success);
  EXPECT_EQ(world.move({1.0, 0.0}, 1.0).message,
            "arm: trajectory refused: elbow is in mode cyclic_velocity, which does not follow "
            "trajectories: ~elbow/set_mode cyclic_position first");
}

TEST_F(GroupTest, RefusesWhileAnotherGroupMovesAnAxis) {
  ASSERT_TRUE(world.move({1.0}, 1.0, "head").success);
  EXPECT_EQ(world.move({1.0, 0.0}, 1.0).message,
            "arm: trajectory refused: elbow follows a trajectory of group head");
  world.run(1100ms);
  EXPECT_TRUE(world.move({1.0, 0.0}, 1.0).success);
}

TEST_F(GroupTest, RefusesWhileStreamedSetPointsMoveAnAxis) {
  (void)world.begin(SetpointCommand{1, 1.0});
  world.run(200ms);
  EXPECT_THAT(world.move({1.0, 0.0}, 1.0).message,
              HasSubstr("elbow is still moved by streamed set-points"));
  world.run(2s);
  EXPECT_TRUE(world.move({1.0, 0.0}, 1.0).success);
}

TEST(Group, RefusesWhileAnAxisIsNotHomed) {
  config::RobotConfig config = test::testRobot();
  config.axes[1].homing = test::homingOfOrder(0);
  RobotWorld world(config);
  world.enable();
  EXPECT_THAT(world.move({1.0, 0.0}, 1.0).message,
              AllOf(HasSubstr("elbow (node 2)"), HasSubstr("not homed")));
  ASSERT_TRUE(world.call(ProcedureKind::home).success);
  const Answer answer = world.move({1.0, 0.0}, 1.0);
  EXPECT_TRUE(answer.success) << answer.message;
}

TEST_F(GroupTest, TakesOverANewTrajectoryWithoutAJump) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(501ms);  // between two cycles, at 1.5 rad/s
  ASSERT_TRUE(world.move({0.0, 0.5}, 2.0).success);
  world.run(2100ms);
  EXPECT_EQ(world.drives[0].position, 0);
  EXPECT_EQ(world.drives[1].position, 50000);
  expectSmooth(0);
  expectSmooth(1);
  EXPECT_EQ(world.eventsWith("goal reached"), 1u);
}

TEST_F(GroupTest, TakesOverAtAStartTimeInTheFutureWithoutAJump) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(200ms);
  TrajectoryCommand command = world.trajectory("arm", {{{0.0, 0.5}, 2.0}});
  command.start_time = world.now + 301ms;
  ASSERT_TRUE(world.call(command).success);
  world.run(2500ms);
  EXPECT_EQ(world.drives[0].position, 0);
  expectSmooth(0);
  expectSmooth(1);
}

// 3t² - 2t³: 1.125 rad/s and 3 rad/s² after a quarter of the time.
TEST_F(GroupTest, GoesOnFromStandstillWhereItWasAfterMissedCycles) {
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(250ms);
  const double from = world.group().commanded()[0].position;
  const double before = world.group().commanded()[0].velocity;
  EXPECT_NEAR(before, 1.125, 0.02);
  world.now += 50ms;
  world.drives[0].targets.clear();
  ASSERT_TRUE(world.runUntil([&] { return !world.drives[0].targets.empty(); }, 10ms));
  const motion::MotionState first = world.group().commanded()[0];
  EXPECT_NEAR(first.position, from, 3e-4);
  // 10 rad/s² in a cycle of 4 ms are 0.04 rad/s, 1/28 of the speed planned.
  EXPECT_NEAR(first.velocity, 0.04, 0.001);
  EXPECT_NEAR(first.acceleration, 3.0 / (28.125 * 28.125), 1e-3);
  double last = first.velocity;
  for (int cycle = 0; cycle < 24; ++cycle) {
    world.run(test::kPeriod);
    const double velocity = world.group().commanded()[0].velocity;
    EXPECT_LE(velocity - last, 0.04 + 1e-3) << cycle;
    EXPECT_GE(velocity, last) << cycle;
    last = velocity;
  }
  EXPECT_GT(last, 0.8);
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 1u);
  expectSmooth(0);
}

TEST_F(GroupTest, StopsByARampOnAnEmptyTrajectory) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  const std::int32_t from = world.drives[0].position;
  ASSERT_EQ(world.call(world.trajectory("arm", {})).message, "arm: stopping");
  EXPECT_TRUE(world.group().stopping());
  world.run(140ms);
  EXPECT_TRUE(world.group().stopping()) << "the ramp takes 150 ms";
  EXPECT_NEAR(world.group().commanded()[0].position, world.drives[0].target_position / 1e5, 1e-3);
  EXPECT_EQ(world.group().commanded()[0].acceleration, 0.0);
  EXPECT_EQ(world.eventsWith("arm: stopped"), 0u);
  world.run(160ms);
  EXPECT_FALSE(world.group().stopping());
  // 1.5 rad/s at 10 rad/s² take 0.1125 rad
  EXPECT_NEAR(world.drives[0].position - from, 11250, 1500);
  expectSmooth(0);
  EXPECT_EQ(world.eventsWith("arm: stopped by an empty trajectory"), 1u);
}

TEST_F(GroupTest, TakesOverFromAStopRampNowAndLater) {
  for (Duration later : {Duration(0), Duration(50ms), Duration(500ms)}) {
    ASSERT_TRUE(world.move({0.0, 0.0}, 3.0).success);
    world.run(3100ms);
    ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
    world.run(500ms);
    ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
    world.run(40ms);
    TrajectoryCommand command = world.trajectory("arm", {{{0.2, 0.0}, 2.0}});
    if (later > 0ms) command.start_time = world.now + later;
    const Answer taken = world.call(command);
    ASSERT_TRUE(taken.success) << taken.message;
    EXPECT_TRUE(world.group().executing());
    world.run(2100ms + later);
    EXPECT_EQ(world.drives[0].position, 20000);
    expectSmooth(0);
    expectSmooth(1);
  }
}

TEST_F(GroupTest, DropsATrajectoryThatWaitsBehindAStopWhenItIsStoppedAgain) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  TrajectoryCommand command = world.trajectory("arm", {{{0.0, 0.0}, 2.0}});
  command.start_time = world.now + 1s;
  ASSERT_TRUE(world.call(command).success);
  world.run(300ms);
  ASSERT_TRUE(world.group().executing()) << "its beginning is awaited";
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  const std::int32_t position = world.drives[0].position;
  world.run(3s);
  EXPECT_EQ(world.drives[0].position, position);
  EXPECT_FALSE(world.group().executing() || world.group().stopping());
}

TEST_F(GroupTest, DropsAWaitingTrajectoryWhenAJointFaults) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(300ms);
  TrajectoryCommand command = world.trajectory("arm", {{{0.0, 0.0}, 2.0}});
  command.start_time = world.now + 400ms;
  ASSERT_TRUE(world.call(command).success);
  world.drives[1].fault(0x8611);
  world.run(250ms);
  EXPECT_FALSE(world.group().executing() || world.group().stopping());
  world.run(3s);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped"), 1u) << world.allEvents();
}

TEST_F(GroupTest, StartsOnTimeThoughCyclesWereMissedWhileItWaited) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  const Time start = world.now + 400ms;
  command.start_time = start;
  ASSERT_TRUE(world.call(command).success);
  world.run(200ms);
  world.now += 50ms;
  world.run(start + 500ms - world.now);
  const double t = toSeconds(world.network.cycle().lastCycle() - start);
  EXPECT_NEAR(world.group().commanded()[0].position, 3 * t * t - 2 * t * t * t, 1e-4);
}

TEST_F(GroupTest, CountsItsTimeFromTheMomentInWhichItWasTaken) {
  ASSERT_TRUE(world.runUntil([&] { return world.network.cycle().lastCycle() == world.now; }));
  world.run(3ms);  // a millisecond before the next cycle
  const Time taken = world.now;
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(500ms);
  const double t = toSeconds(world.network.cycle().lastCycle() - taken);
  EXPECT_NEAR(world.group().commanded()[0].position, 3 * t * t - 2 * t * t * t, 1e-4);
}

TEST_F(GroupTest, TakesTheNextOneInTheCycleInWhichOneHasEnded) {
  ASSERT_TRUE(world.move({0.2, 0.0}, 1.0).success);
  ASSERT_TRUE(world.runUntil([&] { return world.eventsWith("arm: goal reached") == 1; }));
  const Answer next = world.move({0.0, 0.2}, 1.0);
  EXPECT_TRUE(next.success) << next.message;
}

// At a tenth of a radian per second the joints are as fast as before in a few cycles.
TEST_F(GroupTest, IsSoonAsFastAsBeforeAfterMissedCyclesOfASlowTrajectory) {
  ASSERT_TRUE(world.move({0.1, 0.0}, 2.0).success);
  world.run(1s);  // 0.075 rad/s
  world.now += 50ms;
  world.run(24ms);
  EXPECT_NEAR(world.group().commanded()[0].velocity, 0.075, 0.001);
  expectSmooth(0);
}

TEST(Group, GoesTheShorterWayOfAJointThatTurnsWithoutEnd) {
  config::RobotConfig config = test::testRobot();
  config.axes[0].geometry.type = drive::AxisGeometry::Type::continuous;
  config.axes[0].limits.lower.reset();
  config.axes[0].limits.upper.reset();
  RobotWorld world(config);
  world.enable();
  ASSERT_TRUE(world.move({6.2831853 + 0.1, 0.0}, 1.0).success);
  world.run(1100ms);
  EXPECT_NEAR(world.drives[0].position, 10000, 1);
}

TEST_F(GroupTest, DropsAWaitingTrajectoryWhenItIsStopped) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  ASSERT_TRUE(world.move({0.5, 0.0}, 1.0).success);
  world.run(400ms);
  command.start_time = world.now + 1s;
  ASSERT_TRUE(world.call(command).success);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  world.run(3s);
  EXPECT_LT(world.drives[0].radians(), 0.5);
  EXPECT_FALSE(world.group().executing());
}

TEST_F(GroupTest, StopsTheOtherJointsByARampWhenOneFaults) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  world.drives[1].fault(0x8611);
  world.run(1s);
  EXPECT_GT(world.drives[0].radians(), 0.55);
  EXPECT_LT(world.drives[0].radians(), 0.70);
  EXPECT_TRUE(world.drives[0].enabled());
  expectSmooth(0);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped: elbow (node 2): fault 0x8611"), 1u)
      << world.allEvents();
  EXPECT_FALSE(world.group().executing() || world.group().stopping());
}

struct LooseGroupTest : GroupTest {
  LooseGroupTest() : GroupTest(robotWith(false)) {}
};

TEST_F(LooseGroupTest, LeavesTheOtherJointsGoingWhenOneFaults) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  world.drives[1].fault(0x8611);
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 100000);
  expectSmooth(0);
  EXPECT_EQ(world.eventsWith("arm: goal reached"), 0u);
  EXPECT_EQ(world.eventsWith("arm: goal missed: elbow (node 2)"), 1u) << world.allEvents();
}

TEST_F(LooseGroupTest, StopsWhenNoJointIsLeft) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  for (auto& drive : world.drives) drive.fault(0x8611);
  world.run(1s);
  EXPECT_EQ(world.eventsWith("arm: trajectory stopped: no joint is left to follow it: shoulder "
                             "(node 1)"),
            1u)
      << world.allEvents();
}

TEST_F(LooseGroupTest, DoesNotMoveAJointThatIsEnabledAgainUnderWay) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 4.0).success);
  world.run(1s);
  world.drives[1].fault(0x8611);
  world.run(100ms);
  ASSERT_TRUE(world.call(ProcedureKind::clear_faults, "elbow").success);
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  ASSERT_TRUE(world.group().executing());
  const std::int32_t position = world.drives[1].position;
  world.run(500ms);
  EXPECT_EQ(world.drives[1].position, position);
  world.drives[1].targets.clear();
  // A new trajectory takes it along again, from where it stands.
  ASSERT_TRUE(world.move({0.0, 0.0}, 4.0).success);
  world.run(4100ms);
  EXPECT_EQ(world.drives[0].position, 0);
  EXPECT_EQ(world.drives[1].position, 0);
  expectSmooth(0);
  expectSmooth(1);
}

TEST_F(LooseGroupTest, DoesNotTellOldNewsAsTheReasonForAMissedGoal) {
  world.drives[1].blocked = true;
  ASSERT_TRUE(world.move({0.5, 0.5}, 1.0).success);
  world.run(2s);
  ASSERT_EQ(world.eventsWith("the motor stands while its set-points run"), 2u) << world.allEvents();
  world.drives[1].blocked = false;
  world.run(100ms);
  world.events.clear();
  ASSERT_TRUE(world.move({0.2, 0.0}, 2.0).success);
  world.run(500ms);
  ProcedureCommand declare;
  declare.axis = "elbow";
  declare.request.kind = ProcedureKind::set_position;
  declare.request.position = 0.2;
  ASSERT_TRUE(world.call(declare).success) << world.allEvents();
  world.run(2s);
  EXPECT_EQ(world.eventsWith("arm: goal missed: elbow fell out of operation"), 1u)
      << world.allEvents();
}

}  // namespace
}  // namespace cia402::bus
