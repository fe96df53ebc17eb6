// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Modes of the generic simulated drive that plan by themselves, and what all modes share.
#include <algorithm>
#include <iterator>
#include <limits>

#include "generic_bench.h"

namespace cia402::sim {
namespace {

using Bench = GenericBench;

TEST(DriveProfilePosition, MovesATrapezoidAndLagsByTheTimeConstant) {
  Bench b;
  b.mode(1);
  b.target(kTurn);
  b.enable();
  const Time start = b.now;
  b.control(0x001F);
  b.run(start + ms(551) - b.now);  // 1.1 s in all: half way (one SDO answer later)
  EXPECT_NEAR(b.demand(), kTurn / 2, 300);
  EXPECT_NEAR(b.followingError(), 524, 2);  // 1 turn/s * 4 ms
  EXPECT_EQ(b.bits(0x0400), 0);
  b.run(start + ms(1080) - b.now);
  EXPECT_LT(b.demand(), kTurn - 10);
  b.run(start + ms(1110) - b.now);
  EXPECT_EQ(b.demand(), kTurn);
  b.run(ms(100));
  EXPECT_EQ(b.position(), kTurn);
  EXPECT_EQ(b.bits(0x0400), 0x0400);
}

TEST(DriveProfilePosition, AcknowledgesASetPointByBitTwelveUntilBitFourFalls) {
  Bench b;
  b.mode(1);
  b.target(kTurn);
  b.enable();
  EXPECT_EQ(b.bits(0x1000), 0);
  b.control(0x001F);
  EXPECT_EQ(b.bits(0x1000), 0x1000);
  b.control(0x000F);
  EXPECT_EQ(b.bits(0x1000), 0);
}

TEST(DriveProfilePosition, NeedsTheEdgeOfBitFourWhileEnabled) {
  Bench b;
  b.mode(1);
  b.target(kTurn);
  b.control(0x0006);
  b.control(0x0007);
  b.control(0x001F);  // the edge comes with the enabling
  b.run(ms(500));
  EXPECT_EQ(b.position(), 0);
  b.target(2 * kTurn);  // a new target alone does nothing
  b.run(ms(500));
  EXPECT_EQ(b.position(), 0);
}

TEST(DriveProfilePosition, BuffersOneSetPointAndRefusesAThird) {
  Bench b;
  b.mode(1);
  b.enable();
  b.target(kTurn / 2);
  b.control(0x001F);
  b.control(0x000F);
  b.target(kTurn);
  b.control(0x001F);
  b.control(0x000F);
  EXPECT_EQ(b.bits(0x1000), 0x1000);  // buffer full: still acknowledged
  b.target(5 * kTurn);
  b.control(0x001F);  // refused
  b.control(0x000F);
  b.run(ms(620));  // 0.5 turns: 0.5 + 0.1 s
  EXPECT_EQ(b.bits(0x1000), 0);
  EXPECT_EQ(b.bits(0x0400), 0);
  b.run(ms(1000));
  EXPECT_EQ(b.position(), kTurn);
  EXPECT_EQ(b.bits(0x0400), 0x0400);
}

TEST(DriveProfilePosition, ChangesImmediatelyWithBitFiveAndRelativelyWithBitSix) {
  Bench b;
  b.mode(1);
  b.enable();
  b.target(10 * kTurn);
  b.control(0x001F);
  b.control(0x000F);
  b.run(ms(500));
  b.target(-kTurn);
  b.control(0x003F);
  b.control(0x000F);
  b.run(ms(4000));
  EXPECT_EQ(b.position(), -kTurn);
  b.target(kTurn / 4);
  b.control(0x005F);
  b.control(0x000F);
  b.run(ms(1000));
  EXPECT_EQ(b.position(), -kTurn + kTurn / 4);
}

TEST(DriveProfilePosition, HaltWaitsAndGoesOn) {
  Bench b;
  b.mode(1);
  b.enable();
  b.target(kTurn);
  b.control(0x001F);
  b.run(ms(300));
  b.control(0x011F);
  b.run(ms(300));
  const auto waiting = b.position();
  EXPECT_NEAR(waiting, kTurn * 3 / 10, 3000);
  EXPECT_EQ(b.bits(0x0400), 0x0400);
  b.control(0x001F);
  b.run(ms(2000));
  EXPECT_EQ(b.position(), kTurn);
}

TEST(DriveProfilePosition, StopsAtTheSoftwareLimitAndSaysSo) {
  Bench b;
  b.write(0x607D, 1, static_cast<std::uint32_t>(-kTurn), 4);
  b.write(0x607D, 2, kTurn, 4);
  b.mode(1);
  b.enable();
  b.target(3 * kTurn);
  b.control(0x001F);
  b.run(ms(3000));
  EXPECT_EQ(b.position(), kTurn);
}

TEST(DriveProfilePosition, BlockedRotorEndsInARealFollowingError) {
  Bench b;
  b.mode(1);
  b.enable();
  ASSERT_TRUE(b.drive->inject("blocked_rotor", b.now).ok());
  b.target(kTurn);
  b.control(0x001F);
  b.run(ms(400));
  EXPECT_EQ(b.state(), 0x27);
  b.run(ms(300));  // half a turn (6065h) behind for 10 ms (6066h)
  EXPECT_EQ(b.state(), 0x08);
  EXPECT_EQ(b.read(0x603F), 0x8611U);
  EXPECT_EQ(b.position(), 0);
  ASSERT_TRUE(b.drive->inject("clear", b.now).ok());
  b.control(0x0080);
  b.enable();
  b.target(kTurn);
  b.control(0x001F);
  b.run(ms(2000));
  EXPECT_EQ(b.position(), kTurn);
}

TEST(DriveProfileVelocity, RampsReachesAndReportsZeroSpeed) {
  Bench b;
  b.mode(3);
  b.enable();
  b.run(ms(50));
  EXPECT_EQ(b.bits(0x1000), 0x1000);
  b.write(0x60FF, 0, static_cast<std::uint32_t>(-2 * kTurn), 4);
  b.run(ms(100));
  EXPECT_NEAR(b.velocity(), -kTurn, 6000);  // 10 turns/s^2 for 0.1 s
  EXPECT_EQ(b.bits(0x1400), 0);
  b.run(ms(200));
  EXPECT_NEAR(b.velocity(), -2 * kTurn, 5);
  EXPECT_EQ(b.bits(0x1400), 0x0400);
  b.write(0x60FF, 0, 0, 4);
  b.run(ms(300));
  EXPECT_EQ(b.velocity(), 0);
  EXPECT_EQ(b.bits(0x1400), 0x1400);
}

TEST(DriveProfileVelocity, StopsAtALimitSwitchAndLeavesItBackwards) {
  AxisMechanics mechanics;
  mechanics.positive_limit_switch = 0.5;
  Bench b(mechanics);
  b.mode(3);
  b.write(0x60FF, 0, kTurn, 4);
  b.enable();
  b.run(ms(2000));
  EXPECT_EQ(b.velocity(), 0);
  EXPECT_NEAR(b.position(), kTurn / 2, 1500);
  EXPECT_EQ(b.bits(0x0800), 0x0800);
  EXPECT_EQ(b.read(0x60FD) & 7U, 2U);
  EXPECT_EQ(b.state(), 0x27);
  b.write(0x60FF, 0, static_cast<std::uint32_t>(-kTurn), 4);
  b.run(ms(300));
  EXPECT_LT(b.position(), kTurn / 2 - 1000);
  EXPECT_EQ(b.bits(0x0800), 0);
}

TEST(DriveProfilePosition, TakesTheNearestPlaceThatReadsAsItsTarget) {
  AxisMechanics mechanics;
  mechanics.initial_position = 16383.5;
  Bench b(mechanics);
  b.mode(1);
  b.enable();
  b.target(std::numeric_limits<std::int32_t>::min() + kTurn / 2);  // a turn further
  b.control(0x001F);
  b.run(ms(2000));
  EXPECT_NEAR(b.drive->truth(b.now).position_turns, 16384.5, 1e-5);
}

TEST(DriveModes, TheModeCanChangeWhileItTurnsWithoutAJump) {
  Bench b;
  b.mode(3);
  b.write(0x60FF, 0, kTurn, 4);
  b.enable();
  b.run(ms(500));
  b.mode(1);
  EXPECT_EQ(b.read(0x6061) & 0xFFU, 1U);
  b.run(ms(500));
  EXPECT_EQ(b.velocity(), 0);
  EXPECT_EQ(b.state(), 0x27);
}

TEST(DriveModes, TorqueActualPushesWhileItAccelerates) {
  Bench b;
  b.mode(3);
  b.write(0x6083, 0, 100 * kTurn, 4);
  b.write(0x60FF, 0, 50 * kTurn, 4);
  b.enable();
  b.run(ms(200));
  // 100 turns/s^2 of 300 at rated torque, plus 5 % friction.
  EXPECT_NEAR(static_cast<std::int16_t>(b.read(0x6077)), 383, 8);
}

TEST(DriveModes, APositionIsLostWithThePowerOfAnIncrementalEncoder) {
  AxisMechanics mechanics;
  mechanics.initial_position = 2.0;
  Bench b(mechanics);
  EXPECT_EQ(b.position(), 2 * kTurn);
  ASSERT_TRUE(b.drive->inject("power_cycle", b.now).ok());
  b.sent.clear();
  b.frame(0x601, {0x40, 0x64, 0x60, 0x00, 0, 0, 0, 0});
  b.run(ms(450));
  EXPECT_TRUE(b.sent.empty());  // no power, no answer
  b.run(ms(150));
  EXPECT_EQ(b.position(), 0);
  EXPECT_DOUBLE_EQ(b.drive->truth(b.now).position_turns, 2.0);
}

TEST(DriveModes, SilentDriveAnswersNothingUntilCleared) {
  Bench b;
  ASSERT_TRUE(b.drive->inject("silent", b.now).ok());
  b.sent.clear();
  b.frame(0x601, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0});
  b.run(ms(50));
  EXPECT_TRUE(b.sent.empty());
  ASSERT_TRUE(b.drive->inject("clear", b.now).ok());
  EXPECT_EQ(b.state(), 0x40);
}

TEST(DriveModes, ATpdoOfTypeTwoFiftyFiveTellsOfAModeAndOfAShaftThatCoastsWithoutPower) {
  Bench b;
  b.write(0x1800, 1, 0x80000181, 4);
  b.write(0x1800, 2, 255, 1);
  b.write(0x1A00, 0, 0, 1);
  b.write(0x1A00, 1, 0x60610008, 4);  // mode display
  b.write(0x1A00, 2, 0x60640020, 4);  // position actual
  b.write(0x1A00, 0, 2, 1);
  b.write(0x1800, 1, 0x181, 4);
  b.nmt(0x01);
  b.run(ms(10));
  b.sent.clear();
  const auto told = [&] {
    std::vector<can::Frame> frames;
    std::copy_if(b.sent.begin(), b.sent.end(), std::back_inserter(frames),
                 [](const can::Frame& frame) { return frame.id == 0x181; });
    return frames;
  };
  b.mode(3);
  b.run(ms(10));
  ASSERT_EQ(told().size(), 1U);
  EXPECT_EQ(told().back().data[0], 3);
  b.write(0x60FF, 0, 2 * kTurn, 4);
  b.enable();
  b.run(ms(500));
  b.control(0x0000);  // disable voltage: it coasts
  b.run(ms(5));
  b.sent.clear();
  const std::int32_t before = b.position();
  b.run(ms(50));
  ASSERT_NE(b.position(), before);
  EXPECT_GT(told().size(), 10U);
}

}  // namespace
}  // namespace cia402::sim
