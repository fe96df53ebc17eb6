// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/scene.h"

#include <gtest/gtest.h>

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

TEST(Action, IsALineOfTimeAndWords) {
  const auto action = parseAction("3.204 stream a1 0.5 1.2 100");
  ASSERT_TRUE(action);
  EXPECT_EQ(action->at, 3204ms);
  EXPECT_EQ(action->verb(), "stream");
  EXPECT_EQ(action->words.size(), 5u);
  EXPECT_EQ(toString(*action), "3.204 stream a1 0.5 1.2 100");
}

TEST(Action, WithoutTimeOrWordsIsNone) {
  EXPECT_FALSE(parseAction("halt a1"));
  EXPECT_FALSE(parseAction("3.2"));
  EXPECT_FALSE(parseAction(""));
}

TEST(Scene, IsTheSameAfterAFile) {
  Scene scene;
  scene.about = "first line\nsecond line\n";
  scene.seed = 17;
  scene.robot = "bus: {interface: can0}\naxes:\n  a1: {node_id: 1}\n";
  scene.actions = {parseAction("1.0 enable all").value(), parseAction("1.008 halt a1").value()};
  const auto back = readScene(writeScene(scene));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->about, scene.about);
  EXPECT_EQ(back->seed, 17u);
  EXPECT_EQ(writeScene(*back), writeScene(scene));
}

TEST(Scene, PutsItsActionsInOrder) {
  const auto scene = readScene("robot: {}\nactions: [2.0 halt a1, 1.0 enable a1]");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->actions.front().verb(), "enable");
}

}  // namespace
}  // namespace cia402::campaign
