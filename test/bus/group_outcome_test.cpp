// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Whoever commands a trajectory is told once how it ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using motion::TrajectoryErrorCode;
using testing::HasSubstr;
using namespace std::chrono_literals;
using test::Outcomes;

config::RobotConfig robotWithGoal(double tolerance) {
  config::RobotConfig robot = test::testRobot();
  robot.groups[0].goal_time = 0.5;
  robot.groups[0].tolerances["elbow"].goal = tolerance;
  return robot;
}

struct GroupOutcomeTest : test::GroupScene {
  using GroupScene::GroupScene;
  using GroupScene::send;
  /// Sends both joints there in so many seconds. @return how that ended, once it has
  Outcomes send(double shoulder, double elbow, double seconds,
                std::optional<Time> start_time = {}) {
    TrajectoryCommand command = world.trajectory("arm", {{{shoulder, elbow}, seconds}});
    command.start_time = start_time;
    return send(std::move(command));
  }
};

struct TwoGroupsTest : test::GroupScene {
  TwoGroupsTest() : GroupScene(robot()) {}
  static config::RobotConfig robot() {
    config::RobotConfig robot = test::testRobot();
    config::GroupConfig head = robot.groups[0];
    head.name = "head";
    head.joints = {"elbow"};
    robot.groups.push_back(head);
    return robot;
  }
};

TEST_F(GroupOutcomeTest, ATrajectoryThatComesToItsGoalHasReachedIt) {
  const Outcomes ended = send(1.0, -0.5, 1.0);
  ASSERT_TRUE(answer.success);
  world.run(900ms);
  EXPECT_TRUE(ended->empty()) << "it is under way";
  world.run(400ms);
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::successful);
  EXPECT_EQ(ended->front().message, "arm: goal reached");
  EXPECT_EQ(ended->front().joint, "");
  EXPECT_TRUE(std::isnan(ended->front().off));
  EXPECT_EQ(world.drives[0].position, 100000);
}

TEST_F(GroupOutcomeTest, OneThatIsTakenOverUnderWayIsReplacedInThatMoment) {
  const Outcomes first = send(1.0, -0.5, 1.0);
  world.run(300ms);
  const Outcomes second = send(0.5, 0.5, 1.0);
  world.run(20ms);
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
  EXPECT_TRUE(second->empty());
  world.run(1500ms);
  ASSERT_EQ(second->size(), 1u);
  EXPECT_EQ(second->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(first->size(), 1u) << "it is told once";
}

TEST_F(GroupOutcomeTest, OneThatWaitsForItsTimeIsReplacedBeforeItBegins) {
  const Outcomes waits = send(1.0, -0.5, 1.0, world.now + 2s);
  world.run(100ms);
  const Outcomes next = send(0.2, 0.2, 1.0);
  world.run(20ms);
  ASSERT_EQ(waits->size(), 1u);
  EXPECT_EQ(waits->front().end, TrajectoryEnd::replaced);
  world.run(3s);
  ASSERT_EQ(next->size(), 1u);
  EXPECT_EQ(world.drives[0].position, 20000) << "the replaced one never began";
}

TEST_F(GroupOutcomeTest, OneThatWaitsBehindAnotherIsReplacedToo) {
  const Outcomes runs = send(1.0, -0.5, 1.0);
  world.run(100ms);
  const Outcomes waits = send(0.5, 0.5, 1.0, world.now + 500ms);
  world.run(100ms);
  const Outcomes next = send(0.2, 0.2, 1.0, world.now + 500ms);
  ASSERT_TRUE(answer.success) << answer.message;
  ASSERT_EQ(waits->size(), 1u);
  EXPECT_EQ(waits->front().end, TrajectoryEnd::replaced);
  EXPECT_TRUE(runs->empty()) << "it goes on until the next one begins";
  world.run(600ms);
  ASSERT_EQ(runs->size(), 1u);
  EXPECT_EQ(runs->front().end, TrajectoryEnd::replaced);
  world.run(2s);
  ASSERT_EQ(next->size(), 1u);
  EXPECT_EQ(next->front().end, TrajectoryEnd::reached);
}

TEST_F(GroupOutcomeTest, OneThatIsToBeginNowRunsUntilTheLaterOneOfTheSameMomentBegins) {
  send(0.1, 0.0, 4.0);
  world.run(200ms);
  TrajectoryCommand soon = world.trajectory("arm", {{{0.5, 0.0}, 1.0}});
  TrajectoryCommand later = world.trajectory("arm", {{{0.2, 0.0}, 1.0}});
  later.start_time = world.now + 1500ms;
  auto ended = std::make_shared<std::vector<TrajectoryOutcome>>();
  soon.ended = [ended](const TrajectoryOutcome& outcome) { ended->push_back(outcome); };
  (void)world.begin(std::move(soon));
  (void)world.begin(std::move(later));  // in the same cycle
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 1400ms));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(world.drives[0].position, 50000);
  world.run(1500ms);
  EXPECT_EQ(world.drives[0].position, 20000);
}

TEST_F(GroupOutcomeTest, OneThatIsStoppedEndsWhenItsJointsStand) {
  const Outcomes ended = send(1.0, -0.5, 1.0);
  world.run(500ms);
  TrajectoryCommand stop = world.trajectory("arm", {});
  ASSERT_TRUE(world.call(stop).success);
  EXPECT_TRUE(ended->empty()) << "they are being brought to rest";
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 2s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  const int stands = world.drives[0].position;
  world.run(500ms);
  EXPECT_EQ(world.drives[0].position, stands);
}

TEST_F(GroupOutcomeTest, OneThatIsCancelledEndsWhenItsJointsStand) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, -0.5}, 1.0}});
  command.id = 7;
  const Outcomes ended = send(std::move(command));
  world.run(300ms);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 6}).success);
  world.run(200ms);
  const int moving = world.drives[0].position;
  world.run(20ms);
  EXPECT_NE(world.drives[0].position, moving) << "another one was cancelled";
  ASSERT_TRUE(world.call(CancelCommand{"arm", 7}).success);
  EXPECT_TRUE(ended->empty()) << "they are being brought to rest";
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 2s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  EXPECT_EQ(ended->front().message, "arm: cancelled");
  const int stands = world.drives[0].position;
  EXPECT_LT(stands, 99000);
  world.run(500ms);
  EXPECT_EQ(world.drives[0].position, stands);
}

// It was planned from where the other would have led.
TEST_F(GroupOutcomeTest, OneThatWaitsBehindACancelledOneIsStoppedWithIt) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, -0.5}, 1.0}});
  command.id = 7;
  const Outcomes runs = send(std::move(command));
  const Outcomes waits = send(0.5, 0.5, 1.0, world.now + 900ms);
  world.run(500ms);
  ASSERT_TRUE(world.call(CancelCommand{"arm", 7}).success);
  ASSERT_EQ(waits->size(), 1u);
  EXPECT_EQ(waits->front().end, TrajectoryEnd::stopped);
  world.run(300ms);
  ASSERT_EQ(runs->size(), 1u);
  const int stands = position(0);
  world.run(2s);
  EXPECT_EQ(position(0), stands);
}

TEST_F(GroupOutcomeTest, OneThatWaitsIsCancelledAlone) {
  const Outcomes runs = send(1.0, -0.5, 1.0);
  TrajectoryCommand command = world.trajectory("arm", {{{0.5, 0.5}, 1.0}});
  command.id = 8;
  command.start_time = world.now + 900ms;
  const Outcomes waits = send(std::move(command));
  ASSERT_TRUE(world.call(CancelCommand{"arm", 8}).success);
  ASSERT_EQ(waits->size(), 1u);
  EXPECT_EQ(waits->front().end, TrajectoryEnd::stopped);
  world.run(3s);
  ASSERT_EQ(runs->size(), 1u);
  EXPECT_EQ(runs->front().end, TrajectoryEnd::reached);
  EXPECT_EQ(position(0), 100000);
}

// A driver before may have left it turning.
TEST_F(GroupOutcomeTest, OneWithoutPointsSaysOfNoJointThatItStandsOfWhichNothingIsKnown) {
  world.drives[1].silent = true;
  ASSERT_TRUE(world.runUntil([&] { return !world.axis(1).state().feedback_valid; }, 2s));
  const Time asked = world.now;
  const Outcomes ended = send(world.trajectory("arm", {}));
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 2s));
  EXPECT_GE(world.now, asked + 400ms) << "it may come back";
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::goal_tolerance_violated);
  EXPECT_EQ(ended->front().joint, "elbow");
  EXPECT_THAT(ended->front().message,
              testing::MatchesRegex("arm: whether elbow stands is not known: elbow .node 2.: .*"));
}

TEST_F(GroupOutcomeTest, OneWithoutPointsEndsWhenTheJointsStand) {
  send(1.0, -0.5, 1.0);
  world.run(500ms);
  const Outcomes ended = send(world.trajectory("arm", {}));
  EXPECT_TRUE(ended->empty());
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 2s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
  EXPECT_EQ(ended->front().message, "arm: stands");
  const int stands = world.drives[0].position;
  world.run(500ms);
  EXPECT_EQ(world.drives[0].position, stands);
  const Outcomes again = send(world.trajectory("arm", {}));
  world.run(100ms);
  EXPECT_EQ(again->size(), 1u) << "they stand already";
}

TEST_F(GroupOutcomeTest, OneWithoutPointsStopsAJointThatAStreamMoves) {
  for (int i = 0; i < 20; ++i) {
    (void)world.begin(SetpointCommand{0, 1.0});
    world.run(10ms);
  }
  const int from = world.drives[0].position;
  const Outcomes ended = send(world.trajectory("arm", {}));
  EXPECT_TRUE(ended->empty());
  const auto refused = world.begin(SetpointCommand{0, 1.0});
  world.run(test::kPeriod);
  EXPECT_EQ(refused->size(), 1u) << "until it stands";
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 2s));
  const int stands = world.drives[0].position;
  EXPECT_GT(stands, from);
  EXPECT_LT(stands, from + 40000) << "its ramp; 1 rad was asked for";
  world.run(500ms);
  EXPECT_EQ(world.drives[0].position, stands);
  const auto taken = world.begin(SetpointCommand{0, 1.0});
  world.run(100ms);
  EXPECT_TRUE(taken->empty());
  EXPECT_GT(world.drives[0].position, stands) << "the stream may begin anew";
}

TEST_F(TwoGroupsTest, OneWithoutPointsNamesAJointThatAnotherGroupMoves) {
  const Outcomes head = send(world.trajectory("head", {{{1.0}, 2.0}}));
  ASSERT_TRUE(answer.success) << answer.message;
  world.run(300ms);
  const Outcomes ended = send(world.trajectory("arm", {}));
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 1s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::goal_tolerance_violated);
  EXPECT_EQ(ended->front().joint, "elbow");
  EXPECT_EQ(ended->front().message,
            "arm: elbow is not stopped by this: it follows a trajectory of group head, which one "
            "without points stops there");
  world.run(2s);
  EXPECT_EQ(position(1), 100000);
  ASSERT_EQ(head->size(), 1u);
  EXPECT_EQ(head->front().end, TrajectoryEnd::reached);
}

// A trajectory and an empty one come within one cycle.
TEST_F(GroupOutcomeTest, OneThatIsStoppedAsItBeginsEndsWhenTheJointsStand) {
  const Outcomes first = send(1.0, -0.5, 1.0);
  world.run(500ms);
  auto second = std::make_shared<std::vector<TrajectoryOutcome>>();
  TrajectoryCommand command = world.trajectory("arm", {{{-1.0, 0.5}, 2.0}});
  command.ended = [second](const TrajectoryOutcome& outcome) { second->push_back(outcome); };
  (void)world.begin(std::move(command));
  (void)world.begin(world.trajectory("arm", {}));
  const int before = position(0);
  world.run(20ms);
  EXPECT_GT(position(0), before) << "its ramp";
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
  EXPECT_TRUE(second->empty());
  ASSERT_TRUE(world.runUntil([&] { return !second->empty(); }, 2s));
  EXPECT_EQ(second->front().end, TrajectoryEnd::stopped);
  const int stands = position(0);
  world.run(2s);
  EXPECT_EQ(position(0), stands);
}

TEST_F(GroupOutcomeTest, OneThatIsCancelledAsItBeginsDoesNotLeaveTheOneBeforeItToItsWay) {
  const Outcomes first = send(1.0, -0.5, 1.0);
  world.run(300ms);
  auto second = std::make_shared<std::vector<TrajectoryOutcome>>();
  TrajectoryCommand command = world.trajectory("arm", {{{-1.0, 0.5}, 2.0}});
  command.id = 9;
  command.ended = [second](const TrajectoryOutcome& outcome) { second->push_back(outcome); };
  (void)world.begin(std::move(command));
  (void)world.begin(CancelCommand{"arm", 9});
  ASSERT_TRUE(world.runUntil([&] { return !second->empty(); }, 2s));
  EXPECT_EQ(second->front().end, TrajectoryEnd::stopped);
  const int stands = position(0);
  EXPECT_LT(stands, 90000) << "100000 was the goal of the first";
  world.run(2s);
  EXPECT_EQ(position(0), stands);
  ASSERT_EQ(first->size(), 1u);
  EXPECT_EQ(first->front().end, TrajectoryEnd::replaced);
}

TEST(GroupOutcome, OneWithoutPointsNamesAJointThatIsBeingHomed) {
  config::RobotConfig robot = test::testRobot();
  robot.axes[0].homing = test::homingOfOrder(0);
  test::RobotWorld world(robot);
  world.enable();
  world.drives[0].homing_is_slow = true;
  (void)world.begin(ProcedureCommand{"shoulder", {drive::ProcedureKind::home, {}, {}}});
  world.run(200ms);
  std::vector<TrajectoryOutcome> ended;
  TrajectoryCommand command = world.trajectory("arm", {});
  command.ended = [&ended](const TrajectoryOutcome& outcome) { ended.push_back(outcome); };
  ASSERT_TRUE(world.call(std::move(command)).success);
  ASSERT_TRUE(world.runUntil([&] { return !ended.empty(); }, 1s));
  EXPECT_EQ(ended.front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended.front().message,
            "arm: shoulder is not stopped by this: home runs, which halt stops");
}

TEST_F(GroupOutcomeTest, OneIsJudgedByTolerancesOfItsOwn) {
  TrajectoryCommand command = world.trajectory("arm", {{{1.0, -0.5}, 1.0}});
  command.tolerances.joints["elbow"].trajectory = 1e-9;
  const Outcomes ended = send(std::move(command));
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 3s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::path_tolerance_violated);
  EXPECT_EQ(ended->front().joint, "elbow");
  const Outcomes next = send(0.5, 0.5, 1.0);  // as configured again
  ASSERT_TRUE(world.runUntil([&] { return !next->empty(); }, 3s));
  EXPECT_EQ(next->front().end, TrajectoryEnd::reached) << next->front().message;
}

TEST_F(GroupOutcomeTest, OneThatWaitsIsStoppedAtOnce) {
  const Outcomes waits = send(1.0, -0.5, 1.0, world.now + 2s);
  world.run(100ms);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  ASSERT_TRUE(world.runUntil([&] { return !waits->empty(); }, 100ms));
  EXPECT_EQ(waits->front().end, TrajectoryEnd::stopped);
}

TEST_F(GroupOutcomeTest, ARefusedOneIsAnsweredAndHasNoEnd) {
  const Outcomes ended = send(1.0, 100.0, 1.0);  // beyond the elbow's limit
  EXPECT_FALSE(answer.success);
  world.run(2s);
  EXPECT_TRUE(ended->empty());
  EXPECT_EQ(world.drives[0].position, 0);
}

TEST_F(GroupOutcomeTest, AFaultNamesItsJoint) {
  const Outcomes ended = send(1.0, -0.5, 1.0);
  world.run(300ms);
  world.drives[1].fault(0x8611);
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 2s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::path_tolerance_violated);
  EXPECT_EQ(ended->front().joint, "elbow");
  EXPECT_THAT(ended->front().message, HasSubstr("elbow (node 2): fault 0x8611"));
}

TEST_F(GroupOutcomeTest, TheEndOfTheProgramStopsWhatRuns) {
  const Outcomes ended = send(1.0, -0.5, 1.0);
  world.run(300ms);
  world.network.beginShutdown(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.network.shutDown(); }, 3s));
  ASSERT_EQ(ended->size(), 1u);
  EXPECT_EQ(ended->front().end, TrajectoryEnd::stopped);
}

struct GroupGoalTest : GroupOutcomeTest {
  GroupGoalTest() : GroupOutcomeTest(robotWithGoal(0.01)) {}
};

TEST_F(GroupGoalTest, AMissedGoalSaysWhichJointAndByHowMuch) {
  const Outcomes ended = send(0.5, -0.5, 1.0);
  world.drives[1].disturbance = 2000;  // 0.02 rad off
  ASSERT_TRUE(world.runUntil([&] { return !ended->empty(); }, 3s));
  EXPECT_EQ(ended->front().end, TrajectoryEnd::failed);
  EXPECT_EQ(ended->front().code, TrajectoryErrorCode::goal_tolerance_violated);
  EXPECT_EQ(ended->front().joint, "elbow");
  EXPECT_NEAR(ended->front().off, 0.02, 1e-3);
}

}  // namespace
}  // namespace cia402::bus
