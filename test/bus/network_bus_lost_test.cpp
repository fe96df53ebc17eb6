// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What becomes of a robot whose bus is lost for a while.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::RobotWorld;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct NetworkBusLost : testing::Test {
  NetworkBusLost() { world.enable(); }
  std::string refusal() { return world.begin(ProcedureKind::enable)->at(0).message; }
  RobotWorld world;
};

TEST_F(NetworkBusLost, EndsMotionAndRefusesCommandsWithItsFirstReason) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 4.0).success);
  world.run(500ms);
  ASSERT_TRUE(world.group().executing());
  world.network.busLost("can0 is bus-off", world.now);
  EXPECT_TRUE(world.group().stopping() || !world.group().executing());
  world.network.busLost("can0 is down", world.now);
  world.run(1s);
  EXPECT_FALSE(world.group().executing());
  EXPECT_GT(world.eventsWith("stopped: can0 is bus-off"), 0u) << world.allEvents();
  EXPECT_EQ(world.eventsWith("can0 is down"), 0u);
  EXPECT_THAT(refusal(), HasSubstr("refused: can0 is bus-off, nothing reaches the drives"));
}

TEST_F(NetworkBusLost, ItsReturnIsToldWhereItIsNews) {
  world.network.busBack(true, world.now);
  EXPECT_EQ(world.eventsWith("is back"), 0u) << "it was there";
  world.network.busLost("can0 is bus-off", world.now);
  world.network.busBack(false, world.now);
  EXPECT_EQ(world.eventsWith("is back"), 0u);
  EXPECT_EQ(world.begin(ProcedureKind::disable)->size(), 0u) << "commands are taken again";
  world.network.busLost("can0 is bus-off", world.now);
  world.network.busBack(true, world.now);
  EXPECT_EQ(world.eventsWith("can0 is back: drives that were lost are configured again; the axes "
                             "stay disabled until enable or recover"),
            1u);
}

}  // namespace
}  // namespace cia402::bus
