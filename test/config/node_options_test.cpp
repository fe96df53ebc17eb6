// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The keys of an axis for supervision and boot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/robot.h"
#include "folders.h"

namespace cia402::config {
namespace {

using canopen::ErrorControl;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct LoadedNode {
  std::string problems;
  RobotConfig robot;
  canopen::NodeConfig node;
  double load = 0.0;
};

LoadedNode loadNode(const std::string& keys, const std::string& bus = "heartbeat: 0.1") {
  Problems problems;
  LoadedNode loaded;
  const YAML::Node tree =
      YAML::Load("bus: {interface: can0, " + bus +
                 "}\naxes: {a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000, limits: "
                 "{velocity: 1, acceleration: 1}" +
                 (keys.empty() ? "" : ", " + keys) + "}}");
  const std::string drives = cia402::test::configFolder() + "/drives";
  loaded.robot = loadRobot(tree, profilesIn({drives}), problems);
  if (problems.empty()) {
    const canopen::MasterConfig master = makeMasterConfig(loaded.robot, problems);
    loaded.node = master.nodes.at(0);
    loaded.load = busLoad(master, 1e6).nominal;
  }
  loaded.problems = problems.text();
  return loaded;
}

TEST(NodeOptions, WithoutThemTheBusHeartbeatIsWatchedBothWays) {
  const canopen::NodeConfig node = loadNode("").node;
  EXPECT_EQ(node.error_control, ErrorControl::heartbeat);
  EXPECT_EQ(node.heartbeat, milliseconds(100));
  EXPECT_EQ(node.heartbeat_timeout, milliseconds(300));
  EXPECT_EQ(node.master_timeout, milliseconds(300));
  EXPECT_FALSE(node.boot.optional || node.boot.restore_before_configure);
  EXPECT_EQ(node.boot.check, canopen::ConfigurationCheck::none);
}

TEST(NodeOptions, HeartbeatTimesGoByAxis) {
  const canopen::NodeConfig node =
      loadNode("error_control: {period: 0.25, timeout: 1.0, master_timeout: 0.5}").node;
  EXPECT_EQ(node.heartbeat, milliseconds(250));
  EXPECT_EQ(node.heartbeat_timeout, milliseconds(1000));
  EXPECT_EQ(node.master_timeout, milliseconds(500));
}

TEST(NodeOptions, GuardingByAWordTakesTheTimesOfTheBus) {
  const LoadedNode loaded = loadNode("error_control: guarding");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_EQ(loaded.node.error_control, ErrorControl::guarding);
  EXPECT_EQ(loaded.node.guard_time, milliseconds(100));
  EXPECT_EQ(loaded.node.life_time_factor, 3);
  EXPECT_EQ(loaded.node.heartbeat, Duration(0));
  EXPECT_EQ(loaded.node.heartbeat_timeout, Duration(0));
  EXPECT_EQ(loaded.node.master_timeout, Duration(0));
  EXPECT_TRUE(loaded.robot.warnings.empty());
}

TEST(NodeOptions, GuardingCountsForTheBusLoadAsRequestAndAnswer) {
  // A heartbeat and an answer have 55 bits, a request 47, ten times a second.
  EXPECT_NEAR(loadNode("error_control: guarding").load - loadNode("").load, 470.0 / 1e6, 1e-9);
}

TEST(NodeOptions, TheLifeTimeFactorIsTheRatioOfTheTimes) {
  const canopen::NodeConfig node =
      loadNode("error_control: {kind: guarding, period: 0.2, timeout: 1.0}").node;
  EXPECT_EQ(node.guard_time, milliseconds(200));
  EXPECT_EQ(node.life_time_factor, 5);
}

TEST(NodeOptions, NoneIsPossibleAndWarnedOf) {
  const LoadedNode loaded = loadNode("error_control: none");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_EQ(loaded.node.error_control, ErrorControl::none);
  EXPECT_EQ(loaded.node.heartbeat, Duration(0));
  EXPECT_EQ(loaded.node.master_timeout, milliseconds(300)) << "it still watches the master";
  ASSERT_EQ(loaded.robot.warnings.size(), 1u);
  EXPECT_THAT(loaded.robot.warnings[0], HasSubstr("axes/a: this drive is not supervised"));
}

TEST(NodeOptions, WithoutAHeartbeatOfTheBusEachAxisIsJudgedByItsOwn) {
  const auto warnings = [](const std::string& keys) {
    return loadNode(keys, "heartbeat: 0").robot.warnings;
  };
  EXPECT_THAT(warnings(""), ElementsAre(HasSubstr("bus/heartbeat: is 0")));
  EXPECT_THAT(warnings("error_control: {kind: guarding, period: 0.1, timeout: 0.3}"), IsEmpty());
  EXPECT_THAT(warnings("error_control: {period: 0.1}"),
              ElementsAre(HasSubstr("axes/a: this drive watches no heartbeat")));
  EXPECT_THAT(
      loadNode("error_control: {period: 0.1, master_timeout: 0.3}", "heartbeat: 0").problems,
      HasSubstr("`master_timeout` waits for the heartbeat of this program, which has none"));
}

TEST(NodeOptions, BootOptionsReachTheMaster) {
  const canopen::BootPolicy policy =
      loadNode(
          "optional: true, restore_before_configure: true, configuration_check: checksum, boot: "
          "{retries: 5, retry_delay: 0.5, search_period: 10}")
          .node.boot;
  EXPECT_TRUE(policy.optional);
  EXPECT_TRUE(policy.restore_before_configure);
  EXPECT_EQ(policy.check, canopen::ConfigurationCheck::checksum);
  EXPECT_EQ(policy.retries, 5u);
  EXPECT_EQ(policy.retry_delay, milliseconds(500));
  EXPECT_EQ(policy.search_period, milliseconds(10000));
}

TEST(NodeOptions, AnSdoChannelOfOtherCobIdsReachesTheMaster) {
  const LoadedNode loaded = loadNode("sdo: {request: 0x641, answer: 0x5C1}");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_EQ(loaded.node.sdo_channel.request, 0x641);
  EXPECT_EQ(loaded.node.sdo_channel.answer, 0x5C1);
  EXPECT_EQ(loadNode("").node.sdo_channel.request, 0) << "the predefined ones";
}

TEST(NodeOptions, AnSdoChannelMayNotTakeTheIdentifiersOfOthers) {
  const auto problem = [](const char* request, const char* answer) {
    return loadNode(std::string("sdo: {request: ") + request + ", answer: " + answer + "}")
        .problems;
  };
  EXPECT_THAT(problem("0x641", "0x181"),
              HasSubstr("axes/a/sdo/answer: COB-ID 0x181 belongs to TPDO 1 of a already"));
  EXPECT_THAT(problem("0x080", "0x5C1"), HasSubstr("axes/a/sdo/request: COB-ID 0x080 belongs to "
                                                   "SYNC already"));
  EXPECT_THAT(problem("0x641", "0x701"), HasSubstr("error control of a already"));
  EXPECT_THAT(problem("0x641", "0x77F"), HasSubstr("the heartbeat of this program already"));
  EXPECT_THAT(problem("0x641", "0x641"), HasSubstr("the SDO channel of a already"));
  EXPECT_EQ(problem("0x601", "0x581"), "") << "written out, the predefined ones";
  EXPECT_THAT(problem("0x800", "0x581"), HasSubstr("axes/a/sdo/request"));
  EXPECT_THAT(loadNode("sdo: {request: 0x641}").problems, HasSubstr("`answer` is missing"));
}

TEST(NodeOptions, WhatWouldBeIgnoredIsRefused) {
  EXPECT_THAT(loadNode("feedback: [velocity_actual], pdos: {rpdo1: [controlword, target_position], "
                       "tpdo1: [statusword, position_actual]}")
                  .problems,
              HasSubstr("axes/a/feedback: says nothing beside `pdos`"));
  Problems problems;
  const YAML::Node tree = YAML::Load(
      "bus: {interface: can0}\naxes: {a: {node_id: 1, drive: own_pdos_drive, counts_per_turn: "
      "1000, "
      "limits: {velocity: 1, acceleration: 1}, feedback: [mode_display], error_control: "
      "{master_timeout: 1.0}}}");
  const auto file = [](const std::string& drive) {
    return cia402::test::testFolder() + "/config/" + drive + ".yaml";
  };
  loadRobot(tree, file, problems);
  EXPECT_THAT(problems.text(),
              HasSubstr("profile own_pdos_drive says that the drive watches no heartbeat"));
  EXPECT_THAT(problems.text(),
              HasSubstr("axes/a/feedback: says nothing here: profile own_pdos_drive has PDOs"));
}

TEST(NodeOptions, ADateBecomesTheNumbersOf1020h) {
  const canopen::BootPolicy moment = loadNode("configuration_check: 2026-11-21T15:30:00").node.boot;
  EXPECT_EQ(moment.check, canopen::ConfigurationCheck::date);
  EXPECT_EQ(moment.date, 15665u);
  EXPECT_EQ(moment.time, 55800000u);
  const canopen::BootPolicy day = loadNode("configuration_check: 1984-03-01").node.boot;
  EXPECT_EQ(day.date, 60u) << "1984 is a leap year";
  EXPECT_EQ(day.time, 0u);
}

TEST(NodeOptions, MistakesAreNamedWithARemedy) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"error_control: guardin", "axes/a/error_control"},
      {"error_control: {kind: guarding, period: 0.1, timeout: 0.25}",
       "`timeout` (0.25 s) must be 2 to 255 times `period` (0.1 s)"},
      {"error_control: {kind: guarding, period: 0.1, timeout: 0.1}", "must be 2 to 255 times"},
      {"error_control: {kind: guarding, period: 0.1, timeout: 25.6}", "must be 2 to 255 times"},
      {"error_control: {kind: guarding, master_timeout: 0.3}",
       "`master_timeout` is for heartbeats"},
      {"error_control: {period: 0.2, timeout: 0.1}", "must be longer than `period`"},
      {"error_control: {period: 0.2, timeout: 0.2}", "must be longer than `period`"},
      {"error_control: {period: 0.0004}", "axes/a/error_control/period"},
      {"error_control: {period: 0.1005}", "whole number of milliseconds"},
      {"error_control: {period: 66}", "axes/a/error_control/period"},
      {"error_control: {master_timeout: 0.1}", "must be longer than bus/heartbeat"},
      {"error_control: {kind: none, master_timeout: 0.05}", "must be longer than bus/heartbeat"},
      {"error_control: {kind: none, period: 0.1}", "`none` has neither"},
      {"error_control: {perod: 0.1}", "did you mean `period`"},
      {"optional: perhaps", "axes/a/optional"},
      {"configuration_check: sometimes", "must be none, checksum, or the date"},
      {"configuration_check: 2026-02-30", "must be none, checksum, or the date"},
      {"configuration_check: 1983-12-31", "must be none, checksum, or the date"},
      {"configuration_check: 2026-11-21T15:30", "must be none, checksum, or the date"},
      {"configuration_check: 2026-11-21T15:30:00Z", "must be none, checksum, or the date"},
      {"configuration_check: 2026-11-21x", "must be none, checksum, or the date"},
      {"configuration_check: 2026-11-2115:30:00", "must be none, checksum, or the date"},
      {"boot: {retries: -1}", "axes/a/boot/retries"},
      {"boot: {retry_delay: 0}", "axes/a/boot/retry_delay"}};
  for (const auto& [keys, problem] : cases) {
    EXPECT_THAT(loadNode(keys).problems, HasSubstr(problem)) << keys;
  }
  EXPECT_THAT(loadNode("error_control: guarding", "heartbeat: 0").problems,
              HasSubstr("needs a `period`, as bus/heartbeat is 0"));
}

}  // namespace
}  // namespace cia402::config
