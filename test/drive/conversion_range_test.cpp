// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Objects that take less than their type holds (`range` of a profile).
#include <gtest/gtest.h>

#include "drive/profile/conversion.h"

namespace cia402::drive {
namespace {

constexpr double kTurn = 6.283185307179586;  // rad

ObjectSpec ranged(DataType type, Quantity quantity, double low, double high) {
  ObjectSpec spec;
  spec.name = "tested";
  spec.id = {0x6071, 0};
  spec.type = type;
  spec.quantity = quantity;
  spec.range = ObjectSpec::Range{low, high};
  return spec;
}

DriveProfile drive() {
  DriveProfile profile;
  profile.units[Quantity::position] = {UnitSpec::Base::count, 0, false, 1.0};
  profile.units[Quantity::torque] = {UnitSpec::Base::per_mille_of_rated, 0, false, 10.0};
  return profile;
}

AxisGeometry motor(int direction = 1) {
  AxisGeometry geometry;
  geometry.counts_per_turn = 10000;
  geometry.rated_torque = 2.0;
  geometry.direction = direction;
  return geometry;
}

// 6071h of iD286-CNFA: 0 to 120 percent; a negative number would be ignored, and the torque from
// before would go on.
TEST(ConversionRange, WhatTheObjectDoesNotTakeIsNoNumberForIt) {
  const ObjectSpec torque = ranged(DataType::int16, Quantity::torque, 0, 120);
  const Conversion forwards = *Conversion::create(torque, drive(), motor());
  std::uint64_t raw = 7;
  EXPECT_TRUE(forwards.toDevice(2.4, raw));
  EXPECT_EQ(raw, 120U);
  EXPECT_FALSE(forwards.toDevice(2.42, raw));
  EXPECT_FALSE(forwards.toDevice(-0.02, raw));
  EXPECT_EQ(raw, 120U) << "untouched";
  EXPECT_DOUBLE_EQ(forwards.lowest(), 0.0);
  EXPECT_DOUBLE_EQ(forwards.highest(), 2.4);

  const Conversion backwards = *Conversion::create(torque, drive(), motor(-1));
  EXPECT_FALSE(backwards.toDevice(0.02, raw));
  EXPECT_TRUE(backwards.toDevice(-2.4, raw));
  EXPECT_EQ(raw, 120U);
  EXPECT_DOUBLE_EQ(backwards.lowest(), -2.4);
}

TEST(ConversionRange, ALimitIsOpenedAsFarAsTheDriveTakesIt) {
  const Conversion limit = *Conversion::create(
      ranged(DataType::int32, Quantity::position, -2000000000, 2000000000), drive(), motor());
  EXPECT_EQ(limit.lowestRaw(), 0x88CA6C00U);  // -2000000000
  EXPECT_EQ(limit.highestRaw(), 0x77359400U);
  const Conversion all = *Conversion::create(
      ranged(DataType::int32, Quantity::position, -2147483648.0, 2147483647.0), drive(), motor());
  EXPECT_EQ(all.lowestRaw(), 0x80000000U);
  EXPECT_EQ(all.highestRaw(), 0x7FFFFFFFU);
}

// The counter of the drive wraps where its 32 bits do, whatever it takes as a target.
TEST(ConversionRange, NumbersWrapByTheirTypeAndNotByTheRange) {
  const Conversion target =
      Conversion::create(ranged(DataType::int32, Quantity::position, -2000000000, 2000000000),
                         drive(), motor())
          ->wrapping();
  EXPECT_DOUBLE_EQ(target.span(), 429496.7296 * kTurn);
  std::uint64_t raw = 0;
  EXPECT_TRUE(target.toDevice(429496.7296 * kTurn + kTurn, raw));
  EXPECT_EQ(raw, 10000U);
  EXPECT_FALSE(target.toDevice(210000.0 * kTurn, raw)) << "2100000000";
}

TEST(ConversionRange, HoldsForFloatsToo) {
  ObjectSpec spec = ranged(DataType::int32, Quantity::torque, -7.0, 7.0);
  spec.encoding = Encoding::float32;
  DriveProfile profile;
  profile.units[Quantity::torque] = {UnitSpec::Base::newton_metre, 0, false, 1.0};
  const Conversion torque = *Conversion::create(spec, profile, motor());
  std::uint64_t raw = 0;
  EXPECT_TRUE(torque.toDevice(7.0, raw));
  EXPECT_EQ(raw, 0x40E00000U);
  EXPECT_FALSE(torque.toDevice(7.01, raw));
  EXPECT_TRUE(spec.takes(0x40E00000U));
  EXPECT_FALSE(spec.takes(0x40E00001U));
  EXPECT_FALSE(spec.takes(0x7FC00000U)) << "no number";
}

TEST(ConversionRange, BitsAreReadAsTheTypeSays) {
  ObjectSpec spec = ranged(DataType::int16, Quantity::none, -5, 10);
  EXPECT_TRUE(spec.takes(0xFFFBU));
  EXPECT_FALSE(spec.takes(0xFFFAU));
  spec.type = DataType::uint16;
  EXPECT_FALSE(spec.takes(0xFFFBU));
  spec.range.reset();
  EXPECT_TRUE(spec.takes(0xFFFBU));
  EXPECT_EQ(spec.rangeText(), "");
}

}  // namespace
}  // namespace cia402::drive
