// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `position_loop` of an axis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;

LoadedRobot withLoop(const std::string& drive, const std::string& keys) {
  return loadText(
      "bus: {interface: sim, sync_period: 0.004}\naxes: {joint: {node_id: 1, drive: " + drive +
      ", counts_per_turn: 10000, rated_torque: 1.27,\n"
      "  limits: {velocity: 1.0, acceleration: 4.0}" +
      keys + "}}\n");
}

TEST(PositionLoop, IsTheProfilesOrTheAxisOwn) {
  const LoadedRobot by_profile = withLoop("id286_cnfa", ", mode: position_by_velocity");
  ASSERT_EQ(by_profile.problems, "");
  EXPECT_DOUBLE_EQ(by_profile.robot.axes.at(0).position_loop->gain, 10.0);
  EXPECT_DOUBLE_EQ(by_profile.robot.axes.at(0).position_loop->feed_forward, 1.0);
  const LoadedRobot own =
      withLoop("id286_cnfa", ", mode: position_by_velocity, position_loop: {gain: 25.0}");
  ASSERT_EQ(own.problems, "");
  EXPECT_DOUBLE_EQ(own.robot.axes.at(0).position_loop->gain, 25.0);
  EXPECT_DOUBLE_EQ(own.robot.axes.at(0).position_loop->feed_forward, 1.0);
}

// 0.1 / 0.004 s = 25 1/s.
TEST(PositionLoop, ThatWouldOscillateIsRefusedWithTheLargestGain) {
  EXPECT_THAT(
      withLoop("id286_cnfa", ", mode: position_by_velocity, position_loop: {gain: 26.0}").problems,
      AllOf(HasSubstr("axes/joint/position_loop"), HasSubstr("gain 26 1/s would oscillate"),
            HasSubstr("give at most 25")));
  EXPECT_EQ(withLoop("id286_cnfa",
                     ", mode: profile_velocity, modes: [profile_velocity],"
                     " position_loop: {gain: 26.0}")
                .problems,
            "")
      << "the axis cannot be in that mode";
}

TEST(PositionLoop, OfADriveThatHasNoneIsRefused) {
  EXPECT_THAT(
      withLoop("generic_cia402", ", position_loop: {gain: 5.0}").problems,
      HasSubstr("profile generic_cia402 has no mode whose position loop the driver closes"));
  EXPECT_THAT(withLoop("id286_cnfa", ", position_loop: {gain: 0.0}").problems,
              HasSubstr("axes/joint/position_loop/gain"));
  EXPECT_THAT(withLoop("id286_cnfa", ", position_loop: {feed_forward: 2.5}").problems,
              HasSubstr("axes/joint/position_loop/feed_forward"));
}

}  // namespace
}  // namespace cia402::config
