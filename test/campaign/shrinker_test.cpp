// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/shrinker.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cia402::campaign {
namespace {

constexpr char kRobot[] =
    "bus: {interface: can0, heartbeat: 0.1}\n"
    "axes:\n"
    "  a1: {node_id: 1, direction: -1}\n"
    "  a2: {node_id: 2, homing: {offset: 0.3}}\n"
    "groups:\n"
    "  g1: {joints: [a1, a2]}\n"
    "  g2: {joints: [a1]}\n";

Scene longScene() {
  Scene scene;
  scene.robot = kRobot;
  for (int i = 0; i < 100; ++i) {
    const std::string verb = i == 37 ? "halt a2" : i == 73 ? "disable a2" : "read a1 6041:00";
    scene.actions.push_back(parseAction(std::to_string(i) + ".1 " + verb).value());
  }
  return scene;
}

std::size_t count(const Scene& scene, const std::string& verb) {
  return static_cast<std::size_t>(std::count_if(scene.actions.begin(), scene.actions.end(),
                                                [&](const Action& a) { return a.verb() == verb; }));
}

bool haltThenDisable(const Scene& scene) {
  return count(scene, "halt") == 1 && count(scene, "disable") == 1;
}

TEST(Shrinker, LeavesTheActionsThatMatter) {
  const Scene small = shrink(longScene(), haltThenDisable);
  ASSERT_EQ(small.actions.size(), 2u);
  EXPECT_EQ(small.actions[0].verb(), "halt");
  EXPECT_EQ(small.actions[1].verb(), "disable");
}

TEST(Shrinker, ShortensWaits) {
  const Scene small = shrink(longScene(), haltThenDisable);
  EXPECT_LE(small.actions[1].at - small.actions[0].at, std::chrono::seconds(1));
}

TEST(Shrinker, LeavesTheAxesAndOptionsThatMatter) {
  const Shows offset = [](const Scene& scene) {
    return scene.robot.find("offset") != std::string::npos;
  };
  const Scene small = shrink(longScene(), offset);
  EXPECT_EQ(small.robot.find("a1"), std::string::npos) << small.robot;
  EXPECT_EQ(small.robot.find("g2"), std::string::npos) << small.robot;
  EXPECT_EQ(small.robot.find("heartbeat"), std::string::npos) << small.robot;
  EXPECT_NE(small.robot.find("offset"), std::string::npos);
}

TEST(Shrinker, TriesNoMoreThanItMay) {
  int calls = 0;
  const Shows nothing = [&](const Scene&) { return ++calls, false; };
  (void)shrink(longScene(), nothing, 50);
  EXPECT_EQ(calls, 50);
}

}  // namespace
}  // namespace cia402::campaign
