// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/reconfigure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace cia402::ros_node {
namespace {

using dynamic_reconfigure::Config;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

const std::vector<config::Tunable> kTunables = {
    {"joint_state_rate", false, 50.0, 0.0, 1000.0, "Hz"},
    {"groups/arm/constraints/goal_time", false, 0.5, 0.0, 100.0, "s"},
    {"groups/arm/allow_partial_joints_goal", true, 0.0, 0.0, 1.0, "flag"},
    {"axes/elbow/command_timeout", false, 0.25, 0.0, 60.0, "s"},
};

Config& number(Config& config, const std::string& key, double value) {
  dynamic_reconfigure::DoubleParameter parameter;
  parameter.name = key;
  parameter.value = value;
  config.doubles.push_back(parameter);
  return config;
}

Config& flag(Config& config, const std::string& key, bool value) {
  dynamic_reconfigure::BoolParameter parameter;
  parameter.name = key;
  parameter.value = value;
  config.bools.push_back(parameter);
  return config;
}

std::map<std::string, std::string> taken(const Config& config, std::string& problems) {
  Problems found;
  auto values = valuesOf(config, kTunables, found);
  problems = found.text();
  return values;
}

TEST(Reconfigure, TakesWhatDiffers) {
  Config config;
  number(config, "joint_state_rate", 50.0);
  number(config, "groups/arm/constraints/goal_time", 0.1);
  flag(config, "groups/arm/allow_partial_joints_goal", true);
  std::string problems;
  EXPECT_THAT(taken(config, problems),
              ElementsAre(Pair("groups/arm/allow_partial_joints_goal", "true"),
                          Pair("groups/arm/constraints/goal_time", "0.10000000000000001")));
  EXPECT_EQ(problems, "");
}

TEST(Reconfigure, TakesAWholeNumberForANumber) {
  Config config;
  dynamic_reconfigure::IntParameter whole;
  whole.name = "joint_state_rate";
  whole.value = 20;
  config.ints.push_back(whole);
  std::string problems;
  EXPECT_THAT(taken(config, problems), ElementsAre(Pair("joint_state_rate", "20")));
}

TEST(Reconfigure, PassesOnWhatIsNoNumberForTheLoaderToRefuse) {
  Config config;
  number(config, "joint_state_rate", std::numeric_limits<double>::quiet_NaN());
  number(config, "axes/elbow/command_timeout", -std::numeric_limits<double>::infinity());
  std::string problems;
  EXPECT_THAT(taken(config, problems), ElementsAre(Pair("axes/elbow/command_timeout", "-.inf"),
                                                   Pair("joint_state_rate", ".nan")));
}

TEST(Reconfigure, NamesWhatItDoesNotHaveAndWhatIsOfAnotherKind) {
  Config config;
  number(config, "axes/elbow/limits/velocity", 1.0);
  number(config, "groups/arm/allow_partial_joints_goal", 1.0);
  flag(config, "joint_state_rate", true);
  dynamic_reconfigure::StrParameter text;
  text.name = "axes/elbow/command_timeout";
  config.strs.push_back(text);
  text.name = "last_change";
  config.strs.push_back(text);
  std::string problems;
  taken(config, problems);
  for (const char* words :
       {"axes/elbow/limits/velocity: is nothing that can be changed here",
        "groups/arm/allow_partial_joints_goal: must be true or false",
        "joint_state_rate: must be a number", "axes/elbow/command_timeout: must be a number"}) {
    EXPECT_THAT(problems, HasSubstr(words));
  }
  EXPECT_THAT(problems, testing::Not(HasSubstr("last_change")));
}

TEST(Reconfigure, DescribesEachParameterOnceInItsGroup) {
  const auto all = descriptionOf(kTunables);
  ASSERT_EQ(all.groups.size(), 3U);
  const std::vector<std::string> names = {"Default", "groups/arm", "axes/elbow"};
  const std::vector<std::size_t> sizes = {2, 2, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all.groups[i].name, names[i]);
    EXPECT_EQ(all.groups[i].id, static_cast<int>(i));
    EXPECT_EQ(all.groups[i].parameters.size(), sizes[i]);
  }
  EXPECT_EQ(all.groups[0].parameters[1].name, "last_change");
  EXPECT_EQ(all.groups[1].parameters[1].type, "bool");
  EXPECT_EQ(all.max.doubles.size(), 3U);
  EXPECT_EQ(all.max.doubles[0].value, 1000.0);
  EXPECT_EQ(all.dflt.bools.size(), 1U);
}

TEST(Reconfigure, TellsTheValuesWithTheStateOfEachGroup) {
  const Config config = configOf(kTunables, "changed: x");
  ASSERT_EQ(config.doubles.size(), 3U);
  EXPECT_EQ(config.doubles[0].value, 50.0);
  ASSERT_EQ(config.strs.size(), 1U);
  EXPECT_EQ(config.strs[0].value, "changed: x");
  ASSERT_EQ(config.groups.size(), 3U);
  EXPECT_EQ(config.groups[2].id, 2);
}

}  // namespace
}  // namespace cia402::ros_node
