// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/emergency.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

TEST(EmergencyText, prefers_the_most_specific_meaning) {
  EXPECT_EQ(emergencyText(0x8611), "following error");
  EXPECT_EQ(emergencyText(0x3210), "DC link overvoltage");
  EXPECT_EQ(emergencyText(0x8130), "life guard or heartbeat error");
  EXPECT_EQ(emergencyText(0x7305), "incremental encoder 1 fault");
}

TEST(EmergencyText, falls_back_to_the_class_of_the_code) {
  EXPECT_EQ(emergencyText(0x8615), "positioning controller");  // 861xh has no row, 86xxh has
  EXPECT_EQ(emergencyText(0x2399), "current, device output side");
  EXPECT_EQ(emergencyText(0x2311), "continuous overcurrent, device output side");
  EXPECT_EQ(emergencyText(0x6F00), "device software");
  EXPECT_EQ(emergencyText(0xFF42), "manufacturer-specific error");
}

TEST(EmergencyText, tells_the_reset_and_the_unknown) {
  EXPECT_EQ(emergencyText(0x0000), "error reset or no error");
  EXPECT_EQ(emergencyText(0x0012), "error code unknown to CiA 301 and CiA 402");
  EXPECT_EQ(emergencyText(0xA000), "error code unknown to CiA 301 and CiA 402");
}

TEST(ErrorRegisterText, names_the_bits_that_are_set) {
  EXPECT_EQ(errorRegisterText(0x00), "none");
  EXPECT_EQ(errorRegisterText(0x05), "generic, voltage");
  EXPECT_EQ(errorRegisterText(0xA0), "device profile, manufacturer");
}

}  // namespace
}  // namespace cia402::canopen
