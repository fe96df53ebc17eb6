// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// set_digital_outputs, frame by frame: CiA 301 expedited SDO, CiA 402-2 60FEh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/jobs/output_job.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using fieldbus::ObjectId;
using test::Bytes;
using test::RobotWorld;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::chrono_literals;

const ObjectId kValue{0x60FE, 1}, kMask{0x60FE, 2}, kPlain{0x2004, 1};

drive::ObjectSpec objectOf(const char* name, ObjectId id, fieldbus::DataType type) {
  drive::ObjectSpec object;
  object.name = name;
  object.id = id;
  object.type = type;
  return object;
}

/// Shoulder and elbow, whose drives have outputs: do1 and do2 behind a mask, lamp without one.
config::RobotConfig robotWithOutputs() {
  config::RobotConfig robot = test::testRobot();
  auto profile = std::make_shared<drive::DriveProfile>(*test::testProfile());
  profile->objects.push_back(objectOf("outputs", kValue, fieldbus::DataType::uint32));
  profile->objects.push_back(objectOf("outputs_mask", kMask, fieldbus::DataType::uint32));
  profile->objects.push_back(objectOf("lamps", kPlain, fieldbus::DataType::uint16));
  profile->outputs["do1"] = {{"outputs", 16}, {}, 0, drive::ObjectBit{"outputs_mask", 16}};
  profile->outputs["do2"] = {{"outputs", 17}, {}, 0, drive::ObjectBit{"outputs_mask", 17}};
  profile->outputs["lamp"] = {{"lamps", 3}, {}, 0, {}};
  profile->outputs["valve"] = {{"target_torque", 0}, {}, 0, {}};
  for (drive::AxisConfig& axis : robot.axes) axis.profile = profile;
  return robot;
}

struct OutputJobTest : testing::Test {
  OutputJobTest() : world(robotWithOutputs()) {
    for (auto& drive : world.drives) {
      drive.objects[kValue] = {0, 0, 0, 0};
      drive.objects[kMask] = {0, 0, 0, 0};
      drive.objects[kPlain] = {0, 0};
    }
    world.boot();
    world.sent.clear();
  }
  Bytes& stored(ObjectId id) { return world.drives[0].objects[id]; }
  Answer set(const std::vector<std::string>& names, const std::vector<bool>& values) {
    return world.call(SetOutputsCommand{"shoulder", names, values});
  }
  /// Requests to the SDO server of node 1, but those of 1000h that prove an answer to be new.
  std::vector<Bytes> requests() const {
    std::vector<Bytes> found;
    for (const auto& sent : world.sentWithId(0x601)) {
      found.emplace_back(sent.frame.data.begin(), sent.frame.data.begin() + 8);
    }
    return found;
  }
  RobotWorld world;
};

TEST_F(OutputJobTest, LooksAtTheMaskAndWritesAllBitsOfAnObjectAtOnce) {
  stored(kMask) = {0x00, 0x00, 0x03, 0x00};
  stored(kValue) = {0x01, 0x00, 0x02, 0x80};
  const Answer answer = set({"do1", "do2"}, {true, false});
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message, "shoulder (node 1): do1 on, do2 off");
  EXPECT_THAT(requests(), ElementsAre(Bytes{0x40, 0xFE, 0x60, 0x02, 0, 0, 0, 0},
                                      Bytes{0x40, 0xFE, 0x60, 0x01, 0, 0, 0, 0},
                                      Bytes{0x23, 0xFE, 0x60, 0x01, 0x01, 0x00, 0x01, 0x80}));
}

// Else the output would show what stood in 60FEh:01 before, for a moment.
TEST_F(OutputJobTest, GivesAnOutputItsValueBeforeItOpensTheMaskAndAfterIt) {
  stored(kMask) = {0x00, 0x00, 0x02, 0x00};
  stored(kValue) = {0x00, 0x00, 0x01, 0x00};
  EXPECT_TRUE(set({"do1"}, {false}).success);
  EXPECT_THAT(requests(), ElementsAre(Bytes{0x40, 0xFE, 0x60, 0x02, 0, 0, 0, 0},
                                      Bytes{0x40, 0xFE, 0x60, 0x01, 0, 0, 0, 0},
                                      Bytes{0x23, 0xFE, 0x60, 0x01, 0x00, 0x00, 0x00, 0x00},
                                      Bytes{0x40, 0xFE, 0x60, 0x02, 0, 0, 0, 0},
                                      Bytes{0x23, 0xFE, 0x60, 0x02, 0x00, 0x00, 0x03, 0x00},
                                      Bytes{0x40, 0xFE, 0x60, 0x01, 0, 0, 0, 0},
                                      Bytes{0x23, 0xFE, 0x60, 0x01, 0x00, 0x00, 0x00, 0x00}));
}

TEST_F(OutputJobTest, SetsThoseOfSeveralObjectsOneAfterTheOther) {
  stored(kMask) = {0x00, 0x00, 0x03, 0x00};
  stored(kPlain) = {0x81, 0x00};
  EXPECT_TRUE(set({"lamp", "do2"}, {true, true}).success);
  EXPECT_THAT(requests(), ElementsAre(Bytes{0x40, 0x04, 0x20, 0x01, 0, 0, 0, 0},
                                      Bytes{0x2B, 0x04, 0x20, 0x01, 0x89, 0x00, 0, 0},
                                      Bytes{0x40, 0xFE, 0x60, 0x02, 0, 0, 0, 0},
                                      Bytes{0x40, 0xFE, 0x60, 0x01, 0, 0, 0, 0},
                                      Bytes{0x23, 0xFE, 0x60, 0x01, 0x00, 0x00, 0x02, 0x00}));
}

// Each reads what the one before has written.
TEST_F(OutputJobTest, KeepsTheBitsOfCallsAtTheSameTime) {
  stored(kMask) = {0x00, 0x00, 0x03, 0x00};
  const auto first = world.begin(SetOutputsCommand{"shoulder", {"do1"}, {true}});
  const auto second = world.begin(SetOutputsCommand{"shoulder", {"do2"}, {true}});
  world.run(1s);
  ASSERT_EQ(first->size(), 1U);
  ASSERT_EQ(second->size(), 1U);
  EXPECT_TRUE(first->front().success && second->front().success);
  EXPECT_EQ(stored(kValue), (Bytes{0x00, 0x00, 0x03, 0x00}));
}

TEST_F(OutputJobTest, OfTwoDrivesDoNotWaitForEachOther) {
  world.drives[0].sdo_silent = true;
  const auto silent = world.begin(SetOutputsCommand{"shoulder", {"lamp"}, {true}});
  const auto other = world.begin(SetOutputsCommand{"elbow", {"lamp"}, {true}});
  world.run(20ms);
  EXPECT_TRUE(silent->empty());
  ASSERT_EQ(other->size(), 1U);
  EXPECT_EQ(other->front().message, "elbow (node 2): lamp on");
  const Answer answer = world.wait(silent);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              HasSubstr("shoulder (node 1): outputs not set: 2004:01 lamps not read: "));
}

TEST_F(OutputJobTest, TellsWhatTheDriveRefuses) {
  stored(kMask) = {0x00, 0x00, 0x03, 0x00};
  world.drives[0].aborts[kValue] = 0x06010000;
  const Answer answer = set({"do1"}, {true});
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("shoulder (node 1): outputs not set: 60FE:01 outputs not "
                                        "read: the drive refused: 0x06010000"));
  world.drives[0].aborts = {{kMask, 0x06020000}};
  EXPECT_THAT(set({"do1"}, {true}).message,
              HasSubstr("60FE:02 outputs_mask not read: the drive refused: 0x06020000"));
  EXPECT_EQ(stored(kValue), (Bytes{0, 0, 0, 0})) << "nothing was written to";
}

TEST_F(OutputJobTest, RefusesWhatItCannotSetBeforeAnythingIsSent) {
  const auto refused = [&](const std::vector<std::string>& names, const std::vector<bool>& values) {
    const Answer answer = set(names, values);
    EXPECT_FALSE(answer.success);
    return answer.message;
  };
  EXPECT_EQ(refused({"do3"}, {true}),
            "shoulder (node 1): outputs not set: there is no output \"do3\"; there are do1, do2, "
            "lamp, valve");
  EXPECT_THAT(refused({"do1", "do3"}, {true, true}), HasSubstr("there is no output \"do3\""));
  EXPECT_THAT(refused({}, {}), HasSubstr("no output was named; there are do1"));
  EXPECT_THAT(refused({"do1", "do2"}, {true}), HasSubstr("2 names and 1 values were given"));
  EXPECT_THAT(refused({"do1", "do1"}, {true, false}), HasSubstr("\"do1\" was named twice"));
  EXPECT_THAT(refused({"do1", "valve"}, {true, true}),
              HasSubstr("6071:00 target_torque travels in RPDO 2 (COB-ID 0x301), which would undo "
                        "it in the next cycle; take it out of `pdos`"));
  EXPECT_EQ(world.call(SetOutputsCommand{"wrist", {"do1"}, {true}}).message,
            "there is no axis \"wrist\"");
  EXPECT_TRUE(requests().empty());
}

TEST(OutputJob, TellsOfAProfileWithoutOutputs) {
  RobotWorld world;
  world.boot();
  EXPECT_THAT(world.call(SetOutputsCommand{"shoulder", {"do1"}, {true}}).message,
              HasSubstr("there is no output \"do1\"; profile test_drive names no digital outputs"));
}

TEST(OutputJob, RefusesWhatTheConfigurationSaysIsLacking) {
  config::RobotConfig robot = robotWithOutputs();
  robot.axes[0].lacks = {"lamps"};
  RobotWorld world(robot);
  world.boot();
  EXPECT_THAT(world.call(SetOutputsCommand{"shoulder", {"lamp"}, {true}}).message,
              HasSubstr("the configuration says that the drive lacks 2004:01 lamps (`lacks`)"));
}

}  // namespace
}  // namespace cia402::bus
