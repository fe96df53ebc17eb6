// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// From where positions count: declared, lost, and of joints that turn without end.
#include <cmath>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;

AxisConfig homedFirst(AxisConfig config) {
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->search_velocity = config.homing->zero_velocity = 0.1;
  config.homing->acceleration = 1.0;
  return config;
}

AxisConfig continuous() {
  AxisConfig config = testConfig();
  config.geometry.type = AxisGeometry::Type::continuous;
  config.limits.lower.reset();
  config.limits.upper.reset();
  config.mode = "cyclic_velocity";
  return config;
}

/// The number of the position becomes `counts`.
void turnTo(Bench& bench, double counts) {
  bench.drive.position = counts;
  bench.cycle();
}

TEST(DeclaredZero, CountsAtOnceAndIsNoMotion) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  const std::uint32_t before = bench.axis.state().zero_changes;
  ASSERT_TRUE(bench.perform(ProcedureKind::set_position, {}, 0.5).success);
  EXPECT_NEAR(bench.axis.state().position, 0.5, 1e-9);
  EXPECT_NEAR(bench.axis.target(), 0.5, 1e-9);
  EXPECT_EQ(bench.axis.state().zero_changes, before + 1);
  bench.cycle();
  EXPECT_NEAR(bench.axis.state().position, 0.5, 1e-9);
  EXPECT_EQ(bench.drive.target_position, 12345);
  EXPECT_EQ(bench.axis.refusal({ProcedureKind::set_mode, "csv", 0.0}), "");
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.target_position, 12345);
}

TEST(LostZero, LeavesTheDrivesOwnUntilAPositionIsDeclared) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.perform(ProcedureKind::set_position, {}, 0.5).success);
  ASSERT_TRUE(bench.axis.state().homed);
  const std::uint32_t before = bench.axis.state().zero_changes;
  bench.axis.loseZero();
  EXPECT_FALSE(bench.axis.state().homed) << "though no homing is required";
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9);
  EXPECT_GT(bench.axis.state().zero_changes, before);
  bench.axis.measureAnew();
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.mayMove(); }));
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9);
  EXPECT_FALSE(bench.axis.state().homed);
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.axis.setTarget(1.24));
  EXPECT_EQ(bench.axis.obstacle(), "shoulder is not homed: set_position");
  ASSERT_TRUE(bench.perform(ProcedureKind::set_position, {}, 0.5).success);
  EXPECT_EQ(bench.axis.obstacle(), "");
  EXPECT_TRUE(bench.axis.setTarget(0.51));
}

AxisConfig keptByDrive() {
  DriveProfile profile = test::testProfile();
  profile.homed_bit = 15;
  AxisConfig config = homedFirst(testConfig(profile));
  config.homing->kept_by_drive = true;
  return config;
}

TEST(KeptHome, ComesAndGoesWithTheBitOfTheDrive) {
  Bench bench(keptByDrive());
  ASSERT_TRUE(bench.boot());
  EXPECT_FALSE(bench.axis.state().homed);
  bench.drive.knows_home = true;
  bench.run(milliseconds(20));
  EXPECT_TRUE(bench.axis.state().homed);
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9) << "as the drive counts";
  bench.drive.knows_home = false;
  bench.run(milliseconds(20));
  EXPECT_FALSE(bench.axis.state().homed);
  bench.drive.knows_home = true;
  bench.run(milliseconds(20));
  EXPECT_FALSE(bench.axis.state().homed) << "nobody knows whether it is the same one";
}

TEST(KeptHome, IsNotThatWhichSomebodyDeclares) {
  Bench bench(keptByDrive());
  bench.drive.knows_home = true;
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(200));
  ASSERT_TRUE(bench.axis.state().homed);
  ASSERT_TRUE(bench.perform(ProcedureKind::set_position, {}, 0.5).success);
  bench.drive.knows_home = false;
  bench.run(milliseconds(20));
  EXPECT_TRUE(bench.axis.state().homed);
  EXPECT_NEAR(bench.axis.state().position, 0.5, 1e-9);
}

TEST(KeptHome, CountsOnlyWhereTheAxisAndTheProfileSaySo) {
  for (const bool of_axis : {false, true}) {
    AxisConfig config = keptByDrive();
    DriveProfile profile = *config.profile;
    if (of_axis) profile.homed_bit.reset();
    config.profile = std::make_shared<const DriveProfile>(profile);
    config.homing->kept_by_drive = of_axis;
    Bench bench(config);
    bench.drive.knows_home = true;
    ASSERT_TRUE(bench.boot());
    bench.run(milliseconds(50));
    EXPECT_FALSE(bench.axis.state().homed);
  }
}

TEST(LostZero, IsStillLostAfterARebootAndOnceDeclaredIsNot) {
  for (const bool declared : {false, true}) {
    Bench bench;
    ASSERT_TRUE(bench.boot());
    bench.axis.loseZero();
    bench.axis.measureAnew();
    bench.run(milliseconds(200));
    if (declared) {
      ASSERT_TRUE(bench.perform(ProcedureKind::set_position, {}, 0.5).success);
    }
    bench.reboot();
    ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
    EXPECT_EQ(bench.axis.state().homed, declared);
  }
}

TEST(LostZero, ThatHomingFoundAgainIsNotLostAnyMore) {
  AxisConfig config = homedFirst(testConfig());
  config.homing->required = false;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.state().homed);
  bench.axis.loseZero();
  bench.axis.measureAnew();
  bench.run(milliseconds(200));
  ASSERT_FALSE(bench.axis.state().homed);
  ASSERT_TRUE(bench.perform(ProcedureKind::home).success) << bench.axis.procedure().message;
  bench.reboot();
  EXPECT_TRUE(bench.axis.state().homed);
}

TEST(MeasureAnew, BelievesNothingThatCameBefore) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(200));
  ASSERT_FALSE(bench.axis.mayMove());
  bench.axis.loseZero();
  bench.axis.measureAnew();
  EXPECT_FALSE(bench.axis.state().feedback_valid);
  EXPECT_TRUE(std::isnan(bench.axis.state().position));
  bench.drive.silent = true;
  bench.run(milliseconds(20));
  EXPECT_FALSE(bench.axis.state().feedback_valid) << "nothing new has come";
  bench.drive.silent = false;
  bench.cycle();
  EXPECT_TRUE(bench.axis.state().feedback_valid);
  EXPECT_TRUE(bench.axis.mayMove());
  EXPECT_THAT(bench.axis.calibrationRefusal(), HasSubstr("not known to stand"));
  bench.run(milliseconds(120));
  EXPECT_EQ(bench.axis.calibrationRefusal(), "");
}

TEST(MeasureAnew, KeepsAPositionThatIsOnlySentOnChange) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].every_cycle = false;
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(200));
  bench.drive.silent = true;
  bench.axis.loseZero();
  bench.run(milliseconds(200));
  ASSERT_FALSE(bench.axis.mayMove());
  bench.axis.measureAnew();
  bench.cycle();
  EXPECT_TRUE(bench.axis.state().feedback_valid);
  EXPECT_NEAR(bench.axis.state().position, 1.2345, 1e-9);
  EXPECT_TRUE(bench.axis.mayMove()) << "it has to be seen to stand once more";
}

// 0.0001 rad a count; the number of 32 bits wraps from 2147483647 to -2147483648.
TEST(ContinuousJoint, CountsOnWhereItsNumberWraps) {
  Bench bench(continuous());
  bench.drive.position = 2147483000;
  ASSERT_TRUE(bench.boot());
  EXPECT_NEAR(bench.axis.state().position, 214748.3, 1e-6);
  turnTo(bench, -2147483000);  // 1296 counts on
  EXPECT_NEAR(bench.axis.state().position, 214748.4296, 1e-6);
  turnTo(bench, 2147483000);
  EXPECT_NEAR(bench.axis.state().position, 214748.3, 1e-6);
}

TEST(ContinuousJoint, AJointWithLimitsReadsWhatTheDriveSays) {
  Bench bench;
  bench.drive.position = 2147483000;
  ASSERT_TRUE(bench.boot());
  turnTo(bench, -2147483000);
  EXPECT_NEAR(bench.axis.state().position, -214748.3, 1e-6);
}

TEST(ContinuousJoint, AfterARebootTheDrivesNumberCountsAlone) {
  Bench bench(homedFirst(continuous()));
  bench.drive.position = 2147483000;
  ASSERT_TRUE(bench.boot());
  turnTo(bench, -2147483000);
  bench.reboot();
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
  EXPECT_NEAR(bench.axis.state().position, -214748.3, 1e-6);
}

TEST(ContinuousJoint, WhatItsNumberDoesBetweenTwoZerosIsNoMotion) {
  Bench bench(continuous());
  ASSERT_TRUE(bench.boot());
  bench.axis.loseZero();
  turnTo(bench, 2147483000);
  turnTo(bench, -2147483000);
  EXPECT_NEAR(bench.axis.state().position, -214748.3, 1e-6);
  bench.axis.measureAnew();
  bench.cycle();
  EXPECT_NEAR(bench.axis.state().position, -214748.3, 1e-6);
  turnTo(bench, 2147483000);  // and counts from here on
  EXPECT_NEAR(bench.axis.state().position, -214748.4296, 1e-6);
}

// Some drives say that home is attained before their position counts from there.
TEST(ContinuousJoint, WhatItsNumberDoesBeforeHomingIsOverIsNoMotion) {
  Bench bench(homedFirst(continuous()));
  ASSERT_TRUE(bench.boot());
  int after = 0;
  bench.each_cycle = [&] {
    if (!bench.axis.state().homed) return;
    if (++after == 1) bench.drive.position = 2147483000;
    if (after == 2) bench.drive.position = -2147483000;
  };
  ASSERT_TRUE(bench.perform(ProcedureKind::home).success) << bench.axis.procedure().message;
  ASSERT_GT(after, 2);
  EXPECT_NEAR(bench.axis.state().position, -214748.3, 1e-6);
}

TEST(ContinuousJoint, CountsOnAfterHoming) {
  Bench bench(homedFirst(continuous()));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.perform(ProcedureKind::home).success) << bench.axis.procedure().message;
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  EXPECT_NEAR(bench.axis.state().position, 0.0, 1e-6);
  turnTo(bench, 1500000000);
  turnTo(bench, -2000000000);  // 794967296 counts on
  EXPECT_NEAR(bench.axis.state().position, 229496.7296, 1e-6);
}

TEST(DriveLimits, AreWrittenAgainToADriveThatRebooted) {
  DriveProfile profile = test::testProfile();
  profile.objects.push_back(test::object("lower", 0x607D, DataType::int32, Quantity::position, 1));
  profile.objects.push_back(test::object("upper", 0x607D, DataType::int32, Quantity::position, 2));
  profile.startup = {test::from("lower", "limits.lower"), test::from("upper", "limits.upper")};
  for (NamedWrite& write : profile.startup) write.when_homed = true;
  Bench bench(testConfig(std::move(profile)));
  const auto forget = [&] {
    bench.drive.dictionary[{0x607D, 1}] = bench.drive.dictionary[{0x607D, 2}] = {0, 4};
  };
  forget();
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(100));
  for (const bool rebooted : {false, true}) {
    if (rebooted) {
      bench.reboot();
      forget();
      ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
      bench.run(milliseconds(100));
    }
    EXPECT_EQ(static_cast<std::int32_t>(bench.drive.dictionary[{0x607D, 1}].first), -31000);
    EXPECT_EQ(static_cast<std::int32_t>(bench.drive.dictionary[{0x607D, 2}].first), 31000);
  }
}

}  // namespace
}  // namespace cia402::drive
