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
  SettingCheck check;
  check.objects = {"source"};
  check.condition.numbers = {raw};
  check.text = "the drive listens to its panel";
  check.remedy = "set P00 at the panel";
  profile.checks = {check};
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
  profile.checks[0].modes = {"profile_position"};
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

TEST(SettingsStep, SaysInWordsHowANumberIsWrong) {
  using Kind = Condition::Kind;
  const std::pair<Condition, const char*> complaints[] = {
      {{Kind::is, {2, 3}}, "source (2002:00) is 1 instead of 2 or 3, "},
      {{Kind::is, {2, 3, 5}}, "source (2002:00) is 1 instead of 2, 3 or 5, "},
      {{Kind::is_not, {0, 1}}, "source (2002:00) is 1, which it must not be, "},
      {{Kind::above, {1}}, "source (2002:00) is 1, not above 1, "},
      {{Kind::below, {1}}, "source (2002:00) is 1, not below 1, "},
  };
  for (const auto& [condition, told] : complaints) {
    DriveProfile profile = expecting(8);
    profile.checks[0].condition = condition;
    Bench bench(testConfig(profile));
    bench.drive.dictionary[{0x2002, 0}] = {1, 2};
    ASSERT_TRUE(bench.boot());
    EXPECT_THAT(bench.perform(ProcedureKind::enable).message, HasSubstr(told));
    EXPECT_NE(bench.drive.state, FakeDrive::S::enabled);
  }
}

TEST(SettingsStep, TakesWhatFitsAConditionOtherThanOneNumber) {
  using Kind = Condition::Kind;
  for (const Condition& condition : {Condition{Kind::is, {2, 1}}, Condition{Kind::is_not, {0}},
                                     Condition{Kind::above, {0}}, Condition{Kind::below, {2}}}) {
    DriveProfile profile = expecting(8);
    profile.checks[0].condition = condition;
    Bench bench(testConfig(profile));
    bench.drive.dictionary[{0x2002, 0}] = {1, 2};
    ASSERT_TRUE(bench.boot());
    EXPECT_TRUE(bench.enable());
  }
}

TEST(SettingsStep, TellsTheMeaningOfSingleNumbers) {
  DriveProfile profile = expecting(0);
  profile.checks[0].texts = {{3, "main power is missing"}};
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x2002, 0}] = {3, 2};
  ASSERT_TRUE(bench.boot());
  EXPECT_THAT(bench.perform(ProcedureKind::enable).message,
              HasSubstr("is 3 instead of 0, main power is missing; set P00 at the panel"));
}

TEST(SettingsStep, NeedsOneOfSeveralObjects) {
  DriveProfile profile = expecting(8);
  profile.objects.push_back(test::object("second", 0x2003, DataType::uint16));
  profile.checks[0].objects = {"source", "second"};
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  bench.drive.dictionary[{0x2003, 0}] = {2, 2};
  ASSERT_TRUE(bench.boot());
  EXPECT_THAT(bench.perform(ProcedureKind::enable).message,
              HasSubstr("source (2002:00) is 1 instead of 8 and second (2003:00) is 2 instead"));
  bench.drive.dictionary[{0x2003, 0}] = {8, 2};
  EXPECT_TRUE(bench.enable());
}

TEST(SettingsStep, MindsOnlyWhatIsGivenAndNotExcused) {
  DriveProfile profile = expecting(8);
  profile.objects.push_back(test::object("second", 0x2003, DataType::uint16));
  profile.checks[0].if_given = "limits.jerk";
  profile.checks[0].unless = "second";
  profile.checks[0].unless_is = {Condition::Kind::is, {7}};
  AxisConfig config = testConfig(profile);
  {
    Bench bench(config);
    bench.drive.dictionary[{0x2002, 0}] = {1, 2};
    ASSERT_TRUE(bench.boot());
    EXPECT_TRUE(bench.enable()) << "the axis has no jerk limit";
  }
  config.limits.jerk = 100.0;
  Bench bench(config);
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  bench.drive.dictionary[{0x2003, 0}] = {6, 2};
  ASSERT_TRUE(bench.boot());
  EXPECT_FALSE(bench.perform(ProcedureKind::enable).success);
  bench.drive.dictionary[{0x2003, 0}] = {7, 2};
  EXPECT_TRUE(bench.enable());
}

TEST(SettingsStep, WarnsOnceOfWhatIsNoReasonToRefuse) {
  DriveProfile profile = expecting(8);
  profile.checks[0].only_warns = true;
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.enable());
  EXPECT_THAT(bench.axis.notice(), HasSubstr("source (2002:00) is 1 instead of 8"));
}

// Write source := 8, read it again; nothing else differs.
TEST(SettingsStep, WritesWhereTheProfileOrTheAxisAsksForIt) {
  DriveProfile profile = expecting(8);
  profile.checks[0].write = SettingCheck::Write::asked;
  {
    Bench bench(testConfig(profile));
    bench.drive.dictionary[{0x2002, 0}] = {1, 2};
    ASSERT_TRUE(bench.boot());
    EXPECT_FALSE(bench.perform(ProcedureKind::enable).success) << "nobody asked";
    EXPECT_EQ(bench.drive.dictionary.at({0x2002, 0}).first, 1U);
  }
  AxisConfig asks = testConfig(profile);
  asks.adjust = {"source"};
  profile.checks[0].write = SettingCheck::Write::always;
  for (const AxisConfig& config : {asks, testConfig(profile)}) {
    Bench bench(config);
    bench.drive.dictionary[{0x2002, 0}] = {1, 2};
    ASSERT_TRUE(bench.boot());
    EXPECT_TRUE(bench.enable());
    EXPECT_EQ(bench.drive.dictionary.at({0x2002, 0}).first, 8U);
  }
}

// Polarity (607Eh) gives the drive other coordinates: what the axis knew of its zero is over.
TEST(SettingsStep, LosesTheZeroWithWhatItWritesOfCoordinates) {
  DriveProfile profile = expecting(0, DataType::uint8);
  profile.objects.push_back(test::object("polarity", 0x607E, DataType::uint8));
  profile.checks[0].objects = {"polarity"};
  profile.checks[0].write = SettingCheck::Write::always;
  AxisConfig config = testConfig(profile);
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  bench.drive.dictionary[{0x607E, 0}] = {0, 1};
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::home).success);
  ASSERT_TRUE(bench.axis.state().homed);
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  ASSERT_TRUE(bench.enable());
  EXPECT_TRUE(bench.axis.state().homed) << "nothing differed";
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.drive.dictionary[{0x607E, 0}] = {128, 1};
  const Time begun = bench.now;
  ASSERT_TRUE(bench.enable());
  EXPECT_GE(bench.now - begun, 250ms) << "a drive may confirm before it counts anew";
  EXPECT_EQ(bench.drive.dictionary.at({0x607E, 0}).first, 0U);
  EXPECT_FALSE(bench.axis.state().homed);
}

TEST(SettingsStep, RefusesWhereTheDriveKeepsItsOwn) {
  DriveProfile profile = expecting(8);
  profile.checks[0].write = SettingCheck::Write::always;
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  bench.drive.deaf_to.insert({0x2002, 0});
  ASSERT_TRUE(bench.boot());
  EXPECT_THAT(bench.perform(ProcedureKind::enable).message,
              HasSubstr("(the drive was told so just now, and keeps its own)"));
  EXPECT_NE(bench.drive.state, FakeDrive::S::enabled);
}

TEST(SettingsStep, WantsThePowerToBeOffWhereWhatItWroteCountsThenOnly) {
  DriveProfile profile = expecting(8);
  profile.checks[0].write = SettingCheck::Write::always;
  profile.checks[0].power_cycle = true;
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  ASSERT_TRUE(bench.boot());
  const std::string told =
      "shoulder (node 3): is not enabled: source (2002:00) was set to 8, which counts once its "
      "power was off; switch it off and on";
  EXPECT_EQ(bench.perform(ProcedureKind::enable).message, told);
  EXPECT_EQ(bench.perform(ProcedureKind::enable).message, told) << "though it reads 8 by now";
  EXPECT_NE(bench.drive.state, FakeDrive::S::enabled);
}

TEST(SettingsStep, ComparesBeforeASearchWhatConcernsItsMethod) {
  DriveProfile profile = expecting(36);
  profile.checks[0].before = SettingCheck::Before::homing;
  profile.checks[0].methods = {17};
  AxisConfig config = testConfig(profile);
  config.homing = HomingOptions();
  config.homing->method = 17;
  Bench bench(config);
  bench.drive.dictionary[{0x2002, 0}] = {1, 2};
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable()) << "it concerns homing alone";
  EXPECT_THAT(bench.perform(ProcedureKind::home).message,
              HasSubstr("does not search its home: source (2002:00) is 1 instead of 36"));
  EXPECT_EQ(bench.drive.homings, 0);
  bench.drive.dictionary[{0x2002, 0}] = {36, 2};
  EXPECT_TRUE(bench.perform(ProcedureKind::home).success);
  EXPECT_EQ(bench.drive.homings, 1);
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

// As an axis without PDOs may have it of its own first controlword.
TEST(SettingsStep, AsksAgainForWhatMadeWayForAnUrgentWrite) {
  Bench bench(testConfig(expecting(8)));
  bench.drive.dictionary[{0x2002, 0}] = {8, 2};
  bench.drive.unanswered_reads.insert({0x2002, 0});
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(
      bench.runUntil([&] { return bench.axis.procedure().step == "comparing settings"; }, 1s));
  bench.cycle();
  bench.drive.unanswered_reads.clear();
  bench.device().objects().downloadUrgent({0x2099, 0}, {0, 0}, "stop");
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
}

}  // namespace
}  // namespace cia402::drive
