// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The simulated DM5: what its manual says beside CiA 402.
#include "drive_fixture.h"

namespace cia402::sim {
namespace {

struct Dm5Bench : DriveBench {
  Dm5Bench() : DriveBench("megmeet_dm5", AxisMechanics()) {
    run(ms(1500));
    write(0x6072, 0, 1000, 2);
    write(0x60E0, 0, 1000, 2);
    write(0x60E1, 0, 1000, 2);
    write(0x607F, 0, 0x7FFFFFFF, 4);
    write(0x6080, 0, 3000, 4);
    write(0x6083, 0, 0x10000000, 4);
    write(0x6084, 0, 0x10000000, 4);
    write(0x6060, 0, 3, 1);
  }
};

// Er.073 beyond 100 rpm [L3781].
TEST(DriveDm5, IsNotEnabledWhileItsMotorTurnsFasterThan100Rpm) {
  Dm5Bench b;
  b.enable();
  b.run(ms(600));
  b.write(0x60FF, 0, 10 * 8388608, 4);  // 600 rpm
  b.run(ms(800));
  ASSERT_GT(b.drive->truth(b.now).velocity_turns, 9.0);
  b.control(0x0000);  // disable voltage: it coasts
  b.write(0x60FF, 0, 0, 4);
  b.control(0x0006);
  b.control(0x0007);
  ASSERT_GT(b.drive->truth(b.now).velocity_turns, 100.0 / 60.0);
  b.control(0x000F);
  EXPECT_FALSE(b.drive->truth(b.now).power_stage_on);
  EXPECT_EQ(b.read(0x603F) & 0xFFFFU, 0xFF49U);
  b.run(ms(60000));
  ASSERT_LT(b.drive->truth(b.now).velocity_turns, 100.0 / 60.0);
  b.control(0x0000);
  b.control(0x0080);
  b.control(0x0000);
  b.enable();
  EXPECT_TRUE(b.drive->truth(b.now).power_stage_on);
}

// "Same in every mode" [L1940-1950]; whether what it reads back changes its sign is not printed.
TEST(DriveDm5, TurnsTheSignOfTargetsByThePolarity) {
  const auto speedBy = [](std::uint32_t mode, std::uint32_t polarity) {
    Dm5Bench b;
    b.write(0x607E, 0, polarity, 1);
    b.write(0x6060, 0, mode, 1);
    b.write(0x6081, 0, 8388608, 4);
    b.write(0x60FF, 0, 8388608, 4);
    b.write(0x6071, 0, mode == 4 ? 500 : 0, 2);
    b.write(0x607A, 0, 10 * 8388608, 4);
    b.enable();
    b.run(ms(600));
    if (mode == 1) b.control(0x001F);
    b.run(ms(1000));
    return b.drive->truth(b.now).velocity_turns;
  };
  struct Case {
    std::uint32_t mode, bit;
  };
  for (const Case& tested : {Case{1, 0x80}, Case{3, 0x40}, Case{4, 0x20}}) {
    EXPECT_GT(speedBy(tested.mode, 0), 0.5) << tested.mode;
    EXPECT_LT(speedBy(tested.mode, tested.bit), -0.5) << tested.mode;
    EXPECT_GT(speedBy(tested.mode, 0xE0 & ~tested.bit), 0.5) << tested.mode << ": others' bits";
  }
}

/// Bits 0 to 6 of the statusword but 4.
unsigned stateOf(Dm5Bench& b) { return b.status() & 0x6FU; }

// The table of commands [L1709-1718], each word by itself.
TEST(DriveDm5, GoesUpAndDownAsTheTableOfTransitionsSays) {
  Dm5Bench b;
  EXPECT_EQ(stateOf(b), 0x40U);  // 1
  b.control(0x0006);
  EXPECT_EQ(stateOf(b), 0x21U);  // 2
  b.control(0x0007);
  EXPECT_EQ(stateOf(b), 0x23U);  // 3
  b.control(0x000F);
  EXPECT_EQ(stateOf(b), 0x27U);  // 4
  b.control(0x0007);
  b.run(ms(2));
  EXPECT_EQ(stateOf(b), 0x23U);  // 5
  b.control(0x0006);
  EXPECT_EQ(stateOf(b), 0x21U);  // 6
  for (const std::uint16_t word : {std::uint16_t{0x0000}, std::uint16_t{0x0002}}) {
    b.control(0x0006);
    b.control(word);
    EXPECT_EQ(stateOf(b), 0x40U) << word;  // 7
  }
  b.enable();
  b.control(0x0006);
  b.run(ms(2));
  EXPECT_EQ(stateOf(b), 0x21U);  // 8
  b.control(0x000F);
  EXPECT_EQ(stateOf(b), 0x27U) << "3 and 4 in one word";
  b.control(0x0000);
  EXPECT_EQ(stateOf(b), 0x40U);  // 9
  for (const std::uint16_t word : {std::uint16_t{0x0000}, std::uint16_t{0x0002}}) {
    b.control(0x0006);
    b.control(0x0007);
    b.control(word);
    EXPECT_EQ(stateOf(b), 0x40U) << word;  // 10
  }
  b.write(0x605A, 0, 6, 2);
  b.enable();
  b.control(0x0002);
  EXPECT_EQ(stateOf(b), 0x07U);  // 11
  b.control(0x000F);
  EXPECT_EQ(stateOf(b), 0x27U);  // 16
  b.control(0x0002);
  b.control(0x0000);
  EXPECT_EQ(stateOf(b), 0x40U);  // 12
  ASSERT_TRUE(b.drive->inject("overvoltage", b.now).ok());
  EXPECT_EQ(stateOf(b) & 0x4FU, 0x08U);  // 13, 14
  b.run(ms(200));
  b.control(0x0080);
  EXPECT_EQ(stateOf(b), 0x40U);  // 15
}

// Er.066: homing while something else still moves the motor [L3780].
TEST(DriveDm5, BeginsNoSearchForHomeInMotion) {
  for (const bool moves : {true, false}) {
    Dm5Bench b;
    b.write(0x2003, 1, 36, 2);
    b.write(0x6098, 0, 17, 1);
    b.enable();
    b.run(ms(600));
    if (moves) b.write(0x60FF, 0, 8388608, 4);  // a turn a second
    b.run(ms(300));
    b.write(0x6060, 0, 6, 1);
    b.control(0x001F);
    b.run(ms(50));
    EXPECT_EQ(stateOf(b) & 0x4FU, moves ? 0x08U : 0x07U);
    EXPECT_EQ(b.read(0x603F) & 0xFFFFU, moves ? 0xFF42U : 0U);
    EXPECT_EQ(b.drive->truth(b.now).power_stage_on, !moves);
  }
}

// Er.053: 1.2 times what the motor can turn in a SYNC period, 0.4 turns in 5 ms.
TEST(DriveDm5, FollowsNoStepThatItsMotorCannot) {
  Dm5Bench b;
  b.write(0x6060, 0, 8, 1);
  b.nmt(0x01);
  b.enable();
  double turns = 0.0;
  const auto goOn = [&](double step) {
    turns += step;
    b.write(0x607A, 0, static_cast<std::uint32_t>(turns * 8388608.0), 4);
    b.sync();
    b.run(ms(4));
  };
  for (int i = 0; i < 100; ++i) goOn(0.0);
  for (int i = 0; i < 20; ++i) goOn(0.01);
  goOn(0.38);
  for (int i = 0; i < 50; ++i) goOn(0.0);
  ASSERT_EQ(stateOf(b), 0x27U) << std::hex << b.read(0x603F);
  EXPECT_NEAR(b.drive->truth(b.now).position_turns, 0.58, 1e-3);
  goOn(0.42);
  EXPECT_EQ(b.read(0x603F) & 0xFFFFU, 0xFF35U);
  EXPECT_FALSE(b.drive->truth(b.now).power_stage_on);
  EXPECT_NEAR(b.drive->truth(b.now).position_turns, 0.58, 1e-3);
}

}  // namespace
}  // namespace cia402::sim
