// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the documents show of a robot's file must be one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "config/robot.h"
#include "folders.h"

namespace cia402::config {
namespace {

std::string document(const std::string& name) {
  std::ifstream file(cia402::test::configFolder() + "/../" + name);
  EXPECT_TRUE(file.is_open()) << name;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// What stands between the first line that begins with `from` and the next one that is `to`.
std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find("\n" + from);
  if (begin == std::string::npos) return {};
  const std::size_t first = text.find('\n', begin + 1) + 1;
  return text.substr(first, text.find("\n" + to, first) + 1 - first);
}

RobotConfig load(const std::string& yaml, Problems& problems) {
  return loadRobot(YAML::Load(yaml), profilesIn({cia402::test::configFolder() + "/drives"}),
                   problems);
}

TEST(Documents, TheReadmesRobotLoadsWithoutAWarning) {
  Problems problems;
  const RobotConfig robot = load(between(document("README.md"), "```yaml", "```"), problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_THAT(robot.warnings, testing::IsEmpty());
  ASSERT_EQ(robot.axes.size(), 1u);
  EXPECT_EQ(robot.axes[0].name, "shoulder");
}

/// Lines of a PDO plan, without what follows from the other axes.
TEST(Documents, ThePlanInConfigurationMdIsThatOfTheDemo) {
  std::ifstream file(cia402::test::configFolder() + "/robots/demo.yaml");
  std::ostringstream demo;
  demo << file.rdbuf();
  Problems problems;
  const RobotConfig robot = load(demo.str(), problems);
  const canopen::MasterConfig master = makeMasterConfig(robot, problems);
  ASSERT_EQ(problems.text(), "");
  const std::string shown = between(document("docs/configuration.md"), "axis  ", "...");
  const std::string plan = pdoTable(master, robot.bus.bitrate);
  ASSERT_NE(shown, "");
  EXPECT_NE(plan.find(shown), std::string::npos) << shown << "is not in\n" << plan;
  const std::string total = between(document("docs/configuration.md"), "...", "```");
  EXPECT_NE(plan.find(total), std::string::npos) << total << "is not in\n" << plan;
}

}  // namespace
}  // namespace cia402::config
