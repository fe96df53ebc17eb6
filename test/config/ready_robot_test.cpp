// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/ready_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using testing::HasSubstr;

std::optional<ReadyRobot> readied(const std::string& yaml, Problems& problems) {
  return readyRobot(YAML::Load(yaml), profilesIn({cia402::test::configFolder() + "/drives"}),
                    problems);
}

TEST(ReadyRobot, IsARobotAndItsMaster) {
  Problems problems;
  const auto robot = readied(kArm, problems);
  EXPECT_EQ(problems.text(), "");
  ASSERT_TRUE(robot);
  EXPECT_EQ(robot->robot.axes.size(), 2U);
  ASSERT_EQ(robot->master.nodes.size(), 2U);
  EXPECT_EQ(robot->master.nodes[1].name, "elbow");
}

TEST(ReadyRobot, IsNoneWithAMistake) {
  std::string text = kArm;
  text.replace(text.find("node_id: 1,"), 11,
               "node_id: 1, pdos: {rpdo1: [controlword, target_position], tpdo1: {objects: "
               "[statusword, position_actual], cob_id: \"0x600\"}},");
  Problems problems;
  EXPECT_FALSE(readied(text, problems));
  ASSERT_EQ(problems.list().size(), 1U) << problems.text();
  EXPECT_THAT(problems.text(), HasSubstr("COB-ID 0x600, which CiA 301 keeps"));
}

}  // namespace
}  // namespace cia402::config
