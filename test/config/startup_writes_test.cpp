// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What is written into a drive when it boots, and what is said about each write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using canopen::StartupWrite;
using testing::ElementsAre;
using testing::HasSubstr;

/// A generic servo with further keys of the bus and of the axis.
RobotConfig bootedServo(const std::string& axis, const std::string& bus = "") {
  const LoadedRobot loaded = loadText(
      "bus: {interface: can0" + bus +
      "}\naxes:\n  servo: {node_id: 5, drive: generic_cia402, counts_per_turn: 4000, limits: "
      "{velocity: 2.0, acceleration: 8.0}" +
      axis + "}\n");
  EXPECT_EQ(loaded.problems, "");
  return loaded.robot;
}

std::vector<StartupWrite> writesOf(const RobotConfig& robot) {
  Problems problems;
  const canopen::MasterConfig master = makeMasterConfig(robot, problems);
  EXPECT_EQ(problems.text(), "");
  return master.nodes.at(0).writes;
}

StartupWrite writeTo(const std::vector<StartupWrite>& writes, fieldbus::ObjectId object) {
  for (const StartupWrite& write : writes) {
    if (write.object == object) return write;
  }
  ADD_FAILURE() << toString(object) << " is not written";
  return {};
}

TEST(StartupWrites, AQuickStopComesFirstAtEveryBoot) {
  const std::vector<StartupWrite> writes = writesOf(bootedServo(""));
  const StartupWrite& stop = writes.at(0);
  EXPECT_EQ(stop.object, (fieldbus::ObjectId{0x6040, 0}));
  EXPECT_EQ(stop.name, "controlword");
  EXPECT_THAT(stop.data, ElementsAre(0x02, 0x00));  // enable voltage without "no quick stop"
  EXPECT_TRUE(stop.always);
  EXPECT_TRUE(stop.optional);
  EXPECT_FALSE(stop.only_if_different) << "one answer sooner";
  for (std::size_t i = 1; i < writes.size(); ++i) {
    EXPECT_FALSE(writes[i].always) << writes[i].name;
    EXPECT_TRUE(writes[i].only_if_different) << writes[i].name;
  }
}

TEST(StartupWrites, AreCalledByTheNamesOfTheProfile) {
  const auto writes = writesOf(bootedServo(
      ", write: [{object: \"0x6065\", value: 5000}, {object: \"2000:01\", value: 5, type: "
      "uint16}]",
      ", sync_window: 0.002"));
  EXPECT_EQ(writeTo(writes, {0x6081, 0}).name, "profile_velocity");
  EXPECT_EQ(writeTo(writes, {0x6065, 0}).name, "following_error_window") << "given by its index";
  EXPECT_EQ(writeTo(writes, {0x2000, 1}).name, "") << "nobody knows one";
  EXPECT_THAT(writeTo(writes, {0x2000, 1}).data, ElementsAre(0x05, 0x00));
  const StartupWrite window = writeTo(writes, {0x1007, 0});
  EXPECT_EQ(window.name, "synchronous window length");
  EXPECT_TRUE(window.optional) << "few drives have it";
}

TEST(StartupWrites, GoBeforeThePdosWhereThatIsAskedFor) {
  const auto writes =
      writesOf(bootedServo(", write: [{object: \"6065:00\", value: 5000, before_pdos: true}, "
                           "{object: \"6066:00\", value: 5}]"));
  EXPECT_TRUE(writeTo(writes, {0x6065, 0}).before_pdos);
  EXPECT_FALSE(writeTo(writes, {0x6066, 0}).before_pdos);
}

TEST(StartupWrites, WhatSomebodyAskedForIsNoDefault) {
  const auto plain = writesOf(bootedServo(", write: [{object: position_window, value: 0.1}]"));
  EXPECT_TRUE(writeTo(plain, {0x6081, 0}).by_default) << "the profile's";
  EXPECT_TRUE(writeTo(plain, {0x605A, 0}).by_default);
  EXPECT_TRUE(writeTo(plain, {0x605A, 0}).optional);
  EXPECT_FALSE(writeTo(plain, {0x6067, 0}).by_default) << "the user's";
  const auto holding = writesOf(bootedServo(", quick_stop: hold"));
  EXPECT_FALSE(writeTo(holding, {0x605A, 0}).by_default) << "the profile's, but asked for";
  EXPECT_FALSE(writeTo(holding, {0x605A, 0}).optional);
  EXPECT_THAT(writeTo(holding, {0x605A, 0}).data, ElementsAre(0x06, 0x00));
}

TEST(StartupWrites, AValueThatDoesNotFitIsAProblemOfItsAxis) {
  RobotConfig robot = bootedServo("");
  robot.axes[0].limits.velocity = 1e12;
  Problems problems;
  makeMasterConfig(robot, problems);
  EXPECT_THAT(problems.text(),
              HasSubstr("  axes/servo: servo (node 5): profile_velocity (6081:00): "
                        "1e+12 does not fit; the object holds 0 to "));
}

TEST(StartupWrites, WhatIsLeftOutIsSaidToBeRightByTheKeyLacks) {
  Problems problems;
  EXPECT_THAT(makeMasterConfig(bootedServo(""), problems).nodes.at(0).lacking_remedy,
              HasSubstr("`lacks` of axes/servo"));
}

/// The entry of the plan that carries `object`.
canopen::PdoEntry plannedEntry(const RobotConfig& robot, const std::string& object) {
  Problems problems;
  const canopen::MasterConfig master = makeMasterConfig(robot, problems);
  for (const canopen::PdoConfig& pdo : master.nodes.at(0).pdos) {
    for (const canopen::PdoEntry& candidate : pdo.entries) {
      if (candidate.name == object) return candidate;
    }
  }
  ADD_FAILURE() << object << " is not in the plan";
  return {};
}

TEST(PlannedObjects, AreOptionalWhereOnlyDefaultsAskForThem) {
  const RobotConfig plain = bootedServo("");
  EXPECT_FALSE(plannedEntry(plain, "controlword").optional);
  EXPECT_FALSE(plannedEntry(plain, "target_position").optional) << "of the mode to start in";
  EXPECT_FALSE(plannedEntry(plain, "position_actual").optional);
  EXPECT_TRUE(plannedEntry(plain, "target_velocity").optional) << "of modes that nobody named";
  EXPECT_TRUE(plannedEntry(plain, "velocity_actual").optional);
  EXPECT_FALSE(plannedEntry(plain, "velocity_actual").if_room);
  EXPECT_TRUE(plannedEntry(plain, "following_error").if_room);
  EXPECT_TRUE(plannedEntry(plain, "following_error").optional);
  const RobotConfig asked = bootedServo(", modes: [csv], feedback: [velocity_actual]");
  EXPECT_FALSE(plannedEntry(asked, "target_velocity").optional);
  EXPECT_FALSE(plannedEntry(asked, "velocity_actual").optional);
}

TEST(PlannedObjects, VelocitiesComeAsOftenAsJointStates) {
  const auto every = [](const std::string& rate, const std::string& cycle = "0.004") {
    const LoadedRobot loaded =
        changed("0.004}", cycle + "}" + (rate.empty() ? "" : "\njoint_state_rate: " + rate));
    EXPECT_EQ(loaded.problems, "");
    for (const canopen::PdoLayout& pdo : loaded.robot.devices[0].axes[0].pdos) {
      for (const std::string& object : pdo.objects) {
        if (object == "velocity_actual") return unsigned{pdo.transmission};
      }
    }
    return 0U;
  };
  EXPECT_EQ(every(""), 2U) << "10 ms in a cycle of 4 ms";
  EXPECT_EQ(every("100"), 2U);
  EXPECT_EQ(every("200"), 1U) << "5 ms";
  EXPECT_EQ(every("10"), 2U) << "never older than 10 ms";
  EXPECT_EQ(every("", "0.002"), 5U);
  EXPECT_EQ(every("", "0.01"), 1U);
}

TEST(CobIds, AreThoseThatCiA301LeavesToPdos) {
  const auto problems = [](const std::string& cob_id) {
    return loadText(
               "bus: {interface: can0}\naxes:\n  servo: {node_id: 5, drive: generic_cia402, "
               "counts_per_turn: 4000, limits: {velocity: 2.0, acceleration: 8.0}, pdos: {rpdo1: "
               "[controlword, target_position], tpdo1: {objects: [statusword, position_actual], "
               "cob_id: \"" +
               cob_id + "\"}}}\n")
        .problems;
  };
  for (const char* allowed : {"0x181", "0x57F", "0x680", "0x6DF"}) {
    EXPECT_EQ(problems(allowed), "") << allowed;
  }
  for (const char* kept : {"0x580", "0x67F"}) {
    EXPECT_THAT(problems(kept), HasSubstr("axes/servo/pdos: tpdo1 would have the COB-ID " +
                                          std::string(kept) + ", which CiA 301 keeps"));
  }
  for (const char* refused : {"0x180", "0x6E0"}) {
    EXPECT_THAT(problems(refused), HasSubstr("tpdo1/cob_id: must be `drive`, a number from 0x181"))
        << refused;
  }
}

}  // namespace
}  // namespace cia402::config
