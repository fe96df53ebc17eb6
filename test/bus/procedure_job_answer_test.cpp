// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What is answered of procedures on several axes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct ProcedureAnswer : testing::Test {
  ProcedureAnswer() { world.enable(); }
  void start(std::size_t axis, ProcedureKind kind) {
    drive::ProcedureRequest request;
    request.kind = kind;
    ASSERT_TRUE(world.axis(axis).start(request, world.now));
  }
  RobotWorld world;
};

TEST_F(ProcedureAnswer, OfAHaltTellsOfAnAxisOfWhichNothingIsKnownAnyMore) {
  const auto elbowMoves = [&](Duration duration) {
    for (const Time end = world.now + duration; world.now < end; world.run(4ms)) {
      world.drives[1].disturbance += 200;  // 0.5 rad/s
    }
  };
  elbowMoves(20ms);
  const auto halting = world.begin(ProcedureKind::halt);
  elbowMoves(100ms);
  ASSERT_TRUE(world.axis(0).procedure().success);
  world.drives[0].tpdo_bytes = 0;
  elbowMoves(100ms);
  ASSERT_FALSE(world.axis(0).state().feedback_valid);
  ASSERT_TRUE(halting->empty()) << halting->front().message;
  const Answer answer = world.wait(halting);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              HasSubstr("shoulder: halt had succeeded, but nothing tells whether it stands"));
}

TEST_F(ProcedureAnswer, OfAHaltIsNoneTheWorseForAnotherStop) {
  world.drives[1].disturbance = 400;
  world.run(4ms);
  const auto halting = world.begin(ProcedureKind::halt);
  const auto elbowMoves = [&](Duration duration) {
    for (const Time end = world.now + duration; world.now < end; world.run(4ms)) {
      world.drives[1].disturbance += 200;  // 0.5 rad/s
    }
  };
  elbowMoves(100ms);
  ASSERT_TRUE(world.axis(0).procedure().success);
  start(0, ProcedureKind::disable);
  elbowMoves(100ms);
  ASSERT_FALSE(world.drives[0].enabled());
  ASSERT_TRUE(halting->empty()) << halting->front().message;
  const Answer answer = world.wait(halting);
  EXPECT_TRUE(answer.success) << answer.message;
}

// The shoulder has no fault and is done at once; it falls silent while the elbow's is worked at.
void tellsOfSilenceAtClearedFaults(Duration silence, bool is_noticed) {
  RobotWorld world;
  world.enable();
  world.drives[1].fault(0x8611);
  world.run(20ms);
  world.drives[1].deaf_to_controlword = true;
  const auto clearing = world.begin(ProcedureKind::clear_faults);
  ASSERT_TRUE(world.runUntil([&] { return world.axis(0).procedure().success; }, 100ms));
  world.drives[0].tpdo_bytes = 0;
  world.run(silence);
  ASSERT_EQ(world.axis(0).state().feedback_valid, !is_noticed);
  ASSERT_TRUE(clearing->empty()) << clearing->front().message;
  world.drives[1].deaf_to_controlword = false;
  const Answer answer = world.wait(clearing);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              HasSubstr("shoulder: clear_faults had succeeded, but it gives no fresh statusword "
                        "and position any more: recover"));
}

TEST(ProcedureAnswerOfClearedFaults, TellsOfAnAxisThatFellSilentMeanwhile) {
  tellsOfSilenceAtClearedFaults(200ms, true);
}

TEST(ProcedureAnswerOfClearedFaults, WaitsForAnAxisThatHasJustFallenSilent) {
  tellsOfSilenceAtClearedFaults(12ms, false);
}

TEST_F(ProcedureAnswer, OfARecoverThatLeavesTheAxisAloneComesAtOnce) {
  const auto recovering = world.begin(ProcedureKind::recover, "elbow");
  ASSERT_EQ(recovering->size(), 1u);
  EXPECT_TRUE(recovering->front().success) << recovering->front().message;
}

TEST_F(ProcedureAnswer, NamesWhatASuccessLeavesToSay) {
  world.drives[0].fault(0x8611);
  world.run(20ms);
  const Answer answer = world.call(ProcedureKind::quick_stop);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, AllOf(HasSubstr("quick_stop done on 2 of 2 axes"),
                                    HasSubstr("; shoulder: no motion is commanded; ")));
}

TEST_F(ProcedureAnswer, IsThatItWasReplacedThoughTheOneThatDidSoIsReplacedItself) {
  world.drives[1].deaf_to_controlword = true;
  const auto disabling = world.begin(ProcedureKind::disable, "elbow");
  world.run(20ms);
  start(1, ProcedureKind::quick_stop);
  start(1, ProcedureKind::halt);
  world.run(5ms);
  ASSERT_EQ(disabling->size(), 1u);
  EXPECT_FALSE(disabling->front().success);
  EXPECT_EQ(disabling->front().message, "elbow: disable was replaced by halt");
}

TEST_F(ProcedureAnswer, OfAModeThatCannotBeSetBackSaysSoAfterOneTry) {
  world.drives[1].keeps_mode = true;
  const auto setting = world.begin(ProcedureKind::set_mode, "", "cyclic_velocity");
  ASSERT_TRUE(world.runUntil([&] { return world.axis(0).procedure().success; }));
  world.drives[0].keeps_mode = true;
  const Answer answer = world.wait(setting);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("set_mode done on 0 of 2 axes"),
                    HasSubstr("shoulder: another axis failed; it was not set back, it is in mode "
                              "cyclic_velocity: shoulder (node 1): mode cyclic_position was not "
                              "taken")));
}

TEST(ProcedureAnswerOfAnOptionalDrive, SaysThatItWasLeftOut) {
  config::RobotConfig config = test::testRobot();
  config.devices[1].boot.optional = true;
  for (const bool is_there_a_third : {false, true}) {
    if (is_there_a_third) test::addAxis(config, "wrist", 3);
    RobotWorld world(config);
    world.drives[1].silent = true;
    world.network.start(world.now);
    world.run(5s);
    const Answer answer = world.call(ProcedureKind::enable);
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_THAT(answer.message, testing::EndsWith("; elbow is optional and not there, it was left "
                                                  "out"));
    EXPECT_TRUE(world.drives[0].enabled());
  }
}

// A drive that comes back stays disabled until somebody asks anew.
TEST(ProcedureAnswerOfHoming, OfAnAxisThatWasLostWhileItWaitedIsThatItWasNotStarted) {
  for (const auto lost : {1000ms, 4000ms}) {  // it is back when its turn comes, or not
    config::RobotConfig config = test::testRobot();
    config.axes[0].homing = test::homingOfOrder(0);
    config.axes[1].homing = test::homingOfOrder(1);
    RobotWorld world(config);
    world.enable();
    world.drives[0].homing_is_slow = true;
    const auto homing = world.begin(ProcedureKind::home);
    world.run(200ms);
    world.drives[1].silent = true;
    world.run(lost);
    world.drives[1].silent = false;
    world.run(500ms);
    world.drives[0].homing_is_slow = false;
    const Answer answer = world.wait(homing);
    EXPECT_FALSE(answer.success);
    EXPECT_THAT(answer.message, HasSubstr("elbow: not started, for its drive was lost, or has "
                                          "restarted, while it waited: call it again"));
    world.run(3s);
    EXPECT_EQ(world.node(1).health(), fieldbus::Health::ready);
    EXPECT_FALSE(world.drives[1].enabled());
    EXPECT_FALSE(world.drives[1].homing_began);
  }
}

TEST(ProcedureAnswerOfHoming, NamesAxesOfOneOrderAsTheConfigurationDoes) {
  config::RobotConfig config = test::testRobot();
  for (drive::AxisConfig& axis : config.axes) axis.homing = test::homingOfOrder(0);
  RobotWorld world(config);
  world.enable();
  const Answer answer = world.call(ProcedureKind::home);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_LT(answer.message.find("shoulder"), answer.message.find("elbow")) << answer.message;
}

}  // namespace
}  // namespace cia402::bus
