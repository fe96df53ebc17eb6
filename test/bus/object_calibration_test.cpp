// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Objects that shift the drive's coordinates or hold its calibration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/jobs/object_commands.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using fieldbus::ObjectId;
using test::Bytes;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

/// The shoulder has no homing, the elbow has; requests are repeated twice.
config::RobotConfig repeating() {
  config::RobotConfig robot = test::testRobot();
  auto profile = std::make_shared<canopen::DeviceProfile>(*robot.devices[0].profile);
  profile->sdo.retries = 2;
  for (canopen::DeviceConfig& device : robot.devices) device.profile = profile;
  robot.axes[1].homing = test::homingOfOrder(0);
  return robot;
}

struct ObjectCalibration : testing::Test {
  ObjectCalibration() {
    for (test::FakeDrive& drive : world.drives) {
      drive.objects[kOffset] = {0, 0, 0, 0};
      drive.objects[kPolarity] = {0};
      drive.objects[{0x2001, 0}] = {0, 0};
    }
    world.boot();
    world.run(500ms);  // seen to stand
  }
  std::shared_ptr<std::vector<Answer>> begin(const std::string& object, const std::string& value,
                                             const std::string& axis = "shoulder") {
    return world.begin(WriteObjectCommand{axis, object, value});
  }
  Answer write(const std::string& object, const std::string& value,
               const std::string& axis = "shoulder") {
    return world.wait(begin(object, value, axis));
  }
  /// SDO requests to a node that download this object.
  std::size_t downloads(canopen::NodeId node, ObjectId id) const {
    std::size_t count = 0;
    for (const auto& sent : world.sentWithId(0x600U + node)) {
      const auto& d = sent.frame.data;
      count += (d[0] & 0xE0) == 0x20 && d[1] == (id.index & 0xFF) && d[2] == id.index >> 8;
    }
    return count;
  }
  const ObjectId kOffset{0x607C, 0}, kPolarity{0x607E, 0};
  RobotWorld world{repeating()};
};

TEST_F(ObjectCalibration, AWrittenZeroIsToldAndTheAxisIsNotHomedAnyMore) {
  ASSERT_TRUE(world.axis(0).state().homed);
  const Time asked = world.now;
  const Answer answer = write("607C:00 i32", "1000");
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message,
            "shoulder (node 1): wrote 1000 to 607C:00; shoulder is not homed any more, for its "
            "zero may be another now: ~shoulder/set_position");
  EXPECT_EQ(world.drives[0].objects[kOffset], (Bytes{0xE8, 0x03, 0, 0}));
  EXPECT_FALSE(world.axis(0).state().homed);
  EXPECT_GE(world.now, asked + 250ms) << "a drive may confirm it before it counts from it";
  EXPECT_LT(world.now, asked + 300ms);
  EXPECT_TRUE(world.axis(0).state().feedback_valid);
  EXPECT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
}

TEST_F(ObjectCalibration, AnAxisThatCanHomeIsToldSoAndFactorsMustFitTheConfiguration) {
  EXPECT_THAT(write("607C:00 i32", "1", "elbow").message,
              HasSubstr(": ~elbow/set_position or ~elbow/home"));
  EXPECT_THAT(write("607E:00", "128").message,  // its size is asked first
              AllOf(HasSubstr("wrote 128 to 607E:00"),
                    HasSubstr("see that `counts_per_turn`, `gear_ratio` and `direction` fit the "
                              "drive, then ~shoulder/set_position")));
  EXPECT_EQ(world.drives[0].objects[kPolarity], Bytes{128});
}

TEST_F(ObjectCalibration, NobodyEnablesTheAxisMeanwhileButAfterwards) {
  for (const char* const object : {"607C:00 i32", "607C:00"}) {
    SCOPED_TRACE(object);
    const auto written = begin(object, "1");
    EXPECT_THAT(world.call(ProcedureKind::enable, "shoulder").message,
                HasSubstr("607C:00 is being written"));
    EXPECT_THAT(write("607C:00 i32", "2").message, HasSubstr("is being written; call it again"));
    world.run(200ms);
    EXPECT_TRUE(written->empty());
    EXPECT_THAT(world.call(ProcedureKind::enable, "shoulder").message,
                HasSubstr("607C:00 is being written"));
    EXPECT_TRUE(world.wait(written).success);
    EXPECT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
    ASSERT_TRUE(world.call(ProcedureKind::disable, "shoulder").success);
    world.run(500ms);
  }
}

TEST_F(ObjectCalibration, IsNotWrittenTwiceThoughNoAnswerComesAndMayHaveBeenTaken) {
  for (test::FakeDrive& drive : world.drives) drive.sdo_silent = true;
  world.sent.clear();
  const auto written = begin("607C:00 i32", "1000"), other = begin("2001:00 u16", "7", "elbow");
  world.run(50ms);
  for (test::FakeDrive& drive : world.drives) drive.sdo_silent = false;
  const Time from = world.now - 50ms;
  const Answer answer = world.wait(written);
  EXPECT_NEAR(toSeconds(world.now - from), 0.1 + 0.25, 0.02) << "0.1 s are the profile's";
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(downloads(1, kOffset), 1u);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("it is not known whether 1000 was written to 607C:00"),
                    HasSubstr("read it"), HasSubstr("shoulder is not homed any more")));
  EXPECT_FALSE(world.axis(0).state().homed);
  EXPECT_TRUE(world.wait(other).success) << other->front().message;
  EXPECT_EQ(downloads(2, {0x2001, 0}), 2u) << "what holds no calibration is repeated";
}

TEST_F(ObjectCalibration, WhatTheDriveRefusesChangesNothing) {
  world.drives[0].aborts[kOffset] = 0x08000022;
  const Answer answer = write("607C:00 i32", "1000");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("607C:00 not written"), HasSubstr("0x08000022"),
                                    Not(HasSubstr("not homed"))));
  EXPECT_TRUE(world.axis(0).state().homed);
  EXPECT_TRUE(world.call(ProcedureKind::enable, "shoulder").success) << "it is free again";
}

TEST_F(ObjectCalibration, AValueThatDoesNotFitTheAskedSizeChangesNothing) {
  EXPECT_THAT(write("607E:00", "70000").message, HasSubstr("607E:00 not written"));
  EXPECT_TRUE(world.axis(0).state().homed);
  EXPECT_TRUE(world.call(ProcedureKind::enable, "shoulder").success) << "it is free again";
}

TEST_F(ObjectCalibration, ADriveThatTellsNoPositionAfterwardsIsSaidToDoSo) {
  const auto written = begin("607C:00 i32", "1000");
  world.run(240ms);
  world.drives[0].tpdo_bytes = 0;  // what it told last counts from the old zero
  const Time from = world.now - 240ms;
  const Answer answer = world.wait(written);
  EXPECT_THAT(answer.message, HasSubstr("; the drive has not told its position since"));
  EXPECT_NEAR(toSeconds(world.now - from), 0.25 + 1.0, 0.02)
      << "state_change of the profile is 1 s";
}

TEST_F(ObjectCalibration, OfAnEnabledAxisIsRefusedWithTheServiceThatHelps) {
  ASSERT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
  world.drives[0].written.clear();
  const std::pair<const char*, const char*> marked[] = {
      {"6064:00", "the service ~shoulder/set_position"},
      {"607C:00", "the service ~shoulder/home"},
      {"607E:00", "`direction` to match"},
      {"6091:01", "`counts_per_turn`"},
      {"1011:01", "the service ~shoulder/restore_parameters"},
  };
  for (const auto& [object, instead] : marked) {
    const Answer refused = write(object, "1");
    EXPECT_FALSE(refused.success) << object;
    EXPECT_THAT(refused.message,
                AllOf(HasSubstr("shoulder (node 1): " + std::string(object)),
                      HasSubstr(" not written: it shifts the drive's coordinates or holds its "
                                "calibration, and the axis is not disabled"),
                      HasSubstr("Instead: "), HasSubstr(instead)));
  }
  EXPECT_TRUE(world.drives[0].written.empty());
  EXPECT_TRUE(world.axis(0).state().homed);
}

}  // namespace
}  // namespace cia402::bus
