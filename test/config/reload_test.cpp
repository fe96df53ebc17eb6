// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/reload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"
#include "config/ready_robot.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr char kPair[] = R"(
bus: {interface: can0, sync_period: 0.004}
defaults: {drive: generic_cia402, counts_per_turn: 4000, limits: {velocity: 2.0, acceleration: 8.0}}
joint_state_rate: 50
axes:
  m1: {node_id: 1, joint: shoulder, gear_ratio: 50.0, limits: {lower: -3.0, upper: 3.0}}
  elbow: {node_id: 2, homing: {method: 17, search_velocity: 0.5}}
groups:
  arm: {joints: [shoulder, elbow], constraints: {goal_time: 1.0, elbow: {goal: 0.01}}}
)";

YAML::Node settledText(const std::string& yaml) {
  const LoadedRobot loaded = loadText(yaml);
  EXPECT_EQ(loaded.problems, "");
  return settledTree(YAML::Load(yaml), loaded.robot);
}

std::string pairWith(const std::string& from, const std::string& to) {
  std::string text = kPair;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::vector<Change> changesBy(const std::string& from, const std::string& to) {
  return changesOf(settledText(kPair), settledText(pairWith(from, to)));
}

auto isChange(const std::string& key, const std::string& before, const std::string& after,
              ChangeTime when) {
  return AllOf(Field(&Change::key, key), Field(&Change::before, before),
               Field(&Change::after, after), Field(&Change::when, when));
}

TEST(Reload, FindsNothingWhereNothingDiffers) {
  EXPECT_THAT(changesOf(settledText(kPair), settledText(kPair)), IsEmpty());
  EXPECT_THAT(changesBy("joint_state_rate: 50", "joint_state_rate: 5.0e1"), IsEmpty());
  EXPECT_THAT(changesBy("goal_time: 1.0, ", "goal_time: 1, shoulder: {}, "), IsEmpty())
      << "an empty section says nothing";
}

TEST(Reload, TellsAValueWithTheOneOfBefore) {
  EXPECT_THAT(changesBy("joint_state_rate: 50", "joint_state_rate: 100"),
              ElementsAre(isChange("joint_state_rate", "50", "100", ChangeTime::running)));
  EXPECT_THAT(changesBy("lower: -3.0", "lower: -2.0"),
              ElementsAre(isChange("axes/m1/limits/lower", "-3.0", "-2.0", ChangeTime::disabled)));
  const auto changes = changesBy("node_id: 2,", "node_id: 3,");
  EXPECT_THAT(changes, ElementsAre(isChange("axes/elbow/node_id", "2", "3", ChangeTime::restart)));
  EXPECT_THAT(changes[0].because, HasSubstr("identifiers"));
}

TEST(Reload, TellsWhatIsGivenAnewOrNoMore) {
  EXPECT_THAT(
      changesBy("goal_time: 1.0, ", ""),
      ElementsAre(isChange("groups/arm/constraints/goal_time", "1.0", "", ChangeTime::running)));
  EXPECT_THAT(changesBy("elbow: {goal: 0.01}", "elbow: {goal: 0.01}, shoulder: {trajectory: 0.1}"),
              ElementsAre(isChange("groups/arm/constraints/shoulder/trajectory", "", "0.1",
                                   ChangeTime::running)));
}

TEST(Reload, SeesADefaultInEachAxisThatHasIt) {
  EXPECT_THAT(
      changesBy("velocity: 2.0", "velocity: 1.0"),
      ElementsAre(isChange("axes/elbow/limits/velocity", "2.0", "1.0", ChangeTime::disabled),
                  isChange("axes/m1/limits/velocity", "2.0", "1.0", ChangeTime::disabled)));
  EXPECT_THAT(changesBy("limits: {lower: -3.0, upper: 3.0}}",
                        "limits: {lower: -3.0, upper: 3.0, velocity: 2.0}}"),
              IsEmpty());
}

TEST(Reload, ALimitThatIsTakenAwayStaysInTheDrive) {
  const auto changes = changesBy("lower: -3.0, upper: 3.0", "lower: -3.0");
  EXPECT_THAT(changes,
              ElementsAre(isChange("axes/m1/limits/upper", "3.0", "", ChangeTime::restart)));
  EXPECT_THAT(changes[0].because, HasSubstr("give a wider one instead"));
}

TEST(Reload, AHomingSectionIsNotMadeOrTakenAwayUnderWay) {
  EXPECT_THAT(changesBy("search_velocity: 0.5", "search_velocity: 0.25"),
              ElementsAre(isChange("axes/elbow/homing/search_velocity", "0.5", "0.25",
                                   ChangeTime::disabled)));
  EXPECT_THAT(
      changesBy("search_velocity: 0.5", "offset: 0.5"),
      ElementsAre(isChange("axes/elbow/homing/offset", "", "0.5", ChangeTime::restart),
                  isChange("axes/elbow/homing/search_velocity", "0.5", "", ChangeTime::restart)));
  EXPECT_THAT(changesBy(", homing: {method: 17, search_velocity: 0.5}", ""),
              Each(Field(&Change::when, ChangeTime::restart)));
  EXPECT_THAT(changesBy("upper: 3.0}}", "upper: 3.0}, homing: {method: 17, order: 1}}"),
              Each(Field(&Change::when, ChangeTime::restart)));
}

TEST(Reload, WhatIsGivenWithAnotherUnitWaitsForTheRestart) {
  const auto changes = changesBy("gear_ratio: 50.0, limits: {lower: -3.0, ",
                                 "type: prismatic, lead: 0.01, limits: {lower: -0.3, ");
  EXPECT_THAT(changes, Each(Field(&Change::when, ChangeTime::restart)));
  ASSERT_EQ(changes.size(), 4U);
  EXPECT_EQ(changes[2].key, "axes/m1/limits/lower");
  EXPECT_THAT(changes[2].because, HasSubstr("together with a new axes/m1/gear_ratio"));
  const auto group = changesBy("joints: [shoulder, elbow], constraints: {goal_time: 1.0",
                               "joints: [elbow], constraints: {goal_time: 2.0");
  EXPECT_THAT(group, Each(Field(&Change::when, ChangeTime::restart)));
  EXPECT_EQ(group.size(), 2U);
}

TEST(Reload, WhatIsSeenOnlyHoldsNothingBack) {
  const auto changes = changesBy("lower: -3.0, upper: 3.0}",
                                 "lower: -2.0, upper: 3.0}, simulation: {brake_delay: 0.1}");
  EXPECT_THAT(
      changes,
      ElementsAre(isChange("axes/m1/limits/lower", "-3.0", "-2.0", ChangeTime::disabled),
                  isChange("axes/m1/simulation/brake_delay", "", "0.1", ChangeTime::restart)));
}

TEST(Reload, OfOtherAxesGoesOn) {
  std::string text = pairWith("node_id: 2,", "node_id: 3,");
  text.replace(text.find("lower: -3.0"), 11, "lower: -2.0");
  EXPECT_THAT(changesOf(settledText(kPair), settledText(text)),
              ElementsAre(isChange("axes/elbow/node_id", "2", "3", ChangeTime::restart),
                          isChange("axes/m1/limits/lower", "-3.0", "-2.0", ChangeTime::disabled)));
}

TEST(Reload, ATreeWithSomeChangesIsTheOldOneButForThese) {
  std::string text = pairWith("node_id: 2,", "node_id: 3,");
  text.replace(text.find("lower: -3.0"), 11, "lower: -2.0");
  text.replace(text.find("goal_time: 1.0, "), 16, "");
  const YAML::Node before = settledText(kPair), after = settledText(text);
  std::vector<Change> changes = changesOf(before, after);
  ASSERT_EQ(changes.size(), 3U);
  changes.erase(changes.begin());  // the node-ID
  const YAML::Node tree = withChanges(before, changes, after);
  EXPECT_THAT(changesOf(before, settledText(kPair)), IsEmpty()) << "the old tree was changed";
  Problems problems;
  const RobotConfig robot =
      loadRobot(tree, profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_EQ(robot.axes[0].limits.lower, -2.0);
  EXPECT_EQ(robot.axes[0].limits.velocity, 2.0);
  EXPECT_EQ(robot.deviceOf(robot.axes[1]).node_id, 2);
  EXPECT_EQ(robot.groups[0].goal_time, 0.4) << "as if it were not given";
  EXPECT_EQ(robot.groups[0].tolerances.at("elbow").goal, 0.01);
}

TEST(Reload, AGroupThatIsThereWithoutBeingGivenIsGiven) {
  std::string text = kPair;
  text.erase(text.find("groups:"));
  const YAML::Node tree = settledText(text);
  ASSERT_TRUE(tree["groups"]["joints"]["joints"].IsSequence());
  EXPECT_EQ(tree["groups"]["joints"]["joints"].size(), 2U);
  EXPECT_THAT(changesOf(tree, settledText(text + "groups: {joints: {joints: [shoulder, elbow]}}")),
              IsEmpty());
}

TEST(Reload, SaysInWordsWhatHasBecomeOfAChange) {
  const RobotConfig robot = loadText(kPair).robot;
  ChangeReport report;
  EXPECT_EQ(toString(report, robot), "nothing has changed");
  report.changed = changesBy("lower: -3.0", "lower: -2.0");
  report.waiting = changesBy("goal: 0.01", "trajectory: 0.5");
  report.waits_for = "elbow (node 2): it is not disabled";
  report.restart = changesBy("node_id: 2,", "node_id: 3,");
  EXPECT_EQ(toString(report, robot),
            "changed: axes/m1/limits/lower (joint shoulder): -3.0 -> -2.0\n"
            "only while all axes are disabled: groups/arm/constraints/elbow/goal: 0.01 -> not "
            "given; groups/arm/constraints/elbow/trajectory: not given -> 0.5 (elbow (node 2): it "
            "is not disabled)\n"
            "needs a restart of the node: axes/elbow/node_id: 2 -> 3, because the identifiers of "
            "all its frames are made of it");
}

TEST(ReloadRules, KnowEveryKey) {
  for (const char* key : {"x", "axes/a/b", "axes/a/b/c/d", "bus/x", "groups/g/joints", "a/b/c"}) {
    EXPECT_EQ(reloadRuleOf(key).when, ChangeTime::restart) << key;
    EXPECT_STRNE(reloadRuleOf(key).because, "") << key;
  }
  EXPECT_EQ(reloadRuleOf("axes/a/limits/upper").when, ChangeTime::disabled);
  EXPECT_EQ(reloadRuleOf("axes/a/homing/order").when, ChangeTime::disabled);
  EXPECT_EQ(reloadRuleOf("axes/a/homing/offset").when, ChangeTime::restart);
  EXPECT_EQ(reloadRuleOf("axes/a/pdos/rpdo1").when, ChangeTime::restart);
  EXPECT_EQ(reloadRuleOf("couplings").when, ChangeTime::restart);
  EXPECT_THAT(reloadRuleOf("couplings").because, HasSubstr("how a skew is taken back"));
}

TEST(Tunables, AreWhatCanBeChangedAtAnyTimeWithTheirValues) {
  const RobotConfig robot = loadText(kPair).robot;
  std::map<std::string, double> values;
  for (const Tunable& tunable : tunablesOf(robot)) {
    EXPECT_EQ(reloadRuleOf(tunable.key).when, ChangeTime::running) << tunable.key;
    EXPECT_LE(tunable.low, tunable.value) << tunable.key;
    EXPECT_GE(tunable.high, tunable.value) << tunable.key;
    EXPECT_TRUE(values.emplace(tunable.key, tunable.value).second) << tunable.key << " twice";
  }
  EXPECT_EQ(values.at("joint_state_rate"), 50.0);
  EXPECT_EQ(values.at("groups/arm/constraints/goal_time"), 1.0);
  EXPECT_EQ(values.at("groups/arm/constraints/elbow/goal"), 0.01);
  EXPECT_EQ(values.at("groups/arm/constraints/shoulder/goal"), 0.0);
  EXPECT_EQ(values.at("axes/m1/command_timeout"), 0.2);
  EXPECT_EQ(values.count("axes/m1/position_loop/gain"), 0U) << "it has no such loop";
}

TEST(Tunables, CanAllBeGivenInARobotsFile) {
  const RobotConfig robot = loadText(kPair).robot;
  const auto valueOf = [&robot](const std::string& key) {
    for (const Tunable& tunable : tunablesOf(robot)) {
      if (tunable.key == key) return tunable.value;
    }
    return -1.0;
  };
  for (const Tunable& tunable : tunablesOf(robot)) {
    YAML::Node tree = settledText(kPair);
    YAML::Node place = tree;
    std::string rest = tunable.key;
    for (std::size_t at = rest.find('/'); at != std::string::npos; at = rest.find('/')) {
      place.reset(place[rest.substr(0, at)]);
      rest.erase(0, at + 1);
    }
    const double other = tunable.is_flag ? 1.0 - tunable.value : tunable.value + 0.0625;
    place[rest] = tunable.is_flag ? (other != 0.0 ? "true" : "false") : std::to_string(other);
    Problems problems;
    const RobotConfig changed =
        loadRobot(tree, profilesIn({cia402::test::configFolder() + "/drives"}), problems);
    EXPECT_EQ(problems.text(), "") << tunable.key;
    for (const Tunable& now : tunablesOf(changed)) {
      EXPECT_DOUBLE_EQ(now.value, now.key == tunable.key ? other : valueOf(now.key)) << now.key;
    }
  }
}

}  // namespace
}  // namespace cia402::config
