// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "config/robot.h"
#include "folders.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Loaded {
  RobotConfig robot;
  std::string problems;
};

// One axis with an EDS that fits the profile, and `extra` keys.
Loaded load(const std::string& extra, const std::string& eds = "motor.eds") {
  Problems problems;
  Loaded loaded;
  const std::string yaml =
      "bus: {interface: can0}\n"
      "axes:\n"
      "  shoulder: {node_id: 5, drive: generic_cia402, counts_per_turn: 4000, limits: {velocity: "
      "2.0, acceleration: 8.0}, eds: " +
      eds + extra + "}\n";
  loaded.robot = loadRobot(YAML::Load(yaml),
                           profilesIn({cia402::test::configFolder() + "/drives",
                                       cia402::test::testFolder() + "/config"}),
                           problems);
  loaded.problems = problems.text();
  return loaded;
}

canopen::NodeConfig nodeOf(const Loaded& loaded) {
  Problems problems;
  const canopen::MasterConfig master = makeMasterConfig(loaded.robot, problems);
  EXPECT_EQ(problems.text(), "");
  return master.nodes.at(0);
}

/// The name of an object in the EDS.
std::string loadedName(const std::string& index) {
  const Loaded loaded = load("");
  const drive::ObjectSpec* object =
      loaded.robot.axes[0].profile->find(*fieldbus::parseObjectId(index));
  EXPECT_NE(object, nullptr);
  return object == nullptr ? "" : object->name;
}

TEST(LoadEds, WithoutDamageItAddsNeitherProblemNorWarningButMissingObjects) {
  const Loaded loaded = load("");
  EXPECT_EQ(loaded.problems, "");
  ASSERT_EQ(loaded.robot.warnings.size(), 1U);
  EXPECT_THAT(loaded.robot.warnings[0],
              AllOf(HasSubstr("axes/shoulder/eds: motor.eds does not have"),
                    HasSubstr("objects of profile generic_cia402: ")));
  EXPECT_EQ(loaded.robot.axes[0].description->file, "motor.eds");
}

TEST(LoadEds, ObjectsAreWrittenAndMappedByTheirNamesInTheEds) {
  const Loaded loaded = load(
      ", write: [{object: \"Controller / proportional gain\", value: 700}, {object: "
      "\"2011:00\", value: 1.5}], pdos: {rpdo1: [controlword, TARGETPOSITION], tpdo1: "
      "[statusword, position_actual, Motor temperature]}");
  EXPECT_EQ(loaded.problems, "");
  const canopen::NodeConfig node = nodeOf(loaded);
  const auto write = [&](fieldbus::ObjectId id) {
    for (const canopen::StartupWrite& entry : node.writes) {
      if (entry.object == id) return entry.data;
    }
    return fieldbus::Bytes{};
  };
  EXPECT_EQ(write({0x2010, 1}), (fieldbus::Bytes{0xBC, 0x02}));
  EXPECT_EQ(write({0x2011, 0}), (fieldbus::Bytes{0, 0, 0xC0, 0x3F}));
  bool mapped = false;
  for (const canopen::PdoConfig& pdo : node.pdos) {
    for (const canopen::PdoEntry& entry : pdo.entries) {
      mapped = mapped || (entry.object == fieldbus::ObjectId{0x2012, 0} && entry.bits == 16);
    }
  }
  EXPECT_TRUE(mapped);
}

TEST(LoadEds, WhatIsNotFiniteIsNotWrittenIntoAFloatByAnyName) {
  const std::string gain = loadedName("2011:00");
  for (const std::string& name : {std::string("2011:00"), gain}) {
    EXPECT_THAT(load(", write: [{object: \"" + name + "\", raw: 0x7FC00000}]").problems,
                AllOf(HasSubstr("axes/shoulder/write[0]/raw"), HasSubstr("0x7FC00000"),
                      HasSubstr("no finite number")));
    EXPECT_THAT(load(", write: [{object: \"" + name + "\", value: .inf}]").problems,
                HasSubstr("must be a finite number"));
  }
}

bool maps(const Loaded& loaded, const std::string& object) {
  for (const canopen::PdoLayout& pdo : loaded.robot.devices[0].axes[0].pdos) {
    if (std::find(pdo.objects.begin(), pdo.objects.end(), object) != pdo.objects.end()) return true;
  }
  return false;
}

TEST(LoadEds, WhatTheDriveDoesNotHaveIsPlannedOnlyWhereSomebodyAsksForIt) {
  const Loaded loaded = load("");
  EXPECT_TRUE(maps(loaded, "target_position"));
  EXPECT_FALSE(maps(loaded, "velocity_actual"));
  EXPECT_FALSE(maps(loaded, "target_velocity"));
  EXPECT_EQ(loaded.robot.axes[0].modes.front(), "cyclic_position");
  const Loaded asked = load(", feedback: [velocity_actual], modes: [cyclic_velocity]");
  EXPECT_TRUE(maps(asked, "velocity_actual"));
  EXPECT_TRUE(maps(asked, "target_velocity"));
}

TEST(LoadEds, ValuesAreCheckedAgainstTheEdsBeforeAnythingIsSent) {
  EXPECT_THAT(load(", write: [{object: Controller/Proportional gain, value: 1001}]").problems,
              HasSubstr("1001 is above the limit 1000 of motor.eds"));
  EXPECT_THAT(load(", write: [{object: \"2010:01\", value: 70000}]").problems,
              HasSubstr("axes/shoulder/write[0]/value"));
  EXPECT_THAT(load(", write: [{object: Motor temperature, value: 1}]").problems,
              HasSubstr("`Motor temperature` is read-only"));
  EXPECT_THAT(load(", write: [{object: Motor temprature, value: 1}]").problems,
              HasSubstr("profile generic_cia402 with motor.eds has no object `Motor temprature`, "
                        "did you mean `Motor temperature`?"));
  EXPECT_THAT(load(", pdos: {rpdo1: [controlword, target_position, Controller/Proportional gain], "
                   "tpdo1: [statusword, position_actual]}")
                  .problems,
              HasSubstr("cannot be mapped into an RPDO by motor.eds"));
}

TEST(LoadEds, AnotherLengthThanInTheProfileIsAProblemWithBothSources) {
  const Loaded loaded = load("", "contradicting.eds");
  EXPECT_THAT(loaded.problems,
              HasSubstr("axes/shoulder/eds: 607A:00 is int32 in profile generic_cia402 "
                        "(target_position), but int16 in contradicting.eds:3 (Target position); "
                        "correct the one that is wrong by the drive's manual"));
  EXPECT_THAT(loaded.robot.warnings,
              Contains(HasSubstr("6064:00 is int32 in profile generic_cia402 (position_actual), "
                                 "but uint32 in contradicting.eds:10 (Position actual value); the "
                                 "profile is followed")));
  EXPECT_THAT(loaded.robot.warnings,
              Contains(AllOf(HasSubstr("controlword is mapped into RPDO 1 by profile"),
                             HasSubstr("contradicting.eds:16 says that it cannot be (ro, "
                                       "PDOMapping=0)"))));
}

TEST(LoadEds, HoldingAfterAQuickStopNeeds605Ah) {
  EXPECT_THAT(load(", quick_stop: hold").problems,
              HasSubstr("axes/shoulder/quick_stop: the drive cannot hold after a quick stop: "
                        "motor.eds has no 605A:00"));
  std::ifstream file(cia402::test::testFolder() + "/config/motor.eds");
  std::ostringstream motor;
  motor << file.rdbuf();
  const std::string path = testing::TempDir() + "holding_" + std::to_string(getpid()) + ".eds";
  std::ofstream(path) << motor.str()
                      << "\n[605A]\nParameterName=Quick stop option code\nObjectType=7\n"
                         "DataType=3\nAccessType=rw\nPDOMapping=0\n";
  EXPECT_EQ(load(", quick_stop: hold", path).problems, "");
}

TEST(LoadEds, DamageInTheFileIsAWarningWithItsLineOnceAFile) {
  const Loaded loaded = load("", "contradicting.eds");
  int told = 0;
  for (const std::string& warning : loaded.robot.warnings) {
    told += warning.find("contradicting.eds: line 14: error: `nonsense` has no `=`") !=
                    std::string::npos
                ? 1
                : 0;
  }
  EXPECT_EQ(told, 1);
}

TEST(LoadEds, AFileThatIsNotThereOrNoEdsIsRefused) {
  EXPECT_THAT(load("", "nobody.eds").problems,
              HasSubstr("axes/shoulder/eds: there is no file `nobody.eds`"));
  EXPECT_THAT(load("", "ten_mistakes.yaml").problems,
              HasSubstr("describes no object: it is no EDS or DCF"));
}

}  // namespace
}  // namespace cia402::config
