// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_reporter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct AxisReporterTest : testing::Test, EventSink {
  void onEvent(const Event& event) override {
    texts.push_back(event.text.str());
    severities.push_back(event.severity);
    stamps.push_back(event.stamp);
  }
  void onEmergency(const EmergencyEvent& event) override { emergencies.push_back(event); }
  void emergency(std::uint16_t code, std::array<std::uint8_t, 5> vendor = {}) {
    fieldbus::Emergency given;
    given.code = code;
    given.error_register = 0x11;
    given.vendor = vendor;
    given.stamp = now;
    reporter.emergency(given, now);
  }
  std::vector<std::string> texts;
  std::vector<Event::Severity> severities;
  std::vector<Time> stamps;
  std::vector<EmergencyEvent> emergencies;
  Time now{10s};
  AxisReporter reporter{1, "elbow (node 2)", test::testProfile(), *this};
};

TEST_F(AxisReporterTest, PutsAnEmergencyIntoWordsWithItsManufacturerBytes) {
  emergency(0x8611, {0x12, 0, 0, 0, 0xA0});
  EXPECT_THAT(texts, ElementsAre("elbow (node 2): emergency: 0x8611 following error: blocked; "
                                 "check the mechanics; error register: generic, communication; "
                                 "manufacturer bytes: 12 00 00 00 A0"));
  EXPECT_EQ(severities[0], Event::Severity::warning);
  ASSERT_EQ(emergencies.size(), 1u);
  EXPECT_EQ(emergencies[0].axis, 1u);
  EXPECT_EQ(emergencies[0].emergency.code, 0x8611);
}

TEST_F(AxisReporterTest, SaysWhereThisProgramItselfIsTheCause) {
  fieldbus::Emergency given;
  given.code = 0x8611;
  reporter.emergency(given, now, "this program was late");
  EXPECT_THAT(texts, ElementsAre("elbow (node 2): emergency: 0x8611 following error: the cause is "
                                 "that this program was late; nothing is wrong with the drive, the "
                                 "axis goes on unless it says otherwise"));
}

TEST_F(AxisReporterTest, LeavesManufacturerBytesOutThatSayNothing) {
  emergency(0x8611);
  EXPECT_THAT(texts.at(0), Not(HasSubstr("manufacturer")));
}

TEST_F(AxisReporterTest, TellsAnErrorResetAsGoodNews) {
  emergency(0x0000);
  EXPECT_THAT(texts.at(0), HasSubstr("emergency: error reset or no error"));
  EXPECT_EQ(severities[0], Event::Severity::info);
}

TEST_F(AxisReporterTest, SumsUpAStormAndHandsEveryEmergencyOn) {
  for (int i = 0; i < 5000; ++i) {
    emergency(0x8201);
    now += 1ms;
    reporter.tick(now);
  }
  ASSERT_EQ(texts.size(), 4u);
  EXPECT_THAT(texts[2], HasSubstr("further ones are summed up every 5 s"));
  EXPECT_EQ(texts[3],
            "elbow (node 2): emergency 0x8201 protocol error: came 4,997 times in the last 5.0 s, "
            "5,000 times since start");
  EXPECT_EQ(emergencies.size(), 5000u);
  EXPECT_EQ(reporter.emergencies().total, 5000u);
}

TEST_F(AxisReporterTest, CountsEveryCodeForItself) {
  for (int i = 0; i < 7; ++i) emergency(0x8611);
  for (int i = 0; i < 5; ++i) emergency(0x0000);
  const EmergencyCounts& counts = reporter.emergencies();
  ASSERT_EQ(counts.codes, 2u);
  EXPECT_EQ(counts.of[0].code, 0x8611);
  EXPECT_EQ(counts.of[0].count, 7u);
  EXPECT_EQ(counts.of[1].code, 0x0000);
  EXPECT_EQ(counts.of[1].count, 5u);
  EXPECT_EQ(counts.total, 12u);
}

TEST_F(AxisReporterTest, KnowsWhenEachCodeCameLast) {
  emergency(0x8611);
  now += 1s;
  emergency(0x0000);
  now += 1s;
  emergency(0x8611);
  EXPECT_EQ(reporter.emergencies().of[0].last, Time(12s));
  EXPECT_EQ(reporter.emergencies().of[1].last, Time(11s));
}

TEST_F(AxisReporterTest, StampsWhatItTellsWithTheTimeInWhichItIsTold) {
  emergency(0x8611);
  now += 1s;
  reporter.problem(Event::Severity::error, 0x7305, "elbow (node 2): fault", now);
  now += 1s;
  reporter.bootUp(now);
  EXPECT_THAT(stamps, ElementsAre(Time(10s), Time(11s), Time(12s)));
}

// CiA 301: FFxxh are codes of the manufacturer.
TEST_F(AxisReporterTest, SumsUpTheHighestCodeAsACode) {
  for (int i = 0; i < 10; ++i) emergency(0xFFFF);
  reporter.flush(now);
  EXPECT_THAT(texts.back(), HasSubstr("elbow (node 2): emergency 0xFFFF "));
}

TEST_F(AxisReporterTest, CountsMoreCodesThanItHasRoomForInTheTotal) {
  for (std::uint16_t code = 1; code <= 40; ++code) emergency(code);
  EXPECT_EQ(reporter.emergencies().codes, RepeatLimiter::kKinds);
  EXPECT_EQ(reporter.emergencies().total, 40u);
  texts.clear();
  reporter.flush(now);
  EXPECT_THAT(texts, ElementsAre(HasSubstr("emergency of yet other codes: came 24 times")));
}

TEST_F(AxisReporterTest, TellsHowManyWereHeldBackAtTheEnd) {
  for (int i = 0; i < 1237; ++i) emergency(0x0000);
  texts.clear();
  reporter.flush(now + 1s);
  EXPECT_THAT(texts, ElementsAre(HasSubstr(
                         "emergency 0x0000 error reset or no error: came 1,234 times in the "
                         "last 1.0 s, 1,237 times since start")));
}

TEST_F(AxisReporterTest, TellsAShortFrame) {
  fieldbus::Emergency given;
  given.code = 0x8611;
  given.size = 3;
  reporter.emergency(given, now);
  EXPECT_THAT(texts.at(0), HasSubstr("the frame has 3 bytes instead of 8"));
  reporter.malformedEmergency(1, now);
  EXPECT_THAT(texts.at(1), HasSubstr("an emergency frame of 1 byte has no error code"));
  EXPECT_EQ(reporter.emergencies().malformed, 1u);
  EXPECT_EQ(reporter.emergencies().total, 1u);
}

TEST_F(AxisReporterTest, LimitsFaultsThatComeAndGoButTellsEachNewCode) {
  for (int i = 0; i < 100; ++i) {
    reporter.problem(Event::Severity::error, 0x8611, "elbow (node 2): fault", now);
  }
  EXPECT_EQ(texts.size(), 3u);
  reporter.problem(Event::Severity::error, 0x7305, "elbow (node 2): another fault", now);
  EXPECT_EQ(texts.back(), "elbow (node 2): another fault");
  reporter.flush(now);
  EXPECT_THAT(texts.back(), HasSubstr("problem 0x8611 following error: came 97 times"));
}

TEST_F(AxisReporterTest, LimitsBootUps) {
  for (int i = 0; i < 10; ++i) reporter.bootUp(now);
  EXPECT_EQ(texts.size(), 3u);
  EXPECT_THAT(texts[0], HasSubstr("elbow (node 2): boots up again and again before"));
  reporter.tick(now + 5s);
  EXPECT_THAT(texts.back(), HasSubstr("boot-up message: came 7 times"));
}

TEST(GroupedDigits, AreReadable) {
  EXPECT_EQ(groupedDigits(0), "0");
  EXPECT_EQ(groupedDigits(999), "999");
  EXPECT_EQ(groupedDigits(1000), "1,000");
  EXPECT_EQ(groupedDigits(1234567), "1,234,567");
}

}  // namespace
}  // namespace cia402::bus
