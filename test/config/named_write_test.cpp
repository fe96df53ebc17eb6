// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/named_write.h"

#include <limits>

#include "named_write_fixture.h"

namespace cia402::drive {
namespace {

using test::axisOf;
using test::rawOf;
using test::write;

TEST(NamedWrite, TakesLimitsInTheDrivesUnits) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.velocity = 2.0;
  EXPECT_EQ(rawOf(write("profile_velocity", "limits.velocity"), axis), 2000u);
  NamedWrite twice = write("profile_velocity", "limits.velocity");
  twice.times = 2.0;
  EXPECT_EQ(rawOf(twice, axis), 4000u);
}

TEST(NamedWrite, SwapsThePositionLimitsOfAReversedAxis) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.lower = -1.0;
  axis.limits.upper = 3.0;
  EXPECT_EQ(rawOf(write("software_limit_min", "limits.lower"), axis), 0xFFFFFC18u);  // -1000
  axis.geometry.direction = -1;
  EXPECT_EQ(rawOf(write("software_limit_min", "limits.lower"), axis), 0xFFFFF448u);  // -3000
  EXPECT_EQ(rawOf(write("software_limit_max", "limits.upper"), axis), 1000u);
}

TEST(NamedWrite, LimitsInSignedObjectsStayPositiveOnAReversedAxis) {
  AxisConfig axis = axisOf("damiao_dm");
  axis.limits.velocity = 3.0;
  axis.geometry.direction = -1;
  EXPECT_EQ(rawOf(write("target_velocity", "limits.velocity"), axis), 0x40400000u);  // +3.0
}

TEST(NamedWrite, LeavesOutWhatIsNotConfigured) {
  const AxisConfig axis = axisOf("generic_cia402");
  const auto resolved = resolveWrite(write("profile_velocity", "limits.velocity"), axis);
  ASSERT_TRUE(resolved);
  EXPECT_FALSE(*resolved);
  NamedWrite with_default = write("profile_velocity", "limits.velocity");
  with_default.value = 0.5;
  EXPECT_EQ(rawOf(with_default, axis), 500u);
}

TEST(NamedWrite, ChoosesTheQuickStopOption) {
  AxisConfig axis = axisOf("generic_cia402");
  NamedWrite option = write("quick_stop_option", "quick_stop.hold");
  option.raw = 2;
  option.optional = true;
  EXPECT_EQ(rawOf(option, axis), 2u);
  EXPECT_TRUE((*resolveWrite(option, axis))->optional) << "drives without 605Ah do that";
  axis.quick_stop_holds = true;
  EXPECT_EQ(rawOf(option, axis), 6u);
  EXPECT_FALSE((*resolveWrite(option, axis))->optional) << "what was asked for is done or told";
  DriveProfile profile = *axis.profile;
  profile.quick_stop_holds.clear();
  axis.profile = std::make_shared<const DriveProfile>(profile);
  const auto resolved = resolveWrite(option, axis);
  ASSERT_FALSE(resolved);
  EXPECT_THAT(resolved.error().message, testing::HasSubstr("quick_stop_holds"));
}

TEST(NamedWrite, TakesTheHomingOptions) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.homing = HomingOptions();
  axis.homing->method = -2;
  axis.homing->search_velocity = 0.25;
  axis.homing->zero_velocity = 0.05;
  axis.homing->acceleration = 1.5;
  axis.homing->offset = -0.5;
  EXPECT_EQ(rawOf(write("homing_method", "homing.method"), axis), 0xFEu);
  EXPECT_EQ(rawOf(write("homing_search_velocity", "homing.search_velocity"), axis), 250u);
  EXPECT_EQ(rawOf(write("homing_zero_velocity", "homing.zero_velocity"), axis), 50u);
  EXPECT_EQ(rawOf(write("homing_acceleration", "homing.acceleration"), axis), 1500u);
  EXPECT_EQ(rawOf(write("home_offset", "homing.offset"), axis), 0xFFFFFE0Cu);  // -500
}

TEST(NamedWrite, WritesTheSyncPeriodAsValueAndExponent) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.cycle = std::chrono::microseconds(2500);
  EXPECT_EQ(rawOf(write("interpolation_period_value", "sync_period.value"), axis), 25u);
  EXPECT_EQ(rawOf(write("interpolation_period_exponent", "sync_period.exponent"), axis), 0xFCu);
}

TEST(NamedWrite, WritesTheSyncPeriodInMilliseconds) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.cycle = std::chrono::milliseconds(10);
  EXPECT_EQ(rawOf(write("interpolation_period_value", "sync_period.ms"), axis), 10u);
  axis.cycle = std::chrono::milliseconds(256);
  const auto wide =
      drive::resolveWrite(write("interpolation_period_value", "sync_period.ms"), axis);
  ASSERT_FALSE(wide.ok());
  EXPECT_THAT(wide.error().message, testing::HasSubstr("256 (sync_period.ms) does not fit"));
}

TEST(NamedWrite, PeriodsAreExactOrNothing) {
  const auto four = interpolationPeriod(std::chrono::milliseconds(4));
  ASSERT_TRUE(four);
  EXPECT_EQ(four->value, 4);
  EXPECT_EQ(four->exponent, -3);
  EXPECT_EQ(interpolationPeriod(std::chrono::milliseconds(250))->value, 250);
  EXPECT_EQ(interpolationPeriod(std::chrono::milliseconds(250))->exponent, -3) << "where that will";
  EXPECT_EQ(interpolationPeriod(std::chrono::milliseconds(260))->value, 26);
  EXPECT_EQ(interpolationPeriod(std::chrono::milliseconds(20))->value, 20);
  EXPECT_EQ(interpolationPeriod(std::chrono::microseconds(20))->value, 2) << "10^-5";
  EXPECT_EQ(interpolationPeriod(std::chrono::seconds(1))->exponent, 0);
  EXPECT_FALSE(interpolationPeriod(std::chrono::microseconds(3333)));
  EXPECT_FALSE(interpolationPeriod(std::chrono::nanoseconds(1500)));
  EXPECT_FALSE(interpolationPeriod(Duration(0)));
}

TEST(NamedWrite, ACopyNamesTheObjectToRead) {
  const auto copy = resolveWrite(write("target_position", "position_actual"), axisOf("damiao_dm"));
  ASSERT_TRUE(copy && *copy);
  EXPECT_EQ((*copy)->copied_from, (ObjectId{0x6064, 0}));
  EXPECT_EQ((*copy)->object, (ObjectId{0x607A, 0}));
}

TEST(NamedWrite, RefusesInWordsWhatDoesNotFit) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.upper = 3e6;
  const auto resolved = resolveWrite(write("software_limit_max", "limits.upper"), axis);
  ASSERT_FALSE(resolved);
  EXPECT_THAT(resolved.error().message,
              testing::HasSubstr("shoulder (node 3): software_limit_max (607D:02): 3e+06 does not "
                                 "fit; the object holds -2.14748e+06 to 2.14748e+06"));
}

TEST(NamedWrite, NothingThatIsNotFiniteGetsIntoAFloatHoweverItIsNamed) {
  const AxisConfig axis = axisOf("damiao_dm");
  for (const char* object : {"profile_velocity", "6081:00", "200A:03"}) {
    for (const std::int64_t raw : {std::int64_t{-1}, std::int64_t{0x7F800000}}) {
      NamedWrite named;
      named.object = object;
      named.type = DataType::uint32;
      named.raw = raw;
      const auto resolved = resolveWrite(named, axis);
      ASSERT_FALSE(resolved) << object;
      EXPECT_THAT(resolved.error().message,
                  testing::AllOf(testing::HasSubstr("shoulder (node 3): "),
                                 testing::HasSubstr(raw < 0 ? "0xFFFFFFFF" : "0x7F800000"),
                                 testing::HasSubstr("no finite number"),
                                 testing::HasSubstr("give the number itself")));
    }
  }
  NamedWrite velocity;
  velocity.object = "profile_velocity";
  velocity.value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(resolveWrite(velocity, axis));
  NamedWrite zero;
  zero.object = "6081:00";
  zero.raw = 0x80000000;  // -0.0
  EXPECT_EQ(rawOf(zero, axis), 0u);
}

TEST(NamedWrite, AWholeNumberMayHaveAnyBits) {
  NamedWrite option;
  option.object = "communication_error_behaviour";
  option.raw = -1;
  EXPECT_EQ(rawOf(option, axisOf("damiao_dm")), 0xFFu);
}

TEST(NamedWrite, IsLeftOutIfItIsOptionalAndCannotBeConverted) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.effort = 5.0;  // in 1/1000 of a rated torque that nobody gave
  NamedWrite torque = write("max_torque", "limits.effort");
  EXPECT_FALSE(resolveWrite(torque, axis));
  torque.optional = true;
  const auto resolved = resolveWrite(torque, axis);
  ASSERT_TRUE(resolved);
  EXPECT_FALSE(*resolved);
}

TEST(NamedWrite, BytesAreLittleEndianAndAsManyAsTheType) {
  EXPECT_THAT(wireBytes(0x12345678, DataType::uint32),
              testing::ElementsAre(0x78, 0x56, 0x34, 0x12));
  EXPECT_THAT(wireBytes(0xFFFE, DataType::int16), testing::ElementsAre(0xFE, 0xFF));
  EXPECT_THAT(wireBytes(0x08, DataType::int8), testing::ElementsAre(0x08));
}

// The axis with an EDS that knows the object and its limits.
AxisConfig withEds(AxisConfig axis, ObjectId id, DataType type,
                   std::optional<fieldbus::ObjectValue> low,
                   std::optional<fieldbus::ObjectValue> high) {
  fieldbus::DictionaryObject object;
  object.index = id.index;
  fieldbus::DictionaryEntry& entry = object.entries[id.subindex];
  entry.id = id;
  entry.type = type;
  entry.low = std::move(low);
  entry.high = std::move(high);
  fieldbus::DeviceDescription eds;
  eds.file = "motor.eds";
  eds.dictionary.set(std::move(object));
  axis.description = std::make_shared<const fieldbus::DeviceDescription>(std::move(eds));
  return axis;
}

TEST(NamedWrite, EachLimitHasItsOwnSource) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.geometry.rated_torque = 2.0;
  axis.limits.velocity = 0.2;
  axis.limits.acceleration = 0.3;
  axis.limits.jerk = 0.4;
  axis.limits.effort = 0.5;
  DriveProfile profile = *axis.profile;
  ObjectSpec jerk = *profile.find("profile_acceleration");
  jerk.name = "profile_jerk";
  jerk.id = {0x60A4, 1};
  jerk.quantity = Quantity::jerk;
  profile.objects.push_back(jerk);
  axis.profile = std::make_shared<const DriveProfile>(profile);
  EXPECT_EQ(rawOf(write("profile_velocity", "limits.velocity"), axis), 200u);
  EXPECT_EQ(rawOf(write("profile_acceleration", "limits.acceleration"), axis), 300u);
  EXPECT_EQ(rawOf(write("profile_jerk", "limits.jerk"), axis), 400u);
  EXPECT_EQ(rawOf(write("max_torque", "limits.effort"), axis), 250u);  // 1/1000 of 2 N m
}

TEST(NamedWrite, AHomingOptionThatIsGivenIsAskedForAndADefaultIsNot) {
  AxisConfig axis = axisOf("generic_cia402");
  const auto asked = [&](const char* object, const char* from) {
    NamedWrite named = write(object, from);
    named.raw = 1;  // what the profile has instead
    const auto resolved = resolveWrite(named, axis);
    return resolved && *resolved && (*resolved)->asked_for;
  };
  EXPECT_FALSE(asked("home_offset", "homing.offset"));
  EXPECT_FALSE(asked("homing_method", "homing.method"));
  EXPECT_FALSE(asked("homing_search_velocity", "homing.search_velocity"));
  axis.homing = HomingOptions();
  axis.homing->method = 35;
  EXPECT_TRUE(asked("homing_method", "homing.method"));
  EXPECT_FALSE(asked("home_offset", "homing.offset")) << "0 by default";
  EXPECT_FALSE(asked("homing_search_velocity", "homing.search_velocity"));
  axis.homing->offset = 0.0;
  axis.homing->search_velocity = 0.1;
  EXPECT_TRUE(asked("home_offset", "homing.offset"));
  EXPECT_TRUE(asked("homing_search_velocity", "homing.search_velocity"));
  axis.limits.velocity = 1.0;
  EXPECT_FALSE(asked("profile_velocity", "limits.velocity")) << "of every axis";
}

TEST(NamedWrite, AHomingOptionThatIsNotGivenLeavesWhatTheProfileHas) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.homing = HomingOptions();
  for (const char* from :
       {"homing.search_velocity", "homing.zero_velocity", "homing.acceleration"}) {
    NamedWrite named = write("homing_search_velocity", from);
    named.raw = 77;
    EXPECT_EQ(rawOf(named, axis), 77u) << from;
  }
  axis.homing->search_velocity = 0.25;
  NamedWrite slower = write("homing_zero_velocity", "homing.search_velocity");
  slower.times = 0.5;
  EXPECT_EQ(rawOf(slower, axis), 125u);
}

TEST(NamedWrite, PeriodsHaveOneToTwoHundredAndFiftyFiveOfAPowerOfTen) {
  struct Row {
    Duration period;
    int value, exponent;
  };
  const Row rows[] = {
      {std::chrono::microseconds(1), 1, -6},     {std::chrono::microseconds(7), 7, -6},
      {std::chrono::microseconds(255), 255, -6}, {std::chrono::milliseconds(255), 255, -3},
      {std::chrono::seconds(255), 255, 0},       {std::chrono::seconds(1), 1, 0},
      {std::chrono::milliseconds(100), 100, -3}, {std::chrono::milliseconds(300), 3, -1}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.period.count());
    const auto found = interpolationPeriod(row.period);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->value, row.value);
    EXPECT_EQ(found->exponent, row.exponent);
  }
  for (const Duration none :
       {Duration(std::chrono::nanoseconds(100)), Duration(std::chrono::microseconds(256)),
        Duration(std::chrono::milliseconds(256)), Duration(std::chrono::seconds(256)),
        Duration(-std::chrono::milliseconds(4))}) {
    EXPECT_FALSE(interpolationPeriod(none)) << none.count();
  }
}

TEST(NamedWrite, WhatTheEdsForbidsIsRefusedWithItsLimit) {
  AxisConfig axis = withEds(axisOf("generic_cia402"), {0x6081, 0}, DataType::uint32,
                            fieldbus::ObjectValue{0xF4, 0x01, 0, 0},   // 500
                            fieldbus::ObjectValue{0xD0, 0x07, 0, 0});  // 2000
  const NamedWrite velocity = write("profile_velocity", "limits.velocity");
  axis.limits.velocity = 2.0;
  EXPECT_EQ(rawOf(velocity, axis), 2000u);
  axis.limits.velocity = 0.5;
  EXPECT_EQ(rawOf(velocity, axis), 500u);
  for (const auto& [limit, words] : {std::make_pair(2.001, "2001 is above the limit 2000"),
                                     std::make_pair(0.499, "499 is below the limit 500")}) {
    axis.limits.velocity = limit;
    const auto refused = resolveWrite(velocity, axis);
    ASSERT_FALSE(refused) << words;
    EXPECT_THAT(refused.error().message,
                testing::AllOf(testing::HasSubstr("shoulder (node 3): profile_velocity (6081:00)"),
                               testing::HasSubstr(words), testing::HasSubstr("motor.eds")));
  }
  const auto copy = resolveWrite(write("profile_velocity", "position_actual"), axis);
  ASSERT_TRUE(copy && *copy) << "what will be read is not known yet";
}

TEST(NamedWrite, APositionLimitIsOpenAsFarAsTheObjectOrTheEdsGoes) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.lower = -1.0;
  axis.limits.upper = 3.0;
  const auto limit = [](const NamedWrite& named, const AxisConfig& of) {
    const auto resolved = resolveLimit(named, of);
    EXPECT_TRUE(resolved && *resolved);
    return resolved && *resolved ? **resolved : ResolvedLimit();
  };
  const NamedWrite lower = write("software_limit_min", "limits.lower");
  const NamedWrite upper = write("software_limit_max", "limits.upper");
  EXPECT_EQ(limit(lower, axis).open, 0x80000000u);
  EXPECT_EQ(limit(upper, axis).open, 0x7FFFFFFFu);
  const fieldbus::ObjectValue low{0xB0, 0x3C, 0xFF, 0xFF}, high{0x50, 0xC3, 0, 0};  // -+50000
  EXPECT_EQ(limit(lower, withEds(axis, {0x607D, 1}, DataType::int32, low, high)).open, 0xFFFF3CB0u);
  EXPECT_EQ(limit(upper, withEds(axis, {0x607D, 2}, DataType::int32, low, high)).open, 0xC350u);
  EXPECT_EQ(limit(upper, withEds(axis, {0x607D, 2}, DataType::int32, low, {})).open, 0x7FFFFFFFu);
  EXPECT_EQ(limit(lower, withEds(axis, {0x607D, 1}, DataType::int32, {}, high)).open, 0x80000000u);
}

TEST(NamedWrite, APositionLimitSaysWhichWayItHoldsTheJoint) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.lower = -1.0;
  axis.limits.upper = 3.0;
  NamedWrite minimum = write("software_limit_min", "limits.lower");
  minimum.times = 2.0;
  const auto straight = resolveLimit(minimum, axis);
  ASSERT_TRUE(straight && *straight);
  EXPECT_TRUE((*straight)->lower);
  EXPECT_DOUBLE_EQ((*straight)->value, -2.0);
  EXPECT_EQ((*straight)->write.raw, 0xFFFFF830u);  // -2000
  axis.geometry.direction = -1;
  const auto reversed = resolveLimit(minimum, axis);
  ASSERT_TRUE(reversed && *reversed);
  EXPECT_FALSE((*reversed)->lower) << "the smaller number is the joint's upper end";
  EXPECT_DOUBLE_EQ((*reversed)->value, 6.0);
  EXPECT_EQ((*reversed)->write.raw, 0xFFFFE890u);  // -6000
  EXPECT_DOUBLE_EQ((*reversed)->conversion.toJoint(1000), -1.0);
  axis.limits.upper.reset();
  const auto none = resolveLimit(minimum, axis);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(NamedWrite, APositionLimitThatDoesNotFitIsRefused) {
  AxisConfig axis = axisOf("generic_cia402");
  axis.limits.upper = 3e6;
  const auto refused = resolveLimit(write("software_limit_max", "limits.upper"), axis);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("3e+06 does not fit"));
}

}  // namespace
}  // namespace cia402::drive
