// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/object_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cia402::drive {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(ObjectValue, FloatsAreThoseOfTheirTypeOrTheirEncoding) {
  EXPECT_TRUE(holdsFloat(DataType::real32, Encoding::integer));
  EXPECT_TRUE(holdsFloat(DataType::real64, Encoding::integer));
  EXPECT_TRUE(holdsFloat(DataType::uint32, Encoding::float32));
  EXPECT_TRUE(holdsFloat(DataType::int16, Encoding::bfloat16));
  EXPECT_FALSE(holdsFloat(DataType::uint32, Encoding::integer));
}

TEST(ObjectValue, FloatsHaveTheBitsOfTheStandard) {
  struct Row {
    DataType type;
    Encoding encoding;
    double value;
    std::uint64_t bits;
  };
  const Row rows[] = {
      {DataType::real32, Encoding::integer, 1.5, 0x3FC00000},
      {DataType::uint32, Encoding::float32, -1.5, 0xBFC00000},
      {DataType::uint16, Encoding::bfloat16, 1.5, 0x3FC0},
      {DataType::real64, Encoding::integer, 1.5, 0x3FF8000000000000},
      {DataType::real64, Encoding::integer, -2.0, 0xC000000000000000},
      {DataType::real64, Encoding::integer, 1e39, 0x48078287F49C4A1D},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.bits);
    EXPECT_EQ(floatBits(row.type, row.encoding, row.value), row.bits);
    EXPECT_EQ(floatOf(row.type, row.encoding, row.bits), row.value);
    EXPECT_EQ(sendable(row.type, row.encoding, row.bits), row.bits);
  }
}

TEST(ObjectValue, MinusZeroIsSentAsZeroAndWhatIsNotFiniteNever) {
  struct Row {
    DataType type;
    Encoding encoding;
    std::uint64_t minus_zero, infinity, nan;
  };
  const Row rows[] = {
      {DataType::real32, Encoding::integer, 0x80000000, 0x7F800000, 0xFFFFFFFF},
      {DataType::uint32, Encoding::float32, 0x80000000, 0xFF800000, 0x7FC00000},
      {DataType::uint16, Encoding::bfloat16, 0x8000, 0x7F80, 0x7FC0},
      {DataType::real64, Encoding::integer, 0x8000000000000000, 0x7FF0000000000000,
       0xFFFFFFFFFFFFFFFF},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(fieldbus::toString(row.type));
    EXPECT_EQ(floatBits(row.type, row.encoding, -0.0), 0U);
    EXPECT_EQ(sendable(row.type, row.encoding, row.minus_zero), 0U);
    for (const std::uint64_t bad : {row.infinity, row.nan}) {
      EXPECT_FALSE(sendable(row.type, row.encoding, bad)) << bad;
      EXPECT_TRUE(std::isnan(floatOf(row.type, row.encoding, bad))) << bad;
    }
    for (const double bad : {kInfinity, -kInfinity, std::nan("")}) {
      EXPECT_FALSE(floatBits(row.type, row.encoding, bad)) << bad;
    }
  }
  EXPECT_FALSE(floatBits(DataType::real32, Encoding::integer, 1e39)) << "more than a real32 holds";
  EXPECT_EQ(sendable(DataType::uint32, Encoding::integer, 0xFFFFFFFF), 0xFFFFFFFFU);
}

TEST(ObjectValue, WhatIsNotFiniteIsShownAsWideAsItsType) {
  EXPECT_EQ(notFinite(DataType::uint16, 0x7F80).substr(0, 30), "0x7F80 is no finite number in ");
  EXPECT_EQ(notFinite(DataType::uint32, 0x1).substr(0, 14), "0x00000001 is ");
  EXPECT_EQ(notFinite(DataType::real64, 0x7FF0000000000000).substr(0, 22),
            "0x7FF0000000000000 is ");
}

}  // namespace
}  // namespace cia402::drive
