// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the simulated SV660C tells of itself in 200Bh and 200Eh, and its terminals. Lnnn: lines of
// the manual's text.
#include <tuple>

#include "sv660c_bench.h"

namespace cia402::sim {
namespace {

using Sv660cMonitor = Sv660cBench;

// H0b.00 in rpm, H0b.55 in 0.1 rpm, H0b.07 in user units, H0b.17 in encoder counts [L8295-8891].
TEST_F(Sv660cMonitor, ShowsHowTheMotorTurns) {
  bench.write(0x6091, 1, 4194304, 4);  // encoder counts a user unit: two of them are a turn
  bench.write(0x607F, 0, 20, 4);
  mode(3);
  enable();
  bench.write(0x60FF, 0, static_cast<std::uint32_t>(-4), 4);  // -2 turns/s
  bench.run(ms(2000));
  const auto signedNumber = [this](std::uint8_t sub) {
    return static_cast<std::int32_t>(bench.read(0x200B, sub));
  };
  EXPECT_EQ(static_cast<std::int16_t>(bench.read(0x200B, 0x01)), -120);
  EXPECT_EQ(signedNumber(0x38), -1200);
  // Friction: 3 % and what goes with the speed, which the simulated motor has only without power.
  EXPECT_EQ(static_cast<std::int16_t>(bench.read(0x200B, 0x03)), -30);
  EXPECT_EQ(bench.read(0x200B, 0x0D) & 0xFFFF, 30U);
  EXPECT_EQ(bench.read(0x200B, 0x19) & 0xFFFF, 1U) << "3 % of 4.7 A, in 0.1 A";
  bench.write(0x60FF, 0, 0, 4);
  bench.run(ms(1000));
  EXPECT_EQ(signedNumber(0x08), bench.position());
  EXPECT_EQ(signedNumber(0x12), static_cast<std::int32_t>(bench.read(0x6063)));
}

// H0b.01 in rpm, H0b.13 and H0b.64 in user units, H0b.15 in encoder counts [L8309-8975].
TEST_F(Sv660cMonitor, ShowsWhatIsCommanded) {
  bench.write(0x6091, 1, 4194304, 4);  // encoder counts a user unit: two of them are a turn
  bench.write(0x607F, 0, 20, 4);
  mode(3);
  enable();
  bench.write(0x6083, 0, 4, 4);  // 2 turns/s2
  bench.write(0x60FF, 0, static_cast<std::uint32_t>(-4), 4);
  bench.run(ms(500));
  EXPECT_NEAR(static_cast<std::int16_t>(bench.read(0x200B, 0x02)), -60, 3) << "half way";
  bench.run(ms(1500));
  EXPECT_EQ(static_cast<std::int16_t>(bench.read(0x200B, 0x02)), -120);
  const std::uint32_t before = bench.read(0x200B, 0x0E);
  bench.run(ms(3000));
  const std::uint32_t passed = bench.read(0x200B, 0x0E) - before;
  EXPECT_NEAR(static_cast<std::int32_t>(passed), -12, 1) << "3 s with 4 user units a second";
  EXPECT_EQ(bench.read(0x200B, 0x41), bench.read(0x200B, 0x0E));
}

// H0b.15 in encoder counts, H0b.53 in user units, two encoder counts each here [L8439, L8871].
TEST_F(Sv660cMonitor, ShowsByHowMuchTheMotorIsBehind) {
  bench.write(0x6091, 1, 2, 4);
  bench.write(0x6081, 0, 83886080, 4);
  bench.write(0x6083, 0, 4194304, 4);  // a turn/s2
  mode(1);
  enable();
  bench.write(0x607A, 0, 41943040, 4);
  control(0x0F);
  control(0x1F);
  bench.run(ms(1000));
  const auto units = static_cast<std::int32_t>(bench.read(0x200B, 0x36));
  EXPECT_GT(units, 100) << "while it accelerates evenly";
  EXPECT_NEAR(static_cast<std::int32_t>(bench.read(0x200B, 0x10)), 2 * units, 0.01 * units)
      << "read some ms apart";
  bench.run(ms(20000));
  EXPECT_NEAR(static_cast<std::int32_t>(bench.read(0x200B, 0x10)), 0, 2) << "at its target";
}

// 0.1 degrees of one of H00.17 pairs of poles, 5 from the factory [L2105, L8397-8415].
TEST_F(Sv660cMonitor, ShowsTheElectricalAngle) {
  bench.write(0x607F, 0, 838860800, 4);
  mode(3);
  enable();
  bench.write(0x60FF, 0, 838861, 4);  // a tenth of a turn in a second
  const auto degrees = [this] { return (bench.read(0x200B, 0x0B) & 0xFFFF) * 0.1; };
  double last = degrees(), passed = 0.0;
  const double from = bench.drive->truth(bench.now).position_turns;
  for (int i = 0; i < 100; ++i) {
    bench.run(ms(100));
    const double now = degrees();
    EXPECT_LT(now, 360.0);
    passed += now - last + (now < last - 180.0 ? 360.0 : 0.0);
    last = now;
  }
  const double turned = bench.drive->truth(bench.now).position_turns - from;
  EXPECT_GT(turned, 0.8);
  EXPECT_NEAR(passed, turned * 5 * 360.0, 1.0);
}

// H0b.03: 1 where the input conducts; H0b.05 [L8335-8362].
TEST_F(Sv660cMonitor, ShowsTheLevelsOfItsTerminals) {
  EXPECT_EQ(bench.read(0x200B, 0x04) & 0xFFFF, 0U);
  bench.drive->setInput(18, true, bench.now);
  EXPECT_EQ(bench.read(0x200B, 0x04) & 0xFFFF, 4U) << "DI3";
  bench.write(0x2004, 0x17, 31, 2);  // by 2031:05
  bench.write(0x2031, 0x05, 1, 2);
  const std::uint32_t on = bench.read(0x200B, 0x06) & 0xFFFF;
  EXPECT_EQ(on, (bench.drive->truth(bench.now).outputs >> 16) & 0x1F);
  bench.write(0x2031, 0x05, 0, 2);
  EXPECT_EQ((bench.read(0x200B, 0x06) & 0xFFFF) ^ on, 1U) << "DO1";
}

// H0b.37, H0b.40, H0b.41 of the past fault that H0b.33 selects [L8619-8763].
TEST_F(Sv660cMonitor, KeepsHowItWasAtAnAlarm) {
  bench.write(0x607F, 0, 838860800, 4);
  mode(3);
  enable();
  bench.write(0x60FF, 0, 8388608, 4);
  bench.run(ms(2000));
  bench.drive->setInput(18, true, bench.now);
  ASSERT_TRUE(bench.drive->inject("overspeed", bench.now));
  bench.drive->setInput(18, false, bench.now);
  bench.run(ms(2000));
  const auto of = [this](std::uint8_t sub) { return bench.read(0x200B, sub) & 0xFFFF; };
  EXPECT_EQ(of(0x26), 60U) << "rpm then";
  EXPECT_EQ(of(0x01), 0U) << "and now";
  EXPECT_EQ(of(0x29), of(0x1B));
  EXPECT_EQ(of(0x2A), 4U);
  EXPECT_EQ(of(0x04), 0U);
  ASSERT_TRUE(bench.drive->inject("overcurrent", bench.now));
  EXPECT_EQ(of(0x26), 0U);
  bench.write(0x200B, 0x22, 1, 2);
  EXPECT_EQ(of(0x26), 60U) << "the one before";
  bench.write(0x200B, 0x22, 7, 2);
  EXPECT_EQ(of(0x29), 0U) << "there was none";
}

// Supply and temperatures are no part of the simulation: they stay within what the pages allow.
TEST_F(Sv660cMonitor, HasASupplyAndTemperatures) {
  const double link = (bench.read(0x200B, 0x1B) & 0xFFFF) * 0.1;
  EXPECT_GT(link, 200.0) << "H01.42, under voltage [L3037]";
  EXPECT_LT(link, 420.0) << "H01.40, over voltage [L3005]";
  for (const std::uint8_t sub : {std::uint8_t{0x1C}, std::uint8_t{0x43}, std::uint8_t{0x58}}) {
    const std::uint32_t degrees = bench.read(0x200B, sub) & 0xFFFF;
    EXPECT_GT(degrees, 20U);
    EXPECT_LT(degrees, 105U) << "H0A.52, of the encoder [L8221]";
  }
}

// H0b.94 since power-on, H0b.19 in all, 0.1 s [L8475, L9177].
TEST_F(Sv660cMonitor, CountsItsTimeWithPower) {
  const auto seconds = [this](std::uint8_t sub) { return bench.read(0x200B, sub) * 0.1; };
  bench.run(ms(10000));
  EXPECT_NEAR(seconds(0x5F), 10.8, 0.11);
  EXPECT_NEAR(seconds(0x14), 10.8, 0.11);
  bench.drive->powerOff(bench.now);
  bench.drive->powerOn(bench.now);
  bench.run(ms(2000));
  EXPECT_NEAR(seconds(0x5F), 2.0, 0.11);
  EXPECT_NEAR(seconds(0x14), 12.8, 0.11);
}

// H0E.17 to H0E.19 [L9697-9731].
TEST_F(Sv660cMonitor, CountsWhatItHearsWrongly) {
  bench.frame(0x000, {0x01});
  bench.frame(0x000, {0x01, 0x01, 0x00});
  bench.frame(0x000, {0x03, 0x01});
  bench.frame(0x000, {0x01, 0x01});
  bench.frame(0x702, {0x05, 0x00});
  bench.frame(0x702, {0x05});
  EXPECT_EQ(bench.read(0x200E, 0x12) & 0xFFFF, 2U);
  EXPECT_EQ(bench.read(0x200E, 0x13) & 0xFFFF, 1U);
  EXPECT_EQ(bench.read(0x200E, 0x14) & 0xFFFF, 1U);
}

// H0b.81 and H0b.85: within a turn of the load, in encoder counts and in user units [L9077-9123].
TEST(Sv660cRotary, LoadIsToldInCountsAndInUserUnits) {
  AxisMechanics mechanics;
  mechanics.initial_position = 3.25;
  DriveBench bench("sv660c", mechanics);
  bench.run(ms(700));
  bench.write(0x2005, 0x33, 2, 2);  // two turns of the motor for one of the load
  EXPECT_EQ(bench.read(0x200B, 0x52), 10485760U) << "a turn and a quarter";
  EXPECT_EQ(bench.read(0x200B, 0x56), 10485760U);
  bench.write(0x6091, 1, 8388608, 4);
  bench.write(0x6091, 2, 1000, 4);
  EXPECT_EQ(bench.read(0x200B, 0x52), 10485760U);
  EXPECT_EQ(bench.read(0x200B, 0x56), 1250U);
}

// H0A.36 [L8126-8142]: its counter holds 65535 turns; as an incremental one it does not mind.
TEST(Sv660cTurns, ThatItsCounterDoesNotHoldAreAFaultUnlessThatIsMasked) {
  for (const auto& [system, masked, word] :
       {std::tuple(0U, 0U, 0x0250), std::tuple(1U, 0U, 0x0218), std::tuple(1U, 1U, 0x0250)}) {
    AxisMechanics mechanics;
    mechanics.initial_position = 65600.0;
    DriveBench bench("sv660c", mechanics);
    bench.run(ms(700));
    EXPECT_EQ(bench.read(0x6041) & 0x3FF, 0x0250U) << "incremental from the factory [L3384]";
    bench.write(0x2002, 2, system, 2);
    bench.write(0x200A, 0x25, masked, 2);
    bench.drive->powerOff(bench.now);
    bench.drive->powerOn(bench.now);
    bench.run(ms(700));
    EXPECT_EQ(static_cast<int>(bench.read(0x6041) & 0x3FF), word) << system << masked;
  }
}

// --- input terminals [L3896-4192, L16153-16194] -------------------------------------------------

struct Sv660cInput : testing::Test {
  static AxisMechanics switches() {
    AxisMechanics mechanics;
    mechanics.positive_limit_switch = 0.5;
    return mechanics;
  }
  DriveBench bench{"sv660c", switches()};
  Sv660cInput() {
    bench.run(ms(700));
    bench.write(0x6060, 0, 3, 1);
  }
  /// Turns forward for a while. @return how far it comes
  double turned() {
    if (!bench.drive->truth(bench.now).power_stage_on) bench.enable();
    bench.run(ms(300));
    bench.write(0x60FF, 0, 8388608, 4);
    bench.run(ms(1500));
    return bench.drive->truth(bench.now).position_turns;
  }
  std::uint32_t inputs() { return bench.read(0x60FD); }
};

TEST_F(Sv660cInput, Di1IsTheForwardLimitFromTheFactory) {
  EXPECT_EQ(inputs() & 0x010002, 0U);
  EXPECT_NEAR(turned(), 0.5, 0.05);
  EXPECT_EQ(inputs() & 0x010002, 0x010002U) << "the function, and the terminal";
}

TEST_F(Sv660cInput, WithAnotherFunctionMindsNoSwitch) {
  bench.write(0x2003, 3, 0, 2);
  EXPECT_GT(turned(), 1.0);
  EXPECT_EQ(inputs() & 0x010002, 0U);
}

TEST_F(Sv660cInput, OfTheForwardLimitMayBeAnotherOne) {
  bench.write(0x2003, 3, 0, 2);
  bench.write(0x2003, 7, 14, 2);
  EXPECT_NEAR(turned(), 0.5, 0.05);
  EXPECT_EQ(inputs() & 0x050002, 0x040002U) << "DI3";
}

// Any time, but it counts once the motor has no power.
TEST_F(Sv660cInput, HasItsNewFunctionOnceTheMotorHasNoPower) {
  bench.enable();
  bench.run(ms(300));
  bench.write(0x2003, 3, 0, 2);
  EXPECT_NEAR(turned(), 0.5, 0.05) << "not yet";
  bench.write(0x60FF, 0, 0, 4);
  bench.control(0x00);
  bench.run(ms(500));
  EXPECT_EQ(inputs() & 0x02, 0U);
  EXPECT_GT(turned(), 1.0);
}

// H03.03 = 1, high, at a switch that is wired for low: active where it is not pressed.
TEST_F(Sv660cInput, OfTheOtherLogicIsActiveWhereItsSwitchIsNot) {
  bench.write(0x2003, 4, 1, 2);
  EXPECT_EQ(inputs() & 0x02, 0x02U);
  EXPECT_NEAR(turned(), 0.0, 1e-6);
}

// Function 2, at DI4 from the factory; 34 stops as H0d.05 does.
TEST_F(Sv660cInput, ResetsFaultsAndStops) {
  ASSERT_TRUE(bench.drive->inject("overspeed", bench.now));
  ASSERT_EQ(bench.state(), 0x0008);
  bench.drive->setInput(19, true, bench.now);
  EXPECT_EQ(bench.state(), 0x0040);
  bench.drive->setInput(19, false, bench.now);
  bench.write(0x2003, 9, 34, 2);
  bench.write(0x605A, 0, 6, 2);
  bench.enable();
  bench.run(ms(300));
  bench.drive->setInput(19, true, bench.now);
  EXPECT_EQ(bench.state(), 0x0007) << "quick stop active";
}

}  // namespace
}  // namespace cia402::sim
