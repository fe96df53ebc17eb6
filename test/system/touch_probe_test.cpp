// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// arm_touch_probe of whole robots: what it tells is where the motor truly was.
#include "system/families_scene.h"
#include "system/touch_probe_scene.h"

namespace cia402 {
namespace {

using bus::ArmTouchProbeCommand;
using bus::TouchProbeAnswer;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr double kTwoPi = 6.283185307179586;
constexpr double kCount = kTwoPi / 131072 / 100;  // of genericPair(), rad

TEST(TouchProbe, TellsWhereTheJointWasAtTheEdge) {
  ReadyScene scene(genericPair(", direction: -1, position_offset: 0.25"));
  ASSERT_EQ(scene.setpoint("left", 1.5), "");
  scene.run(500ms);
  Waiting waiting(scene, probeOf("left"));
  EXPECT_FALSE(waiting.answered());
  ASSERT_GT(std::abs(scene.velocity("left")), 0.5) << "it moves";
  const double at = touch(scene, "left", true);
  const double step = std::abs(scene.velocity("left")) * 0.0005;  // of the simulated drive
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_NEAR(answer.rising, at, kCount + step);
  EXPECT_TRUE(std::isnan(answer.falling));
  EXPECT_GT(std::abs(scene.position("left") - at), 10 * (kCount + step)) << "it has gone on";
  EXPECT_THAT(answer.message, HasSubstr("left (node 1): touch probe 1: rising edge at "));
  EXPECT_EQ(objectOf(scene, "left", 0x60B8), 0U) << "it is disarmed";
}

TEST(TouchProbe, CountsFromTheZeroThatWasDeclared) {
  ReadyScene scene(genericPair());
  ASSERT_TRUE(declare(scene, "left", 1.25).success);
  Waiting waiting(scene, probeOf("left"));
  touch(scene, "left", true);
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_NEAR(answer.rising, 1.25, 2 * kCount);
}

TEST(TouchProbe, WaitsForBothEdgesWhereBothAreWanted) {
  ReadyScene scene(genericPair());
  ASSERT_EQ(scene.setpoint("left", 1.5), "");
  scene.run(500ms);
  Waiting waiting(scene, probeOf("left", "both", 5.0, 2));
  const double rising = touch(scene, "left", true, 2);
  scene.run(100ms);
  EXPECT_FALSE(waiting.answered());
  const double falling = touch(scene, "left", false, 2);
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_NEAR(answer.rising, rising, 0.001);
  EXPECT_NEAR(answer.falling, falling, 0.001);
  EXPECT_GT(falling - rising, 0.05);
}

TEST(TouchProbe, StoresTheIndexPulse) {
  ReadyScene scene(genericPair(", simulation: {index_offset: 0.25}"));
  ArmTouchProbeCommand command = probeOf("left");
  command.index_pulse = true;
  Waiting waiting(scene, command);
  ASSERT_EQ(scene.setpoint("left", 0.2), "");
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  const double turns = answer.rising / kTwoPi * 100.0;  // of the motor
  EXPECT_NEAR(turns - std::floor(turns), 0.25, 1.0 / 131072);
}

TEST(TouchProbe, OfAnAxisThatStandsWithoutPowerMovesNothing) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.forget();
  Waiting waiting(scene, probeOf("left"));
  touch(scene, "left", true);
  EXPECT_TRUE(waiting.await().success);
  expectNothingMoved(scene, "left");
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

// What was stored before it was armed is of no interest: a drive by the book forgets it when it is
// disarmed, others when they are armed, or never, but those count.
TEST(TouchProbe, TakesNoEdgeOfBefore) {
  for (const char* forgets : {"disarmed", "armed", "never"}) {
    ReadyScene scene(genericPair(
        ", simulation: {with: {touch_probe: {forgets: " + std::string(forgets) + "}}}"));
    Waiting first(scene, probeOf("left"));
    touch(scene, "left", true);
    ASSERT_TRUE(first.await().success) << forgets;
    touch(scene, "left", false);
    ASSERT_EQ(scene.setpoint("left", 0.5), "");
    scene.run(3s);
    Waiting waiting(scene, probeOf("left"));
    scene.run(1s);
    EXPECT_FALSE(waiting.answered()) << forgets;
    const double at = touch(scene, "left", true);
    const TouchProbeAnswer answer = waiting.await();
    ASSERT_TRUE(answer.success) << forgets << ": " << answer.message;
    EXPECT_NEAR(answer.rising, at, 2 * kCount) << forgets;
  }
}

// Somebody has armed it and has had his edge: armed still, it would store no other one.
TEST(TouchProbe, IsDisarmedBeforeItIsArmed) {
  ReadyScene scene(genericPair());
  ASSERT_TRUE(
      scene.call(bus::WriteObjectCommand{"left", "touch_probe_function", "0x0011"}).success);
  touch(scene, "left", true);
  touch(scene, "left", false);
  ASSERT_EQ(scene.setpoint("left", 0.5), "");
  scene.run(2s);
  Waiting waiting(scene, probeOf("left"));
  EXPECT_FALSE(waiting.answered());
  const double at = touch(scene, "left", true);
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_NEAR(answer.rising, at, 2 * kCount);
}

// Probe 1 is left storing, by a call that did not wait for it here.
TEST(TouchProbe, LeavesTheOtherProbeAlone) {
  ReadyScene scene(genericPair());
  ASSERT_TRUE(
      scene.call(bus::WriteObjectCommand{"left", "touch_probe_function", "0x0013"}).success);
  Waiting waiting(scene, probeOf("left", "falling", 5.0, 2));
  EXPECT_EQ(objectOf(scene, "left", 0x60B8), 0x2113U);
  touch(scene, "left", true, 2);
  touch(scene, "left", false, 2);
  EXPECT_TRUE(waiting.await().success);
  EXPECT_EQ(objectOf(scene, "left", 0x60B8), 0x0013U);
}

TEST(TouchProbe, CanBeWaitedForTogetherWithTheOther) {
  ReadyScene scene(genericPair());
  Waiting one(scene, probeOf("left")), two(scene, probeOf("left", "rising", 5.0, 2));
  const TouchProbeAnswer again = scene.call(probeOf("left"));
  EXPECT_FALSE(again.success);
  EXPECT_THAT(again.message, HasSubstr("left (node 1): touch probe 1 not armed: another call has "
                                       "armed it and still waits"));
  touch(scene, "left", true, 2);
  EXPECT_TRUE(two.await().success);
  EXPECT_FALSE(one.answered());
  touch(scene, "left", true, 1);
  EXPECT_TRUE(one.await().success);
}

TEST(TouchProbe, GoesOnStoringWhereItIsContinuous) {
  ReadyScene scene(genericPair());
  ArmTouchProbeCommand command = probeOf("left");
  command.continuous = true;
  Waiting waiting(scene, command);
  touch(scene, "left", true);
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("it stays armed"));
  EXPECT_EQ(objectOf(scene, "left", 0x60B8), 0x0013U) << "as the manual of the SV660C [L1888]";
  touch(scene, "left", false);
  touch(scene, "left", true);
  EXPECT_EQ(objectOf(scene, "left", 0x60D5), 2U);
}

TEST(TouchProbe, IsDisarmedAtItsDeadline) {
  ReadyScene scene(genericPair());
  const Time before = scene.now();
  const TouchProbeAnswer answer = scene.call(probeOf("left", "both", 0.5));
  EXPECT_FALSE(answer.success);
  EXPECT_NEAR(toSeconds(scene.now() - before), 0.5, 0.05);
  EXPECT_THAT(answer.message, HasSubstr("left (node 1): touch probe 1: no rising or falling edge "
                                        "within 0.5 s (status 60B9:00 is 0x0001)"));
  EXPECT_TRUE(std::isnan(answer.rising) && std::isnan(answer.falling));
  EXPECT_EQ(objectOf(scene, "left", 0x60B8), 0U);
}

TEST(TouchProbe, TellsTheEdgeThatCameWhereTheOtherDidNot) {
  ReadyScene scene(genericPair());
  Waiting waiting(scene, probeOf("left", "both", 0.5));
  const double at = touch(scene, "left", true);
  const TouchProbeAnswer answer = waiting.await();
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("no falling edge within 0.5 s"));
  EXPECT_NEAR(answer.rising, at, 2 * kCount);
  EXPECT_TRUE(std::isnan(answer.falling));
}

TEST(TouchProbe, TellsOfADriveThatStartsAnewMeanwhile) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  Waiting waiting(scene, probeOf("left", "rising", 20.0));
  ASSERT_TRUE(scene.call(bus::NmtServiceCommand{"left", "reset_node"}).success);
  const TouchProbeAnswer answer = waiting.await();
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message,
            "left (node 1): touch probe 1: the drive has started anew, and has forgotten it");
  EXPECT_TRUE(std::isnan(answer.rising));
}

TEST(TouchProbe, TellsOfADriveThatIsLostMeanwhile) {
  ReadyScene scene(genericPair());
  Waiting waiting(scene, probeOf("left", "rising", 20.0));
  scene.inject("left", "silent");
  const TouchProbeAnswer answer = waiting.await();
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, AllOf(HasSubstr("60B9:00 touch_probe_status not read"),
                                    HasSubstr("it may still be armed")));
}

TEST(TouchProbe, TellsNoPositionOfAnotherZero) {
  ReadyScene scene(genericPair());
  Waiting waiting(scene, probeOf("left"));
  ASSERT_TRUE(declare(scene, "left", 1.0).success);
  const TouchProbeAnswer answer = waiting.await();
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("the axis has got another zero meanwhile"));
  EXPECT_EQ(objectOf(scene, "left", 0x60B8), 0U);
}

TEST(TouchProbe, IsLeftArmedAtTheEndOfTheProgram) {
  ReadyScene scene(genericPair());
  Waiting waiting(scene, probeOf("left"));
  scene.robot().network().beginShutdown(scene.now());
  scene.run(10ms);
  ASSERT_TRUE(waiting.answered());
  EXPECT_FALSE(waiting.await().success);
  EXPECT_EQ(waiting.await().message,
            "left (node 1): touch probe 1: ended by the shutdown of the driver; it is left armed");
}

TEST(TouchProbe, IsRefusedInWordsWhereItCannotBe) {
  ReadyScene scene(genericPair());
  const auto refused = [&](const ArmTouchProbeCommand& command) {
    const TouchProbeAnswer answer = scene.call(command);
    EXPECT_FALSE(answer.success);
    return answer.message;
  };
  EXPECT_THAT(refused(probeOf("left", "rising", 1.0, 3)),
              HasSubstr("left (node 1): touch probe 3 not armed: there are touch probes 1 and 2"));
  EXPECT_THAT(refused(probeOf("left", "rising", 1.0, 0)), HasSubstr("not 0"));
  EXPECT_THAT(refused(probeOf("left", "up")),
              HasSubstr("the edge is rising, falling or both, not \"up\""));
  for (const double timeout : {0.0, -1.0, 600.1, std::nan("")}) {
    EXPECT_THAT(refused(probeOf("left", "rising", timeout)),
                HasSubstr("the timeout must be more than 0 and at most 600 s"));
  }
  EXPECT_EQ(refused(probeOf("wrist")), "there is no axis \"wrist\"");
}

TEST(TouchProbe, OfADriveWithoutItIsRefusedInWords) {
  Scene minimal(loadText(genericPair(", simulation: {drive: generic_cia402_minimal}")));
  ASSERT_TRUE(minimal.boot()) << minimal.told();
  const TouchProbeAnswer aborted = minimal.call(probeOf("left"));
  EXPECT_FALSE(aborted.success);
  EXPECT_THAT(aborted.message,
              AllOf(HasSubstr("60B8:00 touch_probe_function not read"), HasSubstr("0x06020000")));
  Scene stepper(loadText(familyJoint({"nimotion_stepper", "10000", "profile_position"})));
  ASSERT_TRUE(stepper.boot()) << stepper.told();
  EXPECT_EQ(stepper.call(probeOf("joint")).message,
            "joint (node 1): touch probe 1 not armed: profile nimotion_stepper names no touch "
            "probes (`touch_probe`)");
}

TEST(TouchProbe, WorksByEachProfileThatHasIt) {
  for (const auto& [family, counts] :
       {std::pair("sv660c", "100000"), std::pair("megmeet_dm5", "8388608")}) {
    Scene scene(loadText(familyJoint({family, counts, "profile_position"})));
    ASSERT_TRUE(scene.boot()) << family << scene.told();
    Waiting waiting(scene, probeOf("joint", "falling", 5.0, 2));
    touch(scene, "joint", true, 2);
    const double at = touch(scene, "joint", false, 2);
    const TouchProbeAnswer answer = waiting.await();
    ASSERT_TRUE(answer.success) << family << ": " << answer.message;
    EXPECT_NEAR(answer.falling, at, 2 * kTwoPi / std::stod(counts) / 50.0) << family;
  }
}

// 2^24 counts * 128 = 2^31 counts a turn: 6064h and 60BAh wrap at +-6.283 rad.
TEST(TouchProbe, OfAJointThatTurnsWithoutEndTellsThePlaceNearIt) {
  ReadyScene scene(
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
      "axes:\n"
      "  table: {node_id: 1, drive: generic_cia402, type: continuous,\n"
      "    counts_per_turn: 16777216, gear_ratio: 128.0, mode: cyclic_position,\n"
      "    write: [{object: following_error_window, value: 0.1}],\n"
      "    limits: {velocity: 1.5, acceleration: 3.0, jerk: 30.0},\n"
      "    simulation: {initial_position: 6.0}}\n");
  ASSERT_EQ(scene.setpoint("table", 6.5), "");
  scene.run(3s);
  Waiting waiting(scene, probeOf("table"));
  const double at = touch(scene, "table", true);
  ASSERT_NEAR(at, 6.5, 1e-3) << scene.told();
  const TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_NEAR(answer.rising, at, 1e-6);
}

}  // namespace
}  // namespace cia402
