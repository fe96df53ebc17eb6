// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Trouble with SYNC that becomes another one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using test::RobotWorld;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct SyncTroubleThatChanges : testing::Test {
  static config::RobotConfig configuration() {
    config::RobotConfig robot = test::testRobot();
    robot.bus.external_sync = true;
    return robot;
  }
  void lead(Duration duration, Duration period) {
    for (const Time end = world.now + duration; world.now < end; world.run(period)) {
      world.network.receive(can::Frame(0x080, {}), world.now, world.now);
    }
  }
  std::string problem() const {
    NetworkSnapshot snapshot;
    world.network.fill(snapshot);
    return snapshot.sync_problem.str();
  }
  RobotWorld world{configuration()};
};

TEST_F(SyncTroubleThatChanges, IsToldWhenTheNewOneHasLastedForASecond) {
  world.network.start(world.now);
  world.run(2s);
  ASSERT_THAT(problem(), HasSubstr("no SYNC (COB-ID 0x080) comes"));
  lead(900ms, 5ms);
  EXPECT_THAT(problem(), HasSubstr("no SYNC (COB-ID 0x080) comes"));
  lead(1s, 5ms);
  EXPECT_THAT(problem(), HasSubstr("SYNC comes every 5 ms, not every 4 ms"));
  EXPECT_EQ(world.eventsWith("SYNC comes every 5 ms, not every 4 ms"), 1u) << world.allEvents();
}

TEST_F(SyncTroubleThatChanges, OrNotTheDriverProducesNoneWhereAnotherDeviceLeads) {
  world.network.start(world.now);
  lead(1s, 4ms);
  world.network.produceSync(world.now + 1s);
  EXPECT_TRUE(world.sentWithId(0x080).empty());
}

}  // namespace
}  // namespace cia402::bus
