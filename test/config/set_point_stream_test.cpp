// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `set_point_stream` of an axis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;

LoadedRobot withSetPoints(const std::string& drive, const std::string& keys) {
  return loadText(
      "bus: {interface: sim, sync_period: 0.004}\naxes: {joint: {node_id: 1, drive: " + drive +
      ", counts_per_turn: 10000, rated_torque: 1.27,\n"
      "  limits: {velocity: 1.0, acceleration: 4.0}" +
      keys + "}}\n");
}

constexpr char kInIt[] = ", mode: position_by_set_points, modes: [position_by_set_points]";

TEST(SetPointStream, IsTheProfilesOrTheAxisOwn) {
  const LoadedRobot by_profile = withSetPoints("id286_cnfa", kInIt);
  ASSERT_EQ(by_profile.problems, "");
  const drive::SetPointStream of_profile = *by_profile.robot.axes.at(0).set_point_stream;
  EXPECT_EQ(of_profile.speed, "profile_velocity");
  EXPECT_EQ(of_profile.deceleration, "profile_deceleration");
  EXPECT_DOUBLE_EQ(of_profile.interval, 0.01);
  EXPECT_DOUBLE_EQ(of_profile.catch_up, 0.3);
  const LoadedRobot own = withSetPoints(
      "id286_cnfa", std::string(kInIt) + ", set_point_stream: {interval: 0.05, catch_up: 0.1}");
  ASSERT_EQ(own.problems, "");
  const drive::SetPointStream of_axis = *own.robot.axes.at(0).set_point_stream;
  EXPECT_EQ(of_axis.speed, "profile_velocity");
  EXPECT_DOUBLE_EQ(of_axis.interval, 0.05);
  EXPECT_DOUBLE_EQ(of_axis.catch_up, 0.1);
}

TEST(SetPointStream, MakesTrajectoriesPossibleAndItsSpeedTravel) {
  const LoadedRobot loaded = withSetPoints("id286_cnfa", kInIt);
  ASSERT_EQ(loaded.problems, "");
  const drive::AxisConfig& axis = loaded.robot.axes.at(0);
  EXPECT_THAT(axis.outputs, testing::Contains("profile_velocity"));
  EXPECT_THAT(axis.outputs, testing::Contains("profile_deceleration"));
  ASSERT_NE(drive::trajectoryMode(axis), nullptr);
  EXPECT_EQ(drive::trajectoryMode(axis)->name, "position_by_set_points");
  const LoadedRobot goals = withSetPoints("id286_cnfa", ", mode: pp, modes: [pp]");
  ASSERT_EQ(goals.problems, "");
  EXPECT_EQ(drive::trajectoryMode(goals.robot.axes.at(0)), nullptr) << "it has no such mode";
  const LoadedRobot both =
      withSetPoints("id286_cnfa", ", mode: position_by_set_points, modes: [position_by_velocity]");
  ASSERT_EQ(both.problems, "");
  EXPECT_EQ(drive::trajectoryMode(both.robot.axes.at(0))->name, "position_by_set_points")
      << "the mode to start in comes first";
}

TEST(SetPointStream, ThatCannotBeIsRefusedInWords) {
  EXPECT_THAT(
      withSetPoints("generic_cia402", ", set_point_stream: {interval: 0.05}").problems,
      HasSubstr("profile generic_cia402 has no mode whose set-points lead the drive along a "
                "stream of positions"));
  const std::string in_it = kInIt;
  EXPECT_THAT(withSetPoints("id286_cnfa", in_it + ", set_point_stream: {catch_up: 0.6}").problems,
              HasSubstr("axes/joint/set_point_stream/catch_up"));
  EXPECT_THAT(withSetPoints("id286_cnfa", in_it + ", set_point_stream: {interval: -0.1}").problems,
              HasSubstr("axes/joint/set_point_stream/interval"));
  EXPECT_THAT(
      withSetPoints("id286_cnfa", in_it + ", pdos: {rpdo1: [controlword, target_position],"
                                          " tpdo1: [statusword, position_actual, mode_display]}")
          .problems,
      HasSubstr("mode `position_by_set_points` needs `profile_velocity` in an RPDO"));
}

}  // namespace
}  // namespace cia402::config
