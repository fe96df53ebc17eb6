// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a drive is set to is compared before it is enabled, and its brake's time learnt.
#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::testConfig;
using test::testProfile;
using namespace std::chrono_literals;

DriveProfile expecting(std::int64_t raw, DataType type = DataType::uint16) {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("source", 0x2002, type));
  Expectation expectation;
  expectation.object = "source";
  expectation.raw = raw;
  expectation.text = "the drive listens to its panel";
  expectation.remedy = "set P00 at the panel";
  profile.expected = {expectation};
  return profile;
}

TEST(SettingsStep, RefusesInWordsWhatIsSetOtherwise) {
  Bench bench(testConfig(expecting(8)));
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(status.message,
            "shoulder (node 3): is not enabled: source (2002:00) is 1 instead of 8, the drive "
            "listens to its panel; set P00 at the panel");
  EXPECT_NE(bench.drive.state, FakeDrive::S::enabled);
  bench.drive.dictionary[{0x2002, 0}] = {8, 2};
  EXPECT_TRUE(bench.enable()) << "it is read anew each time";
}

TEST(SettingsStep, ReadsASignByTheLengthThatComes) {
  Bench bench(testConfig(expecting(-2, DataType::int16)));
  bench.drive.dictionary[{0x2002, 0}] = {0xFE, 1};
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.enable());
}

TEST(SettingsStep, RefusesWhatCannotBeReadUnlessTheAxisSaysThatTheDriveLacksIt) {
  AxisConfig config = testConfig(expecting(8));
  {
    Bench bench(config);
    ASSERT_TRUE(bench.boot());
    const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
    EXPECT_FALSE(status.success);
    EXPECT_THAT(status.message, HasSubstr("0x06020000"));
    EXPECT_THAT(status.message, HasSubstr("`lacks: [source]` of axes/shoulder"));
  }
  config.lacks = {"source"};
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.enable());
}

TEST(SettingsStep, ComparesWhatConcernsAModeWhereTheAxisUsesIt) {
  DriveProfile profile = expecting(8);
  profile.expected[0].modes = {"profile_position"};
  AxisConfig config = testConfig(profile);
  config.modes = {"cyclic_position"};
  {
    Bench bench(config);
    bench.drive.dictionary[{0x2002, 0}] = {1, 2};
    ASSERT_TRUE(bench.boot());
    EXPECT_TRUE(bench.enable());
  }
  config.modes = {"cyclic_position", "profile_position"};
  Bench bench(config);
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  ASSERT_TRUE(bench.boot());
  EXPECT_FALSE(bench.perform(ProcedureKind::enable).success);
}

TEST(SettingsStep, ComparesTheCountsOfATurn) {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("resolution", 0x2003, DataType::uint32));
  profile.objects.push_back(test::object("units", 0x2004, DataType::uint32));
  profile.objects.push_back(test::object("counts", 0x2005, DataType::uint32));
  profile.counts_rule = {{"resolution", "units"}, {"counts"}};
  AxisConfig config = testConfig(profile);
  config.geometry.counts_per_turn = 10000;
  Bench bench(config);
  bench.drive.dictionary[{0x2003, 0}] = {1048576, 4};
  bench.drive.dictionary[{0x2004, 0}] = {625, 4};
  bench.drive.dictionary[{0x2005, 0}] = {65536, 4};
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.enable()) << "2^20 * 625 / 2^16 = 10000";
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.drive.dictionary[{0x2004, 0}] = {626, 4};
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("the drive counts 10016 a turn of its motor"));
  EXPECT_THAT(status.message, HasSubstr("units (2004:00) = 626"));
  EXPECT_THAT(status.message, HasSubstr("but counts_per_turn of axes/shoulder is 10000"));
}

DriveProfile braked() {
  DriveProfile profile = testProfile();
  profile.units[Quantity::time].base = UnitSpec::Base::second;
  profile.units[Quantity::time].scale = 0.001;
  profile.objects.push_back(test::object("brake_time", 0x2006, DataType::uint16));
  profile.objects.back().quantity = Quantity::time;
  profile.timing.brake_release = 500ms;
  profile.timing.brake_object = "brake_time";
  return profile;
}

/// @return from operation enabled until the axis takes commands
Duration waited(Bench& bench) {
  EXPECT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0}, bench.now).ok());
  EXPECT_TRUE(bench.runUntil([&] { return bench.drive.state == FakeDrive::S::enabled; }));
  const Time enabled = bench.now;
  EXPECT_TRUE(bench.runUntil([&] { return bench.axis.state().ready_for_motion; }));
  return bench.now - enabled;
}

TEST(SettingsStep, LearnsHowLongTheBrakeTakes) {
  Bench bench(testConfig(braked()));
  bench.drive.dictionary[{0x2006, 0}] = {120, 2};
  ASSERT_TRUE(bench.boot());
  const Duration time = waited(bench);
  EXPECT_GE(time, 120ms);
  EXPECT_LE(time, 140ms);
}

TEST(SettingsStep, TakesTheLongestTimeWhereTheDriveDoesNotTell) {
  Bench bench(testConfig(braked()));
  ASSERT_TRUE(bench.boot());
  EXPECT_GE(waited(bench), 500ms);
}

TEST(SettingsStep, RefusesABrakeThatTakesLonger) {
  Bench bench(testConfig(braked()));
  bench.drive.dictionary[{0x2006, 0}] = {501, 2};
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("brake_time (2006:00) is 0.501 s, longer than the 0.5 s"));
}

}  // namespace
}  // namespace cia402::drive
