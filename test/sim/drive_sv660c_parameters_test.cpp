// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the parameters and modes of the simulated SV660C do. Lnnn: lines of the manual's text.
#include <cmath>

#include "sv660c_bench.h"

namespace cia402::sim {
namespace {

using Sv660cParameter = Sv660cBench;

// --- what the 2000h groups do ----------------------------------------------------------------

// [L465-488] 4194304 encoder counts are one user unit: 6064h counts half turns.
TEST_F(Sv660cParameter, CountsEncoderCountsInUserUnits) {
  AxisMechanics mechanics;
  mechanics.initial_position = 3.0;
  DriveBench turned("sv660c", mechanics);
  turned.run(ms(700));
  EXPECT_EQ(turned.position(), 3 * 8388608);
  EXPECT_EQ(turned.sdo({0x23, 0x91, 0x60, 0x01, 0x00, 0x00, 0x40, 0x00})[0], 0x60);
  EXPECT_EQ(turned.sdo({0x23, 0x91, 0x60, 0x02, 0x01, 0x00, 0x00, 0x00})[0], 0x60);
  turned.control(0x0006);
  turned.control(0x0007);
  turned.control(0x000F);
  turned.run(ms(5));
  EXPECT_EQ(turned.position(), 6);
  EXPECT_EQ(turned.read(0x6063), 3U * 8388608U) << "in encoder counts [L15229]";
  EXPECT_EQ(turned.refusal(0x6091, 1, 1, 4), kDeviceState) << "while stopped only [L15716]";
}

// [L15650-15678] 400 rpm, 400 rpm/s up and 200 rpm/s down at 1:1: 1 s and 2 s.
TEST_F(Sv660cParameter, RampsBy6083hAnd6084h) {
  mode(3);
  EXPECT_EQ(bench.sdo({0x23, 0x83, 0x60, 0x00, 0x55, 0x55, 0x55, 0x03})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x84, 0x60, 0x00, 0xAB, 0xAA, 0xAA, 0x01})[0], 0x60);
  enable();
  const auto speed = [this] { return bench.drive->truth(bench.now).velocity_turns * 60.0; };
  bench.write(0x60FF, 0, 0x03555555, 4);
  bench.run(ms(500));
  EXPECT_NEAR(speed(), 200.0, 4.0);
  bench.run(ms(600));
  EXPECT_NEAR(speed(), 400.0, 0.1);
  bench.write(0x60FF, 0, 0, 4);
  bench.run(ms(1000));
  EXPECT_NEAR(speed(), 200.0, 4.0);
  bench.run(ms(1100));
  EXPECT_NEAR(speed(), 0.0, 0.1);
}

// H02.09 = 250 ms [L3516]. Whether an edge is lost meanwhile or waits is open: here it is lost.
TEST_F(Sv660cParameter, LosesCommandsWhileItsBrakeOpens) {
  mode(1);
  bench.enable();
  bench.run(ms(240));
  bench.write(0x607A, 0, 838861, 4);
  control(0x1F);
  bench.run(ms(1000));
  EXPECT_EQ(bench.drive->truth(bench.now).position_turns, 0.0);
  control(0x0F);
  control(0x1F);
  bench.run(ms(1000));
  EXPECT_NEAR(bench.drive->truth(bench.now).position_turns, 0.1, 1e-6);
}

// Method 35, start by 0x0F to 0x1F [L1745-1751]; bit 15: home was found [L618].
TEST_F(Sv660cParameter, ShowsInBit15ThatItsHomeWasFound) {
  EXPECT_EQ(bench.read(0x6041) & 0x8000, 0U);
  EXPECT_EQ(bench.sdo({0x2F, 0x98, 0x60, 0x00, 0x23, 0x00, 0x00, 0x00})[0], 0x60);
  bench.write(0x607C, 0, 4711, 4);
  mode(6);
  enable();
  control(0x0F);
  control(0x1F);
  bench.run(ms(5));
  EXPECT_EQ(bench.read(0x6041) & 0xB400, 0x9400U);
  EXPECT_EQ(bench.position(), 4711) << "+607Ch [L15532]";
  control(0x00);
  EXPECT_EQ(bench.read(0x6041) & 0x8000, 0x8000U) << "in every state";
  bench.drive->powerOff(bench.now);
  bench.drive->powerOn(bench.now);
  bench.run(ms(700));
  EXPECT_EQ(bench.read(0x6041) & 0x8000, 0U);
}

TEST_F(Sv660cParameter, TakesTheMethodsThatDoNothing) {
  mode(6);
  enable();
  for (const unsigned method : {15U, 16U, 31U, 32U}) {
    bench.write(0x6098, 0, method, 1);
    control(0x0F);
    control(0x1F);
    bench.run(ms(500));
    EXPECT_EQ(bench.read(0x6041) & 0x3000, 0U) << method;
    EXPECT_EQ(bench.drive->truth(bench.now).position_turns, 0.0) << method;
  }
  EXPECT_EQ(bench.refusal(0x6098, 0, 36, 1), 0x06090031U) << "35 is the last [L15762]";
}

TEST_F(Sv660cParameter, HasItsFiveModesAndZero) {
  for (const int mode : {1, 3, 4, 6, 7, 0}) {
    const auto number = static_cast<std::uint8_t>(mode);
    EXPECT_EQ(bench.sdo({0x2F, 0x60, 0x60, 0x00, number, 0, 0, 0})[0], 0x60);
    EXPECT_EQ(bench.read(0x6061), number);
  }
  for (const std::uint32_t number : {2U, 8U, 9U, 10U}) {
    EXPECT_EQ(bench.refusal(0x6060, 0, number, 1), kInvalidValue) << number;
  }
}

// H0d.00 = 1 [L9428]: as at power-on.
TEST_F(Sv660cParameter, StartsAnewBySoftwareReset) {
  bench.write(0x6081, 0, 12345, 4);
  bench.sent.clear();
  EXPECT_EQ(bench.sdo({0x2B, 0x0D, 0x20, 0x01, 0x01, 0x00, 0x00, 0x00})[0], 0x60);
  bench.run(ms(1000));
  ASSERT_FALSE(bench.sent.empty());
  EXPECT_EQ(bench.sent.back().id, 0x701U);
  EXPECT_EQ(bench.sent.back().data[0], 0x00);
  EXPECT_EQ(bench.read(0x6081), 13981013U) << "what was not stored is gone";
  enable();
  EXPECT_EQ(bench.refusal(0x200D, 1, 1, 2), kDeviceState) << "while stopped only";
}

// 200A:29 [L8158-8171]: 0 off, as from the factory, 1 on, 2 once home was found.
TEST_F(Sv660cParameter, MindsItsPositionLimitsWhereTheyAreOn) {
  bench.write(0x607D, 1, static_cast<std::uint32_t>(-8388608), 4);
  bench.write(0x607D, 2, 8388608, 4);
  bench.write(0x6098, 0, 35, 1);
  const auto goTo = [this](double turns) {
    const auto raw = static_cast<std::uint32_t>(std::lround(turns * 8388608));
    bench.write(0x607A, 0, raw, 4);
    control(0x0F);
    control(0x3F);
    bench.run(ms(3000));
    return bench.drive->truth(bench.now).position_turns;
  };
  mode(1);
  enable();
  EXPECT_NEAR(goTo(1.5), 1.5, 1e-6);
  bench.write(0x200A, 0x29, 2, 2);
  EXPECT_NEAR(goTo(2.0), 2.0, 1e-6) << "not homed yet";
  EXPECT_NEAR(goTo(0.0), 0.0, 1e-6);
  mode(6);
  control(0x0F);
  control(0x1F);
  bench.run(ms(5));
  mode(1);
  EXPECT_NEAR(goTo(1.5), 1.0, 1e-6);
  bench.write(0x200A, 0x29, 0, 2);
  EXPECT_NEAR(goTo(1.5), 1.5, 1e-6);
}

// --- ip [L852-949] ---------------------------------------------------------------------------

struct Sv660cIp : Sv660cBench {
  using Sv660cBench::Sv660cBench;
  void SetUp() override {
    bench.write(0x1400, 1, 0x80000201, 4);
    bench.write(0x1600, 0, 0, 1);
    bench.write(0x1600, 1, 0x60400010, 4);
    bench.write(0x1600, 2, 0x60C10120, 4);
    bench.write(0x1600, 0, 2, 1);
    bench.write(0x1400, 2, 1, 1);
    bench.write(0x1400, 1, 0x00000201, 4);
    EXPECT_EQ(bench.sdo({0x2F, 0xC2, 0x60, 0x01, 0x04, 0x00, 0x00, 0x00})[0], 0x60);
    EXPECT_EQ(bench.sdo({0x2F, 0xC2, 0x60, 0x02, 0xFD, 0x00, 0x00, 0x00})[0], 0x60);
    mode(7);
    bench.nmt(0x01);
    for (const int word : {0x06, 0x07, 0x0F}) cycle(0, static_cast<std::uint8_t>(word));
    for (int i = 0; i < 80; ++i) cycle(0, 0x0F);
    cycle(0, 0x1F);
  }
  void cycle(std::int32_t counts, std::uint8_t control = 0x1F, double wait = 4.0) {
    const auto raw = static_cast<std::uint32_t>(counts);
    bench.frame(0x201, {control, 0x00, DriveBench::low(raw), DriveBench::high(raw),
                        DriveBench::low(raw >> 16), DriveBench::high(raw >> 16)});
    bench.sync();
    bench.run(ms(wait));
  }
  // Looked at without an SDO, which would take its time.
  std::uint64_t now(std::uint16_t index) {
    return bench.drive->dictionary().find({index, 0})->number;
  }
  std::int32_t demand() { return static_cast<std::int32_t>(now(0x6062)); }
  bool faulted() { return (now(0x6041) & 0x0008) != 0; }
};

// P1 is received, and gone to from the next SYNC on [L859-865].
TEST_F(Sv660cIp, GoesToASetPointInThePeriodAfterItCame) {
  EXPECT_NE(now(0x6041) & 0x1000, 0U);
  cycle(1000);
  EXPECT_EQ(demand(), 0);
  cycle(2000, 0x1F, 2.0);
  EXPECT_EQ(demand(), 500);
  bench.run(ms(2));
  EXPECT_EQ(demand(), 1000);
  cycle(2000);
  EXPECT_EQ(demand(), 2000);
}

TEST_F(Sv660cIp, StandsWhereBit4IsGone) {
  cycle(1000);
  cycle(2000);
  cycle(2000, 0x0F);
  EXPECT_EQ(now(0x6041) & 0x1000, 0U);
  const double stood = bench.drive->truth(bench.now).position_turns;
  for (int i = 0; i < 50; ++i) cycle(90000, 0x0F);
  EXPECT_NEAR(bench.drive->truth(bench.now).position_turns, stood, 1e-3);
  for (int i = 0; i < 20; ++i) cycle(2000);
  EXPECT_NEAR(bench.drive->truth(bench.now).position_turns, 2000.0 / 8388608, 1e-6);
}

struct Sv660cIpAtASwitch : Sv660cIp {
  Sv660cIpAtASwitch() : Sv660cIp(mechanics()) {}
  static AxisMechanics mechanics() {
    AxisMechanics mechanics;
    mechanics.negative_limit_switch = -0.001;
    return mechanics;
  }
};

// The set-point before lies beyond the switch still, and is gone to first.
TEST_F(Sv660cIpAtASwitch, IsCalledBackWithoutGoingBeyondIt) {
  for (int counts = 0; counts > -20000; counts -= 200) cycle(counts);
  const double stood = bench.drive->truth(bench.now).position_turns;
  EXPECT_NEAR(stood, -0.001, 4e-5) << "a cycle further, and a stop";
  EXPECT_NE(now(0x6041) & 0x0800, 0U);
  const auto here = static_cast<std::int32_t>(now(0x6064));
  for (int i = 0; i < 40; ++i) {
    if (i % 8 == 0) cycle(here, 0x1F, 0.0);
    bench.run(ms(0.5));
    EXPECT_NEAR(bench.drive->truth(bench.now).position_turns, stood, 1e-6) << i;
  }
}

// H0E.13 = 0: a quarter of the period, 1 ms of 4.
TEST_F(Sv660cIp, MindsSyncThatIsLateByMoreThanItsTolerance) {
  cycle(0, 0x1F, 4.9);
  cycle(0, 0x1F, 3.1);
  cycle(0);
  EXPECT_FALSE(faulted());
  cycle(0, 0x1F, 5.6);
  EXPECT_TRUE(faulted());
  EXPECT_EQ(now(0x603F), 0x8700U);
}

TEST_F(Sv660cIp, MindsSyncThatIsEarlyByMoreThanItsTolerance) {
  cycle(0, 0x1F, 2.9);
  EXPECT_FALSE(faulted());
  cycle(0);
  EXPECT_TRUE(faulted());
}

TEST_F(Sv660cIp, MindsNothingWithTheToleranceOff) {
  bench.write(0x200E, 0x0E, 5, 2);
  bench.run(ms(50));
  EXPECT_FALSE(faulted());
  EXPECT_EQ(word(), 0x0237);
}

// H0E.07 = 1: speeds in 0.01 rpm, accelerations as the ms from 0 to 1000 rpm [L9609-9627].
TEST_F(Sv660cParameter, CountsInRpmAndMillisecondsWhereItsUnitsAreTheUsers) {
  bench.write(0x200E, 8, 1, 2);
  mode(3);
  bench.write(0x6083, 0, 10000, 4);  // 600 rpm in 6 s
  bench.write(0x607F, 0, 300000, 4);
  for (const std::uint16_t index : {std::uint16_t{0x60C5}, std::uint16_t{0x60C6}})
    bench.write(index, 0, 1, 4);
  enable();
  bench.write(0x60FF, 0, 60000, 4);  // 600 rpm are 10 turns/s
  bench.run(ms(3000));
  EXPECT_NEAR(bench.drive->truth(bench.now).velocity_turns, 5.0, 0.3) << "half of it";
  bench.run(ms(4000));
  EXPECT_NEAR(bench.drive->truth(bench.now).velocity_turns, 10.0, 0.05);
  EXPECT_NEAR(bench.velocity(), 60000, 300);
  EXPECT_NE(bench.refusal(0x200E, 8, 0, 2), 0U) << "at rest only";
  control(0x06);
  bench.run(ms(20000));
  bench.write(0x200E, 8, 0, 2);
  for (const std::uint16_t index : {std::uint16_t{0x60C5}, std::uint16_t{0x60C6}})
    bench.write(index, 0, 0xFFFFFFFF, 4);
  bench.write(0x607F, 0, 838860800, 4);
  bench.write(0x6083, 0, 10000, 4);  // counts/s^2 now: 1.2e-3 turns/s^2
  enable();
  bench.write(0x60FF, 0, 60000, 4);
  bench.run(ms(4000));
  EXPECT_LT(bench.drive->truth(bench.now).velocity_turns, 0.006);
}

// --- which way round [L3400-3418, L15582-15598] -----------------------------------------------

struct Sv660cDirection : Sv660cBench {
  double turns() { return bench.drive->truth(bench.now).position_turns; }
  double speed() { return bench.drive->truth(bench.now).velocity_turns; }
  void goTo(std::uint32_t counts) {
    bench.write(0x607A, 0, counts, 4);
    control(0x0F);
    control(0x3F);
    bench.run(ms(3000));
  }
};

// Bit 7: pp and ip.
TEST_F(Sv660cDirection, IsTurnedByBit7OfThePolarityForPositionsAlone) {
  bench.write(0x607E, 0, 0x80, 1);
  mode(1);
  enable();
  goTo(838861);
  EXPECT_NEAR(turns(), -0.1, 1e-6);
  EXPECT_EQ(bench.position(), -838861) << "only the command is said to change its sign";
  mode(3);
  bench.write(0x60FF, 0, 8388608, 4);
  bench.run(ms(300));
  EXPECT_NEAR(speed(), 1.0, 1e-3);
  bench.write(0x60FF, 0, 0, 4);
  bench.run(ms(300));
  mode(1);
  bench.write(0x607E, 0, 0, 1);  // any time
  goTo(838861);
  EXPECT_NEAR(turns(), 0.1, 1e-6);
}

// Bit 6: pv. Bit 5: pt, an addition of the maker's.
TEST_F(Sv660cDirection, IsTurnedByBit6ForVelocitiesAndByBit5ForTorques) {
  bench.write(0x607E, 0, 0x40, 1);
  mode(3);
  enable();
  bench.write(0x60FF, 0, 8388608, 4);
  bench.run(ms(300));
  EXPECT_NEAR(speed(), -1.0, 1e-3);
  EXPECT_NE(bench.read(0x6041) & 0x0400, 0U) << "the target, as it is meant, is reached";
  bench.write(0x60FF, 0, 0, 4);
  bench.run(ms(300));
  bench.write(0x607F, 0, 8388608, 4);  // bounds the speed in pt
  for (const auto& [bits, sign] : {std::pair(0x40U, 1.0), std::pair(0x20U, -1.0)}) {
    bench.write(0x607E, 0, bits, 1);
    mode(4);
    bench.write(0x6071, 0, 500, 2);
    bench.run(ms(300));
    EXPECT_NEAR(speed(), sign, 1e-2) << bits;
    EXPECT_NEAR(static_cast<std::int32_t>(bench.read(0x606C)), sign * 8388608, 1e5) << bits;
  }
}

// H02.02 = 1: forward is clockwise, from the next power-on on.
TEST_F(Sv660cDirection, IsAnotherOnceH0202WasSetAndThePowerWasOff) {
  mode(1);
  enable();
  goTo(838861);
  EXPECT_NEAR(turns(), 0.1, 1e-6);
  EXPECT_EQ(bench.refusal(0x2002, 3, 1, 2), kDeviceState) << "while stopped only";
  control(0x00);
  bench.run(ms(100));
  bench.write(0x2002, 3, 1, 2);
  enable();
  goTo(1677722);
  EXPECT_NEAR(turns(), 0.2, 1e-6) << "not yet";
  bench.drive->powerOff(bench.now);
  bench.drive->powerOn(bench.now);
  bench.run(ms(700));
  mode(1);
  enable();
  EXPECT_EQ(bench.position(), 0) << "incremental from the factory [L3384]";
  goTo(838861);
  EXPECT_NEAR(turns(), 0.1, 1e-6) << "back by a tenth";
  EXPECT_EQ(bench.position(), 838861);
}

// The switches stay where they are, and at their terminals: forward now leads away from P-OT.
TEST_F(Sv660cDirection, LeavesSwitchesAndIndexPulsesWhereTheyAre) {
  AxisMechanics mechanics;
  mechanics.positive_limit_switch = 0.5;
  mechanics.index_offset = 0.3;
  DriveBench turned("sv660c", mechanics);
  turned.run(ms(700));
  turned.write(0x2002, 3, 1, 2);
  turned.drive->powerOff(turned.now);
  turned.drive->powerOn(turned.now);
  turned.run(ms(700));
  turned.write(0x6098, 0, 34, 1);  // forward at low speed to the first Z [L1729-1743]
  turned.write(0x6060, 0, 6, 1);
  for (const int word : {0x06, 0x07, 0x0F}) turned.control(static_cast<std::uint16_t>(word));
  turned.run(ms(300));
  turned.control(0x1F);
  turned.run(ms(9000));  // 0.7 turns at 10 rpm
  EXPECT_NEAR(turned.drive->truth(turned.now).position_turns, -0.7, 1e-6)
      << "a whole turn from 0.3";
  turned.write(0x6060, 0, 1, 1);
  turned.write(0x607A, 0, static_cast<std::uint32_t>(-2 * 8388608), 4);
  turned.control(0x0F);
  turned.control(0x3F);
  turned.run(ms(3000));
  EXPECT_NE(turned.read(0x60FD) & 0x02, 0U)
      << "forward overtravel is its switch, whatever is forward";
}

}  // namespace
}  // namespace cia402::sim
