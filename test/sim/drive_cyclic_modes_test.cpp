// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Modes of the generic simulated drive that follow a stream of set-points.
#include <fstream>

#include "generic_bench.h"

namespace cia402::sim {
namespace {

using Bench = GenericBench;

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

TEST(DriveInterpolatedPosition, FollowsWhileBitFourIsSetAndSaysSo) {
  Bench b;
  b.nmt(0x01);
  b.mode(7);
  b.enable();
  EXPECT_EQ(b.bits(0x1000), 0);
  const auto cycle = [&](std::uint16_t controlword, std::uint32_t counts) {
    b.write(0x60C1, 1, counts, 4);
    b.control(controlword);
    b.sync();
    b.run(ms(2));  // each of the two SDOs takes 1 of the 4 ms
  };
  std::uint32_t counts = 0;
  for (int i = 0; i < 50; ++i) cycle(0x000F, counts += 500);
  EXPECT_EQ(b.position(), 0);
  counts = 0;
  for (int i = 0; i < 100; ++i) cycle(0x001F, counts += 500);
  EXPECT_EQ(b.bits(0x1000), 0x1000);
  EXPECT_NEAR(b.velocity(), 125000, 1300);
  cycle(0x000F, counts + 500);  // interrupted: it ramps to rest by 6084h
  EXPECT_EQ(b.bits(0x1000), 0);
  for (int i = 0; i < 50; ++i) cycle(0x000F, counts += 500);
  EXPECT_EQ(b.velocity(), 0);
  EXPECT_LT(b.position(), static_cast<std::int32_t>(counts) - 10000);
}

TEST(DriveInterpolatedPosition, ReachesItsTargetWhereTheStreamRests) {
  Bench b;
  b.nmt(0x01);
  b.mode(7);
  b.enable();
  b.control(0x001F);
  b.write(0x60C1, 1, 1000, 4);
  for (int i = 0; i < 50; ++i) {
    b.sync();
    b.run(ms(4));
    if (i == 0) {
      EXPECT_EQ(b.bits(0x0400), 0);
    }
  }
  EXPECT_EQ(b.position(), 1000);
  EXPECT_EQ(b.bits(0x0400), 0x0400);
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

}  // namespace
}  // namespace cia402::sim
