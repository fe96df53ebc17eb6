// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/habits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "campaign/stage.h"
#include "folders.h"

namespace cia402::campaign {
namespace {

using testing::HasSubstr;

std::string robotWith(const Habits& habits) {
  const std::string keys = habits.profile.empty() ? "" : ", profile_keys: {" + habits.profile + "}";
  return "bus: {interface: can0, bitrate: 1000000, sync_period: 0.004}\naxes:\n"
         "  a1: {node_id: 1, drive: generic_cia402, counts_per_turn: 4096, gear_ratio: 50.0" +
         keys +
         ", limits: {lower: -1, upper: 1, velocity: 1, acceleration: 4}, simulation: {with: {" +
         habits.simulation + "}}}\n";
}

TEST(Habits, OfEachDrawLoadWithTheirProfile) {
  std::set<std::string> different;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed), again(seed);
    const Habits habits = drawHabits(random);
    EXPECT_EQ(habits.simulation, drawHabits(again).simulation);
    EXPECT_FALSE(habits.simulation.empty());
    different.insert(habits.simulation);
    const auto loaded = loadRobot(robotWith(habits), cia402::test::configFolder());
    EXPECT_TRUE(loaded) << habits.simulation << ": " << loaded.error().message;
  }
  EXPECT_GT(different.size(), 30U);
}

TEST(ProfileKeys, AreOnTopOfTheProfileOfTheirAxisAlone) {
  const std::string axis =
      "{drive: generic_cia402, counts_per_turn: 4096, gear_ratio: 50.0, limits: {lower: -1, upper: "
      "1, velocity: 1, acceleration: 4}";
  const auto loaded = loadRobot(
      "bus: {interface: can0, bitrate: 1000000, sync_period: 0.004}\naxes:\n  a1: " + axis +
          ", node_id: 1, profile_keys: {fault_reset_tries: 7, timing: {sdo: 0.7}}}\n  a2: " + axis +
          ", node_id: 2}\n",
      cia402::test::configFolder());
  ASSERT_TRUE(loaded) << loaded.error().message;
  const drive::DriveProfile& own = *loaded->robot.axes[0].profile;
  EXPECT_EQ(own.fault_reset.tries, 7);
  const canopen::DeviceProfile& device = *loaded->robot.devices[0].profile;
  EXPECT_EQ(device.sdo.timeout, std::chrono::milliseconds(700));
  EXPECT_EQ(device.boot_time, std::chrono::seconds(5)) << "beside it the keys stay";
  EXPECT_EQ(loaded->robot.axes[1].profile->fault_reset.tries, 1);
}

TEST(ProfileKeys, AreTakenAwayByANull) {
  Habits habits;
  habits.simulation = "quirks: {homing_reaches_no_target: true}";
  habits.profile = "modes: {homing: {status_bits: {target_reached: ~}}}";
  const auto loaded = loadRobot(robotWith(habits), cia402::test::configFolder());
  ASSERT_TRUE(loaded) << loaded.error().message;
  const drive::ModeSpec* homing = loaded->robot.axes[0].profile->mode("homing");
  ASSERT_NE(homing, nullptr);
  EXPECT_FALSE(homing->target_reached_bit);
  EXPECT_EQ(homing->homing_attained_bit, 12) << "beside it the keys stay";
}

TEST(ProfileKeys, ThatNobodyKnowsAreRefused) {
  Habits habits;
  habits.simulation = "quirks: {}";
  habits.profile = "fault_reset_trys: 7";
  const auto loaded = loadRobot(robotWith(habits), cia402::test::configFolder());
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("fault_reset_trys"));
}

}  // namespace
}  // namespace cia402::campaign
