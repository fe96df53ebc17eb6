// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Procedures on the axes of a group: where it makes sense on all of them or on none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

/// Shoulder and elbow are the arm; the wrist is not.
struct GroupProcedure : testing::Test {
  GroupProcedure() { world.boot(); }
  static config::RobotConfig robot() {
    config::RobotConfig robot = test::testRobot();
    test::addAxis(robot, "wrist", 3);
    robot.axes[0].homing = test::homingOfOrder(1);
    robot.axes[2].homing = test::homingOfOrder(0);
    for (std::size_t i : {0, 2}) robot.axes[i].homing->required = false;
    return robot;
  }
  std::shared_ptr<std::vector<Answer>> begin(ProcedureKind kind, const std::string& mode = {}) {
    ProcedureCommand command;
    command.group = "arm";
    command.request.kind = kind;
    command.request.mode = mode;
    return world.begin(command);
  }
  Answer call(ProcedureKind kind, const std::string& mode = {}) {
    return world.wait(begin(kind, mode));
  }
  /// Which motors have power.
  std::vector<bool> enabled() const {
    return {world.drives[0].enabled(), world.drives[1].enabled(), world.drives[2].enabled()};
  }
  using States = std::vector<bool>;
  test::RobotWorld world{robot()};
};

TEST_F(GroupProcedure, ConcernsItsAxesAlone) {
  const Answer answer = call(ProcedureKind::enable);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("enable done on 2 of 2 axes"));
  EXPECT_EQ(enabled(), (States{true, true, false}));
  ASSERT_TRUE(world.call(ProcedureKind::enable, "wrist").success);
  EXPECT_TRUE(call(ProcedureKind::set_mode, "cyclic_velocity").success);
  EXPECT_EQ(world.drives[0].mode, 9);
  EXPECT_EQ(world.drives[1].mode, 9);
  EXPECT_EQ(world.drives[2].mode, 8);
  EXPECT_TRUE(call(ProcedureKind::disable).success);
  EXPECT_EQ(enabled(), (States{false, false, true}));
}

TEST_F(GroupProcedure, AHaltOfItStopsNoOtherAxis) {
  ASSERT_TRUE(world.call(ProcedureKind::enable).success);
  for (std::size_t i : {0, 1, 2}) ASSERT_TRUE(world.axis(i).command(0.5, world.now));
  world.run(100ms);
  const Answer answer = call(ProcedureKind::halt);
  EXPECT_TRUE(answer.success) << answer.message;
  world.run(2s);
  EXPECT_LT(world.drives[0].position, 30000);
  EXPECT_LT(world.drives[1].position, 30000);
  EXPECT_EQ(world.drives[2].position, 50000);
}

TEST_F(GroupProcedure, NothingIsSwitchedOnWhereOneAxisCannotBe) {
  world.drives[1].fault(0x8611);
  world.run(20ms);
  const auto answers = begin(ProcedureKind::enable);
  bool any = false;
  world.runUntil([&] {
    any |= world.drives[0].enabled();
    return !answers->empty();
  });
  ASSERT_EQ(answers->size(), 1U);
  EXPECT_FALSE(answers->front().success);
  EXPECT_THAT(answers->front().message,
              AllOf(HasSubstr("enable done on 0 of 2 axes"), HasSubstr("elbow (node 2)"),
                    HasSubstr("shoulder: not started, for another axis cannot")));
  EXPECT_FALSE(any);
}

TEST_F(GroupProcedure, WhatWasSwitchedOnIsSwitchedOffAgainWhereOneAxisFails) {
  world.drives[1].deaf_to_controlword = true;
  const Answer answer = call(ProcedureKind::enable);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("enable done on 0 of 2 axes"),
                    HasSubstr("shoulder: another axis failed; it is disabled again")));
  EXPECT_EQ(enabled(), (States{false, false, false}));
}

TEST_F(GroupProcedure, WhatWasOnBeforeStaysOn) {
  ASSERT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
  world.drives[1].deaf_to_controlword = true;
  const Answer answer = call(ProcedureKind::enable);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("shoulder: it was enabled before, and stays so"));
  EXPECT_EQ(enabled(), (States{true, false, false}));
}

TEST_F(GroupProcedure, WhatSomebodyStoppedMeanwhileIsLeftAlone) {
  world.drives[1].deaf_to_controlword = true;
  const auto answers = begin(ProcedureKind::enable);
  ASSERT_TRUE(world.runUntil([&] { return world.drives[0].enabled(); }));
  ASSERT_TRUE(world.runUntil([&] { return !world.axis(0).procedure().running; }));
  ASSERT_TRUE(world.call(ProcedureKind::halt, "shoulder").success);
  const Answer answer = world.wait(answers);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("shoulder: halt was called"));
  EXPECT_TRUE(world.drives[0].enabled()) << "who halted it wants it held";
}

TEST_F(GroupProcedure, RecoverBringsItsFaultedAxesBackAndLeavesAllOthersAlone) {
  ASSERT_TRUE(world.call(ProcedureKind::enable).success);
  world.drives[1].fault(0x8611);
  world.drives[2].fault(0x8611);
  world.run(200ms);
  const std::size_t before = world.sentWithId(0x201).size();
  const Answer answer = call(ProcedureKind::recover);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("recover done on 2 of 2 axes"));
  EXPECT_EQ(enabled(), (States{true, true, false}));
  EXPECT_EQ(world.drives[2].statusword & 0x4F, 0x08) << "it is in fault, and not of the group";
  const auto sent = world.sentWithId(0x201);
  ASSERT_GT(sent.size(), before);
  for (std::size_t i = before; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].frame.data[0], 0x0F) << "it was enabled, and stays so";
  }
}

TEST_F(GroupProcedure, RecoverNamesTheAxisThatDoesNotComeBack) {
  ASSERT_TRUE(world.call(ProcedureKind::enable).success);
  world.drives[1].fault(0x8611);
  world.drives[1].deaf_to_controlword = true;
  world.run(200ms);
  const Answer answer = call(ProcedureKind::recover);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("recover done on 1 of 2 axes"), HasSubstr("elbow (node 2)")));
  EXPECT_EQ(enabled(), (States{true, false, true}));
}

TEST_F(GroupProcedure, HomesThoseThatHaveAHoming) {
  ASSERT_TRUE(world.call(ProcedureKind::enable).success);
  const Answer answer = call(ProcedureKind::home);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(world.drives[0].homing_began.has_value());
  EXPECT_FALSE(world.drives[1].homing_began.has_value());
  EXPECT_FALSE(world.drives[2].homing_began.has_value()) << "it is not of the group";
}

TEST_F(GroupProcedure, OneWithoutAnyHomingHasNothingToHome) {
  config::RobotConfig unhomed = robot();
  unhomed.axes[0].homing.reset();
  test::RobotWorld other(unhomed);
  other.boot();
  ProcedureCommand home;
  home.group = "arm";
  home.request.kind = ProcedureKind::home;
  const Answer answer = other.call(home);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "nothing to do: no axis of arm has a `homing` section");
}

TEST_F(GroupProcedure, OneThatIsNotThereIsRefused) {
  ProcedureCommand command;
  command.group = "leg";
  command.request.kind = ProcedureKind::enable;
  const Answer answer = world.call(command);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "there is no group `leg`");
}

}  // namespace
}  // namespace cia402::bus
