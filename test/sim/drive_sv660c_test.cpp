// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The simulated SV660C against the numbers that its manual prints. Lnnn: lines of the manual's
// text.
#include <cmath>

#include "drive_fixture.h"

namespace cia402::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kInvalidValue = 0x06090030, kReadOnly = 0x06010002,
                        kDeviceState = 0x08000022;

struct Sv660c : testing::Test {
  DriveBench bench{"sv660c"};
  Sv660c() { bench.run(ms(700)); }  // until it has booted

  /// Bits 0 to 9 of 6041h, as the manual's table tells them; in `word` of an SDO answer.
  int word() { return static_cast<int>(bench.read(0x6041) & 0x3FF); }
  void mode(std::uint32_t number) { bench.write(0x6060, 0, number, 1); }
  /// Sends 6040h as its bytes.
  void control(std::uint8_t low, std::uint8_t high = 0) {
    ASSERT_EQ(bench.sdo({0x2B, 0x40, 0x60, 0x00, low, high, 0, 0}),
              (Bytes{0x60, 0x40, 0x60, 0, 0, 0, 0, 0}));
  }
  void enable() {
    control(0x06);
    control(0x07);
    control(0x0F);
    bench.run(ms(300));  // H02.09
  }
};

// --- 6040h and 6041h [L511-536] --------------------------------------------------------------

TEST_F(Sv660c, GoesUpAndDownAsTheTableOfTransitionsSays) {
  EXPECT_EQ(word(), 0x0250);  // 1
  control(0x06);
  EXPECT_EQ(word(), 0x0231);  // 2
  control(0x07);
  EXPECT_EQ(word(), 0x0233);  // 3
  control(0x0F);
  EXPECT_EQ(word(), 0x0237);  // 4
  control(0x07);
  EXPECT_EQ(word(), 0x0233);  // 5, as 605Ch is 0
  control(0x06);
  EXPECT_EQ(word(), 0x0231);  // 6
  control(0x00);
  EXPECT_EQ(word(), 0x0250);  // 7
  enable();
  control(0x06);
  EXPECT_EQ(word(), 0x0231);  // 8
  control(0x07);
  control(0x0F);
  control(0x00);
  EXPECT_EQ(word(), 0x0250);  // 9
  control(0x06);
  control(0x07);
  control(0x00);
  EXPECT_EQ(word(), 0x0250);  // 10
}

TEST_F(Sv660c, TakesOneStateACommand) {
  control(0x0F);
  EXPECT_EQ(word(), 0x0250);
  control(0x06);
  control(0x0F);
  EXPECT_EQ(word(), 0x0233);
}

// 12 after 605Ah = 0 to 3, 16 after 5 to 7.
TEST_F(Sv660c, QuickStopEndsAsItsOptionSays) {
  for (const unsigned option : {0U, 1U, 2U, 3U, 5U, 6U, 7U}) {
    bench.write(0x605A, 0, option, 2);
    mode(3);
    enable();
    bench.write(0x60FF, 0, 8388608, 4);  // a turn a second at 1:1
    bench.run(ms(200));
    ASSERT_GT(bench.drive->truth(bench.now).velocity_turns, 0.5) << option;
    control(0x02);
    EXPECT_EQ(word(), option == 0 ? 0x0250 : 0x0217) << option;  // 11
    bench.run(ms(3000));
    EXPECT_NEAR(bench.drive->truth(bench.now).velocity_turns, 0.0, 1e-3) << option;
    EXPECT_EQ(word(), option < 4 ? 0x0250 : 0x0217) << option;  // 12
    bench.write(0x60FF, 0, 0, 4);
    control(0x0F);
    EXPECT_EQ(word(), option < 4 ? 0x0250 : 0x0237) << option;  // 16
    control(0x00);
  }
  EXPECT_EQ(bench.refusal(0x605A, 0, 8, 2), 0x06090031U) << "0 to 7 [L15012]";
}

TEST_F(Sv660c, AFaultIsResetByTheEdgeOfBit7WhichBlocksAllElse) {
  mode(3);
  enable();
  bench.write(0x60FF, 0, 8388608, 4);
  bench.run(ms(200));
  ASSERT_TRUE(bench.drive->inject("position_command", bench.now));
  EXPECT_EQ(word(), 0x021F);  // 13
  bench.run(ms(3000));
  EXPECT_EQ(word(), 0x0218);  // 14
  control(0x80);
  EXPECT_EQ(word(), 0x0250);  // 15
  control(0x86);
  EXPECT_EQ(word(), 0x0250) << "all other commands are ignored while bit 7 is 1";
  control(0x06);
  EXPECT_EQ(word(), 0x0231);
}

// --- objects as from the factory -------------------------------------------------------------

TEST_F(Sv660c, TellsThePrintedIdentity) {
  EXPECT_EQ(bench.sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}),
            (Bytes{0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}));
  EXPECT_EQ(bench.sdo({0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}),
            (Bytes{0x43, 0x18, 0x10, 0x01, 0xB9, 0x03, 0x00, 0x00}));
  EXPECT_EQ(bench.sdo({0x40, 0x18, 0x10, 0x02, 0, 0, 0, 0}),
            (Bytes{0x43, 0x18, 0x10, 0x02, 0x17, 0x01, 0x0D, 0x00}));
  EXPECT_EQ(bench.sdo({0x40, 0x18, 0x10, 0x03, 0, 0, 0, 0}),
            (Bytes{0x43, 0x18, 0x10, 0x03, 0x01, 0x00, 0x02, 0x00}));
}

// 1614807056 and its like in decimal [L13651 to L14874], 512 to 1408 [L13535], 500 [L14202].
TEST_F(Sv660c, HasThePrintedPdosFromTheFactory) {
  const std::uint32_t rpdo[] = {0x201, 0x80000301, 0x80000401, 0x80000501};
  const std::uint32_t tpdo[] = {0x40000181, 0xC0000281, 0xC0000381, 0xC0000481};
  const std::uint32_t second_r[] = {0, 1616904200, 1618608160, 1627324448};
  const std::uint32_t second_t[] = {0, 1616969736, 1617166368, 1617690656};
  for (std::uint16_t i = 0; i < 4; ++i) {
    const auto at = [i](int index) { return static_cast<std::uint16_t>(index + i); };
    EXPECT_EQ(bench.read(at(0x1400), 1), rpdo[i]) << i;
    EXPECT_EQ(bench.read(at(0x1800), 1), tpdo[i]) << i;
    EXPECT_EQ(bench.read(at(0x1400), 2), 255U);
    EXPECT_EQ(bench.read(at(0x1800), 2), 255U);
    EXPECT_EQ(bench.read(at(0x1800), 3), 500U);
    EXPECT_EQ(bench.read(at(0x1600), 0), i == 0 ? 1U : 2U);
    EXPECT_EQ(bench.read(at(0x1A00), 0), i == 0 ? 1U : 2U);
    EXPECT_EQ(bench.read(at(0x1600), 1), 1614807056U);
    EXPECT_EQ(bench.read(at(0x1A00), 1), 1614872592U);
    if (i == 0) continue;
    EXPECT_EQ(bench.read(at(0x1600), 2), second_r[i]) << i;
    EXPECT_EQ(bench.read(at(0x1A00), 2), second_t[i]) << i;
  }
  EXPECT_EQ(bench.sdo({0x40, 0x00, 0x16, 0x01, 0, 0, 0, 0}),
            (Bytes{0x43, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60}));
  EXPECT_EQ(bench.sdo({0x40, 0x02, 0x1A, 0x02, 0, 0, 0, 0}),
            (Bytes{0x43, 0x02, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60}));
}

// The statusword comes with a change, but not twice within 50 ms.
TEST_F(Sv660c, InhibitsItsStatuswordFor50MsFromTheFactory) {
  bench.nmt(0x01);
  bench.run(ms(100));
  bench.sent.clear();
  bench.frame(0x201, {0x06, 0x00});
  bench.run(ms(1));
  bench.frame(0x201, {0x07, 0x00});
  bench.run(ms(45));
  const auto words = [this] {
    std::vector<int> found;
    for (const can::Frame& f : bench.sent) {
      if (f.id == 0x181) found.push_back(f.data[0] | f.data[1] << 8);
    }
    return found;
  };
  EXPECT_EQ(words(), (std::vector<int>{0x0231}));
  bench.run(ms(10));
  EXPECT_EQ(words(), (std::vector<int>{0x0231, 0x0233}));
}

// --- rules of PDOs and COB-IDs [L13531-14450] ------------------------------------------------

TEST_F(Sv660c, TakesAPdoApartAndTogetherInOneOrderOnly) {
  EXPECT_EQ(bench.refusal(0x1802, 2, 1, 1), 0U) << "it is invalid from the factory";
  EXPECT_EQ(bench.refusal(0x1800, 2, 1, 1), kDeviceState);
  EXPECT_EQ(bench.refusal(0x1800, 3, 0, 2), kDeviceState);
  EXPECT_EQ(bench.refusal(0x1800, 5, 0, 2), kDeviceState);
  EXPECT_EQ(bench.refusal(0x1A00, 0, 0, 1), kDeviceState);
  EXPECT_EQ(bench.refusal(0x1400, 2, 1, 1), kDeviceState);
  const Bytes taken_18{0x60, 0x00, 0x18, 0x01, 0, 0, 0, 0};
  EXPECT_EQ(bench.sdo({0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0x00, 0xC0}), taken_18);
  bench.write(0x1A00, 0, 0, 1);
  EXPECT_EQ(bench.sdo({0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x00, 0x1A, 0x03, 0x08, 0x00, 0x61, 0x60})[0], 0x60);
  bench.write(0x1A00, 0, 3, 1);
  bench.write(0x1800, 2, 1, 1);
  bench.write(0x1800, 3, 0, 2);
  EXPECT_EQ(bench.sdo({0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0x00, 0x40}), taken_18);
}

TEST_F(Sv660c, LetsOnlyBit31OfAnRpdoAndBit30OfATpdoChange) {
  EXPECT_EQ(bench.refusal(0x1402, 1, 0x80000402, 4), kReadOnly);
  EXPECT_EQ(bench.refusal(0x1402, 1, 0xC0000401, 4), kReadOnly);
  EXPECT_EQ(bench.refusal(0x1402, 1, 0x00000401, 4), 0U);
  EXPECT_EQ(bench.refusal(0x1802, 1, 0xC0000382, 4), kReadOnly);
  EXPECT_EQ(bench.refusal(0x1802, 1, 0x80000381, 4), 0U);
  EXPECT_EQ(bench.sdo({0x23, 0x02, 0x18, 0x01, 0x81, 0x03, 0x00, 0xC0})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x02, 0x18, 0x01, 0x81, 0x03, 0x00, 0x40})[0], 0x60);
}

// 1006h first, then 1005h [L13265-13279]; 1014h by bit 31 alone [L13347-13353].
TEST_F(Sv660c, ProducesSyncOnceItsPeriodIsSetAndKeepsItsIdentifiers) {
  EXPECT_EQ(bench.refusal(0x1005, 0, 0x40000080, 4), kDeviceState);
  EXPECT_EQ(bench.refusal(0x1005, 0, 0x00000081, 4), kInvalidValue);
  EXPECT_EQ(bench.sdo({0x23, 0x06, 0x10, 0x00, 0xA0, 0x0F, 0x00, 0x00})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x05, 0x10, 0x00, 0x80, 0x00, 0x00, 0x40})[0], 0x60);
  bench.sent.clear();
  bench.run(ms(41));
  std::size_t syncs = 0;
  for (const can::Frame& frame : bench.sent) syncs += frame.id == 0x080 ? 1 : 0;
  EXPECT_EQ(syncs, 10U);
  EXPECT_EQ(bench.sdo({0x23, 0x05, 0x10, 0x00, 0x80, 0x00, 0x00, 0x00})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x14, 0x10, 0x00, 0x81, 0x00, 0x00, 0x80})[0], 0x60);
  EXPECT_EQ(bench.sdo({0x23, 0x14, 0x10, 0x00, 0x81, 0x00, 0x00, 0x00})[0], 0x60);
  EXPECT_EQ(bench.refusal(0x1014, 0, 0x00000082, 4), kInvalidValue);
}

// --- what the 2000h groups do ----------------------------------------------------------------

// [L465-488] 4194304 encoder counts are one user unit: 6064h counts half turns.
TEST_F(Sv660c, CountsEncoderCountsInUserUnits) {
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
TEST_F(Sv660c, RampsBy6083hAnd6084h) {
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
TEST_F(Sv660c, LosesCommandsWhileItsBrakeOpens) {
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
TEST_F(Sv660c, ShowsInBit15ThatItsHomeWasFound) {
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

TEST_F(Sv660c, TakesTheMethodsThatDoNothing) {
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

TEST_F(Sv660c, HasItsFiveModesAndZero) {
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
TEST_F(Sv660c, StartsAnewBySoftwareReset) {
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
TEST_F(Sv660c, MindsItsPositionLimitsWhereTheyAreOn) {
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

struct Sv660cIp : Sv660c {
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

}  // namespace
}  // namespace cia402::sim
