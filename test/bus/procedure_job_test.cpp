// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/procedure_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::homingOfOrder;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

config::RobotConfig homingRobot() {
  config::RobotConfig robot = test::testRobot();
  robot.axes[0].homing = homingOfOrder(1);
  robot.axes[1].homing = homingOfOrder(0);
  return robot;
}

struct ProcedureJobTest : testing::Test {
  RobotWorld world{homingRobot()};
  ProcedureJobTest() { world.enable(); }
};

TEST_F(ProcedureJobTest, HomesAxesOfALowerOrderFirst) {
  const Answer answer = world.call(ProcedureKind::home);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("home done on 2 of 2 axes"));
  ASSERT_TRUE(world.drives[0].homing_began && world.drives[1].homing_began);
  // The fake drive takes 100 ms; the shoulder waits for its result.
  EXPECT_GT(*world.drives[0].homing_began, *world.drives[1].homing_began + 100ms);
  EXPECT_TRUE(world.axis(0).state().homed && world.axis(1).state().homed);
}

TEST_F(ProcedureJobTest, LeavesLaterOrdersUnstartedAfterAFailureAndSaysSo) {
  world.drives[1].homing_fails = true;
  const Answer answer = world.call(ProcedureKind::home);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("home done on 0 of 2 axes"),
                                    HasSubstr("elbow (node 2): homing stopped"),
                                    HasSubstr("shoulder: not started, for another axis failed")));
  EXPECT_FALSE(world.drives[0].homing_began);
}

TEST_F(ProcedureJobTest, AnAxisThatIsStoppedWhileItWaitsForItsTurnIsNotMoved) {
  const auto home = world.begin(ProcedureKind::home);
  world.run(20ms);
  drive::ProcedureRequest halt;
  halt.kind = ProcedureKind::halt;
  ASSERT_TRUE(world.axis(0).start(halt, world.now));
  const Answer answer = world.wait(home);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("shoulder: not started, for halt was called"));
  world.run(1s);
  EXPECT_FALSE(world.drives[0].homing_began);
}

TEST_F(ProcedureJobTest, HomesOneAxisAloneWhateverItsOrder) {
  const Answer answer = world.call(ProcedureKind::home, "shoulder");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("shoulder: homed"));
  EXPECT_FALSE(world.drives[1].homing_began);
}

TEST_F(ProcedureJobTest, TellsThatAProcedureWasStoppedByAnother) {
  world.drives[1].homing_is_slow = true;
  const auto home = world.begin(ProcedureKind::home, "elbow");
  world.run(200ms);
  ASSERT_TRUE(home->empty());
  const Answer halted = world.call(ProcedureKind::halt, "elbow");
  EXPECT_TRUE(halted.success) << halted.message;
  ASSERT_EQ(home->size(), 1u);
  EXPECT_FALSE(home->front().success);
  EXPECT_THAT(home->front().message,
              AllOf(HasSubstr("elbow"), HasSubstr("home"), HasSubstr("halt")));
}

TEST_F(ProcedureJobTest, RefusesWhatTheAxisRefusesWithItsSentence) {
  world.drives[1].homing_is_slow = true;
  const auto home = world.begin(ProcedureKind::home, "elbow");
  world.run(100ms);
  const Answer second = world.call(ProcedureKind::enable, "elbow");
  EXPECT_FALSE(second.success);
  EXPECT_THAT(second.message, HasSubstr("elbow (node 2): enable is refused while home runs"));
}

TEST_F(ProcedureJobTest, DoesOnAllAxesWhatItCanAndNamesThoseThatFail) {
  world.drives[0].silent = true;
  ASSERT_TRUE(
      world.runUntil([&] { return world.axis(0).state().health == fieldbus::Health::lost; }));
  const Answer answer = world.call(ProcedureKind::disable);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("disable done on 1 of 2 axes"), HasSubstr("; shoulder (node 1): ")));
  EXPECT_FALSE(world.drives[1].enabled());
}

TEST_F(ProcedureJobTest, WhatWaitsBeginsNoMoreOnceTheBusWasLost) {
  const auto home = world.begin(ProcedureKind::home);
  // The elbow is homed, and the job has not looked yet: the shoulder would be next.
  while (world.axis(1).procedure().running) {
    world.run(1ms);
    world.axis(1).readFeedback(world.now);
    world.axis(1).update(world.now);
  }
  ASSERT_TRUE(world.axis(1).procedure().success && home->empty());
  world.network.busLost("can0 is bus-off", world.now);
  world.network.busBack(false, world.now);
  world.run(1s);
  EXPECT_FALSE(world.drives[0].homing_began);
  ASSERT_EQ(home->size(), 1u);
  EXPECT_FALSE(home->front().success);
  EXPECT_THAT(home->front().message, HasSubstr("shoulder: not started, for can0 is bus-off"));
}

TEST_F(ProcedureJobTest, RepliesOnceOnly) {
  const auto answers = world.begin(ProcedureKind::enable);
  world.run(1s);
  EXPECT_EQ(answers->size(), 1u);
}

TEST_F(ProcedureJobTest, GivesTheResultOfAProcedureThatEndedJustBeforeTheNextBegan) {
  const auto first = world.begin(ProcedureKind::disable, "elbow");
  // Its end is noticed by the axis while the job has not looked yet.
  while (world.axis(1).procedure().running) {
    world.run(1ms);
    world.axis(1).readFeedback(world.now);
    world.axis(1).update(world.now);
  }
  ASSERT_TRUE(first->empty());
  const Answer second = world.call(ProcedureKind::enable, "elbow");
  EXPECT_TRUE(second.success) << second.message;
  ASSERT_EQ(first->size(), 1u);
  EXPECT_TRUE(first->front().success) << first->front().message;
}

TEST_F(ProcedureJobTest, RecoverNamesEachAxisThatTakesNoCommandAndTheCallThatHelps) {
  ASSERT_TRUE(world.call(ProcedureKind::home).success);
  ASSERT_TRUE(world.call(ProcedureKind::recover).success);
  ASSERT_TRUE(world.call(ProcedureKind::halt, "elbow").success);
  const Answer answer = world.call(ProcedureKind::recover);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "recover done on 1 of 2 axes; elbow is halted: enable");
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  EXPECT_TRUE(world.call(ProcedureKind::recover).success);
}

TEST_F(ProcedureJobTest, RecoverTellsWhatIsTrueWhenItsLastAxisHasEnded) {
  ASSERT_TRUE(world.call(ProcedureKind::home).success);
  world.drives[1].fault(0x8611);
  world.run(20ms);
  const auto recovering = world.begin(ProcedureKind::recover);
  world.run(200ms);  // the elbow's fault reset takes longer; the shoulder was left alone
  ASSERT_TRUE(recovering->empty());
  ASSERT_TRUE(world.call(ProcedureKind::disable, "shoulder").success);
  const Answer answer = world.wait(recovering);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("shoulder is not enabled (switch on disabled): enable"));
}

TEST_F(ProcedureJobTest, ClearFaultsOfAllTellsOfAnAxisThatHasFaultedMeanwhile) {
  ASSERT_TRUE(world.call(ProcedureKind::home).success);
  world.drives[1].fault(0x8611);
  world.run(20ms);
  const auto clearing = world.begin(ProcedureKind::clear_faults);
  world.run(200ms);  // the elbow's fault reset takes longer; the shoulder had none
  ASSERT_TRUE(clearing->empty());
  world.drives[0].fault(0x2340);
  const Answer answer = world.wait(clearing);
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, AllOf(HasSubstr("clear_faults done on 1 of 2 axes"),
                                    HasSubstr("shoulder: clear_faults had succeeded, but it is "
                                              "fault")));
  EXPECT_EQ(world.drives[1].statusword & 0x0008, 0) << "the elbow's is cleared";
}

TEST_F(ProcedureJobTest, EnableOfAllTellsOfAnAxisThatWasDisabledMeanwhile) {
  ASSERT_TRUE(world.call(ProcedureKind::disable).success);
  world.drives[1].deaf_to_controlword = true;
  const auto enabling = world.begin(ProcedureKind::enable);
  ASSERT_TRUE(world.runUntil([&] { return world.drives[0].enabled(); }));
  world.run(20ms);
  ASSERT_TRUE(world.call(ProcedureKind::disable, "shoulder").success);
  ASSERT_TRUE(enabling->empty()) << enabling->front().message;
  world.drives[1].deaf_to_controlword = false;
  const Answer answer = world.wait(enabling);
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("enable done on 1 of 2 axes"),
                    HasSubstr("shoulder: enable had succeeded, but disable was called: it is "
                              "switch on disabled")));
  EXPECT_FALSE(world.drives[0].enabled());
  EXPECT_TRUE(world.drives[1].enabled());
}

TEST_F(ProcedureJobTest, EnableOfAllWaitsForNewsOfAnAxisThatHasFallenSilent) {
  ASSERT_TRUE(world.call(ProcedureKind::disable).success);
  world.drives[1].deaf_to_controlword = true;
  const auto enabling = world.begin(ProcedureKind::enable);
  ASSERT_TRUE(world.runUntil([&] { return world.axis(0).procedure().success; }));
  world.drives[0].silent = true;
  world.run(5 * test::kPeriod);
  ASSERT_TRUE(world.axis(0).state().feedback_valid) << "it is not missed yet";
  world.drives[1].deaf_to_controlword = false;
  ASSERT_TRUE(world.runUntil([&] { return world.drives[1].enabled(); }));
  const Answer answer = world.wait(enabling);
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("enable done on 1 of 2 axes; shoulder"));
}

TEST_F(ProcedureJobTest, StopsOfAllTellOfAnAxisThatMovesMeanwhile) {
  for (const ProcedureKind kind : {ProcedureKind::disable, ProcedureKind::quick_stop}) {
    ASSERT_TRUE(world.call(ProcedureKind::disable).success);
    ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
    world.drives[1].deaf_to_controlword = true;
    const auto stopping = world.begin(kind);  // the shoulder's ends at once
    world.run(50ms);
    world.drives[1].deaf_to_controlword = false;
    for (int i = 0; i < 300 && stopping->empty(); ++i) {
      world.drives[0].disturbance += 1000;  // 1 rad/s by nobody's will
      world.run(10ms);
    }
    ASSERT_EQ(stopping->size(), 1U);
    EXPECT_FALSE(stopping->front().success) << stopping->front().message;
    EXPECT_THAT(stopping->front().message,
                AllOf(HasSubstr("done on 1 of 2 axes"),
                      HasSubstr(std::string("shoulder: ") + toString(kind) +
                                " had succeeded, but it moves")));
    EXPECT_THAT(stopping->front().message, Not(HasSubstr("velocity"))) << "which is not known";
    world.run(500ms);
  }
}

TEST_F(ProcedureJobTest, DisableOfAllTellsOfAnAxisThatWasEnabledMeanwhile) {
  world.drives[1].deaf_to_controlword = true;
  const auto disabling = world.begin(ProcedureKind::disable);
  ASSERT_TRUE(world.runUntil([&] { return !world.drives[0].enabled(); }));
  world.run(20ms);
  ASSERT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
  ASSERT_TRUE(disabling->empty()) << disabling->front().message;
  world.drives[1].deaf_to_controlword = false;
  const Answer answer = world.wait(disabling);
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("shoulder: disable had succeeded, but enable was called"));
}

TEST_F(ProcedureJobTest, SetsTheModeOfAllAxesOrOfNone) {
  world.drives[1].keeps_mode = true;
  const Answer answer = world.call(ProcedureKind::set_mode, "", "cyclic_velocity");
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, AllOf(HasSubstr("set_mode done on 0 of 2 axes"),
                                    HasSubstr("elbow (node 2): mode cyclic_velocity was not taken"),
                                    HasSubstr("shoulder: another axis failed; it is back in mode "
                                              "cyclic_position")));
  EXPECT_EQ(world.drives[0].mode, 8);
  EXPECT_EQ(world.drives[1].mode, 8);
  EXPECT_TRUE(world.drives[0].enabled());
  world.drives[1].keeps_mode = false;
  EXPECT_TRUE(world.call(ProcedureKind::set_mode, "", "cyclic_velocity").success);
  EXPECT_EQ(world.drives[0].mode, 9);
  EXPECT_EQ(world.drives[1].mode, 9);
}

TEST_F(ProcedureJobTest, DoesNotBeginToSetModesWhereOneAxisCannot) {
  world.drives[1].silent = true;
  ASSERT_TRUE(
      world.runUntil([&] { return world.axis(1).state().health == fieldbus::Health::lost; }));
  const auto setting = world.begin(ProcedureKind::set_mode, "", "cyclic_velocity");
  bool changed = false;
  world.runUntil([&] {
    changed |= world.drives[0].mode != 8;
    return !setting->empty();
  });
  ASSERT_EQ(setting->size(), 1u);
  EXPECT_FALSE(setting->front().success);
  EXPECT_THAT(setting->front().message,
              AllOf(HasSubstr("elbow (node 2): cannot set the mode"),
                    HasSubstr("shoulder: not started, for another axis cannot")));
  EXPECT_FALSE(changed);
}

TEST_F(ProcedureJobTest, SetsNoModeBackOnAnAxisThatSomebodyStopped) {
  world.drives[1].keeps_mode = true;
  const auto setting = world.begin(ProcedureKind::set_mode, "", "cyclic_velocity");
  ASSERT_TRUE(world.runUntil([&] { return !world.axis(0).procedure().running; }));
  ASSERT_TRUE(world.call(ProcedureKind::disable, "shoulder").success);
  const Answer answer = world.wait(setting);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("shoulder: it stays in mode cyclic_velocity, as disable "
                                        "was called"));
  EXPECT_FALSE(world.drives[0].enabled());
}

TEST_F(ProcedureJobTest, AStopFromBeforeTheCallDoesNotCount) {
  ASSERT_TRUE(world.call(ProcedureKind::home).success);
  ASSERT_TRUE(world.call(ProcedureKind::halt, "shoulder").success);
  world.drives[0].homing_began.reset();
  const Answer answer = world.call(ProcedureKind::home);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(world.drives[0].homing_began);
}

TEST_F(ProcedureJobTest, AStopOfAllDoesNotWaitForNewsOfAnAxisThatHasFallenSilent) {
  world.drives[1].deaf_to_controlword = true;
  const auto disabling = world.begin(ProcedureKind::disable);
  ASSERT_TRUE(world.runUntil([&] { return world.axis(0).procedure().success; }));
  world.drives[0].silent = true;
  world.run(5 * test::kPeriod);
  world.drives[1].deaf_to_controlword = false;
  ASSERT_TRUE(world.runUntil([&] { return world.axis(1).procedure().success; }));
  world.run(1ms);
  ASSERT_TRUE(world.axis(0).state().feedback_valid) << "it is not missed yet";
  ASSERT_EQ(disabling->size(), 1u);
  EXPECT_TRUE(disabling->front().success) << disabling->front().message;
}

TEST_F(ProcedureJobTest, WhatWaitsIsWithdrawnWhileSyncIsInTrouble) {
  const auto home = world.begin(ProcedureKind::home);
  world.run(50ms);
  world.network.receive(can::Frame(0x080, {}), world.now, world.now);  // of another device
  const Answer answer = world.wait(home);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("home done on 1 of 2 axes"),
                                    HasSubstr("shoulder: not started, for another device produces "
                                              "SYNC")));
  EXPECT_FALSE(world.drives[0].homing_began);
}

TEST_F(ProcedureJobTest, WhatStopsNothingWithdrawsNothing) {
  const auto home = world.begin(ProcedureKind::home);
  world.run(20ms);
  EXPECT_TRUE(world.call(ProcedureKind::enable, "shoulder").success) << "it is that already";
  EXPECT_TRUE(world.wait(home).success) << home->front().message;
  EXPECT_TRUE(world.drives[0].homing_began);
}

TEST_F(ProcedureJobTest, OfOneAxisWhoseModeWasNotSetSaysNoMoreThanTheAxis) {
  world.drives[1].keeps_mode = true;
  const auto setting = world.begin(ProcedureKind::set_mode, "elbow", "cyclic_velocity");
  world.run(50ms);
  ASSERT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  ASSERT_EQ(setting->size(), 1u);
  EXPECT_EQ(setting->front().message, world.axis(1).previousProcedure().message);
}

TEST(ProcedureJob, RefusesAnUnknownAxisAndHomingWithoutAnyHomingSection) {
  RobotWorld world;
  world.boot();
  EXPECT_EQ(world.call(ProcedureKind::enable, "wrist").message, "there is no axis \"wrist\"");
  EXPECT_THAT(world.call(ProcedureKind::home).message, HasSubstr("no axis has a `homing` section"));
}

}  // namespace
}  // namespace cia402::bus
