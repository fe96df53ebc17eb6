// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_condition.h"

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

AxisSnapshot snapshotOf(const RobotWorld& world, std::size_t axis = 0) {
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  return snapshot.axes[axis];
}

Summary summary(const RobotWorld& world, bool warning_stops = false) {
  return summaryOf(snapshotOf(world), warning_stops);
}

config::RobotConfig inMode(const std::string& mode) {
  config::RobotConfig robot = test::testRobot();
  robot.axes[0].mode = mode;
  robot.groups.clear();
  return robot;
}

TEST(AxisCondition, IsWellWhileItDoesWhatItIsTold) {
  RobotWorld world;
  world.enable();
  EXPECT_EQ(summary(world).condition, Condition::well);
  EXPECT_EQ(summary(world).text, "operation enabled");
}

TEST(AxisCondition, IsWellButSaysSoWhileItIsHalted) {
  RobotWorld world;
  world.enable();
  ASSERT_TRUE(world.call(ProcedureKind::halt, "shoulder").success);
  EXPECT_TRUE(snapshotOf(world).state.halted);
  EXPECT_EQ(summary(world).condition, Condition::well);
  EXPECT_EQ(summary(world).text, "operation enabled, halted until `enable`");
  EXPECT_FALSE(snapshotOf(world, 1).state.halted);
  ASSERT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
  EXPECT_FALSE(snapshotOf(world).state.halted);
  EXPECT_EQ(summary(world).text, "operation enabled");
}

TEST(AxisCondition, WarnsOfADriveThatWarns) {
  RobotWorld world;
  world.enable();
  world.drives[0].statusword_bits = 0x0080;  // warning
  world.run(200ms);
  EXPECT_EQ(summary(world).condition, Condition::warning);
  EXPECT_THAT(summary(world).text, HasSubstr("warning"));
  EXPECT_EQ(summary(world, true).condition, Condition::error) << "where it makes the drive stop";
}

// CiA 301: an EMCY with bit 0 of the error register set and no fault in the statusword.
TEST(AxisCondition, WarnsOfAnErrorThatLeavesTheDriveRunning) {
  RobotWorld world;
  world.enable();
  world.drives[0].objects[{0x1001, 0}] = {0x01};
  world.drives[0].out.emplace_back(
      0x081, std::initializer_list<std::uint8_t>{0x10, 0x42, 0x01, 0, 0, 0, 0, 0});
  world.run(200ms);
  EXPECT_EQ(summary(world).condition, Condition::warning);
  EXPECT_THAT(summary(world).text, AllOf(HasSubstr("shoulder (node 1)"), HasSubstr("0x4210")));
  for (const Event& event : world.events) {
    EXPECT_NE(event.severity, Event::Severity::error) << event.text.str();
  }
}

TEST(AxisCondition, IsAnErrorInFault) {
  RobotWorld world;
  world.enable();
  world.drives[0].fault(0x8611);
  world.run(200ms);
  EXPECT_EQ(summary(world).condition, Condition::error);
  EXPECT_THAT(summary(world).text, HasSubstr("0x8611"));
}

TEST(AxisCondition, IsAnErrorWithTheReasonWhereNoTpdoComes) {
  RobotWorld world;
  world.boot();
  world.drives[0].tpdo_bytes = 0;
  world.run(1s);
  EXPECT_EQ(summary(world).condition, Condition::error);
  EXPECT_THAT(summary(world).text,
              AllOf(HasSubstr("shoulder (node 1): its state is unknown"),
                    HasSubstr("TPDO 1 (COB-ID 0x181) does not come"), HasSubstr("check cable")));
  EXPECT_EQ(world.eventsWith("its state is unknown"), 1u) << world.allEvents();
  world.drives[0].tpdo_bytes = 7;
  world.run(300ms);
  EXPECT_EQ(summary(world).condition, Condition::well) << summary(world).text;
}

TEST(AxisCondition, IsAnErrorWithTheReasonWhereTheTpdoIsTooShort) {
  RobotWorld world;
  world.boot();
  world.drives[0].tpdo_bytes = 3;
  world.run(1s);
  EXPECT_EQ(summary(world).condition, Condition::error);
  EXPECT_THAT(summary(world).text, HasSubstr("comes too short (3 bytes instead of 7)"));
  EXPECT_EQ(world.eventsWith("its state is unknown"), 1u) << world.allEvents();
}

// Bits 2 and 6 together are no state of CiA 402.
TEST(AxisCondition, IsAnErrorWhereTheStatuswordShowsNoState) {
  RobotWorld world;
  world.boot();
  world.drives[0].statusword_bits = 0x0004;  // 0x0250 switch on disabled becomes 0x0254
  world.run(1s);
  EXPECT_EQ(summary(world).condition, Condition::error);
  EXPECT_THAT(summary(world).text, AllOf(HasSubstr("0x0254"), HasSubstr("none of the states")));
}

TEST(AxisCondition, OnlyWarnsBetweenBootAndTheFirstTpdo) {
  RobotWorld world;
  world.drives[0].tpdo_bytes = 0;
  world.network.start(world.now);
  ASSERT_TRUE(
      world.runUntil([&] { return world.axis(0).state().health == fieldbus::Health::ready; }, 5s));
  world.run(300ms);
  EXPECT_EQ(world.eventsWith("its state is unknown"), 0u) << world.allEvents();
  world.run(700ms);
  EXPECT_EQ(world.eventsWith("its state is unknown"), 1u) << world.allEvents();
}

TEST(AxisCondition, WarnsOfAVelocityStreamThatDriedUpWhileThatLasts) {
  RobotWorld world(inMode("cyclic_velocity"));
  world.enable();
  (void)world.begin(SetpointCommand{0, 0.5});
  world.run(150ms);
  EXPECT_EQ(summary(world).condition, Condition::well);
  world.run(2s);
  EXPECT_EQ(world.drives[0].target_velocity, 0);
  EXPECT_EQ(summary(world).condition, Condition::warning);
  EXPECT_THAT(summary(world).text, AllOf(HasSubstr("stream of velocities ended"),
                                         HasSubstr("0.2 s"), HasSubstr("ramped to rest")));
  EXPECT_EQ(world.eventsWith("stream of velocities ended"), 1u) << world.allEvents();
  (void)world.begin(SetpointCommand{0, 0.0});
  world.run(1s);
  EXPECT_EQ(summary(world).condition, Condition::well) << "a stream that ended with a zero";
  EXPECT_EQ(world.eventsWith("stream of velocities ended"), 1u) << world.allEvents();
}

TEST(AxisCondition, WarnsOfAnEffortStreamThatDriedUpAndLetTheAxisCoast) {
  config::RobotConfig robot = inMode("cyclic_torque");
  robot.axes[0].brake_after_effort = false;
  RobotWorld world(robot);
  world.enable();
  (void)world.begin(SetpointCommand{0, 2.0});
  world.run(400ms);
  EXPECT_EQ(summary(world).condition, Condition::warning);
  EXPECT_THAT(summary(world).text, AllOf(HasSubstr("stream of efforts ended"),
                                         HasSubstr("command_timeout_action: coast")));
  EXPECT_EQ(world.eventsWith("stream of efforts ended"), 1u) << world.allEvents();
  (void)world.call(ProcedureKind::disable, "shoulder");
  world.run(200ms);
  EXPECT_EQ(summary(world).condition, Condition::well) << summary(world).text;
}

// The axis says itself that a quick stop brakes it, after which it is disabled.
TEST(AxisCondition, AnEffortStreamThatEndsInAQuickStopIsToldOnce) {
  RobotWorld world(inMode("cyclic_torque"));
  world.enable();
  (void)world.begin(SetpointCommand{0, 2.0});
  world.run(400ms);
  EXPECT_EQ(world.eventsWith("stream of efforts ended"), 1u) << world.allEvents();
  EXPECT_EQ(world.eventsWith("quick stop"), 1u) << world.allEvents();
}

TEST(AxisCondition, IsUnheardWhereTheNodeIsLostUnlessItMayBeAbsent) {
  RobotWorld world;
  world.enable();
  world.drives[0].silent = true;
  world.run(1s);
  EXPECT_EQ(summary(world).condition, Condition::unheard);
  EXPECT_THAT(summary(world).text, HasSubstr("shoulder (node 1)"));
  AxisSnapshot optional = snapshotOf(world);
  optional.node.may_be_absent = true;
  EXPECT_EQ(summaryOf(optional, false).condition, Condition::warning) << "it was there";
  optional.state.health = fieldbus::Health::absent;
  EXPECT_EQ(summaryOf(optional, false).condition, Condition::well) << "it never was";
}

// Nothing has been told of it yet.
TEST(AxisCondition, AFaultIsCalledAFaultAlsoWhereTheDriveWarnsBesides) {
  AxisSnapshot axis;
  axis.state.health = fieldbus::Health::ready;
  axis.state.feedback_valid = true;
  axis.state.state = drive::State::fault;
  axis.state.warning = true;
  EXPECT_EQ(summaryOf(axis, false).condition, Condition::error);
  EXPECT_EQ(summaryOf(axis, false).text, "fault");
}

}  // namespace
}  // namespace cia402::bus
