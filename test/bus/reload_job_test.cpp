// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Other limits under way: first the drives, then the driver, all or nothing.
#include "bus/canopen/reload_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using fieldbus::ObjectId;
using test::Bytes;
using test::RobotWorld;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using namespace std::chrono_literals;

constexpr ObjectId kWindow{0x6065, 0};  // 100000 counts of it are a radian
const Bytes kOfTwo = {0x40, 0x0D, 0x03, 0x00}, kOfOne = {0xA0, 0x86, 0x01, 0x00};

/// Its drives get the limit of velocity as their following error window.
config::RobotConfig limited(double velocity) {
  config::RobotConfig robot = test::testRobot();
  drive::NamedWrite write;
  write.object = "following_error_window";
  write.from = "limits.velocity";
  for (drive::AxisConfig& axis : robot.axes) {
    axis.limits.velocity = velocity;
    axis.writes = {write};
  }
  robot.groups[0].strict = true;  // else it is slowed down
  return robot;
}

struct ReloadScene : testing::Test {
  ReloadScene() {
    world.boot();
    world.run(500ms);  // seen to stand
  }

  static std::shared_ptr<Reload> to(const config::RobotConfig& next, bool at_rest = true) {
    const config::RobotConfig now = limited(2.0);
    const canopen::MasterConfig master = test::masterOf(now), next_master = test::masterOf(next);
    return makeReload({now, master}, {next, next_master}, at_rest);
  }
  RobotWorld::Answers<ReloadAnswer> begin(std::shared_ptr<Reload> reload = to(limited(1.0))) {
    for (test::FakeDrive& drive : world.drives) drive.written.clear();
    return world.begin(ReloadCommand{std::move(reload)});
  }
  ReloadAnswer reload() { return world.wait(begin()); }
  double fastest(std::size_t axis) { return *world.axis(axis).config().limits.velocity; }
  const Bytes& held(std::size_t drive) { return world.drives[drive].objects[kWindow]; }
  void expectNothingChanged() {
    for (const std::size_t i : {0U, 1U}) {
      EXPECT_EQ(fastest(i), 2.0);
      EXPECT_EQ(held(i), kOfTwo) << "drive " << i;
      EXPECT_EQ(*world.network.cycle().joints().all()[i]->description().limits.velocity, 2.0);
    }
    EXPECT_TRUE(world.call(ProcedureKind::enable).success) << "an axis is held still";
    EXPECT_TRUE(world.move({0.8, 0.8}, 1.0).success) << "1.5 rad/s at its peak";
  }
  RobotWorld world{limited(2.0)};
};

TEST_F(ReloadScene, ALimitGetsIntoTheDriveAndThenCounts) {
  ASSERT_EQ(held(0), kOfTwo);
  const ReloadAnswer answer = reload();
  EXPECT_TRUE(answer.success) << answer.message;
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_EQ(held(i), kOfOne);
    EXPECT_EQ(fastest(i), 1.0);
    EXPECT_THAT(world.drives[i].written, testing::ElementsAre(kWindow)) << "and nothing else";
  }
  ASSERT_TRUE(world.call(ProcedureKind::enable).success);
  const Answer refused = world.move({0.0, 0.8}, 1.0);  // 1.2 rad/s at its peak
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("elbow"), HasSubstr("limit")));
  EXPECT_TRUE(world.move({0.0, 0.5}, 1.0).success);
}

TEST_F(ReloadScene, AWriteOfTheAxisItselfIsNotUndoneByTheProfilesBeforeIt) {
  const auto own = [](double velocity) {
    config::RobotConfig robot = limited(velocity);
    for (drive::AxisConfig& axis : robot.axes) {
      drive::NamedWrite write = axis.writes[0];
      write.from.clear();
      write.raw = 77;
      axis.writes.push_back(write);
    }
    return robot;
  };
  const config::RobotConfig now = own(2.0), next = own(1.0);
  const canopen::MasterConfig master = test::masterOf(now), next_master = test::masterOf(next);
  const auto reload = makeReload({now, master}, {next, next_master}, true);
  ASSERT_EQ(reload->nodes.size(), 2U);
  EXPECT_THAT(reload->nodes[0].changed, IsEmpty());
  EXPECT_EQ(reload->nodes[0].all.size(), next_master.nodes[0].writes.size());
}

TEST_F(ReloadScene, AnEnabledAxisKeepsTheLimitsOfAll) {
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  const ReloadAnswer answer = reload();
  EXPECT_FALSE(answer.success);
  EXPECT_TRUE(answer.not_disabled);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("elbow (node 2): the axis is not disabled"),
                                    Not(HasSubstr("shoulder"))));
  expectNothingChanged();
}

TEST_F(ReloadScene, AnAxisOnItsWayToOperationDoes) {
  const auto enabling = world.begin(ProcedureKind::enable, "elbow");
  const ReloadAnswer answer = reload();
  EXPECT_TRUE(answer.not_disabled);
  EXPECT_THAT(answer.message, HasSubstr("elbow (node 2): enable runs"));
  EXPECT_TRUE(world.wait(enabling).success);
  expectNothingChanged();
}

TEST_F(ReloadScene, ADriveThatRefusesHasTheOthersTakeItBack) {
  world.drives[1].aborts[kWindow] = 0x06090030;
  const ReloadAnswer answer = reload();
  EXPECT_FALSE(answer.success);
  EXPECT_FALSE(answer.not_disabled);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("elbow (node 2)"), HasSubstr("6065"), HasSubstr("0x06090030")));
  EXPECT_THAT(world.drives[0].written, testing::ElementsAre(kWindow, kWindow)) << "there and back";
  world.drives[1].aborts.clear();
  expectNothingChanged();
}

TEST_F(ReloadScene, ADriveThatAnswersNothingDoes) {
  world.drives[1].sdo_silent = true;
  const ReloadAnswer answer = reload();
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("elbow (node 2)"));
  world.drives[1].sdo_silent = false;
  expectNothingChanged();
}

TEST_F(ReloadScene, NobodyIsEnabledMeanwhile) {
  const auto reloading = begin();
  const Answer refused = world.call(ProcedureKind::enable, "shoulder");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              AllOf(HasSubstr("a new limit is being written"), Not(HasSubstr("zero"))));
  EXPECT_TRUE(world.wait(reloading).success);
  EXPECT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
}

TEST_F(ReloadScene, OneAtATime) {
  const auto first = begin();
  const ReloadAnswer second = world.call(ReloadCommand{to(limited(0.5))});
  EXPECT_FALSE(second.success);
  EXPECT_TRUE(second.not_disabled);
  EXPECT_TRUE(world.wait(first).success);
  EXPECT_EQ(fastest(0), 1.0);
}

TEST_F(ReloadScene, ADriveThatIsAwayGetsItAsItComesBack) {
  world.drives[1].silent = true;
  ASSERT_TRUE(world.runUntil([&] { return !world.node(1).ready(); }));
  const ReloadAnswer answer = reload();
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(held(1), kOfTwo);
  world.drives[1].silent = false;
  ASSERT_TRUE(world.runUntil([&] { return world.node(1).ready(); }, 60s));
  EXPECT_EQ(held(1), kOfOne);
}

TEST_F(ReloadScene, ABootThatBeganMeanwhileBeginsAnewWithTheNewLimit) {
  const auto reloading = begin();
  world.node(1).boot(world.now, false);
  EXPECT_TRUE(world.wait(reloading).success);
  ASSERT_TRUE(world.runUntil([&] { return world.node(1).ready(); }));
  EXPECT_EQ(held(1), kOfOne);
}

TEST_F(ReloadScene, ADriveThatIsBeingConfiguredIsWaitedFor) {
  world.node(1).boot(world.now, true);
  const ReloadAnswer answer = reload();
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("elbow (node 2): its drive is being configured"));
}

TEST_F(ReloadScene, ABootThatHasWrittenTheOldLimitWritesTheNewOne) {
  std::vector<canopen::StartupWrite> writes = test::masterOf(limited(1.0)).nodes[1].writes;
  world.drives[1].objects[kWindow] = {0, 0, 0, 0};
  world.node(1).boot(world.now, false);
  ASSERT_TRUE(world.runUntil([&] { return held(1) == kOfTwo; }));
  ASSERT_EQ(world.node(1).health(), fieldbus::Health::booting);
  world.node(1).swapWrites(writes, world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.node(1).ready(); }));
  EXPECT_EQ(held(1), kOfOne);
}

TEST_F(ReloadScene, IsAnsweredAtTheEndOfTheProgram) {
  world.drives[1].sdo_silent = true;
  const auto reloading = begin();
  ASSERT_TRUE(world.runUntil([&] { return held(0) == kOfOne; }));
  world.run(10ms);
  world.network.beginShutdown(world.now);
  ASSERT_EQ(reloading->size(), 1U);
  EXPECT_FALSE(reloading->front().success);
  EXPECT_THAT(reloading->front().message, HasSubstr("shutdown"));
  EXPECT_EQ(fastest(0), 2.0);
}

TEST_F(ReloadScene, WhatCanBeChangedAtAnyTimeTakesNoDrive) {
  ASSERT_TRUE(world.call(ProcedureKind::enable).success);
  config::RobotConfig next = limited(2.0);
  next.groups[0].goal_time = 3.0;
  next.axes[0].command_timeout = 50ms;
  const auto answers = begin(to(next, false));
  ASSERT_EQ(answers->size(), 1U) << "answered at once";
  EXPECT_TRUE(answers->front().success);
  EXPECT_EQ(world.group().config().goal_time, 3.0);
  EXPECT_EQ(world.axis(0).config().command_timeout, Duration(50ms));
  EXPECT_THAT(world.drives[0].written, IsEmpty());
}

}  // namespace
}  // namespace cia402::bus
