// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What becomes of a drive that is looked for by its identity.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/lss_world.h"

namespace cia402::bus {
namespace {

using canopen::NodeHealth;
using test::byIdentity;
using test::LssWorld;
using test::ready;
using namespace std::chrono_literals;

/// The shoulder has been in operation and is gone.
void lose(LssWorld& world) {
  world.robot.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.takeAway(0);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == NodeHealth::lost; }));
}

TEST(RobotLssLook, ADriveThatGotItsNodeIdIsAskedOnceItHadTheTimeForItsBootUpMessage) {
  LssWorld world(1);
  lose(world);
  const auto hear = world.bystanders;
  world.bystanders = [&](const can::Frame& frame) {
    const auto answer = hear(frame);
    world.drives[0].silent = true;  // but for LSS
    return answer;
  };
  world.bringBack(0);
  const char* const got = "shoulder (node 1): LSS: the device got node-ID 1";
  ASSERT_TRUE(world.runUntil([&] { return world.eventsWith(got) == 2; })) << world.allEvents();
  const Time assigned = world.now;
  world.sent.clear();
  ASSERT_TRUE(world.runUntil([&] { return !world.sentWithId(0x601).empty(); }));
  EXPECT_EQ(world.now - assigned, 500ms);
}

TEST(RobotLssLook, ThatFindsNobodyAsksNobodyBySdo) {
  const auto requests = [](const config::RobotConfig& config, std::size_t unconfigured) {
    LssWorld world(unconfigured, config);
    lose(world);
    world.sent.clear();
    world.run(20s);
    EXPECT_EQ(world.sentWithId(0x7E5).empty(), unconfigured == 0);
    return world.sentWithId(0x601).size();
  };
  EXPECT_EQ(requests(byIdentity(1), 1), requests(test::testRobot(), 0));
}

}  // namespace
}  // namespace cia402::bus
