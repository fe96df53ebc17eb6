// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/node_condition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using fieldbus::Health;
using test::RobotWorld;
using testing::HasSubstr;
using namespace std::chrono_literals;

AxisSnapshot nodeOf(const RobotWorld& world) {
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  return snapshot.axes[0];
}

/// A node that is all right.
AxisSnapshot readyNode() {
  AxisSnapshot axis;
  axis.state.health = Health::ready;
  axis.node.supervision.watched = true;
  axis.node.supervision.watches_master = true;
  return axis;
}

AxisSnapshot nodeThatIs(Health health, const char* problem) {
  AxisSnapshot axis;
  axis.state.health = health;
  axis.words.say(&AxisWords::step, "asking for the device type");
  axis.words.say(&AxisWords::problem, problem);
  return axis;
}

TEST(NodeCondition, IsWellOnceConfiguredAndOperational) {
  EXPECT_EQ(nodeSummaryOf(readyNode()).condition, Condition::well);
  EXPECT_EQ(nodeSummaryOf(readyNode()).text, "configured and operational");
}

TEST(NodeCondition, WarnsWhileALossWouldGoUnnoticed) {
  AxisSnapshot axis = readyNode();
  axis.node.supervision.watched = false;
  EXPECT_EQ(nodeSummaryOf(axis).condition, Condition::warning);
  EXPECT_EQ(nodeSummaryOf(axis).text, "its loss would show in missing TPDOs only");
  axis.node.supervision.watches_master = false;
  EXPECT_EQ(nodeSummaryOf(axis).condition, Condition::warning);
  EXPECT_EQ(nodeSummaryOf(axis).text,
            "its loss would show in missing TPDOs only; it cannot notice a dead master");
}

TEST(NodeCondition, WarnsOfStaleTpdosWhileTheyAre) {
  AxisSnapshot axis = readyNode();
  axis.words.say(&AxisWords::stale, "TPDO 3 does not come");
  EXPECT_EQ(nodeSummaryOf(axis).condition, Condition::warning);
  EXPECT_EQ(nodeSummaryOf(axis).text, "TPDO 3 does not come");
  axis.words.say(&AxisWords::stale, "");
  EXPECT_EQ(nodeSummaryOf(axis).condition, Condition::well);
}

TEST(NodeCondition, WarnsWhileItWaitsForItsBootAndWhileItBoots) {
  for (const Health health : {Health::absent, Health::booting}) {
    const Summary summary = nodeSummaryOf(nodeThatIs(health, ""));
    EXPECT_EQ(summary.condition, Condition::warning);
    EXPECT_THAT(summary.text, HasSubstr("asking for the device type"));
  }
}

TEST(NodeCondition, IsAnErrorWithTheReasonWhereItIsAwayOrItsBootHasFailed) {
  for (const Health health : {Health::absent, Health::lost, Health::failed}) {
    const Summary summary = nodeSummaryOf(nodeThatIs(health, "check its cable"));
    EXPECT_EQ(summary.condition, Condition::error) << fieldbus::toString(health);
    EXPECT_EQ(summary.text, "check its cable");
  }
  EXPECT_EQ(nodeSummaryOf(nodeThatIs(Health::lost, "")).condition, Condition::error);
}

TEST(NodeCondition, AnOptionalOneMayBeAbsentAndItsLossIsAWarning) {
  AxisSnapshot axis = nodeThatIs(Health::absent, "it is optional");
  axis.node.may_be_absent = true;
  EXPECT_EQ(nodeSummaryOf(axis).condition, Condition::well);
  EXPECT_EQ(nodeSummaryOf(axis).text, "it is optional");
  axis.state.health = Health::lost;
  EXPECT_EQ(nodeSummaryOf(axis).condition, Condition::warning);
}

TEST(NodeCondition, FollowsADriveThatIsLostAndComesBack) {
  RobotWorld world;
  world.enable();
  EXPECT_EQ(nodeSummaryOf(nodeOf(world)).condition, Condition::well)
      << nodeSummaryOf(nodeOf(world)).text;
  EXPECT_TRUE(nodeOf(world).words.last.empty());
  world.drives[0].silent = true;
  world.run(1s);
  EXPECT_EQ(nodeSummaryOf(nodeOf(world)).condition, Condition::error);
  EXPECT_THAT(nodeSummaryOf(nodeOf(world)).text, HasSubstr("shoulder (node 1)"));
  const std::string told = nodeOf(world).words.problem.str();
  const Time lost_at = nodeOf(world).words.last_at;
  EXPECT_GE(lost_at, world.now - 1s);
  world.drives[0].silent = false;
  ASSERT_TRUE(world.runUntil([&] { return world.axis(0).state().health == Health::ready; }, 60s));
  world.run(1s);
  EXPECT_EQ(nodeSummaryOf(nodeOf(world)).condition, Condition::well)
      << nodeSummaryOf(nodeOf(world)).text;
  EXPECT_EQ(nodeOf(world).words.last, told) << "what was wrong last stays";
  EXPECT_EQ(nodeOf(world).words.last_at, lost_at);
}

}  // namespace
}  // namespace cia402::bus
