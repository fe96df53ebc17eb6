// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Floats as the Damiao has them: in 32 bits, and in 16, as drives encode those in three ways.
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

/// A position in radians of the output shaft.
Conversion floating(DataType type, Encoding encoding) {
  DriveProfile profile;
  profile.output_shaft = true;
  profile.units[Quantity::position] = {UnitSpec::Base::radian, 0, false, 1.0};
  ObjectSpec spec;
  spec.name = "tested";
  spec.id = {0x607A, 0};
  spec.type = type;
  spec.quantity = Quantity::position;
  spec.encoding = encoding;
  AxisGeometry geometry;
  geometry.counts_per_turn = 4000;
  geometry.rated_torque = 0.64;
  return *Conversion::create(spec, profile, geometry);
}
Conversion half(Encoding encoding) { return floating(DataType::int16, encoding); }

std::uint64_t sentAs(const Conversion& conversion, double value) {
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
      EXPECT_EQ(sentAs(half(encoding), half(encoding).toJoint(row.word)), row.word);
    }
    EXPECT_EQ(sentAs(half(encoding), -0.0), 0u) << "0x8000 reads as NaN";
    EXPECT_EQ(sentAs(half(encoding), -1e-40), 0u);
  }
  EXPECT_EQ(sentAs(half(Encoding::bfloat16), 0.3), 0x3E9Au);
  EXPECT_EQ(sentAs(half(Encoding::float32_by_65535_unsigned), 0.3), 0x3E9Au);
  EXPECT_EQ(sentAs(half(Encoding::float32_by_65535_unsigned), 0.1), 0x3DCDu);
}

// Every integer of 32 bits that the manual of the Damiao prints beside a float: each is the float
// that lies nearest to the decimal.
TEST(Conversion, FloatsAreThePairsThatTheDamiaoManualPrints) {
  struct Pair {
    std::uint64_t bits;
    double value;  // as printed
  };
  constexpr Pair kPairs[] = {
      {0x00000000, 0.0},    {0x3796FEB5, 0.000018}, {0x38C308FF, 0.000093}, {0x39B4E11E, 0.000345},
      {0x3A83126F, 0.001},  {0x3B03126F, 0.002},    {0x3C23D70A, 0.01},     {0x3D23D70A, 0.04},
      {0x3DCCCCCD, 0.1},    {0x3E4CCCCD, 0.2},      {0x3ECCCCCD, 0.4},      {0x3F000000, 0.5},
      {0x3F4CCCCD, 0.8},    {0x3F59999A, 0.85},     {0x3F800000, 1.0},      {0x40400000, 3.0},
      {0x40800000, 4.0},    {0x40E00000, 7.0},      {0x41700000, 15.0},     {0x41A00000, 20.0},
      {0x41C00000, 24.0},   {0x42000000, 32.0},     {0x42580000, 54.0},     {0x42C80000, 100.0},
      {0x42F00000, 120.0},  {0x44160000, 600.0},    {0x447A0000, 1000.0},   {0x44FA0000, 2000.0},
      {0x457A0000, 4000.0}, {0x461C4000, 10000.0}};
  const Conversion conversion = floating(DataType::int32, Encoding::float32);
  for (const Pair& pair : kPairs) {
    EXPECT_EQ(sentAs(conversion, pair.value), pair.bits) << pair.value;
    EXPECT_NEAR(conversion.toJoint(pair.bits), pair.value, 6e-8 * pair.value)
        << std::hex << pair.bits;
    EXPECT_EQ(sentAs(conversion, conversion.toJoint(pair.bits)), pair.bits) << pair.value;
  }
}

// The five words of 16 bits that it prints [L36, L257-259, L322]. Those of 0.01, 0.1 and 0.2 are
// the upper half of the float, cut off: the driver sends the nearest word, which is the next one.
TEST(Conversion, HalfFloatsAreTheWordsThatTheDamiaoManualPrints) {
  struct Word {
    std::uint64_t bits;
    double value;        // as printed
    double upper;        // the bits with 16 zeros behind them, exactly
    std::uint64_t sent;  // the nearest
  };
  const Conversion conversion = half(Encoding::bfloat16);
  for (const Word& word :
       {Word{0x3F00, 0.5, 0.5, 0x3F00}, Word{0x3DCC, 0.1, 0.099609375, 0x3DCD},
        Word{0x3E4C, 0.2, 0.19921875, 0x3E4D}, Word{0x3C23, 0.01, 0.00994873046875, 0x3C24},
        Word{0x3E99, 0.3, 0.298828125, 0x3E9A}}) {
    EXPECT_EQ(conversion.toJoint(word.bits), word.upper);
    EXPECT_NEAR(conversion.toJoint(word.bits), word.value, word.value / 128.0);
    EXPECT_EQ(sentAs(conversion, word.upper), word.bits);
    EXPECT_EQ(sentAs(conversion, word.value), word.sent) << word.value;
  }
  // 0x3E99 * 65535 = 0x3E98C167, "0.3" [L36]
  const Conversion product = half(Encoding::float32_by_65535_unsigned);
  EXPECT_EQ(product.toJoint(0x3E99),
            floating(DataType::int32, Encoding::float32).toJoint(0x3E98C167));
  EXPECT_NEAR(product.toJoint(0x3E99), 0.3, 0.006 * 0.3);
}

}  // namespace
}  // namespace cia402::drive
