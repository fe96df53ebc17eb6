// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Standstill, condition, homing status, fault texts and numbers in sentences.
#include "drive/sentence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "drive/axis/axis.h"
#include "drive/axis/standstill.h"
#include "drive/procedures/homing_status.h"
#include "drive/profile/fault_text.h"

namespace cia402::drive {
namespace {

using std::chrono::milliseconds;

TEST(Standstill, NeedsAFullWindowAtRest) {
  Standstill standstill(0.01, 1e-4);
  Time now{};
  standstill.update(1.0, now);
  standstill.update(1.0, now + milliseconds(49));
  EXPECT_FALSE(standstill.still());
  EXPECT_FALSE(standstill.moving());
  standstill.update(1.0, now + milliseconds(50));
  EXPECT_TRUE(standstill.still());
}

TEST(Standstill, NoticesMotionFasterThanTheThreshold) {
  Standstill standstill(0.01, 0.0);
  Time now{};
  double position = 0;
  for (int i = 0; i < 100; ++i) standstill.update(0.0, now += milliseconds(4));
  ASSERT_TRUE(standstill.still());
  for (int i = 0; i < 100; ++i) {
    standstill.update(position += 0.02 * 0.004, now += milliseconds(4));
  }
  EXPECT_FALSE(standstill.still());
  EXPECT_TRUE(standstill.moving());
}

TEST(Standstill, BelievesAnEncoderThatTogglesByOneUnit) {
  Standstill standstill(0.01, 0.01);  // one unit is far more than the threshold in a window
  Time now{};
  for (int i = 0; i < 100; ++i) standstill.update(i % 2 == 0 ? 0.0 : 0.01, now += milliseconds(4));
  EXPECT_TRUE(standstill.still());
}

TEST(AxisCondition, DiffersByEachThingThatItHolds) {
  using Change = void (*)(AxisCondition&);
  static constexpr Change kChanges[] = {
      [](AxisCondition& c) { c.state = State::fault; },
      [](AxisCondition& c) { c.health = fieldbus::Health::lost; },
      [](AxisCondition& c) { c.statusword = 0x8000; },
      [](AxisCondition& c) { c.error_code = 0x8000; },
      [](AxisCondition& c) { c.mode_value = -1; },
      [](AxisCondition& c) { c.feedback_valid = true; },
      [](AxisCondition& c) { c.homed = true; },
      [](AxisCondition& c) { c.target_reached = true; },
      [](AxisCondition& c) { c.warning = true; },
      [](AxisCondition& c) { c.internal_limit = true; },
      [](AxisCondition& c) { c.halted = true; },
      [](AxisCondition& c) { c.ready_for_motion = true; },
      [](AxisCondition& c) { c.digital_inputs_valid = true; },
  };
  for (const Change change : kChanges) {
    AxisCondition condition;
    EXPECT_TRUE(condition == AxisCondition());
    change(condition);
    EXPECT_TRUE(condition != AxisCondition()) << &change - &kChanges[0];
  }
}

TEST(HomingStatus, DecodesTheTableOfTheStandard) {
  ModeSpec mode;
  mode.target_reached_bit = 10;
  EXPECT_EQ(decodeHoming(0x0237, mode, true), HomingStatus::in_progress);
  EXPECT_EQ(decodeHoming(0x0637, mode, true), HomingStatus::interrupted);
  EXPECT_EQ(decodeHoming(0x1237, mode, true), HomingStatus::attained_moving);
  EXPECT_EQ(decodeHoming(0x1637, mode, true), HomingStatus::completed);
  EXPECT_EQ(decodeHoming(0x2237, mode, true), HomingStatus::error_moving);
  EXPECT_EQ(decodeHoming(0x2637, mode, true), HomingStatus::error_stopped);
  EXPECT_EQ(decodeHoming(0x3237, mode, true), HomingStatus::contradictory);
  EXPECT_EQ(decodeHoming(0x3637, mode, true), HomingStatus::contradictory);
}

TEST(HomingStatus, HasWords) {
  EXPECT_STREQ(toString(HomingStatus::in_progress), "homing in progress");
  EXPECT_STREQ(toString(HomingStatus::interrupted), "homing interrupted or not started");
  EXPECT_STREQ(toString(HomingStatus::attained_moving), "home found, still moving");
  EXPECT_STREQ(toString(HomingStatus::completed), "homing completed");
  EXPECT_STREQ(toString(HomingStatus::error_moving), "homing error, still moving");
  EXPECT_STREQ(toString(HomingStatus::error_stopped), "homing error, stopped");
  EXPECT_THAT(toString(HomingStatus::contradictory), ::testing::HasSubstr("attained and error"));
}

TEST(HomingStatus, UsesTheBitsOfTheProfile) {
  ModeSpec mode;
  mode.homing_attained_bit = 15;
  mode.homing_error_bit = 14;
  EXPECT_EQ(decodeHoming(0x8237, mode, true), HomingStatus::completed);
  EXPECT_EQ(decodeHoming(0x4237, mode, true), HomingStatus::error_stopped);
}

TEST(FaultText, KnowsTheFamiliesCodes) {
  DriveProfile profile;
  profile.errors[0x7305] = {"encoder", "no signal", "check the plug"};
  profile.errors[0x7306] = {"encoder battery", "", "replace it"};
  EXPECT_EQ(errorCodeText(profile, 0x7305), "0x7305 encoder: no signal; check the plug");
  EXPECT_EQ(errorCodeText(profile, 0x7306), "0x7306 encoder battery: replace it");
}

TEST(FaultText, FallsBackToTheClassesOfTheStandard) {
  EXPECT_EQ(errorCodeText(DriveProfile(), 0x8611).substr(0, 22), "0x8611 following error");
}

TEST(FaultText, NamesAnErrorByTheProfileElseByTheStandard) {
  DriveProfile profile;
  profile.errors[0x7305] = {"encoder", "no signal", "check the plug"};
  EXPECT_EQ(errorName(profile, 0x7305), "encoder");
  EXPECT_EQ(errorName(profile, 0x8611), "following error");
}

TEST(Sentence, LengthsHaveTheUnitOfTheJoint) {
  EXPECT_EQ(length(-3.05, false), "-3.050 rad");
  EXPECT_EQ(length(0.12, true), "0.120 m");
  EXPECT_EQ(number(-3.05), "-3.050");
  EXPECT_EQ(seconds(milliseconds(350)), "0.35 s");
  EXPECT_EQ(seconds(std::chrono::seconds(2)), "2 s");
  EXPECT_EQ(seconds(std::chrono::seconds(999)), "999 s");
  EXPECT_EQ(seconds(milliseconds(999600)), "1000 s");
  EXPECT_EQ(seconds(std::chrono::seconds(3600)), "3600 s");
}

}  // namespace
}  // namespace cia402::drive
