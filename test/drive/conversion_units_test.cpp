// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every unit that a profile may count in, what is refused, and how halves are rounded.
#include "drive/profile/conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace cia402::drive {
namespace {

using testing::HasSubstr;
using Base = UnitSpec::Base;

constexpr double kHalfTurn = 3.14159265358979323846;

ObjectSpec specOf(DataType type, Quantity quantity, Encoding encoding = Encoding::integer) {
  ObjectSpec spec;
  spec.name = "tested";
  spec.id = {0x607A, 0};
  spec.type = type;
  spec.quantity = quantity;
  spec.encoding = encoding;
  return spec;
}

DriveProfile counted(Quantity quantity, Base base, double scale = 1.0) {
  DriveProfile profile;
  profile.units[quantity] = {base, 0, false, scale};
  return profile;
}

AxisGeometry geared(double gear_ratio) {
  AxisGeometry geometry;
  geometry.gear_ratio = gear_ratio;
  geometry.counts_per_turn = 4000;
  geometry.rated_torque = 2.0;
  return geometry;
}

std::uint64_t rawOf(const Conversion& conversion, double value) {
  std::uint64_t raw = 0xDEAD;
  EXPECT_TRUE(conversion.toDevice(value, raw)) << value;
  return raw;
}

TEST(ConversionUnits, AnglesOfTheMotorAreDividedByTheGear) {
  const std::pair<Base, double> degrees_per_unit[] = {{Base::turn, 360.0},
                                                      {Base::degree, 1.0},
                                                      {Base::radian, 180.0 / kHalfTurn},
                                                      {Base::count, 0.09}};
  for (const auto& [base, degrees] : degrees_per_unit) {
    SCOPED_TRACE(static_cast<int>(base));
    DriveProfile profile = counted(Quantity::position, base);
    const ObjectSpec position = specOf(DataType::int32, Quantity::position);
    const double radians = degrees * kHalfTurn / 180.0;
    EXPECT_DOUBLE_EQ(Conversion::create(position, profile, geared(10.0))->toJoint(3),
                     0.3 * radians);
    profile.output_shaft = true;
    EXPECT_DOUBLE_EQ(Conversion::create(position, profile, geared(10.0))->toJoint(3),
                     3.0 * radians);
  }
}

TEST(ConversionUnits, WhatDoesNotMoveIsOnlyScaled) {
  const std::pair<Quantity, Base> still[] = {{Quantity::current, Base::ampere},
                                             {Quantity::voltage, Base::volt},
                                             {Quantity::temperature, Base::celsius},
                                             {Quantity::time, Base::second}};
  AxisGeometry geometry = geared(10.0);
  geometry.direction = -1;
  geometry.position_offset = 0.5;
  for (const auto& [quantity, base] : still) {
    SCOPED_TRACE(static_cast<int>(quantity));
    const auto conversion = Conversion::create(specOf(DataType::int16, quantity),
                                               counted(quantity, base, 0.001), geometry);
    ASSERT_TRUE(conversion);
    EXPECT_DOUBLE_EQ(conversion->toJoint(1500), 1.5);
    EXPECT_DOUBLE_EQ(conversion->toJoint(0xFFFF), -0.001);
    EXPECT_EQ(rawOf(*conversion, -1.5), 0xFA24U);
    EXPECT_FALSE(conversion->reversed());
  }
}

TEST(ConversionUnits, FloatsAreScaledTurnedAndShiftedAsWholeNumbersAre) {
  AxisGeometry geometry = geared(2.0);
  geometry.direction = -1;
  geometry.position_offset = 0.25;
  const auto position =
      *Conversion::create(specOf(DataType::int32, Quantity::position, Encoding::float32),
                          counted(Quantity::position, Base::degree), geometry);
  EXPECT_DOUBLE_EQ(position.toJoint(0x42B40000), 0.25 - kHalfTurn / 4);  // 90 degrees of the motor
  EXPECT_EQ(rawOf(position, 0.25 - kHalfTurn / 4), 0x42B40000U);
  EXPECT_DOUBLE_EQ(position.toJoint(0), 0.25);
  const auto torque =
      *Conversion::create(specOf(DataType::int32, Quantity::torque, Encoding::float32),
                          counted(Quantity::torque, Base::newton_metre), geared(10.0));
  EXPECT_DOUBLE_EQ(torque.toJoint(0x40200000), 25.0);  // 2.5 N m of the motor
  EXPECT_EQ(rawOf(torque, -25.0), 0xC0200000U);
}

TEST(ConversionUnits, AReversedAxisHasItsBoundsTheOtherWayRound) {
  AxisGeometry geometry = geared(1.0);
  geometry.direction = -1;
  geometry.position_offset = 0.5;
  const auto position = *Conversion::create(specOf(DataType::int16, Quantity::position),
                                            counted(Quantity::position, Base::radian), geometry);
  EXPECT_DOUBLE_EQ(position.lowest(), 0.5 - 32767.0);
  EXPECT_DOUBLE_EQ(position.highest(), 0.5 + 32768.0);
  EXPECT_EQ(rawOf(position, position.lowest()), 0x7FFFU);
  EXPECT_EQ(rawOf(position, position.highest()), 0x8000U);
  geometry.direction = 1;
  const auto straight = *Conversion::create(specOf(DataType::int16, Quantity::position),
                                            counted(Quantity::position, Base::radian), geometry);
  EXPECT_DOUBLE_EQ(straight.lowest(), 0.5 - 32768.0);
  EXPECT_DOUBLE_EQ(straight.highest(), 0.5 + 32767.0);
}

TEST(ConversionUnits, WhatCannotBeConvertedIsToldWithTheObjectAndWhatIsMissing) {
  struct Row {
    DataType type;
    Quantity quantity;
    Base base;
    AxisGeometry geometry;
    const char* lacks;
  };
  AxisGeometry screw = geared(1.0);
  screw.type = AxisGeometry::Type::prismatic;
  AxisGeometry uncounted = geared(1.0);
  uncounted.counts_per_turn = 0.0;
  AxisGeometry unrated = geared(1.0);
  unrated.rated_torque = 0.0;
  const Row rows[] = {
      {DataType::int32, Quantity::position, Base::radian, geared(0.0), "gear_ratio is not greater"},
      {DataType::int32, Quantity::position, Base::radian, geared(-1.0), "gear_ratio is not great"},
      {DataType::int16, Quantity::torque, Base::newton_metre, geared(0.0), "gear_ratio is not gre"},
      {DataType::int32, Quantity::position, Base::count, uncounted, "counts_per_turn is not given"},
      {DataType::int32, Quantity::position, Base::radian, screw, "lead is not given"},
      {DataType::int16, Quantity::torque, Base::newton_metre, screw, "lead is not given"},
      {DataType::int16, Quantity::torque, Base::per_mille_of_rated, unrated, "rated_torque is not"},
      {DataType::int16, Quantity::torque, Base::ampere, geared(1.0), "neither per_mille_of_rated"},
      {DataType::int32, Quantity::position, Base::volt, geared(1.0), "none of count, turn, rad"},
      {DataType::real64, Quantity::position, Base::radian, geared(1.0), "holds no number that can"},
      {DataType::domain, Quantity::position, Base::radian, geared(1.0), "holds no number that can"},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.lacks);
    const auto conversion = Conversion::create(specOf(row.type, row.quantity),
                                               counted(row.quantity, row.base), row.geometry);
    ASSERT_FALSE(conversion);
    EXPECT_THAT(conversion.error().message, HasSubstr("tested (607A:00) cannot be converted: "));
    EXPECT_THAT(conversion.error().message, HasSubstr(row.lacks));
  }
}

TEST(ConversionUnits, HalfFloatsAreRoundedToTheNearest) {
  const DriveProfile radians = [] {
    DriveProfile profile = counted(Quantity::position, Base::radian);
    profile.output_shaft = true;
    return profile;
  }();
  const auto exact = *Conversion::create(
      specOf(DataType::int32, Quantity::position, Encoding::float32), radians, geared(1.0));
  struct Row {
    Encoding encoding;
    std::uint32_t bits;  ///< of the float to be sent
    std::uint16_t word;  ///< on the wire
  };
  const Row rows[] = {
      {Encoding::bfloat16, 0x3F807FFF, 0x3F80},  // below the middle
      {Encoding::bfloat16, 0x3F808000, 0x3F80},  // the middle: to the even word
      {Encoding::bfloat16, 0x3F808001, 0x3F81},
      {Encoding::bfloat16, 0x3F817FFF, 0x3F81},
      {Encoding::bfloat16, 0x3F818000, 0x3F82},
      {Encoding::bfloat16, 0xBF818000, 0xBF82},
      {Encoding::bfloat16, 0x00800000, 0x0080},  // the smallest that is not too small
      {Encoding::bfloat16, 0x007FFFFF, 0},
      // 0x3F80 * 65535 = 0x3F7FC080, and 32767 of 65535 more
      {Encoding::float32_by_65535_unsigned, 0x3F80407F, 0x3F80},
      {Encoding::float32_by_65535_unsigned, 0x3F804080, 0x3F81},
      {Encoding::float32_by_65535_signed, 0x3F80407F, 0x3F80},
      {Encoding::float32_by_65535_signed, 0x3F804080, 0x3F81},
      // 0xBF80 is -16512, * 65535 = 0xBF804080, and 32767 of 65535 less
      {Encoding::float32_by_65535_signed, 0xBF7FC081, 0xBF80},
      {Encoding::float32_by_65535_signed, 0xBF7FC080, 0xBF7F},
  };
  for (const Row& row : rows) {
    const auto half = *Conversion::create(specOf(DataType::int16, Quantity::position, row.encoding),
                                          radians, geared(1.0));
    EXPECT_EQ(rawOf(half, exact.toJoint(row.bits)), row.word) << std::hex << row.bits;
  }
}

TEST(ConversionUnits, FloatsHaveBoundsOfTheirOwn) {
  struct Row {
    DataType type;
    Encoding encoding;
    std::uint64_t low, high;  ///< on the wire
  };
  const Row rows[] = {
      {DataType::int32, Encoding::float32, 0xFF7FFFFF, 0x7F7FFFFF},
      {DataType::uint32, Encoding::float32, 0, 0x7F7FFFFF},
      {DataType::int16, Encoding::bfloat16, 0xFF7F, 0x7F7F},
      {DataType::int16, Encoding::float32_by_65535_unsigned, 0xFF80,
       0x7F80},  // * 65535 = 0xFF7F0080
      // -129 * 65535 = 0xFF7F0081, and -128 * 65535 would be no number
      {DataType::int16, Encoding::float32_by_65535_signed, 0xFF7F, 0x7F80},
      {DataType::uint16, Encoding::bfloat16, 0, 0x7F7F},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.high);
    const auto conversion = *Conversion::create(specOf(row.type, Quantity::none, row.encoding),
                                                DriveProfile(), geared(1.0));
    EXPECT_EQ(conversion.lowestRaw(), row.low);
    EXPECT_EQ(conversion.highestRaw(), row.high);
    EXPECT_EQ(rawOf(conversion, conversion.highest()), row.high);
    EXPECT_EQ(rawOf(conversion, conversion.lowest()), row.low);
  }
}

}  // namespace
}  // namespace cia402::drive
