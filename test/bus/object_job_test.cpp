// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"
#include "cia402_driver/bus/jobs.h"

namespace cia402::bus {
namespace {

using canopen::ObjectId;
using test::Bytes;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct ObjectJobTest : testing::Test {
  ObjectJobTest() { world.boot(); }
  Answer read(const std::string& object, const std::string& axis = "shoulder") {
    return world.call(ReadObjectCommand{axis, object});
  }
  Answer write(const std::string& object, const std::string& value) {
    return world.call(WriteObjectCommand{"shoulder", object, value});
  }
  Bytes& stored(std::uint16_t index) { return world.drives[0].objects[ObjectId{index, 0}]; }
  RobotWorld world;
};

TEST_F(ObjectJobTest, ReadsByNameWithJointUnits) {
  stored(0x6065) = {0x10, 0x27, 0x00, 0x00};  // 10000 counts
  const Answer answer = read("following_error_window");
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message,
            "shoulder (node 1): 6065:00 following_error_window is 10000 (0x00002710)");
  EXPECT_EQ(answer.data, (Bytes{0x10, 0x27, 0x00, 0x00}));
  EXPECT_EQ(answer.number, 10000.0);
}

TEST_F(ObjectJobTest, ReadsByIndexAndNamesTheObjectWhereTheProfileKnowsIt) {
  stored(0x6098) = {17};
  EXPECT_EQ(read("6098:00").message, "shoulder (node 1): 6098:00 homing_method is 17 (0x11)");
  EXPECT_EQ(read("0x6098").text, "17 (0x11)");
}

TEST_F(ObjectJobTest, ReadsWhatTheProfileDoesNotList) {
  stored(0x2001) = {0x34, 0x12};
  EXPECT_EQ(read("2001:00").message, "shoulder (node 1): 2001:00 is 4660 (0x1234)");
}

TEST_F(ObjectJobTest, ReadsAShortNameOrVersionAsText) {
  stored(0x1008) = {'D', 'M'};
  stored(0x1009) = {'s', 'i', 'm'};
  stored(0x100A) = {'1', '.', '0', 0};  // padded as in C
  EXPECT_EQ(read("1008:00").message, "shoulder (node 1): 1008:00 is \"DM\"");
  EXPECT_EQ(read("1009:00").text, "\"sim\"");
  EXPECT_EQ(read("100A:00").text, "\"1.0\"");
  EXPECT_TRUE(std::isnan(read("1008:00").number));
}

TEST_F(ObjectJobTest, TellsAnAbortInWords) {
  const Answer answer = read("2002:05");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("2002:05"), HasSubstr("0x06020000"),
                                    HasSubstr("object does not exist")));
  EXPECT_TRUE(std::isnan(answer.number));
}

TEST_F(ObjectJobTest, TellsThatTheDriveDoesNotAnswer) {
  world.drives[0].sdo_silent = true;
  const Answer answer = read("6098:00");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("node 1"));
}

TEST_F(ObjectJobTest, WritesANumberInTheTypeOfTheProfile) {
  const Answer answer = write("homing_method", "-3");
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message, "shoulder (node 1): wrote -3 to 6098:00 homing_method");
  EXPECT_EQ(stored(0x6098), (Bytes{0xFD}));
}

TEST_F(ObjectJobTest, AsksTheDriveForTheSizeOfAnUnlistedObjectBeforeWriting) {
  stored(0x2001) = {0, 0};
  EXPECT_TRUE(write("2001:00", "0xABCD").success);
  EXPECT_EQ(stored(0x2001), (Bytes{0xCD, 0xAB}));
}

TEST_F(ObjectJobTest, WritesNothingIfTheUnlistedObjectCannotBeRead) {
  world.drives[0].aborts[ObjectId{0x2001, 0}] = 0x06010001;
  const Answer answer = write("2001:00", "1");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("0x06010001"));
}

TEST_F(ObjectJobTest, TellsAnAbortOfAWriteInWords) {
  world.drives[0].aborts[ObjectId{0x6098, 0}] = 0x06090030;
  const Answer answer = write("homing_method", "99");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("homing_method"), HasSubstr("0x06090030")));
}

TEST_F(ObjectJobTest, RefusesAValueThatDoesNotFitWithoutAskingTheDrive) {
  world.drives[0].written.clear();
  const Answer answer = write("homing_method", "300");
  EXPECT_EQ(answer.message,
            "shoulder (node 1): 6098:00 homing_method not written: 300 does not fit int8 "
            "(-128..127)");
  EXPECT_TRUE(world.drives[0].written.empty());
}

TEST_F(ObjectJobTest, RefusesWhatIsNeitherANameNorAnIndexAndUnknownAxes) {
  EXPECT_EQ(read("homing_speed").message,
            "shoulder (node 1): \"homing_speed\" is neither an object of profile test_drive nor an "
            "index such as 6041:00");
  EXPECT_EQ(read("6041:00", "wrist").message, "there is no axis \"wrist\"");
  EXPECT_EQ(world.call(WriteObjectCommand{"wrist", "6041:00", "1"}).message,
            "there is no axis \"wrist\"");
}

TEST(ObjectJob, IsRefusedWhileTheBusIsNotThere) {
  RobotWorld world;
  const auto read = world.begin(ReadObjectCommand{"shoulder", "6041:00"});
  const auto write = world.begin(WriteObjectCommand{"shoulder", "6098:00", "1"});
  for (const auto& answers : {read, write}) {
    ASSERT_EQ(answers->size(), 1u);
    EXPECT_EQ(answers->front().message, "refused: the bus interface can0 is not there yet");
  }
  EXPECT_TRUE(world.sent.empty());
}

}  // namespace
}  // namespace cia402::bus
