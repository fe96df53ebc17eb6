// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Writes to objects that take less than their type holds, and such as depend on another value.
#include "named_write_fixture.h"

namespace cia402::drive {
namespace {

using test::axisOf;
using test::write;

/// The family, with a range for one of its objects.
AxisConfig axisWithRange(const char* object, double low, double high) {
  AxisConfig axis = axisOf("generic_cia402");
  auto profile = std::make_shared<drive::DriveProfile>(*axis.profile);
  for (drive::ObjectSpec& spec : profile->objects) {
    if (spec.name == object) spec.range = drive::ObjectSpec::Range{low, high};
  }
  axis.profile = profile;
  return axis;
}

TEST(NamedWriteRange, KeepsToWhatTheDriveTakes) {
  AxisConfig axis = axisWithRange("max_motor_speed", 1, 500);
  axis.limits.velocity = 1e-5;
  const auto slow = resolveWrite(write("max_motor_speed", "limits.velocity"), axis);
  ASSERT_FALSE(slow) << "0 turns a minute";
  EXPECT_THAT(
      slow.error().message,
      testing::HasSubstr("max_motor_speed (6080:00): 1e-05 does not fit; the object holds "));
  axis = axisWithRange("homing_method", 17, 30);
  axis.homing.emplace();
  axis.homing->method = 35;
  const auto method = resolveWrite(write("homing_method", "homing.method"), axis);
  ASSERT_FALSE(method);
  EXPECT_THAT(method.error().message,
              testing::HasSubstr("homing_method (6098:00): 35 does not fit; the object takes 17 to "
                                 "30 in the drive's own numbers"));
}

TEST(NamedWriteRange, OpensALimitAsFarAsTheDriveTakesIt) {
  AxisConfig axis = axisWithRange("software_limit_max", -2000000000, 2000000000);
  axis.limits.upper = 1.0;
  NamedWrite named = write("software_limit_max", "limits.upper");
  named.when_homed = true;
  const auto limit = resolveLimit(named, axis);
  ASSERT_TRUE(limit && *limit);
  EXPECT_EQ((*limit)->open, 0x77359400U);
}

TEST(NamedWrite, IsLeftOutWithoutTheValueThatItGoesWith) {
  AxisConfig axis = axisOf("generic_cia402");
  NamedWrite named = write("vl_acceleration_time", "");
  named.raw = 1;
  named.if_given = "limits.acceleration";
  axis.limits.acceleration.reset();
  auto resolved = resolveWrite(named, axis);
  ASSERT_TRUE(resolved);
  EXPECT_FALSE(*resolved);
  axis.limits.acceleration = 4.0;
  resolved = resolveWrite(named, axis);
  ASSERT_TRUE(resolved && *resolved);
  EXPECT_EQ((*resolved)->raw, 1U);
  named.if_given = "homing.search_velocity";
  EXPECT_FALSE(*resolveWrite(named, axis));
  axis.homing.emplace();
  axis.homing->search_velocity = 0.1;
  EXPECT_TRUE(*resolveWrite(named, axis));
  named.if_given = "quick_stop.hold";
  EXPECT_FALSE(*resolveWrite(named, axis));
  axis.quick_stop_holds = true;
  EXPECT_TRUE(*resolveWrite(named, axis));
}

}  // namespace
}  // namespace cia402::drive
