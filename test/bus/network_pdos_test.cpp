// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What people are told of PDOs that do not come as they should.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using test::RobotWorld;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct NetworkPdos : testing::Test {
  NetworkPdos() {
    world.boot();
    world.run(2s);
  }
  AxisSnapshot shown(std::size_t axis) const {
    NetworkSnapshot snapshot;
    world.network.fill(snapshot);
    return snapshot.axes[axis];
  }
  void intrude(int times) {
    for (int i = 0; i < times; ++i) {
      world.network.receive(can::Frame(0x182, {0x50, 0x02}), world.now, world.now);
    }
  }
  RobotWorld world;
};

TEST_F(NetworkPdos, NothingIsToldWhereTheyComeAsTheyShould) {
  EXPECT_EQ(world.eventsWith("TPDO"), 0u) << world.allEvents();
  EXPECT_EQ(shown(0).words.stale.str(), "");
}

TEST_F(NetworkPdos, OfAWrongLengthAreToldOnceASecondWhileMoreCome) {
  intrude(1);
  world.run(20ms);
  EXPECT_EQ(world.eventsWith("elbow (node 2): TPDO 1 (COB-ID 0x182) came with 2 bytes instead of "
                             "7: too short, not taken (1 so far); the drive maps other objects"),
            1u)
      << world.allEvents();
  intrude(3);
  world.run(900ms);
  EXPECT_EQ(world.eventsWith("bytes instead of"), 1u);
  world.run(200ms);
  EXPECT_EQ(world.eventsWith("(4 so far)"), 1u) << world.allEvents();
  world.run(5s);
  EXPECT_EQ(world.eventsWith("bytes instead of"), 2u) << "no more came";
  EXPECT_EQ(shown(1).wrong_lengths, 4u);
}

TEST_F(NetworkPdos, ThatDoNotComeAreToldOnceAndShownWhileItLasts) {
  world.drives[1].tpdo_bytes = 0;
  world.run(500ms);
  EXPECT_EQ(world.eventsWith("elbow (node 2): TPDO 1 (COB-ID 0x182) did not come for"), 1u)
      << world.allEvents();
  EXPECT_EQ(world.eventsWith("its values are stale and shown as unknown"), 1u);
  EXPECT_THAT(shown(1).words.stale.str(), HasSubstr("TPDO 1 (COB-ID 0x182) did not come for"));
  EXPECT_EQ(shown(0).words.stale.str(), "");
  const std::string first = shown(1).words.stale.str();
  world.run(3s);
  EXPECT_NE(shown(1).words.stale.str(), first) << "so many cycles by now";
  EXPECT_EQ(world.eventsWith("did not come for"), 1u);
  world.drives[1].tpdo_bytes = 7;
  world.run(1100ms);
  EXPECT_EQ(shown(1).words.stale.str(), "");
}

TEST_F(NetworkPdos, WhatWasToldOfTheirLengthIsNotToldAgainWithWhatComesLater) {
  intrude(1);
  world.run(2s);
  ASSERT_EQ(world.eventsWith("bytes instead of"), 1u);
  world.drives[1].tpdo_bytes = 0;
  world.run(5s);
  EXPECT_EQ(world.eventsWith("did not come for"), 1u);
  EXPECT_EQ(world.eventsWith("came with 2 bytes instead of"), 1u) << world.allEvents();
}

TEST_F(NetworkPdos, OfADriveThatWasTakenOutOfOperationAreNotMissed) {
  const auto answer = world.begin(NmtServiceCommand{"elbow", "pre_operational"});
  world.run(3s);
  ASSERT_EQ(answer->size(), 1u);
  ASSERT_TRUE(answer->front().success) << answer->front().message;
  EXPECT_EQ(world.eventsWith("did not come for"), 0u) << world.allEvents();
}

TEST_F(NetworkPdos, OfAWrongLengthAreToldAtOnceAfterASecondWithoutAny) {
  intrude(1);
  world.run(2500ms);
  intrude(1);
  world.run(20ms);
  EXPECT_EQ(world.eventsWith("too short, not taken (2 so far)"), 1u) << world.allEvents();
}

}  // namespace
}  // namespace cia402::bus
