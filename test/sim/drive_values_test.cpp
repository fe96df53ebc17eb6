// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/values.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cia402::sim {
namespace {

Entry entry(DataType type, std::uint64_t number = 0) {
  Entry e;
  e.type = type;
  e.number = number;
  return e;
}

TEST(DriveValues, ReadsFloatBits) {
  EXPECT_EQ(decodeNumber(entry(DataType::int32, 0x3F800000), Encoding::float32), 1.0);
  EXPECT_EQ(decodeNumber(entry(DataType::int32, 0xBF800000), Encoding::float32), -1.0);
  EXPECT_TRUE(std::isnan(decodeNumber(entry(DataType::int32, 0xFFFFFFFF), Encoding::float32)));
  EXPECT_EQ(encodeNumber(600.0, entry(DataType::uint32), Encoding::float32), 0x44160000U);
  EXPECT_EQ(encodeNumber(-0.3, entry(DataType::int32), Encoding::float32), 0xBE99999AU);
}

// Values of the table in the Damiao sheet, section 6.3.
TEST(DriveValues, ReadsSixteenBitFloatsByThreeRules) {
  const Entry positive = entry(DataType::int16, 0x3E99);
  const Entry negative = entry(DataType::int16, 0xBF80);
  EXPECT_NEAR(decodeNumber(positive, Encoding::bfloat16), 0.298828125, 1e-12);
  EXPECT_NEAR(decodeNumber(positive, Encoding::scaled_unsigned), 0.298350543, 1e-9);
  EXPECT_NEAR(decodeNumber(positive, Encoding::scaled_signed), 0.298350543, 1e-9);
  EXPECT_EQ(decodeNumber(negative, Encoding::bfloat16), -1.0);
  EXPECT_NEAR(decodeNumber(negative, Encoding::scaled_unsigned), -0.997077942, 1e-9);
  EXPECT_NEAR(decodeNumber(negative, Encoding::scaled_signed), -1.00196838, 1e-8);
}

TEST(DriveValues, WritesSixteenBitFloats) {
  const Entry word = entry(DataType::int16);
  EXPECT_EQ(encodeNumber(0.3, word, Encoding::bfloat16), 0x3E9AU);
  EXPECT_EQ(encodeNumber(0.1, word, Encoding::scaled_unsigned), 0x3DCDU);
  EXPECT_EQ(encodeNumber(-0.3, word, Encoding::scaled_signed), 0xBE9AU);
  EXPECT_EQ(encodeNumber(7.0, word, Encoding::scaled_signed), 0x40E0U);
}

TEST(DriveValues, IntegersRoundToNearestAndWrapInTheirWidth) {
  EXPECT_EQ(encodeNumber(-1.6, entry(DataType::int16), Encoding::integer), 0xFFFEU);
  EXPECT_EQ(encodeNumber(2.5, entry(DataType::int16), Encoding::integer), 3U) << "as std::llround";
  EXPECT_EQ(encodeNumber(-2.5, entry(DataType::int16), Encoding::integer), 0xFFFDU);
  EXPECT_EQ(encodeNumber(0.49999999999999994, entry(DataType::int16), Encoding::integer), 0U);
  EXPECT_EQ(encodeNumber(4294967297.0, entry(DataType::int32), Encoding::integer), 1U);
  EXPECT_EQ(decodeNumber(entry(DataType::int16, 0xFFFE), Encoding::integer), -2.0);
  EXPECT_EQ(decodeNumber(entry(DataType::uint16, 0xFFFE), Encoding::integer), 65534.0);
}

TEST(DriveValues, KnowsRolesByNameAndByTheStandardsObject) {
  EXPECT_EQ(findRole("target_position"), Role::target_position);
  EXPECT_EQ(findRole(fieldbus::ObjectId{0x6099, 2}), Role::homing_zero_speed);
  EXPECT_FALSE(findRole("nothing").has_value());
  EXPECT_FALSE(findRole(fieldbus::ObjectId{0, 0}).has_value());
}

}  // namespace
}  // namespace cia402::sim
