// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the axis knows, since when, and what it knows no more.
#include <cmath>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

DriveProfile withObject(const ObjectSpec& object) {
  DriveProfile profile = testProfile();
  profile.objects.push_back(object);
  return profile;
}

DriveProfile withInputs() {
  return withObject(test::object("digital_inputs", 0x60FD, DataType::uint32));
}

DriveProfile withFollowingError() {
  return withObject(test::object("following_error", 0x60F4, DataType::int32, Quantity::distance));
}

AxisConfig startingIn(const std::string& mode) {
  AxisConfig config = testConfig();
  config.mode = mode;
  return config;
}

TEST(AxisFeedback, OfALostNodeNothingIsKnown) {
  AxisConfig config = testConfig(withInputs());
  config.mode = "profile_position";
  Bench bench(config);
  bench.drive.dictionary[{0x60FD, 0}] = {0x00030001, 4};
  bench.drive.warning = bench.drive.at_limit = true;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.run(milliseconds(400));
  const AxisState& state = bench.axis.state();
  ASSERT_TRUE(state.warning && state.internal_limit && state.target_reached);
  ASSERT_TRUE(state.digital_inputs_valid);
  const auto nothing = [&] {
    EXPECT_FALSE(state.feedback_valid);
    EXPECT_TRUE(std::isnan(state.position));
    EXPECT_TRUE(std::isnan(state.velocity));
    EXPECT_TRUE(std::isnan(state.effort));
    EXPECT_TRUE(std::isnan(state.following_error));
    EXPECT_EQ(state.state, State::unknown);
    EXPECT_EQ(state.statusword, 0);
    EXPECT_EQ(state.error_code, 0);
    EXPECT_EQ(state.mode, nullptr);
    EXPECT_EQ(state.mode_value, 0);
    EXPECT_FALSE(state.target_reached || state.warning || state.internal_limit);
    EXPECT_EQ(state.digital_inputs, 0u);
    EXPECT_FALSE(state.digital_inputs_valid);
    EXPECT_FALSE(state.ready_for_motion);
  };
  bench.reboot();
  EXPECT_NE(state.health, fieldbus::Health::ready);
  EXPECT_EQ(state.health, bench.device().health());
  nothing();
  bench.drive.dead = true;
  bench.run(milliseconds(40));
  nothing();
}

TEST(AxisFeedback, ALostNodeIsToldOnceAndLeavesNoSetPoint) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.reboot();
  EXPECT_TRUE(std::isnan(bench.axis.target()));
  EXPECT_TRUE(bench.axis.setPoint().atRest());
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
  bench.reboot();  // nobody has asked for anything since
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.noticeCount(), 1u);
}

TEST(AxisFeedback, EachValueSaysWhenItWasOnTheWire) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(20));
  const Time last = bench.now;
  EXPECT_EQ(bench.axis.state().stamp, last);
  EXPECT_EQ(bench.axis.state().stamps.velocity, last);
  EXPECT_EQ(bench.axis.state().stamps.effort, last);
  EXPECT_EQ(bench.axis.state().stamps.mode, last);
  bench.drive.silent = true;
  bench.run(milliseconds(20));
  EXPECT_EQ(bench.axis.state().stamp, last);
  EXPECT_EQ(bench.axis.state().stamps.velocity, last);
  EXPECT_EQ(bench.axis.state().stamps.effort, last);
  EXPECT_EQ(bench.axis.state().stamps.mode, last);
}

TEST(AxisFeedback, IsHeardLatelyUntilACycleAndTwoMoreHavePassedInSilence) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(3 * Bench::kCycle);
  EXPECT_TRUE(bench.axis.heardLately(bench.now));
  bench.run(Bench::kCycle);
  EXPECT_FALSE(bench.axis.heardLately(bench.now));
}

TEST(AxisFeedback, ThatComesOnChangeOnlyIsAsNewAsItCanBe) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].every_cycle = false;
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot());
  bench.drive.silent = true;
  bench.run(milliseconds(400));
  EXPECT_TRUE(bench.axis.heardLately(bench.now));
}

TEST(AxisFeedback, SaysHowItsNodeIsWhileThatBoots) {
  Bench bench;
  EXPECT_EQ(bench.axis.state().health, fieldbus::Health::absent);
  bool booting = false;
  bench.each_cycle = [&] {
    booting = booting || bench.axis.state().health == fieldbus::Health::booting;
    EXPECT_EQ(bench.axis.state().health, bench.device().health());
  };
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(booting);
}

TEST(AxisFeedback, AnEmergencyIsForgottenWithItsNode) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.emergency(0x4210);
  bench.run(milliseconds(20));
  ASSERT_EQ(bench.axis.state().error_code, 0x4210);
  bench.reboot();
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
  EXPECT_EQ(bench.axis.state().error_code, 0);
}

TEST(AxisFeedback, DigitalInputsThatNoTpdoBringsAreReadAndGetOld) {
  Bench bench(testConfig(withInputs()));
  bench.drive.dictionary[{0x60FD, 0}] = {0x00030001, 4};
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(400));
  const AxisState& state = bench.axis.state();
  EXPECT_TRUE(state.digital_inputs_valid);
  EXPECT_EQ(state.digital_inputs, 0x00030001u);
  EXPECT_GT(state.stamps.digital_inputs, bench.now - milliseconds(100));
  EXPECT_LE(state.stamps.digital_inputs, bench.now);
  bench.drive.mute = true;
  bench.run(milliseconds(1200));
  EXPECT_FALSE(state.digital_inputs_valid);
  EXPECT_EQ(state.digital_inputs, 0u);
}

TEST(AxisFeedback, WhatWasReadFromANodeIsForgottenWithIt) {
  Bench bench(testConfig(withInputs()));
  bench.drive.dictionary[{0x60FD, 0}] = {0x00030001, 4};
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(400));
  ASSERT_TRUE(bench.axis.state().digital_inputs_valid);
  bench.reboot();
  bench.drive.dictionary.erase({0x60FD, 0});  // is not told again
  ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
  EXPECT_FALSE(bench.axis.state().digital_inputs_valid);
}

TEST(AxisFeedback, DigitalInputsOfATpdoAreUnknownUntilItComes) {
  test::Layout layout = test::testLayout();
  layout.inputs.push_back(test::thirdInput({0x60FD, 0}, 32));
  Bench bench(testConfig(withInputs()), layout);
  ASSERT_TRUE(bench.boot());
  EXPECT_FALSE(bench.axis.state().digital_inputs_valid);
  bench.bring({0x60FD, 0}, 4);
  const Time brought = bench.now;
  bench.cycle();
  EXPECT_TRUE(bench.axis.state().digital_inputs_valid);
  EXPECT_EQ(bench.axis.state().digital_inputs, 4u);
  EXPECT_EQ(bench.axis.state().stamps.digital_inputs, brought);
}

TEST(AxisFeedback, TheFollowingErrorOfPositionModesIsTheSetPointLessThePosition) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(std::isnan(bench.axis.state().following_error)) << "nothing is commanded";
  ASSERT_TRUE(bench.enable());
  EXPECT_NEAR(bench.axis.state().following_error, 0.0, 1e-9);
  const AxisState& state = bench.axis.state();
  double largest = 0.0;
  bench.each_cycle = [&] {  // target() is what was sent last
    EXPECT_NEAR(state.following_error, bench.axis.target() - state.position, 1e-9);
    EXPECT_EQ(state.stamps.following_error, state.stamp);
    largest = std::max(largest, state.following_error);
    EXPECT_TRUE(bench.axis.setTarget(1.25));
  };
  bench.drive.silent = true;  // what was measured last counts
  bench.run(milliseconds(20));
  EXPECT_NEAR(largest, 1.25 - 1.2345, 1e-6);
  bench.each_cycle = nullptr;
  bench.drive.silent = false;
  ASSERT_TRUE(bench.perform(ProcedureKind::disable).success);
  bench.cycle();
  EXPECT_TRUE(std::isnan(state.following_error));
}

TEST(AxisFeedback, AVelocityHasNoFollowingError) {
  Bench bench(startingIn("cyclic_velocity"));
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.follow(0.5);
  bench.run(milliseconds(40));
  EXPECT_TRUE(std::isnan(bench.axis.state().following_error));
}

TEST(AxisFeedback, AFollowingErrorThatNoTpdoBringsIsReadForALook) {
  Bench bench(testConfig(withFollowingError()));
  bench.drive.dictionary[{0x60F4, 0}] = {100, 4};
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(400));
  EXPECT_TRUE(std::isnan(bench.axis.state().following_error));
  bench.axis.look();
  const Time looked = bench.now;
  bench.run(milliseconds(200));
  EXPECT_NEAR(bench.axis.state().following_error, 0.01, 1e-9);
  EXPECT_GE(bench.axis.state().stamps.following_error, looked);
  EXPECT_LE(bench.axis.state().stamps.following_error, looked + milliseconds(100));
}

TEST(AxisFeedback, AFollowingErrorOfATpdoIsNotReadForALook) {
  test::Layout layout = test::testLayout();
  layout.inputs.push_back(test::thirdInput({0x60F4, 0}, 32));
  Bench bench(testConfig(withFollowingError()), layout);
  bench.drive.dictionary[{0x60F4, 0}] = {100, 4};
  ASSERT_TRUE(bench.boot());
  bench.axis.look();
  bench.run(milliseconds(200));
  EXPECT_TRUE(std::isnan(bench.axis.state().following_error));
  bench.bring({0x60F4, 0}, 200);
  bench.cycle();
  EXPECT_NEAR(bench.axis.state().following_error, 0.02, 1e-9);
}

TEST(AxisFeedback, APositionThatEndsTakesTheFeedbackAlong) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects = {{{0x6041, 0}, 16}};
  layout.inputs.push_back(test::thirdInput({0x6064, 0}, 32));
  Bench bench(testConfig(), layout);
  bench.each_cycle = [&] { bench.bring({0x6064, 0}, 1000); };
  ASSERT_TRUE(bench.boot());
  bench.each_cycle = nullptr;
  bench.run(milliseconds(150));
  EXPECT_EQ(bench.axis.state().state, State::switch_on_disabled);
  EXPECT_FALSE(bench.axis.state().feedback_valid);
  EXPECT_TRUE(std::isnan(bench.axis.state().position));
  EXPECT_TRUE(std::isnan(bench.axis.state().velocity));
}

TEST(AxisFeedback, AModeThatIsShownNoMoreIsUnknown) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects.pop_back();
  layout.inputs.push_back(test::thirdInput({0x6061, 0}, 8));
  Bench bench(testConfig(), layout);
  bench.each_cycle = [&] { bench.bring({0x6061, 0}, 8); };
  ASSERT_TRUE(bench.boot() && bench.enable());
  ASSERT_TRUE(bench.axis.state().ready_for_motion);
  bench.each_cycle = nullptr;
  bench.run(milliseconds(150));
  EXPECT_TRUE(bench.axis.state().feedback_valid);
  EXPECT_EQ(bench.axis.state().mode, nullptr);
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
  EXPECT_THAT(bench.axis.motionRefusal(), HasSubstr("6061:00 shows mode unknown instead of 8"));
}

TEST(AxisFeedback, NoModeIsShownAsZero) {
  Bench bench;
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.silent = true;
  bench.bring({{{0x6041, 0}, 0x0237}, {{0x6064, 0}, 12345}, {{0x6061, 0}, 0}});
  bench.cycle();
  EXPECT_EQ(bench.axis.state().mode_value, 0);
  EXPECT_EQ(bench.axis.state().mode, nullptr);
  EXPECT_FALSE(bench.axis.state().ready_for_motion);
}

TEST(AxisFeedback, ADriveThatCannotShowItsModeIsBelieved) {
  DriveProfile profile = testProfile();
  profile.objects.erase(profile.objects.begin() + 3);  // mode_display
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects.pop_back();
  Bench bench(testConfig(profile), layout);
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
  EXPECT_EQ(bench.axis.state().stamps.mode, bench.axis.state().stamp);
  EXPECT_TRUE(bench.axis.state().ready_for_motion);
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_velocity");
}

TEST(AxisFeedback, AModeThatASwitchHasReadIsKnownAtOnce) {
  test::Layout layout = test::testLayout();
  layout.inputs[0].objects.pop_back();  // 6061h
  layout.inputs.pop_back();             // and much else that is read in turn
  Bench bench(testConfig(), layout);
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.run(milliseconds(200));
  for (const char* mode : {"pp", "csp", "pp", "csp", "pp", "csp"}) {
    const Time asked = bench.now;
    ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, mode).success);
    EXPECT_LE(bench.now - asked, milliseconds(80)) << mode;
  }
}

TEST(AxisFeedback, OfTwoModesWithOneValueTheCommandedOneIsActive) {
  DriveProfile profile = testProfile();
  profile.modes.push_back(
      test::modeSpec("smooth_position", 8, ControlKind::position, true, "target_position"));
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot() && bench.enable());
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "smooth_position").success);
  EXPECT_EQ(bench.axis.state().mode->name, "smooth_position");
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csp").success);
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_position");
}

TEST(AxisStandstill, IsNotKnownBeforeThereIsFeedback) {
  Bench bench;
  EXPECT_TRUE(bench.axis.mayMove());
  ASSERT_TRUE(bench.boot());
  EXPECT_TRUE(bench.axis.mayMove()) << "a window is not full yet";
  bench.run(milliseconds(120));
  EXPECT_FALSE(bench.axis.mayMove());
}

TEST(AxisStandstill, OfAnAxisWithoutPowerOutlastsItsFeedback) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(120));
  bench.drive.silent = true;
  bench.run(milliseconds(100));
  ASSERT_FALSE(bench.axis.state().feedback_valid);
  EXPECT_FALSE(bench.axis.mayMove());
  bench.drive.silent = false;
  bench.run(milliseconds(12));
  ASSERT_TRUE(bench.axis.state().feedback_valid);
  EXPECT_TRUE(bench.axis.mayMove()) << "it has to be seen anew";
  bench.run(milliseconds(120));
  EXPECT_FALSE(bench.axis.mayMove());
}

TEST(AxisStandstill, OfAnAxisThatMovesOrHasPowerEndsWithItsFeedback) {
  for (const bool enabled : {false, true}) {
    SCOPED_TRACE(enabled ? "enabled, at rest" : "disabled, pushed by hand");
    Bench bench;
    ASSERT_TRUE(bench.boot());
    if (enabled) {
      ASSERT_TRUE(bench.enable());
    } else {
      bench.drive.coast = 5000;
    }
    bench.run(milliseconds(120));
    bench.drive.silent = true;
    bench.run(milliseconds(100));
    ASSERT_FALSE(bench.axis.state().feedback_valid);
    EXPECT_TRUE(bench.axis.mayMove());
  }
}

}  // namespace
}  // namespace cia402::drive
