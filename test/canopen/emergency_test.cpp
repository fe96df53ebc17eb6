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

TEST(DecodeEmergency, TakesTheFieldsOfTheFrame) {
  const can::Frame frame(0x083, {0x11, 0x86, 0x21, 0x01, 0x02, 0x03, 0x04, 0x05});
  const auto emergency = decodeEmergency(frame, Time(std::chrono::seconds(7)));
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->code, 0x8611);
  EXPECT_EQ(emergency->error_register, 0x21);
  EXPECT_EQ(emergency->vendor, (std::array<std::uint8_t, 5>{1, 2, 3, 4, 5}));
  EXPECT_EQ(emergency->size, 8);
  EXPECT_EQ(emergency->stamp, Time(std::chrono::seconds(7)));
}

TEST(DecodeEmergency, TakesAShortFrameAsFarAsItGoes) {
  const auto emergency = decodeEmergency(can::Frame(0x083, {0x30, 0x81, 0x11, 0xAB}), Time());
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->code, 0x8130);
  EXPECT_EQ(emergency->error_register, 0x11);
  EXPECT_EQ(emergency->vendor, (std::array<std::uint8_t, 5>{0xAB, 0, 0, 0, 0}));
  EXPECT_EQ(emergency->size, 4);
  EXPECT_EQ(decodeEmergency(can::Frame(0x083, {0x30, 0x81}), Time())->code, 0x8130);
  EXPECT_FALSE(decodeEmergency(can::Frame(0x083, {0x30}), Time()));
  EXPECT_FALSE(decodeEmergency(can::Frame(0x083, {}), Time()));
}

TEST(VendorBytesText, IsHexadecimalAndEmptyWhereThereIsNothing) {
  Emergency emergency;
  EXPECT_EQ(vendorBytesText(emergency), "");
  emergency.vendor = {0x0A, 0, 0xFF, 0, 1};
  EXPECT_EQ(vendorBytesText(emergency), "0A 00 FF 00 01");
}

}  // namespace
}  // namespace cia402::canopen
