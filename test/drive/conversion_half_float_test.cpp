// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Floats in 16 bits, as drives encode them in three ways.
#include <gtest/gtest.h>

#include <cmath>

#include "drive/profile/conversion.h"

namespace cia402::drive {
namespace {

struct HalfRow {
  std::uint64_t word;
  double unsigned_value, signed_value, upper_value;
};
// Damiao fact sheet, 6.3 "Decoders compared".
constexpr HalfRow kHalfRows[] = {
    {0x3E99, 0.298350543, 0.298350543, 0.298828125},
    {0x3F80, 0.999031067, 0.999031067, 1.0},
    {0x40E0, 6.99208069, 6.99208069, 7.0},
    {0xBE99, -0.29737398, -0.299327105, -0.298828125},
    {0xBF80, -0.997077942, -1.00196838, -1.0},
    {0xC0E0, -6.97645569, -7.00770569, -7.0},
    {0x4416, 598.936157, 598.936157, 600.0},
    {0x461C, 9966.47266, 9966.47266, 9984.0},
};

/// Of a position in radians of the output shaft.
Conversion half(Encoding encoding) {
  DriveProfile profile;
  profile.output_shaft = true;
  profile.units[Quantity::position] = {UnitSpec::Base::radian, 0, false, 1.0};
  ObjectSpec spec;
  spec.name = "tested";
  spec.id = {0x607A, 0};
  spec.type = DataType::int16;
  spec.quantity = Quantity::position;
  spec.encoding = encoding;
  AxisGeometry geometry;
  geometry.counts_per_turn = 4000;
  geometry.rated_torque = 0.64;
  return *Conversion::create(spec, profile, geometry);
}

std::uint64_t halfOf(const Conversion& conversion, double value) {
  std::uint64_t raw = 0xDEAD;
  EXPECT_TRUE(conversion.toDevice(value, raw)) << value;
  return raw;
}

TEST(Conversion, DecodesHalfFloatsInAllThreeWays) {
  for (const HalfRow& row : kHalfRows) {
    const double slack = 1e-8 * std::fabs(row.upper_value) + 1e-9;
    EXPECT_NEAR(half(Encoding::float32_by_65535_unsigned).toJoint(row.word), row.unsigned_value,
                slack);
    EXPECT_NEAR(half(Encoding::float32_by_65535_signed).toJoint(row.word), row.signed_value, slack);
    EXPECT_NEAR(half(Encoding::bfloat16).toJoint(row.word), row.upper_value, slack);
  }
}

TEST(Conversion, HalfFloatsDoNotDriftOverReadingAndWriting) {
  for (const Encoding encoding : {Encoding::bfloat16, Encoding::float32_by_65535_unsigned,
                                  Encoding::float32_by_65535_signed}) {
    for (const HalfRow& row : kHalfRows) {
      EXPECT_EQ(halfOf(half(encoding), half(encoding).toJoint(row.word)), row.word);
    }
    EXPECT_EQ(halfOf(half(encoding), -0.0), 0u) << "0x8000 reads as NaN";
    EXPECT_EQ(halfOf(half(encoding), -1e-40), 0u);
  }
  EXPECT_EQ(halfOf(half(Encoding::bfloat16), 0.3), 0x3E9Au);
  EXPECT_EQ(halfOf(half(Encoding::float32_by_65535_unsigned), 0.3), 0x3E9Au);
  EXPECT_EQ(halfOf(half(Encoding::float32_by_65535_unsigned), 0.1), 0x3DCDu);
}

}  // namespace
}  // namespace cia402::drive
