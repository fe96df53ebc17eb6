// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/status_bits.h"

#include <gtest/gtest.h>

namespace cia402::drive {
namespace {

TEST(StatusBits, HaveTheNamesOfCia402WhereNoModeIsKnown) {
  EXPECT_EQ(statusBitsText(0x0091, nullptr, {}), "ready to switch on, voltage enabled, warning");
  EXPECT_EQ(statusBitsText(0x0250, nullptr, {}), "voltage enabled, switch on disabled, remote");
  EXPECT_EQ(statusBitsText(0x0C2E, nullptr, {}),
            "switched on, operation enabled, fault, quick stop inactive, target reached, internal "
            "limit active");
  EXPECT_EQ(statusBitsText(0xF100, nullptr, {}), "bit 8, bit 12, bit 13, bit 14, bit 15");
  EXPECT_EQ(statusBitsText(0x0000, nullptr, {}), "no bit set");
}

TEST(StatusBits, AreWhatTheModeSaysTheyAre) {
  ModeSpec homing;
  homing.homing_attained_bit = 12;
  homing.homing_error_bit = 13;
  EXPECT_EQ(statusBitsText(0x3400, &homing, {}), "bit 10, homing attained, homing error");
  ModeSpec position;
  position.target_reached_bit = 10;
  position.set_point_acknowledge_bit = 12;
  position.following_error_bit = 13;
  EXPECT_EQ(statusBitsText(0x3400, &position, {}),
            "target reached, set-point acknowledged, following error");
  ModeSpec velocity;
  velocity.speed_zero_bit = 12;
  velocity.follows_command_bit = 15;
  EXPECT_EQ(statusBitsText(0x9000, &velocity, {}), "speed is zero, follows the command");
}

TEST(StatusBits, HaveTheWordsOfTheFamilyBeforeThoseOfTheStandard) {
  StatusWords words;
  words[8] = "abnormal stop";
  words[14] = "a parameter is 0";
  words[12] = "of no mode";
  EXPECT_EQ(statusBitsText(0xC100, nullptr, words), "abnormal stop, a parameter is 0, bit 15");
  ModeSpec position;
  position.set_point_acknowledge_bit = 12;
  EXPECT_EQ(statusBitsText(0x1000, &position, words), "set-point acknowledged");
}

}  // namespace
}  // namespace cia402::drive
