// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Parameters that a drive does not have, does not take, or that are copied within it.
#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::HasSubstr;
using test::stepsOf;
using test::testConfig;
using test::testProfile;
using testing::Not;
using Write = std::pair<unsigned, std::uint64_t>;

constexpr std::uint32_t kNoObject = 0x06020000, kReadOnly = 0x06010002, kOutOfRange = 0x06090030;

AxisConfig optionBeforeEnable(bool optional = false) {
  DriveProfile profile = testProfile();
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 2;
  option.optional = optional;
  profile.before_enable = {option};
  return testConfig(profile);
}

AxisConfig homingByMethod17(std::optional<double> offset = std::nullopt) {
  AxisConfig config = testConfig();
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->search_velocity = 0.3;
  config.homing->offset = offset;
  return config;
}

/// before_enable copies one object into another.
AxisConfig copies(DataType type, Encoding encoding, bool optional = false) {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("gain_stored", 0x2001, type));
  profile.objects.push_back(test::object("gain", 0x2002, type));
  profile.objects[profile.objects.size() - 2].encoding = encoding;
  profile.objects.back().encoding = encoding;
  NamedWrite copy = test::from("gain", "gain_stored");
  copy.optional = optional;
  profile.before_enable = {copy};
  return testConfig(profile);
}

TEST(WriteStep, TellsWhichParameterTheDriveIsToTake) {
  Bench bench(optionBeforeEnable());
  ASSERT_TRUE(bench.boot());
  bench.drive.unanswered.insert({0x605A, 0});
  EXPECT_THAT(
      stepsOf(bench, ProcedureKind::enable),
      testing::Contains("writing parameters | the drive to take quick_stop_option (605A:00)"));
}

TEST(WriteStep, WhatOnlyADefaultAsksForIsLeftOutWhereTheDriveDoesNotHaveIt) {
  for (const std::uint32_t code : {kNoObject, kReadOnly}) {
    SCOPED_TRACE(code);
    Bench bench(optionBeforeEnable());
    ASSERT_TRUE(bench.boot());
    bench.drive.aborts[{0x605A, 0}] = code;
    EXPECT_TRUE(bench.enable());
    EXPECT_THAT(bench.axis.notice(),
                HasSubstr("shoulder (node 3): quick_stop_option (605A:00) is left out"));
    EXPECT_THAT(bench.axis.notice(), HasSubstr("`lacks: [quick_stop_option]` of axes/shoulder"));
    EXPECT_EQ(bench.axis.notice(bench.axis.noticeCount()).kind, NoticeKind::warning);
  }
}

TEST(WriteStep, AnOptionalParameterIsLeftOutWithoutAWord) {
  Bench bench(optionBeforeEnable(true));
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x605A, 0}] = kNoObject;
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.notice(), "");
}

TEST(WriteStep, AValueThatTheDriveRefusesIsNoLack) {
  Bench bench(optionBeforeEnable());
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x605A, 0}] = kOutOfRange;
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, Not(HasSubstr("lacks")));
}

TEST(WriteStep, SilenceIsTakenForALackAfterThreeTries) {
  Bench bench(optionBeforeEnable());
  ASSERT_TRUE(bench.boot());
  bench.drive.unanswered.insert({0x605A, 0});
  bench.drive.writes.clear();
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.writes, (std::vector<Write>{{0x605A, 2}, {0x605A, 2}, {0x605A, 2}}));
  EXPECT_THAT(bench.axis.notice(), HasSubstr("quick_stop_option (605A:00) is left out"));
}

TEST(WriteStep, WhatTheConfigurationAsksForIsNotLeftOut) {
  Bench bench(homingByMethod17());
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x6098, 0}] = kNoObject;
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(bench.drive.homings, 0);
  EXPECT_THAT(status.message, HasSubstr("6098:00"));
  EXPECT_THAT(status.message, HasSubstr("`lacks: [homing_method]` of axes/shoulder says that"));
}

TEST(WriteStep, SilenceOnWhatTheConfigurationAsksForIsNoLack) {
  Bench bench(homingByMethod17());
  ASSERT_TRUE(bench.boot());
  bench.drive.unanswered.insert({0x6098, 0});
  bench.drive.writes.clear();
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(bench.drive.writes, (std::vector<Write>{{0x6098, 17}, {0x6098, 17}}))
      << "timing/sdo_retries: 1";
  EXPECT_THAT(status.message, Not(HasSubstr("lacks")));
}

TEST(WriteStep, AHomeOffsetThatTheDriveKeepsIsReadInsteadOfWritten) {
  Bench bench(homingByMethod17());  // no offset: its 0 is a default
  bench.drive.dictionary[{0x607C, 0}] = {500, 4};
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x607C, 0}] = kReadOnly;
  EXPECT_THAT(stepsOf(bench, ProcedureKind::home),
              testing::Contains("reading the home offset | 607C:00 home offset"));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_NEAR(bench.axis.state().position, 0.0, 1e-9) << "what it counts as 500 is home";
}

TEST(WriteStep, AHomeOffsetThatTheDriveIsSaidToLackIsNeitherWrittenNorRead) {
  AxisConfig config = homingByMethod17();
  config.lacks = {"home_offset"};
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  EXPECT_THAT(stepsOf(bench, ProcedureKind::home),
              Not(testing::Contains("reading the home offset | 607C:00 home offset")));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_EQ(bench.drive.writes, (std::vector<Write>{{0x6098, 17}, {0x6099, 3000}}));
  EXPECT_EQ(bench.axis.state().position, 0.0);
}

TEST(WriteStep, WhatDoesNotFitIsNotSent) {
  DriveProfile profile = testProfile();
  NamedWrite offset;
  offset.object = "home_offset";
  offset.value = 214748.3648;  // 0.0001 rad a count: 2^31, one more than an INTEGER32 holds
  profile.before_enable = {offset};
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("home_offset (607C:00): 214748 does not fit"));
  EXPECT_TRUE(bench.drive.writes.empty());
}

TEST(WriteStep, CopiesOneObjectOfTheDriveIntoAnother) {
  Bench bench(copies(DataType::uint32, Encoding::integer));
  bench.drive.dictionary[{0x2001, 0}] = {123456, 4};
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.writes, (std::vector<Write>{{0x2002, 123456}}));
}

TEST(WriteStep, CopiesAFloatThatIsANumber) {
  Bench bench(copies(DataType::real32, Encoding::integer));
  bench.drive.dictionary[{0x2001, 0}] = {0x3FC00000, 4};  // 1.5
  ASSERT_TRUE(bench.boot());
  bench.drive.writes.clear();
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.writes, (std::vector<Write>{{0x2002, 0x3FC00000}}));
}

TEST(WriteStep, CopiesNoFloatThatIsNoFiniteNumberOrNoFloatAtAll) {
  const std::vector<std::pair<std::uint64_t, unsigned>> held = {
      {0x7FC00000, 4},  // NaN
      {0x7F800000, 4},  // infinity
      {0x3FC0, 2}};     // two bytes of the four
  for (const auto& value : held) {
    for (const bool optional : {false, true}) {
      SCOPED_TRACE(testing::Message() << std::hex << value.first << " optional " << optional);
      Bench bench(copies(DataType::real32, Encoding::integer, optional));
      bench.drive.dictionary[{0x2001, 0}] = value;
      ASSERT_TRUE(bench.boot());
      bench.drive.writes.clear();
      const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
      EXPECT_EQ(status.success, optional) << status.message;
      EXPECT_TRUE(bench.drive.writes.empty());
      if (!optional) {
        EXPECT_THAT(status.message, HasSubstr("what was to be copied into gain (2002:00) is no "
                                              "finite number; look at it with read_object"));
      }
    }
  }
}

// As an axis without PDOs may have it of its own first controlword.
TEST(WriteStep, WhatMadeWayForAnUrgentWriteIsWrittenOnceMore) {
  Bench bench(optionBeforeEnable());
  ASSERT_TRUE(bench.boot());
  bench.drive.unanswered.insert({0x605A, 0});
  ASSERT_TRUE(bench.axis.start({ProcedureKind::enable, {}, 0.0}, bench.now).ok());
  ASSERT_TRUE(bench.runUntil(
      [&] { return !bench.drive.writes.empty() && bench.drive.writes.back().first == 0x605A; }));
  bench.drive.unanswered.clear();
  bench.drive.writes.clear();
  bench.device().objects().downloadUrgent({0x2099, 0}, {0, 0}, "stop");
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_EQ(bench.drive.writes, (std::vector<Write>{{0x2099, 0}, {0x605A, 2}}));
}

}  // namespace
}  // namespace cia402::drive
