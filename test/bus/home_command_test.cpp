// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/home_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

/// Shoulder (order 1), elbow and wrist (order 0), and a tool without homing; the arm is shoulder
/// and elbow.
config::RobotConfig robotToHome() {
  config::RobotConfig robot = test::testRobot();
  test::addAxis(robot, "wrist", 3);
  test::addAxis(robot, "tool", 4);
  robot.axes[0].homing = test::homingOfOrder(1);
  robot.axes[1].homing = test::homingOfOrder(0);
  robot.axes[2].homing = test::homingOfOrder(0);
  config::GroupConfig rest;
  rest.name = "rest";
  rest.joints = {"wrist", "tool"};
  config::GroupConfig tools;
  tools.name = "tools";
  tools.joints = {"tool"};
  robot.groups.push_back(rest);
  robot.groups.push_back(tools);
  return robot;
}

/// "axis:order" of each.
std::vector<std::string> planned(const std::vector<std::string>& names,
                                 const std::vector<int>& order = {}) {
  const config::RobotConfig robot = robotToHome();
  const auto plan = homingPlan(robot, names, order);
  if (!plan) return {plan.error().message};
  std::vector<std::string> texts;
  for (const HomingItem& item : *plan) {
    texts.push_back(robot.axes[item.axis].name + ":" + std::to_string(item.order));
  }
  return texts;
}

TEST(HomingPlan, TakesAllThatHaveAHomingAsConfiguredWhereNothingIsNamed) {
  EXPECT_THAT(planned({}), ElementsAre("shoulder:1", "elbow:0", "wrist:0"));
}

TEST(HomingPlan, TakesAxesAndThoseOfGroupsInTheOrderThatIsAskedFor) {
  EXPECT_THAT(planned({"wrist", "shoulder"}), ElementsAre("wrist:0", "shoulder:1"));
  EXPECT_THAT(planned({"arm"}), ElementsAre("shoulder:1", "elbow:0"));
  EXPECT_THAT(planned({"rest", "arm"}, {-5, 2}), ElementsAre("wrist:-5", "shoulder:2", "elbow:2"));
}

TEST(HomingPlan, TakesAnAxisOnceThatIsNamedTwice) {
  EXPECT_THAT(planned({"elbow", "arm"}), ElementsAre("elbow:0", "shoulder:1"));
  EXPECT_THAT(planned({"elbow", "arm"}, {3, 3}), ElementsAre("elbow:3", "shoulder:3"));
}

TEST(HomingPlan, SaysWhatMakesNoSense) {
  EXPECT_THAT(planned({"elbow", "arm"}, {1, 2}),
              ElementsAre("elbow is named twice, with the orders 1 and 2"));
  EXPECT_THAT(planned({"neck"}), ElementsAre("there is no axis or group \"neck\""));
  EXPECT_THAT(planned({"elbow", ""}), ElementsAre("there is no axis or group \"\""));
  EXPECT_THAT(planned({"tool"}),
              ElementsAre("tool has no `homing` section; set_position says where it stands"));
  EXPECT_THAT(planned({"tools"}),
              ElementsAre("nothing to do: no axis of tools has a `homing` section"));
  EXPECT_THAT(planned({"elbow"}, {1, 2}),
              ElementsAre("`order` has 2 numbers for 1 names in `axes`; give one for each name, or "
                          "none for the configured order"));
  EXPECT_THAT(planned({}, {1}), ElementsAre(HasSubstr("`order` has 1 numbers for 0 names")));
  const config::RobotConfig without = test::testRobot();
  const auto nothing = homingPlan(without, {}, {});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().message, "nothing to do: no axis has a `homing` section");
}

struct HomeCommandTest : testing::Test {
  using Answers = test::RobotWorld::Answers<ProcedureReport>;
  using Stage = ProcedureStage;
  HomeCommandTest() { world.enable(); }

  Answers home(const std::vector<std::string>& names, const std::vector<int>& order = {},
               std::uint64_t id = 7) {
    HomeCommand command;
    command.plan = homingPlan(world.network.config(), names, order).value();
    command.id = id;
    command.begun = [this] { ++begun; };
    progress = command.progress =
        std::make_shared<ProcedureProgress>(world.network.config().axes.size());
    return world.begin(command);
  }
  bool homing(std::size_t axis) const { return world.drives[axis].homing_began.has_value(); }
  std::vector<Stage> stages() const { return {progress->of(0), progress->of(1), progress->of(2)}; }

  test::RobotWorld world{robotToHome()};
  std::shared_ptr<ProcedureProgress> progress;
  int begun = 0;
};

TEST_F(HomeCommandTest, HomesInTheConfiguredOrderThoseOfOneOrderTogether) {
  const auto answers = home({});
  world.run(50ms);
  EXPECT_EQ(begun, 1);
  EXPECT_THAT(stages(), ElementsAre(Stage::waiting, Stage::running, Stage::running));
  EXPECT_EQ(world.drives[1].homing_began, world.drives[2].homing_began);
  const ProcedureReport answer = world.wait(answers);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_FALSE(answer.stopped);
  EXPECT_THAT(answer.message, HasSubstr("home done on 3 of 3 axes"));
  EXPECT_THAT(stages(), ElementsAre(Stage::succeeded, Stage::succeeded, Stage::succeeded));
  // The fake drive takes 100 ms.
  EXPECT_GT(*world.drives[0].homing_began, *world.drives[1].homing_began + 100ms);
  ASSERT_EQ(answer.axes.size(), 3U);
  for (const ProcedureReport::Axis& axis : answer.axes) {
    EXPECT_TRUE(axis.homed);
    EXPECT_THAT(axis.message,
                AllOf(HasSubstr(world.axis(axis.number).config().name), HasSubstr("homed by")));
  }
}

TEST_F(HomeCommandTest, HomesInTheOrderOfTheGoalInsteadOfTheConfiguredOne) {
  const ProcedureReport answer = world.wait(home({"arm", "wrist"}, {-1, 4}));
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(world.drives[0].homing_began, world.drives[1].homing_began);
  EXPECT_GT(*world.drives[2].homing_began, *world.drives[0].homing_began + 100ms);
}

TEST_F(HomeCommandTest, BeginsNothingWhereOneAxisCannot) {
  world.drives[0].fault(0x8611);  // whose turn would be the last
  world.run(20ms);
  const ProcedureReport answer = world.wait(home({}));
  EXPECT_FALSE(answer.success || answer.stopped);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("cannot home: shoulder"), HasSubstr("0x8611"),
                                    HasSubstr("elbow: not started, for another axis cannot")));
  world.run(1s);
  EXPECT_EQ(begun, 0);
  EXPECT_FALSE(homing(0) || homing(1) || homing(2));
}

TEST_F(HomeCommandTest, AFailureLeavesLaterOrdersUnstartedAndLetsThoseOfItsOwnEnd) {
  world.drives[1].homing_fails = true;
  const ProcedureReport answer = world.wait(home({}));
  EXPECT_FALSE(answer.success || answer.stopped);
  EXPECT_EQ(begun, 1);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("home done on 1 of 3 axes"),
                                    HasSubstr("elbow (node 2): homing stopped")));
  EXPECT_THAT(stages(), ElementsAre(Stage::failed, Stage::failed, Stage::succeeded));
  EXPECT_FALSE(homing(0));
  ASSERT_EQ(answer.axes.size(), 3U);
  for (const ProcedureReport::Axis& axis : answer.axes) EXPECT_EQ(axis.homed, axis.number == 2);
}

TEST_F(HomeCommandTest, EndsByTheDeadlineOfAnAxisThatNeverFindsHome) {
  world.drives[1].homing_is_slow = true;
  const Time before = world.now;
  const ProcedureReport answer = world.wait(home({}));
  EXPECT_FALSE(answer.success || answer.stopped);
  EXPECT_THAT(answer.message, HasSubstr("elbow (node 2): homing timed out after 5 s"));
  EXPECT_THAT(world.now - before, AllOf(testing::Gt(5s), testing::Lt(8s)));
  EXPECT_FALSE(homing(0));
  EXPECT_FALSE(world.drives[1].enabled());
}

TEST_F(HomeCommandTest, CancelledItStopsWhatRunsAndBeginsNoMore) {
  world.drives[1].homing_is_slow = world.drives[2].homing_is_slow = true;
  const auto answers = home({});
  world.run(200ms);
  ASSERT_TRUE(homing(1) && homing(2) && answers->empty());
  ASSERT_TRUE(world.call(CancelHomeCommand{8}).success);
  world.run(100ms);
  ASSERT_TRUE(answers->empty()) << "that was another one";
  ASSERT_TRUE(world.call(CancelHomeCommand{7}).success);
  const ProcedureReport answer = world.wait(answers);
  EXPECT_FALSE(answer.success);
  EXPECT_TRUE(answer.stopped);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("shoulder: not started, for the goal was cancelled"),
                    HasSubstr("elbow (node 2): homing stopped: it was cancelled: the client asked "
                              "for it; the axis stands at 0.000 rad and is not homed"),
                    HasSubstr("wrist (node 3): homing stopped: it was cancelled")));
  world.run(1s);
  EXPECT_FALSE(homing(0));
  for (const test::FakeDrive& drive : {world.drives[1], world.drives[2]}) {
    EXPECT_TRUE(drive.enabled());
    EXPECT_EQ(drive.mode, 8) << "that from before";
    EXPECT_EQ(drive.controlword & 0x0110, 0) << "neither start nor halt";
  }
  const ProcedureReport again = world.wait(home({"shoulder"}));
  EXPECT_TRUE(again.success) << again.message;
}

TEST_F(HomeCommandTest, CancelledAfterAnOrderWasHomedThatStaysHomed) {
  world.drives[0].homing_is_slow = true;
  const auto answers = home({});
  ASSERT_TRUE(world.runUntil([&] { return homing(0); }));
  ASSERT_TRUE(world.call(CancelHomeCommand{7}).success);
  const ProcedureReport answer = world.wait(answers);
  EXPECT_TRUE(answer.stopped);
  EXPECT_THAT(answer.message, HasSubstr("home done on 2 of 3 axes"));
  for (const ProcedureReport::Axis& axis : answer.axes) EXPECT_EQ(axis.homed, axis.number != 0);
}

TEST_F(HomeCommandTest, StoppedByAHaltItSaysSo) {
  world.drives[1].homing_is_slow = true;
  const auto answers = home({"elbow", "shoulder"});
  world.run(200ms);
  ASSERT_TRUE(world.call(ProcedureKind::halt, "elbow").success);
  const ProcedureReport answer = world.wait(answers);
  EXPECT_FALSE(answer.success);
  EXPECT_TRUE(answer.stopped);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("elbow (node 2): home was stopped by halt while searching home"),
                    HasSubstr("shoulder: not started, for another axis was stopped")));
  EXPECT_FALSE(homing(0));
}

TEST_F(HomeCommandTest, AMotorThatDoesNotComeToRestIsTold) {
  test::FakeDrive& elbow = world.drives[1];
  elbow.homing_is_slow = true;
  const auto answers = home({"elbow"});
  world.run(200ms);
  ASSERT_TRUE(world.call(CancelHomeCommand{7}).success);
  const Time cancelled = world.now;
  while (answers->empty() && world.now < cancelled + 20s) {
    elbow.disturbance += 500;  // its load drags it along
    world.run(10ms);
  }
  ASSERT_FALSE(answers->empty());
  EXPECT_GT(world.now - cancelled, 5s);
  EXPECT_TRUE(answers->front().stopped);
  EXPECT_THAT(answers->front().message, HasSubstr("; after 5 s it moves: see what drives it"));
}

TEST_F(HomeCommandTest, OneThatHasStoodAndIsLedOnKeepsNoAnswerBack) {
  test::FakeDrive &elbow = world.drives[1], &wrist = world.drives[2];
  elbow.homing_is_slow = wrist.homing_is_slow = true;
  const auto answers = home({"elbow", "wrist"});
  world.run(200ms);
  ASSERT_TRUE(world.call(CancelHomeCommand{7}).success);
  const Time cancelled = world.now;
  while (answers->empty() && world.now < cancelled + 20s) {
    (world.now < cancelled + 1s ? wrist : elbow).disturbance += 500;
    world.run(10ms);
  }
  ASSERT_FALSE(answers->empty());
  EXPECT_THAT(world.now - cancelled, AllOf(testing::Gt(1s), testing::Lt(2s)));
  EXPECT_THAT(answers->front().message, Not(HasSubstr("it moves")));
}

// It leads nothing on: the axis has to stand before.
TEST_F(HomeCommandTest, OneWhoseModeIsToChangeIsAwaitedAtRest) {
  test::FakeDrive& elbow = world.drives[1];
  elbow.homing_is_slow = true;
  const auto answers = home({"elbow"});
  world.run(200ms);
  const Time halted = world.now;
  decltype(world.begin(ProcedureKind::set_mode)) mode;
  const auto halt = world.begin(ProcedureKind::halt, "elbow");
  while (answers->empty() && world.now < halted + 20s) {
    if (world.now < halted + 1s) elbow.disturbance += 500;
    world.run(10ms);
    if (world.now == halted + 50ms) elbow.fault(0x8611);
    if (world.now == halted + 100ms)
      mode = world.begin(ProcedureKind::set_mode, "elbow", "cyclic_velocity");
  }
  ASSERT_FALSE(answers->empty());
  EXPECT_TRUE(mode);
  EXPECT_THAT(world.now - halted, AllOf(testing::Gt(1s), testing::Lt(2s)));
}

TEST_F(HomeCommandTest, AHaltOfOneAndAFailureOfAnotherAreAFailure) {
  world.drives[1].homing_is_slow = world.drives[2].homing_fails = true;
  const auto answers = home({});
  world.run(50ms);
  ASSERT_TRUE(world.call(ProcedureKind::halt, "elbow").success);
  EXPECT_FALSE(world.wait(answers).stopped);
}

TEST_F(HomeCommandTest, AFailureStaysOneThoughTheRestIsCancelled) {
  world.drives[1].homing_fails = world.drives[2].homing_is_slow = true;
  const auto answers = home({});
  world.run(500ms);
  ASSERT_TRUE(answers->empty()) << "the wrist still searches";
  ASSERT_TRUE(world.call(CancelHomeCommand{7}).success);
  EXPECT_FALSE(world.wait(answers).stopped);
}

TEST_F(HomeCommandTest, IsRefusedForAnAxisThatAnotherOneHomesOrIsGoingTo) {
  world.drives[2].homing_is_slow = true;
  const auto first = home({"wrist", "shoulder"});
  world.run(300ms);
  ASSERT_FALSE(homing(0));
  const std::string words =
      "home is refused: one that was called before has not ended, and shoulder is a part of it; "
      "wait for its end, or stop it by halt, quick_stop or disable";
  EXPECT_EQ(world.call(ProcedureKind::home, "shoulder").message, words);
  EXPECT_EQ(world.wait(home({"elbow", "shoulder"}, {}, 8)).message, words);
  EXPECT_EQ(world.call(ProcedureKind::home).message, words);
  EXPECT_EQ(begun, 1);
  EXPECT_FALSE(homing(0) || homing(1));
  const ProcedureReport other = world.wait(home({"elbow"}, {}, 9));
  EXPECT_TRUE(other.success) << "it has nothing to do with the first: " << other.message;
  EXPECT_TRUE(first->empty());
  ASSERT_TRUE(world.call(CancelHomeCommand{7}).success);
  (void)world.wait(first);
  EXPECT_TRUE(world.call(ProcedureKind::home, "shoulder").success) << "the first has ended";
}

TEST_F(HomeCommandTest, IsRefusedWhileTheBusIsOffAndEndsWithIt) {
  world.drives[1].homing_is_slow = true;
  const auto first = home({"elbow"});
  world.run(100ms);
  world.network.busLost("can0 is bus-off", world.now);
  const ProcedureReport refused = world.wait(home({"shoulder"}, {}, 8));
  EXPECT_THAT(refused.message, HasSubstr("can0 is bus-off"));
  EXPECT_EQ(begun, 1);
  const ProcedureReport answer = world.wait(first);
  EXPECT_FALSE(answer.success || answer.stopped);
  EXPECT_THAT(answer.message, HasSubstr("elbow (node 2): home was ended: can0 is bus-off"));
}

TEST_F(HomeCommandTest, TheEndOfTheProgramEndsIt) {
  world.drives[1].homing_is_slow = true;
  const auto answers = home({"elbow", "shoulder"});
  world.run(100ms);
  world.network.beginShutdown(world.now);
  ASSERT_EQ(answers->size(), 1U);
  EXPECT_FALSE(answers->front().success);
  EXPECT_THAT(answers->front().message, HasSubstr("ended by the shutdown of the driver"));
  world.run(2s);
  EXPECT_FALSE(homing(0));
}

}  // namespace
}  // namespace cia402::bus
