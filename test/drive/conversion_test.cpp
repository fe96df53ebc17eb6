// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/conversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cia402::drive {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Units as config/drives/generic_cia402.yaml has them.
DriveProfile countingDrive() {
  DriveProfile profile;
  profile.units[Quantity::position] = {UnitSpec::Base::count, 0, false, 1.0};
  profile.units[Quantity::velocity] = {UnitSpec::Base::count, 1, false, 1.0};
  profile.units[Quantity::acceleration] = {UnitSpec::Base::count, 2, false, 1.0};
  profile.units[Quantity::torque] = {UnitSpec::Base::per_mille_of_rated, 0, false, 1.0};
  return profile;
}

DriveProfile floatDrive() {
  DriveProfile profile;
  profile.output_shaft = true;
  profile.units[Quantity::position] = {UnitSpec::Base::radian, 0, false, 1.0};
  profile.units[Quantity::torque] = {UnitSpec::Base::newton_metre, 0, false, 1.0};
  return profile;
}

ObjectSpec object(DataType type, Quantity quantity, Encoding encoding = Encoding::integer) {
  ObjectSpec spec;
  spec.name = "tested";
  spec.id = {0x607A, 0};
  spec.type = type;
  spec.quantity = quantity;
  spec.encoding = encoding;
  return spec;
}

AxisGeometry servo(int direction = 1, double gear = 1.0, double offset = 0.0) {
  AxisGeometry geometry;
  geometry.counts_per_turn = 4000;
  geometry.gear_ratio = gear;
  geometry.direction = direction;
  geometry.position_offset = offset;
  geometry.rated_torque = 0.64;
  return geometry;
}

std::uint64_t encode(const Conversion& conversion, double value) {
  std::uint64_t raw = 0xDEAD;
  EXPECT_TRUE(conversion.toDevice(value, raw)) << value;
  return raw;
}

TEST(Conversion, MinusZeroIsNotSentBack) {
  const auto joint = *Conversion::create(
      object(DataType::int32, Quantity::position, Encoding::float32), floatDrive(), servo());
  EXPECT_EQ(joint.sendable(0x80000000), 0u);
  EXPECT_EQ(joint.sendable(0xBF800000), 0xBF800000u);  // -1.0
  const auto counts =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), servo());
  EXPECT_EQ(counts.sendable(0x80000000), 0x80000000u) << "a count like any other";
}

TEST(Conversion, AJointWithoutEndWrapsWhatDoesNotFit) {
  const auto plain =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), servo());
  const auto wrapping = plain.wrapping();
  constexpr double kCount = 2.0 * kPi / 4000;
  std::uint64_t raw = 0xDEAD;
  EXPECT_FALSE(plain.toDevice(2147483648.0 * kCount, raw));
  EXPECT_EQ(raw, 0xDEADu);
  EXPECT_EQ(encode(wrapping, 2147483647.0 * kCount), 0x7FFFFFFFu);
  EXPECT_EQ(encode(wrapping, 2147483648.0 * kCount), 0x80000000u);
  EXPECT_EQ(encode(wrapping, -2147483649.0 * kCount), 0x7FFFFFFFu);
  EXPECT_EQ(encode(wrapping, (3 * 4294967296.0 + 5.0) * kCount), 5u);
  EXPECT_FALSE(wrapping.toDevice(std::numeric_limits<double>::infinity(), raw));
  EXPECT_FALSE(wrapping.toDevice(std::nan(""), raw));
  EXPECT_FALSE(wrapping.toDevice(1e30, raw));
  EXPECT_NEAR(plain.span(), 4294967296.0 * kCount, 1e-3);
}

TEST(Conversion, FloatsDoNotWrap) {
  const auto joint =
      Conversion::create(object(DataType::int32, Quantity::position, Encoding::float32),
                         floatDrive(), servo())
          ->wrapping();
  EXPECT_EQ(joint.span(), 0.0);
  EXPECT_EQ(encode(joint, 1e10), 0x501502F9u);  // 1e10 as a float
}

TEST(Conversion, KnowsTheNumbersThatLimitNothing) {
  const auto position =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), servo());
  EXPECT_EQ(position.lowestRaw(), 0x80000000u);
  EXPECT_EQ(position.highestRaw(), 0x7FFFFFFFu);
  const auto narrow =
      *Conversion::create(object(DataType::uint16, Quantity::position), countingDrive(), servo());
  EXPECT_EQ(narrow.lowestRaw(), 0u);
  EXPECT_EQ(narrow.highestRaw(), 0xFFFFu);
  const auto joint = *Conversion::create(
      object(DataType::int32, Quantity::position, Encoding::float32), floatDrive(), servo());
  EXPECT_EQ(joint.lowestRaw(), 0xFF7FFFFFu);
  EXPECT_EQ(joint.highestRaw(), 0x7F7FFFFFu);
}

TEST(Conversion, CountsOfTheMotorBecomeRadiansBehindTheGear) {
  const auto position = *Conversion::create(object(DataType::int32, Quantity::position),
                                            countingDrive(), servo(1, 50.0));
  // 4000 counts * 50 = 200000 counts per joint turn.
  EXPECT_DOUBLE_EQ(position.toJoint(50000), kPi / 2);
  EXPECT_DOUBLE_EQ(position.toJoint(0xFFFF3CB0), -kPi / 2);  // -50000 as 32 bits
  EXPECT_EQ(encode(position, kPi), 100000u);
  EXPECT_EQ(encode(position, -kPi), 0xFFFE7960u);
  EXPECT_DOUBLE_EQ(position.resolution(), 2 * kPi / 200000);
}

TEST(Conversion, AgreesWithTheMakersTables) {
  // iD286, section 6: R = 10000, 1591.549431 pulse/rad; NiMotion, section 6: 636.6197724 per rad.
  AxisGeometry geometry = servo();
  geometry.counts_per_turn = 10000;
  const auto stepper =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), geometry);
  EXPECT_EQ(encode(stepper, 1.0), 1592u);
  EXPECT_NEAR(1.0 / stepper.resolution(), 1591.549431, 1e-6);
  const auto nimotion =
      *Conversion::create(object(DataType::int32, Quantity::velocity), countingDrive(), servo());
  EXPECT_NEAR(1.0 / nimotion.resolution(), 636.6197724, 1e-7);
  EXPECT_EQ(encode(nimotion, 600.0 * 2 * kPi / 60), 40000u);  // 600 rpm = 40000 units/s
}

TEST(Conversion, DirectionTurnsSignedValuesRound) {
  const auto velocity =
      *Conversion::create(object(DataType::int32, Quantity::velocity), countingDrive(), servo(-1));
  EXPECT_EQ(encode(velocity, 2 * kPi), 0xFFFFF060u);  // -4000
  EXPECT_DOUBLE_EQ(velocity.toJoint(4000), -2 * kPi);
  EXPECT_TRUE(velocity.reversed());
}

TEST(Conversion, EverythingThatMovesTurnsRoundWithTheDirection) {
  DriveProfile drive = countingDrive();
  drive.units[Quantity::jerk] = {UnitSpec::Base::count, 3, false, 1.0};
  for (const Quantity quantity : {Quantity::position, Quantity::distance, Quantity::velocity,
                                  Quantity::acceleration, Quantity::jerk, Quantity::torque}) {
    const auto conversion =
        *Conversion::create(object(DataType::int32, quantity), drive, servo(-1));
    EXPECT_TRUE(conversion.reversed()) << static_cast<int>(quantity);
  }
  const auto jerk = *Conversion::create(object(DataType::int32, Quantity::jerk), drive, servo(-1));
  EXPECT_EQ(encode(jerk, 2 * kPi), 0xFFFFF060u);  // -4000 counts/s^3
  const auto plain = *Conversion::create(object(DataType::int32, Quantity::none), drive, servo(-1));
  EXPECT_FALSE(plain.reversed());
}

TEST(Conversion, AnUnsignedPositionHasNoOffset) {
  const auto position = *Conversion::create(object(DataType::uint32, Quantity::position),
                                            countingDrive(), servo(1, 1.0, 0.5));
  EXPECT_EQ(encode(position, kPi / 2), 1000u);
  EXPECT_DOUBLE_EQ(position.toJoint(1000), kPi / 2);
}

TEST(Conversion, UnsignedObjectsAreMagnitudesWhateverTheDirection) {
  const auto profile_velocity = *Conversion::create(object(DataType::uint32, Quantity::velocity),
                                                    countingDrive(), servo(-1, 1.0, 0.5));
  EXPECT_EQ(encode(profile_velocity, 2 * kPi), 4000u);
  std::uint64_t raw = 7;
  EXPECT_FALSE(profile_velocity.toDevice(-1.0, raw));
  EXPECT_EQ(raw, 7u);
}

TEST(Conversion, OffsetBelongsToPositionsAndNotToDistances) {
  const auto position = *Conversion::create(object(DataType::int32, Quantity::position),
                                            countingDrive(), servo(-1, 1.0, 0.5));
  EXPECT_DOUBLE_EQ(position.toJoint(0), 0.5);
  EXPECT_DOUBLE_EQ(position.toJoint(1000), 0.5 - kPi / 2);
  EXPECT_EQ(encode(position, 0.5 - kPi / 2), 1000u);
  const auto error = *Conversion::create(object(DataType::int32, Quantity::distance),
                                         countingDrive(), servo(-1, 1.0, 0.5));
  EXPECT_DOUBLE_EQ(error.toJoint(1000), -kPi / 2);
  EXPECT_DOUBLE_EQ(position.shifted(0.25).toJoint(0), 0.75);
}

TEST(Conversion, AScrewTurnsIntoMetres) {
  AxisGeometry geometry = servo(1, 2.0);
  geometry.type = AxisGeometry::Type::prismatic;
  geometry.lead = 0.01;
  const auto position =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), geometry);
  EXPECT_EQ(encode(position, 0.01), 8000u);  // one screw turn = two motor turns
  // Power: F * 0.01 m = M * 2 * 2 pi.
  const auto force =
      *Conversion::create(object(DataType::int16, Quantity::torque), countingDrive(), geometry);
  EXPECT_NEAR(force.toJoint(1000), 0.64 * 2 * 2 * kPi / 0.01, 1e-9);
}

TEST(Conversion, TorqueIsThatOfTheJoint) {
  const auto torque = *Conversion::create(object(DataType::int16, Quantity::torque),
                                          countingDrive(), servo(1, 50.0));
  EXPECT_NEAR(torque.toJoint(1000), 32.0, 1e-12);  // 0.64 N m * 50
  EXPECT_EQ(encode(torque, -16.0), 0xFE0Cu);       // -500 per mille
}

TEST(Conversion, AnObjectMayHaveItsOwnUnitAndFactor) {
  ObjectSpec speed = object(DataType::uint32, Quantity::velocity);
  speed.unit = UnitSpec{UnitSpec::Base::turn, 1, true, 1.0};  // rpm, beside counts/s
  const auto rpm = *Conversion::create(speed, countingDrive(), servo(1, 10.0));
  EXPECT_EQ(encode(rpm, 2 * kPi), 600u);  // 1 joint turn/s = 600 rpm of the motor
  speed.unit->scale = 0.1;
  EXPECT_EQ(encode(*Conversion::create(speed, countingDrive(), servo(1, 10.0)), 2 * kPi), 6000u);
  speed.unit->scale = 1.0;
  speed.factor = 4.0;
  EXPECT_EQ(encode(*Conversion::create(speed, countingDrive(), servo(1, 10.0)), 2 * kPi), 2400u);
}

// SV660C, H0E.07 = 1: the time in ms from 0 to 1000 rpm [L9609-9627].
TEST(Conversion, AnAccelerationMayBeTheTimeToASpeed) {
  DriveProfile profile = countingDrive();
  profile.units[Quantity::acceleration] = {UnitSpec::Base::turn, 1, true, 0.001, 1000.0};
  const auto conversion = *Conversion::create(object(DataType::uint32, Quantity::acceleration),
                                              profile, servo(-1, 50.0));
  // 1000 rpm in 10 s are 10.472 rad/s^2 of the motor, behind the gear a fiftieth of it.
  const double slow = 1000.0 / 60.0 * 2.0 * kPi / 10.0 / 50.0;
  EXPECT_NEAR(conversion.toJoint(10000), slow, 1e-12);
  EXPECT_EQ(encode(conversion, slow), 10000U);
  EXPECT_EQ(encode(conversion, 0.5 * slow), 20000U) << "bigger is slower";
  EXPECT_NEAR(conversion.highest(), 10000.0 * slow, 1e-6) << "in 1 ms";
  EXPECT_NEAR(conversion.lowest(), slow * 10000.0 / 4294967295.0, 1e-12);
  EXPECT_FALSE(conversion.reversed());
  EXPECT_EQ(conversion.mostRaw(), 1U) << "ms";
  std::uint64_t raw = 7;
  for (const double none :
       {0.0, -slow, 3e4 * slow, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(conversion.toDevice(none, raw)) << none;
  }
  EXPECT_EQ(raw, 7U);
}

TEST(Conversion, RoundsToTheNearestDeviceUnit) {
  const auto position =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), servo());
  const double unit = 2 * kPi / 4000;
  EXPECT_EQ(encode(position, 10.4 * unit), 10u);
  EXPECT_EQ(encode(position, 10.6 * unit), 11u);
  EXPECT_EQ(encode(position, -10.6 * unit), 0xFFFFFFF5u);
}

TEST(Conversion, RefusesWhatWouldWrapAround) {
  const auto position =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), servo());
  const double unit = 2 * kPi / 4000;
  EXPECT_EQ(encode(position, 2147483647.0 * unit), 0x7FFFFFFFu);
  EXPECT_EQ(encode(position, -2147483648.0 * unit), 0x80000000u);
  std::uint64_t raw = 7;
  EXPECT_FALSE(position.toDevice(2147483648.0 * unit, raw));
  EXPECT_FALSE(position.toDevice(-2147483649.0 * unit, raw));
  EXPECT_EQ(raw, 7u);
  EXPECT_NEAR(position.highest(), 2147483647.0 * unit, 1e-6);
  EXPECT_NEAR(position.lowest(), -2147483648.0 * unit, 1e-6);
}

TEST(Conversion, AFloatInAnUnsignedObjectIsNeverNegative) {
  const auto position = *Conversion::create(
      object(DataType::uint32, Quantity::distance, Encoding::float32), floatDrive(), servo());
  std::uint64_t raw = 7;
  EXPECT_FALSE(position.toDevice(-1.5, raw));
  EXPECT_FALSE(position.toDevice(std::nan(""), raw));
  EXPECT_EQ(raw, 7u);
  EXPECT_EQ(encode(position, 1.5), 0x3FC00000u);
}

TEST(Conversion, SixtyFourBitsEndBelowTheLargestDouble) {
  ObjectSpec wide = object(DataType::uint64, Quantity::none);
  const auto conversion = *Conversion::create(wide, countingDrive(), servo());
  std::uint64_t raw = 7;
  EXPECT_FALSE(conversion.toDevice(std::ldexp(1.0, 64), raw));
  EXPECT_TRUE(conversion.toDevice(conversion.highest(), raw));
  EXPECT_EQ(raw, 0xFFFFFFFFFFFFF800u);
}

TEST(Conversion, NeverSendsNaNOrInfinity) {
  std::uint64_t raw = 7;
  const auto integer =
      *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), servo());
  for (const Encoding encoding :
       {Encoding::float32, Encoding::bfloat16, Encoding::float32_by_65535_unsigned,
        Encoding::float32_by_65535_signed}) {
    const DataType type = encoding == Encoding::float32 ? DataType::int32 : DataType::int16;
    const auto floating =
        *Conversion::create(object(type, Quantity::position, encoding), floatDrive(), servo());
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(), 1e39, -1e39}) {
      EXPECT_FALSE(floating.toDevice(bad, raw)) << static_cast<int>(encoding) << " " << bad;
      EXPECT_FALSE(integer.toDevice(bad, raw));
    }
  }
  EXPECT_EQ(raw, 7u);
}

TEST(Conversion, FloatBitsAreThoseOfTheDamiaoManual) {
  const auto position = *Conversion::create(
      object(DataType::int32, Quantity::position, Encoding::float32), floatDrive(), servo());
  EXPECT_EQ(encode(position, 1.0), 0x3F800000u);
  EXPECT_EQ(encode(position, -1.0), 0xBF800000u);
  EXPECT_EQ(encode(position, 0.3), 0x3E99999Au);
  EXPECT_EQ(encode(position, kPi), 0x40490FDBu);
  EXPECT_EQ(encode(position, -kPi), 0xC0490FDBu);
  EXPECT_EQ(encode(position, 600.0), 0x44160000u);
  EXPECT_EQ(encode(position, -0.0), 0u);
  EXPECT_DOUBLE_EQ(position.toJoint(0x3E4CCCCD), static_cast<double>(0.2F));
  EXPECT_EQ(position.resolution(), 0.0);
}

TEST(Conversion, BelievesNoNaNFromTheDevice) {
  const auto position = *Conversion::create(
      object(DataType::int32, Quantity::position, Encoding::float32), floatDrive(), servo());
  EXPECT_TRUE(std::isnan(position.toJoint(0xFFFFFFFF)));  // -1 as an integer
  EXPECT_TRUE(std::isnan(position.toJoint(0x7F800000)));  // +infinity
  EXPECT_TRUE(std::isnan(position.toJoint(0xFF800000)));  // -infinity
}

TEST(Conversion, ReturnsWhatWentInToHalfADeviceUnit) {
  std::mt19937 random(20260101);
  std::uniform_real_distribution<double> share(-0.999, 0.999), gear(0.1, 200.0), offset(-5.0, 5.0);
  for (int i = 0; i < 20000; ++i) {
    AxisGeometry geometry = servo(i % 2 == 0 ? 1 : -1, gear(random), offset(random));
    geometry.counts_per_turn = 1 << (10 + i % 14);
    const auto position =
        *Conversion::create(object(DataType::int32, Quantity::position), countingDrive(), geometry);
    const double middle = 0.5 * (position.highest() + position.lowest());
    const double half_span = 0.5 * (position.highest() - position.lowest());
    const double value = middle + share(random) * half_span;
    const double back = position.toJoint(encode(position, value));
    ASSERT_NEAR(back, value, 0.5000001 * position.resolution() + 1e-12 * half_span);
  }
}

TEST(Conversion, ReturnsEveryRawNumberAsItWas) {
  std::mt19937 random(20260102);
  std::uniform_int_distribution<std::uint32_t> any;
  for (int i = 0; i < 20000; ++i) {
    const std::uint32_t raw = any(random);
    const auto position = *Conversion::create(object(DataType::int32, Quantity::position),
                                              countingDrive(), servo(-1, 37.5, 1.25));
    ASSERT_EQ(encode(position, position.toJoint(raw)), raw);
    const auto floating = *Conversion::create(
        object(DataType::int32, Quantity::position, Encoding::float32), floatDrive(), servo());
    const double value = floating.toJoint(raw);
    if (std::isnan(value) || raw == 0x80000000) continue;
    ASSERT_EQ(encode(floating, value), raw);
  }
}

std::string refusal(const ObjectSpec& spec, const AxisGeometry& geometry) {
  const auto conversion = Conversion::create(spec, countingDrive(), geometry);
  return conversion ? "" : conversion.error().message;
}

TEST(Conversion, SaysWhatIsMissing) {
  const ObjectSpec position = object(DataType::int32, Quantity::position);
  AxisGeometry geometry;
  EXPECT_NE(refusal(position, geometry).find("counts_per_turn"), std::string::npos);
  geometry = servo();
  geometry.type = AxisGeometry::Type::prismatic;
  EXPECT_NE(refusal(position, geometry).find("lead"), std::string::npos);
  geometry = servo();
  geometry.rated_torque = 0.0;
  EXPECT_NE(refusal(object(DataType::int16, Quantity::torque), geometry).find("rated_torque"),
            std::string::npos);
  EXPECT_NE(refusal(object(DataType::visible_string, Quantity::none), servo()).find("no number"),
            std::string::npos);
  EXPECT_NE(refusal(object(DataType::int32, Quantity::jerk), servo()).find("no unit"),
            std::string::npos);
}

}  // namespace
}  // namespace cia402::drive
