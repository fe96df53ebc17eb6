// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Modes of the generic simulated drive. 131072 counts per turn; ramps 10 turns/s^2 by default.
#include <fstream>
#include <limits>

#include "drive_fixture.h"

namespace cia402::sim {
namespace {

constexpr int kTurn = 131072;

struct Bench : DriveBench {
  explicit Bench(const AxisMechanics& mechanics = {}) : DriveBench("generic_cia402", mechanics) {}
  int bits(int mask) { return static_cast<int>(read(0x6041)) & mask; }
  void mode(int number) { write(0x6060, 0, static_cast<std::uint32_t>(number), 1); }
  void target(std::int32_t counts) { write(0x607A, 0, static_cast<std::uint32_t>(counts), 4); }
  std::int32_t demand() { return static_cast<std::int32_t>(read(0x6062)); }
  std::int32_t followingError() { return static_cast<std::int32_t>(read(0x60F4)); }
  // One cycle of a master: RPDO3 (controlword 0x000F, target), SYNC, 4 ms.
  void cycle(std::int32_t counts) {
    const auto raw = static_cast<std::uint32_t>(counts);
    frame(0x401, {0x0F, 0x00, low(raw), high(raw), low(raw >> 16), high(raw >> 16)});
    sync();
    run(ms(4));
  }
};

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

TEST(DriveCyclicPosition, FollowsTheStreamWithTheLagOfItsLoop) {
  Bench b;
  b.nmt(0x01);
  b.mode(8);
  b.enable();
  std::int32_t counts = 0;
  for (int i = 0; i < 250; ++i) b.cycle(counts += 500);  // 125000 counts/s
  b.frame(0x401, {0x0F, 0x00, 0x48, 0xEA, 0x01, 0x00});  // 125512
  b.sync();
  EXPECT_NEAR(b.velocity(), 125000, 40);  // each SDO takes 1 of the 4 ms
  EXPECT_NEAR(b.followingError(), 500, 5);
  counts = 125512;
  EXPECT_EQ(b.bits(0x3000), 0x1000);
  b.run(ms(100));  // the stream ends: it stands at the last set-point
  EXPECT_EQ(b.position(), counts);
}

TEST(DriveCyclicPosition, RunsOnWhereItsNumbersWrap) {
  for (const int direction : {1, -1}) {
    AxisMechanics mechanics;
    mechanics.initial_position = direction * 16383.98;  // turns; 131072 counts * 16384 = 2^31
    Bench b(mechanics);
    b.nmt(0x01);
    b.mode(8);
    std::uint32_t counts = b.read(0x6064);
    b.target(static_cast<std::int32_t>(counts));
    b.enable();
    const double start = b.drive->truth(b.now).position_turns;
    for (int i = 0; i < 20; ++i) {
      counts += static_cast<std::uint32_t>(direction * 500);
      b.cycle(static_cast<std::int32_t>(counts));
    }
    b.run(ms(100));
    EXPECT_EQ(b.state(), 0x27);
    EXPECT_EQ(b.read(0x6064), counts);
    EXPECT_EQ((counts >> 31) == 1, direction > 0) << "the sign has changed";
    EXPECT_NEAR(b.drive->truth(b.now).position_turns - start, direction * 10000.0 / kTurn,
                1.0 / kTurn);
  }
}

TEST(DriveCyclicPosition, WithoutWrappingATargetBeyondTheWrapIsAWholeRangeAway) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "generic_cia402.yaml")
      << std::ifstream(cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml")
             .rdbuf();
  std::ofstream(folder + "counting.yaml")
      << "extends: generic_cia402\nname: counting\npositions_wrap: false\n";
  AxisMechanics mechanics;
  mechanics.initial_position = 16383.999;
  DriveBench b(loadDriveDefinition(folder + "counting.yaml"), mechanics);
  b.nmt(0x01);
  b.write(0x6060, 0, 8, 1);
  b.write(0x607A, 0, b.read(0x6064), 4);
  b.enable();
  for (int i = 0; i < 20; ++i) {
    b.frame(0x401, {0x0F, 0x00, 0x00, 0x00, 0x00, 0x80});  // one count beyond the largest
    b.sync();
    b.run(ms(4));
  }
  EXPECT_EQ(b.read(0x603F), 0x8611U);
  EXPECT_LT(b.drive->truth(b.now).velocity_turns, -1.0) << "it ran backwards";
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

TEST(DriveCyclicPosition, TheWidestSoftwareLimitsAreNone) {
  AxisMechanics mechanics;
  mechanics.initial_position = 16383.9;
  Bench b(mechanics);
  b.write(0x607D, 1, 0x80000000, 4);
  b.write(0x607D, 2, 0x7FFFFFFF, 4);
  b.mode(3);
  b.write(0x60FF, 0, kTurn, 4);
  b.enable();
  b.run(ms(1000));
  EXPECT_GT(b.drive->truth(b.now).position_turns, 16384.5);
  EXPECT_EQ(b.bits(0x0800), 0);
}

TEST(DriveCyclicPosition, ASetPointBetweenTwoSyncsWaitsForTheNext) {
  Bench b;
  b.nmt(0x01);
  b.mode(8);
  b.enable();
  for (int i = 0; i < 5; ++i) b.cycle(0);
  b.frame(0x401, {0x0F, 0x00, 0xF4, 0x01, 0x00, 0x00});  // 500
  b.run(ms(4));
  EXPECT_EQ(b.demand(), 0);
  b.sync();
  b.run(ms(5));
  EXPECT_EQ(b.demand(), 500);
}

TEST(DriveCyclicPosition, EnablingFarFromTheTargetJumpsIntoAFollowingError) {
  Bench b;
  b.nmt(0x01);
  b.mode(8);
  b.target(100 * kTurn);
  b.enable();
  for (int i = 0; i < 10; ++i) b.cycle(100 * kTurn);
  b.run(ms(300));
  EXPECT_EQ(b.state(), 0x08);
  EXPECT_EQ(b.read(0x603F), 0x8611U);
  EXPECT_EQ(b.emergencies().back(), std::make_pair(0x8611, 0x21));
}

TEST(DriveCyclicPosition, InterpolationTimeShorterThanTheCycleJerks) {
  Bench b;
  b.write(0x60C2, 1, 1, 1);  // 1 ms for set-points that come every 4 ms
  b.nmt(0x01);
  b.mode(8);
  b.enable();
  std::int32_t counts = 0;
  for (int i = 0; i < 50; ++i) b.cycle(counts += 500);
  EXPECT_EQ(b.demand(), counts);  // reached long before the next one comes
  EXPECT_EQ(b.read(0x606B), 0U);
}

TEST(DriveCyclicPosition, IgnoresSetPointsUntilTheBrakeIsOpen) {
  AxisMechanics mechanics;
  mechanics.brake_delay = 0.2;
  Bench b(mechanics);
  b.nmt(0x01);
  b.mode(8);
  b.enable();
  std::int32_t counts = 0;
  for (int i = 0; i < 40; ++i) b.cycle(counts += 100);
  EXPECT_EQ(b.position(), 0);
  EXPECT_EQ(b.bits(0x1000), 0);
  for (int i = 0; i < 40; ++i) b.cycle(counts += 100);
  EXPECT_NEAR(b.position(), counts, 200);
  EXPECT_EQ(b.bits(0x1000), 0x1000);
}

TEST(DriveCyclicPosition, FollowingErrorSetsBitThirteenInTheStatusword) {
  Bench b;
  b.write(0x6065, 0, 100, 4);
  b.write(0x6066, 0, 0, 2);
  b.nmt(0x01);
  b.mode(8);
  b.enable();
  std::int32_t counts = 0;
  for (int i = 0; i < 20; ++i) b.cycle(counts += 500);
  EXPECT_EQ(b.read(0x603F), 0x8611U);
  b.write(0x6065, 0, 0xFFFFFFFF, 4);  // supervision off
  b.control(0x0080);
  b.control(0x0006);
  b.control(0x0007);
  for (int i = 0; i < 50; ++i) b.cycle(counts += 500);
  EXPECT_EQ(b.state(), 0x27);
}

TEST(DriveCyclicPosition, StopsAtALimitSwitch) {
  AxisMechanics mechanics;
  mechanics.negative_limit_switch = -0.1;
  Bench b(mechanics);
  b.nmt(0x01);
  b.mode(8);
  b.enable();
  std::int32_t counts = 0;
  for (int i = 0; i < 60; ++i) b.cycle(counts -= 500);
  EXPECT_EQ(b.state(), 0x27);
  EXPECT_NEAR(b.position(), -kTurn / 10, 2000);
  EXPECT_EQ(b.bits(0x0800), 0x0800);
  EXPECT_EQ(b.read(0x60FD) & 7U, 1U);
  for (int i = 0; i < 100; ++i) b.cycle(counts += 500);
  EXPECT_GT(b.position(), 0);
}

TEST(DriveCyclicVelocity, FollowsWithoutARamp) {
  Bench b;
  b.mode(9);
  b.enable();
  b.write(0x60FF, 0, kTurn, 4);
  b.run(ms(20));
  EXPECT_NEAR(b.velocity(), kTurn, 20);
  EXPECT_EQ(b.bits(0x1000), 0x1000);
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

}  // namespace
}  // namespace cia402::sim
