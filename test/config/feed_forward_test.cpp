// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `feed_forward` and `unwatched_streams` of an axis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

LoadedRobot withKeys(const std::string& drive, const std::string& keys) {
  return loadText(
      "bus: {interface: sim, sync_period: 0.004}\naxes: {joint: {node_id: 1, drive: " + drive +
      ", counts_per_turn: 4000, limits: {velocity: 1.0, acceleration: 4.0}" + keys + "}}\n");
}

TEST(FeedForwardKey, HasItsObjectsTravel) {
  const LoadedRobot none = withKeys("generic_cia402", "");
  ASSERT_EQ(none.problems, "");
  EXPECT_THAT(none.robot.axes.at(0).outputs, Not(Contains("velocity_offset")));
  const LoadedRobot velocity = withKeys("generic_cia402", ", feed_forward: {velocity: 0.8}");
  ASSERT_EQ(velocity.problems, "");
  EXPECT_DOUBLE_EQ(velocity.robot.axes.at(0).feed_forward.velocity, 0.8);
  EXPECT_THAT(velocity.robot.axes.at(0).outputs,
              AllOf(Contains("velocity_offset"), Not(Contains("torque_offset"))));
  const LoadedRobot inertia =
      withKeys("generic_cia402", ", rated_torque: 0.64, feed_forward: {inertia: 0.02}");
  ASSERT_EQ(inertia.problems, "");
  EXPECT_THAT(inertia.robot.axes.at(0).outputs,
              AllOf(Contains("torque_offset"), Not(Contains("velocity_offset"))));
}

TEST(FeedForwardKey, ThatCannotBeSentIsRefused) {
  EXPECT_THAT(withKeys("nimotion_stepper", ", feed_forward: {velocity: 1.0}").problems,
              AllOf(HasSubstr("axes/joint/feed_forward"),
                    HasSubstr("no mode of the axis has objects for it")));
  EXPECT_THAT(withKeys("generic_cia402", ", feed_forward: {velocity: 2.5}").problems,
              HasSubstr("axes/joint/feed_forward/velocity"));
  EXPECT_THAT(withKeys("generic_cia402", ", feed_forward: {inertia: 1.0}").problems,
              HasSubstr("`inertia` needs `rated_torque`"));
  EXPECT_THAT(withKeys("generic_cia402", ", feed_forward: {speed: 1.0}").problems,
              HasSubstr("feed_forward/speed"));
  EXPECT_THAT(withKeys("generic_cia402",
                       ", feed_forward: {velocity: 1.0}, mode: csp, modes: [csp], pdos: {rpdo1: "
                       "[controlword, target_position], tpdo1: [statusword, position_actual]}")
                  .problems,
              HasSubstr("needs `velocity_offset` in an RPDO"));
}

TEST(UnwatchedStreamsKey, IsNoByDefault) {
  EXPECT_FALSE(withKeys("generic_cia402", "").robot.axes.at(0).unwatched_streams);
  const LoadedRobot allowed = withKeys("generic_cia402", ", unwatched_streams: true");
  EXPECT_EQ(allowed.problems, "");
  EXPECT_TRUE(allowed.robot.axes.at(0).unwatched_streams);
  EXPECT_THAT(withKeys("generic_cia402", ", unwatched_streams: maybe").problems,
              HasSubstr("axes/joint/unwatched_streams"));
}

}  // namespace
}  // namespace cia402::config
