// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Settings that must differ from each other, and those that are compared with what was written.
#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::HasSubstr;
using test::testConfig;
using test::testProfile;

DriveProfile withTerminals() {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("one", 0x2003, DataType::uint16));
  profile.objects.push_back(test::object("two", 0x2004, DataType::uint16));
  profile.objects.push_back(test::object("three", 0x2005, DataType::uint16));
  SettingCheck check;
  check.objects = {"one", "two", "three"};
  check.each_once = true;
  check.condition.numbers = {0, 9};
  check.text = "which no two may be";
  check.remedy = "give one of them another";
  profile.checks = {check};
  return profile;
}

TEST(EachOnce, RefusesANumberThatStandsTwiceUnlessItMay) {
  struct Numbers {
    std::uint64_t one, two, three;
    const char* told;
  };
  for (const Numbers& row :
       {Numbers{1, 2, 3, nullptr}, Numbers{0, 0, 0, nullptr}, Numbers{9, 5, 9, nullptr},
        Numbers{4, 0, 4, "one (2003:00) and three (2005:00) are both 4, which no two may be"},
        Numbers{9, 7, 7, "two (2004:00) and three (2005:00) are both 7, which no two may be"}}) {
    Bench bench(testConfig(withTerminals()));
    bench.drive.dictionary[{0x2003, 0}] = {row.one, 2};
    bench.drive.dictionary[{0x2004, 0}] = {row.two, 2};
    bench.drive.dictionary[{0x2005, 0}] = {row.three, 2};
    ASSERT_TRUE(bench.boot());
    const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
    EXPECT_EQ(status.success, row.told == nullptr) << status.message;
    if (row.told != nullptr) {
      EXPECT_THAT(status.message, HasSubstr(row.told));
      EXPECT_THAT(status.message, HasSubstr("; give one of them another"));
    }
  }
}

DriveProfile readingBack() {
  DriveProfile profile = testProfile();
  profile.objects.push_back(test::object("most", 0x2006, DataType::int16));
  profile.objects.push_back(test::object("unwritten", 0x2007, DataType::uint16));
  profile.may_be_cut = {"most", "unwritten"};
  NamedWrite write;
  write.object = "most";
  write.raw = -300;
  profile.startup = {write};
  return profile;
}

TEST(ReadBack, TellsOnceWhatTheDriveHoldsOtherwiseAndRefusesNothing) {
  Bench bench(testConfig(readingBack()));
  bench.drive.dictionary[{0x2006, 0}] = {0xFF38, 2};  // -200
  ASSERT_TRUE(bench.boot());
  const auto before = bench.axis.noticeCount();
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.noticeCount(), before + 1);
  EXPECT_THAT(bench.axis.notice(), HasSubstr("most (2006:00) is -200 instead of the -300 that was "
                                             "written at the boot"));
  EXPECT_EQ((bench.drive.reads[{0x2007, 0}]), 0) << "nobody writes it";
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.noticeCount(), before + 1);
}

TEST(ReadBack, ComparesWithWhatTheAxisWritesLast) {
  AxisConfig config = testConfig(readingBack());
  NamedWrite own;
  own.object = "2006:00";
  own.raw = 500;
  config.writes = {own};
  Bench bench(config);
  bench.drive.dictionary[{0x2006, 0}] = {500, 2};
  ASSERT_TRUE(bench.boot());
  const auto before = bench.axis.noticeCount();
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.noticeCount(), before);
  EXPECT_GT((bench.drive.reads[{0x2006, 0}]), 0);
}

TEST(ReadBack, IsNothingWhereTheDriveDoesNotTellIt) {
  Bench bench(testConfig(readingBack()));
  ASSERT_TRUE(bench.boot());
  const auto before = bench.axis.noticeCount();
  bench.drive.read_aborts[{0x2006, 0}] = 0x06010001;
  EXPECT_TRUE(bench.enable());
  EXPECT_EQ(bench.axis.noticeCount(), before);
}

}  // namespace
}  // namespace cia402::drive
