// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/emcy/emergency.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

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

TEST(DecodeEmergency, TakesNothingFromBehindTheEndOfAFrame) {
  can::Frame frame(0x083, {0x30, 0x81, 0x11, 0xAB, 0xEE, 0xEE, 0xEE, 0xEE});
  frame.size = 4;
  EXPECT_EQ(decodeEmergency(frame, Time())->vendor,
            (std::array<std::uint8_t, 5>{0xAB, 0, 0, 0, 0}));
  frame.size = 2;
  EXPECT_EQ(decodeEmergency(frame, Time())->error_register, 0);
}

}  // namespace
}  // namespace cia402::canopen
