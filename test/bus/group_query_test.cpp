// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Where the joints of a group are commanded to be at a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::chrono_literals;

struct GroupQueryTest : test::GroupScene {
  PlannedStateAnswer at(Time time) { return world.call(PlannedStateCommand{"arm", time}); }
  /// The position of the first joint, once its asked is known to be one.
  double shoulderAt(Time time) {
    const PlannedStateAnswer asked = at(time);
    EXPECT_TRUE(asked.success) << asked.message;
    return asked.success ? asked.states.at(0).position : -99.0;
  }
};

TEST_F(GroupQueryTest, IsWhereTheMotorsThenAre) {
  ASSERT_TRUE(world.move({1.0, -0.5}, 1.0).success);
  world.run(100ms);
  const PlannedStateAnswer early = at(world.now + 400ms);
  ASSERT_TRUE(early.success) << early.message;
  EXPECT_THAT(early.joints, ElementsAre("shoulder", "elbow"));
  world.run(400ms);
  EXPECT_NEAR(early.states[0].position, world.drives[0].radians(), 0.02);
  EXPECT_NEAR(early.states[1].position, world.drives[1].radians(), 0.01);
  EXPECT_NEAR(early.states[0].velocity, -2.0 * early.states[1].velocity, 1e-9);
  EXPECT_GT(early.states[0].velocity, 1.0);
  // The past of what runs, and after its end.
  EXPECT_NEAR(shoulderAt(world.now - 450ms), 0.0, 0.02);
  EXPECT_EQ(shoulderAt(world.now + 10s), 1.0);
  EXPECT_EQ(at(world.now + 10s).states[0].velocity, 0.0);
}

TEST_F(GroupQueryTest, KnowsWhatWaits) {
  TrajectoryCommand later = world.trajectory("arm", {{{1.0, 0.0}, 1.0}});
  later.start_time = world.now + 500ms;
  ASSERT_TRUE(world.call(later).success);
  EXPECT_EQ(shoulderAt(world.now), 0.0);
  EXPECT_EQ(shoulderAt(world.now + 400ms), 0.0);
  EXPECT_NEAR(shoulderAt(world.now + 1s), 0.5, 1e-3);
  EXPECT_EQ(shoulderAt(world.now + 2s), 1.0);
}

TEST_F(GroupQueryTest, WhatTakesOverCountsFromThen) {
  ASSERT_TRUE(world.move({1.0, 0.0}, 2.0).success);
  TrajectoryCommand later = world.trajectory("arm", {{{-0.5, 0.0}, 2.0}});
  later.start_time = world.now + 500ms;
  ASSERT_TRUE(world.call(later).success);
  const double before = shoulderAt(world.now + 300ms);
  EXPECT_GT(before, 0.0);
  EXPECT_LT(before, 0.5);
  EXPECT_EQ(shoulderAt(world.now + 5s), -0.5);
}

TEST_F(GroupQueryTest, AStopComesToRestWhereItSays) {
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(500ms);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  world.run(8ms);
  const double rest = shoulderAt(world.now + 2s);
  EXPECT_GT(rest, world.drives[0].radians());
  world.run(1s);
  EXPECT_NEAR(world.drives[0].radians(), rest, 0.002);
}

TEST_F(GroupQueryTest, AJointThatRestsDoesSoSinceItMoved) {
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(3s);
  EXPECT_EQ(shoulderAt(world.now - 1s), 1.0);
  const PlannedStateAnswer long_ago = at(world.now - 2500ms);
  EXPECT_FALSE(long_ago.success);
  EXPECT_THAT(long_ago.message, AllOf(HasSubstr("arm: shoulder"), HasSubstr("2.5 s ago"),
                                      HasSubstr("is not known any more")));
}

TEST_F(GroupQueryTest, WhatWasBeforeATrajectoryIsNotKnown) {
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(300ms);
  EXPECT_THAT(at(world.now - 400ms).message,
              AllOf(HasSubstr("arm: shoulder follows a trajectory that began 0.296"),
                    HasSubstr("0.4 s ago, is not known any more")));
}

TEST_F(GroupQueryTest, AJointWithoutPowerSaysWhy) {
  ASSERT_TRUE(world.call(drive::ProcedureKind::disable, "shoulder").success);
  const PlannedStateAnswer asked = at(world.now);
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(asked.message, AllOf(HasSubstr("arm: shoulder"), HasSubstr("enable")));
}

TEST_F(GroupQueryTest, OfNoGroupIsRefused) {
  EXPECT_THAT(world.call(PlannedStateCommand{"leg", world.now}).message, HasSubstr("\"leg\""));
}

}  // namespace
}  // namespace cia402::bus
