// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/jobs/object_commands.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using fieldbus::ObjectId;
using test::Bytes;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct ObjectJobTest : testing::Test {
  ObjectJobTest() { world.boot(); }
  ObjectAnswer read(const std::string& object, const std::string& axis = "shoulder") {
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
  const ObjectAnswer answer = read("following_error_window");
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message,
            "shoulder (node 1): 6065:00 following_error_window is 10000 (0x00002710) = 0.1 rad");
  EXPECT_EQ(answer.data, (Bytes{0x10, 0x27, 0x00, 0x00}));
  EXPECT_EQ(answer.number, 10000.0);
}

TEST_F(ObjectJobTest, AnswersOnceOnly) {
  const auto read = world.begin(ReadObjectCommand{"shoulder", "6098:00"});
  const auto written = world.begin(WriteObjectCommand{"shoulder", "6098:00", "1"});
  world.run(1s);
  EXPECT_EQ(read->size(), 1u);
  EXPECT_EQ(written->size(), 1u);
}

TEST_F(ObjectJobTest, ReadsByIndexAndNamesTheObjectWhereTheProfileKnowsIt) {
  stored(0x6098) = {17};
  EXPECT_EQ(read("6098:00").message, "shoulder (node 1): 6098:00 homing_method is 17 (0x11)");
  EXPECT_EQ(read("0x6098").text, "17 (0x11)");
}

TEST_F(ObjectJobTest, ReadsWhatTheProfileDoesNotList) {
  stored(0x2001) = {0x34, 0x12};
  const ObjectAnswer answer = read("2001:00");
  EXPECT_THAT(answer.message, AllOf(HasSubstr("shoulder (node 1): 2001:00 is 34 12 (2 bytes; its "
                                              "type is not known"),
                                    HasSubstr("u16")));
  EXPECT_TRUE(std::isnan(answer.number));
  EXPECT_EQ(answer.data, (Bytes{0x34, 0x12}));
}

TEST_F(ObjectJobTest, ReadsWhatTheProfileDoesNotListByTheTypeThatIsGiven) {
  stored(0x2001) = {0xFE, 0xFF};
  EXPECT_EQ(read("2001h:0 u16").message, "shoulder (node 1): 2001:00 is 65534 (0xFFFE)");
  EXPECT_EQ(read("2001h:0 i16").message, "shoulder (node 1): 2001:00 is -2 (0xFFFE)");
  EXPECT_EQ(read("2001h i16").number, -2.0);
  EXPECT_EQ(read("2001h bytes").text, "FE FF");
  stored(0x2001) = {0x00, 0x00, 0xC0, 0xBF};  // -1.5 in IEEE 754
  EXPECT_EQ(read("0x2001:0 f32").number, -1.5);
  stored(0x2001) = {'D', 'M'};
  EXPECT_EQ(read("2001h text").text, "\"DM\"");
  EXPECT_THAT(read("2001h u32").message, HasSubstr("2 bytes, but"));
}

TEST_F(ObjectJobTest, WritesByTheTypeThatIsGivenWithoutAskingFirst) {
  EXPECT_FALSE(write("2001h:0", "1").success) << "the drive has no such object";
  stored(0x2001) = {0, 0, 0, 0};
  world.sent.clear();
  EXPECT_EQ(write("2001h:0 i16", "-2").message, "shoulder (node 1): wrote -2 to 2001:00");
  EXPECT_EQ(stored(0x2001), (Bytes{0xFE, 0xFF}));
  EXPECT_EQ(world.sentWithId(0x601).size(), 1u);
  EXPECT_TRUE(write("2001h f32", "-1.5").success);
  EXPECT_EQ(stored(0x2001), (Bytes{0x00, 0x00, 0xC0, 0xBF}));
  EXPECT_TRUE(write("2001h bytes", "01 2A ff").success);
  EXPECT_EQ(stored(0x2001), (Bytes{0x01, 0x2A, 0xFF}));
  EXPECT_TRUE(write("2001h text", "DM").success);
  EXPECT_EQ(stored(0x2001), (Bytes{'D', 'M'}));
}

TEST_F(ObjectJobTest, RefusesValuesThatDoNotFitTheTypeThatIsGiven) {
  world.drives[0].written.clear();
  EXPECT_THAT(write("2001h u8", "256").message, HasSubstr("does not fit uint8"));
  EXPECT_THAT(write("2001h f32", "nan").message, HasSubstr("cannot be sent"));
  EXPECT_THAT(write("2001h f32", "0x7F800000").message, HasSubstr("no finite number"));
  EXPECT_THAT(write("2001h bytes", "123").message, HasSubstr("01 2A FF"));
  EXPECT_THAT(write("2001h bytes", "").message, HasSubstr("no byte"));
  EXPECT_TRUE(world.drives[0].written.empty());
}

TEST_F(ObjectJobTest, RefusesATypeThatContradictsTheProfile) {
  EXPECT_EQ(read("6098h u16").message,
            "shoulder (node 1): 6098:00 homing_method is int8 by profile test_drive, not uint16; "
            "leave the type out");
  stored(0x6098) = {17};
  EXPECT_EQ(read("homing_method i8").number, 17.0);
}

TEST_F(ObjectJobTest, TakesWhatYamlMakesOfAnIndex) {
  stored(0x6098) = {17};
  EXPECT_EQ(read("24728").number, 17.0);   // 0x6098 in decimal
  EXPECT_EQ(read("365880").number, 17.0);  // 6098:00 = 6098 * 60
  const ObjectAnswer answer = read("4120");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("4120h"), HasSubstr("1018h")));
}

TEST_F(ObjectJobTest, TellsWhatWasWrittenInJointUnits) {
  EXPECT_EQ(write("following_error_window", "10000").message,
            "shoulder (node 1): wrote 10000 to 6065:00 following_error_window (0.1 rad)");
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
  const ObjectAnswer answer = read("2002:05");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("2002:05"), HasSubstr("0x06020000"),
                                    HasSubstr("object does not exist")));
  EXPECT_TRUE(std::isnan(answer.number));
}

TEST_F(ObjectJobTest, TellsThatTheDriveDoesNotAnswer) {
  world.drives[0].sdo_silent = true;
  const ObjectAnswer answer = read("6098:00");
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

TEST_F(ObjectJobTest, AValueThatDoesNotFitTheSizeThatTheDriveToldIsAFailure) {
  stored(0x2001) = {0, 0};
  world.drives[0].written.clear();
  const Answer answer = write("2001:00", "65536");
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message,
            "shoulder (node 1): 2001:00 not written: 65536 does not fit 2 bytes (-32768..65535)");
  EXPECT_TRUE(world.drives[0].written.empty());
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

// CiA 402-2: 60B0h, 60B1h and 60B2h.
TEST_F(ObjectJobTest, WritesNothingThatADriveAddsToItsSetPoints) {
  for (const unsigned index : {0x60B0U, 0x60B1U, 0x60B2U}) {
    char object[16];
    std::snprintf(object, sizeof object, "%04X:00", index);
    SCOPED_TRACE(object);
    const auto id = static_cast<std::uint16_t>(index);
    stored(id) = {0, 0, 0, 0};
    for (const std::string& typed : {std::string(), std::string(" i32")}) {
      world.drives[0].written.clear();
      for (const char* const value : {"1", "256", "-1"}) {
        const Answer refused = write(object + typed, value);
        EXPECT_FALSE(refused.success);
        EXPECT_THAT(refused.message,
                    AllOf(HasSubstr("shoulder (node 1): " + std::string(object) + " not written"),
                          HasSubstr("adds it to each of its set-points"), HasSubstr("leave 0")));
      }
      EXPECT_TRUE(world.drives[0].written.empty());
      EXPECT_TRUE(write(object + typed, "0").success) << "moves nothing";
      EXPECT_EQ(stored(id), (Bytes{0, 0, 0, 0}));
    }
  }
}

// CiA 402-2: eight axes, 800h apart. Whoever writes those of another one might move it.
TEST_F(ObjectJobTest, WritesNothingOfAnotherAxisInTheDrive) {
  for (const unsigned index : {0x6800U, 0x6840U, 0x68B0U, 0x70B1U, 0x98B2U, 0x9FFFU}) {
    char object[16];
    std::snprintf(object, sizeof object, "%04X:00", index);
    stored(static_cast<std::uint16_t>(index)) = {0, 0};
    world.drives[0].written.clear();
    for (const std::string& typed : {std::string(), std::string(" u16")}) {
      for (const char* const value : {"0", "15"}) {
        const Answer refused = write(object + typed, value);
        EXPECT_FALSE(refused.success);
        EXPECT_THAT(refused.message,
                    AllOf(HasSubstr("shoulder (node 1): " + std::string(object) + " not written"),
                          HasSubstr("it is of axis " + std::to_string((index - 0x6000) / 0x800) +
                                    " of the drive (CiA 402-2), and this is axis 0")));
      }
    }
    EXPECT_TRUE(world.drives[0].written.empty());
  }
}

TEST_F(ObjectJobTest, WritesWhatLiesBesideThoseOffsets) {
  for (const unsigned index : {0x58B0U, 0x60AFU, 0x60B3U, 0xA0B0U}) {
    char object[16];
    std::snprintf(object, sizeof object, "%04X:00", index);
    const auto id = static_cast<std::uint16_t>(index);
    stored(id) = {0, 0};
    const Answer written = write(object, "0x1234");
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_EQ(stored(id), (Bytes{0x34, 0x12})) << object;
  }
}

TEST_F(ObjectJobTest, RefusesWhatIsNeitherANameNorAnIndexAndUnknownAxes) {
  EXPECT_EQ(read("homing_speed").message,
            "shoulder (node 1): \"homing_speed\" is neither an object of profile test_drive nor an "
            "index such as 6041h:0");
  EXPECT_THAT(write("homing_speed", "1").message,
              HasSubstr("\"homing_speed\" is neither an object of profile test_drive"));
  EXPECT_EQ(read("6041:00", "wrist").message, "there is no axis \"wrist\"");
  EXPECT_EQ(world.call(WriteObjectCommand{"wrist", "6041:00", "1"}).message,
            "there is no axis \"wrist\"");
}

TEST(ObjectJob, IsRefusedWhileTheBusIsNotThere) {
  RobotWorld world;
  const auto read = world.begin(ReadObjectCommand{"shoulder", "6041:00"});
  const auto write = world.begin(WriteObjectCommand{"shoulder", "6098:00", "1"});
  ASSERT_EQ(read->size(), 1u);
  ASSERT_EQ(write->size(), 1u);
  for (const Answer& refused : {Answer(read->front()), write->front()}) {
    EXPECT_EQ(refused.message, "refused: the bus interface can0 is not there yet");
  }
  EXPECT_TRUE(world.sent.empty());
}

}  // namespace
}  // namespace cia402::bus
