// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The words, defaults and rules of PDOs that the manual of the SV660C prints, in its simulation.
// Lnnn: lines of the manual's text.
#include "sv660c_bench.h"

namespace cia402::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

using Sv660c = Sv660cBench;

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

// 6084h 2, 6085h 8 turns/s^2; from 2 turns/s: 1 and 1/4 turn. As hard as it can, 3 times the rated
// torque, 3000 turns/s^2; coasting, 30 turns/s^2 of friction and 0.5/s of the speed; by the dynamic
// brake 300 more, which no manual tells: 4 / 662 of a turn.
TEST_F(Sv660c, DisablingEndsAsItsOptionSays) {
  struct Option {
    unsigned code;  // 605Ch as sent
    double way;     // turns
    bool at_once;   // it lets the motor go
  };
  for (const Option& option :
       {Option{0xFFFC, 0.25, false}, Option{0xFFFD, 0.0007, false}, Option{0xFFFE, 1.0, false},
        Option{0xFFFF, 0.0060, true}, Option{0, 0.0656, true}, Option{1, 1.0, false},
        Option{2, 0.0060, true}}) {
    bench.write(0x605C, 0, option.code, 2);
    bench.write(0x6084, 0, 16777216, 4);
    bench.write(0x6085, 0, 67108864, 4);
    const auto truth = [this] { return bench.drive->truth(bench.now); };
    turnTwicePerSecond();
    ASSERT_NEAR(truth().velocity_turns, 2.0, 1e-3) << option.code;
    const double from = truth().position_turns;
    control(0x07);
    EXPECT_EQ(word(), option.at_once ? 0x0233 : 0x0237) << option.code;
    bench.run(ms(1500));
    EXPECT_EQ(word(), 0x0233) << option.code;
    EXPECT_NEAR(truth().velocity_turns, 0.0, 1e-6);
    EXPECT_NEAR(truth().position_turns - from, option.way, 0.05 * option.way + 2.0 * 0.006)
        << option.code;
    bench.write(0x60FF, 0, 0, 4);
    control(0x00);
  }
  EXPECT_EQ(bench.refusal(0x605C, 0, 3, 2), 0x06090031U) << "-4 to 2 [L15043]";
}

// A fault of class 1 by H02.08 [L3500-3514], one of class 2 by 605Eh [L15101-15153]: at once
// without power, and to rest by the dynamic brake or without it.
TEST_F(Sv660c, AFaultEndsByTheDynamicBrakeWhereItsOptionSaysSo) {
  struct Option {
    const char* fault;
    std::uint16_t object;
    std::uint8_t sub;
    unsigned code;
    double way;  // turns
  };
  for (const Option& option :
       {Option{"encoder", 0x2002, 9, 0, 0.0656}, Option{"encoder", 0x2002, 9, 1, 0.0060},
        Option{"encoder", 0x2002, 9, 2, 0.0060}, Option{"position_command", 0x605E, 0, 0, 0.0656},
        Option{"position_command", 0x605E, 0, 0xFFFF, 0.0060},
        Option{"position_command", 0x605E, 0, 4, 0.0060}}) {
    bench.write(option.object, option.sub, option.code, 2);
    const auto truth = [this] { return bench.drive->truth(bench.now); };
    turnTwicePerSecond();
    ASSERT_NEAR(truth().velocity_turns, 2.0, 1e-3) << option.code;
    const double from = truth().position_turns;
    ASSERT_TRUE(bench.drive->inject(option.fault, bench.now));
    EXPECT_FALSE(truth().power_stage_on) << option.fault;
    EXPECT_EQ(word(), 0x0218) << option.fault;
    bench.run(ms(1500));
    EXPECT_NEAR(truth().velocity_turns, 0.0, 1e-6);
    EXPECT_NEAR(truth().position_turns - from, option.way, 0.05 * option.way + 1e-3)
        << option.fault << " " << option.code;
    bench.write(0x60FF, 0, 0, 4);
    control(0x80);
    control(0x00);
    EXPECT_EQ(word(), 0x0250);
  }
}

// In pt "it stops by 6087h" for 605Ah = 1, 2, 5, 6 and 605Dh = 1, 2 [L15710-15712], here 100 % a
// second: 50 % push against the speed limit until friction (3 %) is stronger, then the motor
// coasts.
TEST_F(Sv660c, AStopOfATorqueGoesBy6087h) {
  const auto speed = [this] { return bench.drive->truth(bench.now).velocity_turns; };
  struct Option {
    std::uint16_t object;
    unsigned code;
    bool fades;
  };
  for (const Option& option :
       {Option{0x605A, 1, true}, Option{0x605A, 2, true}, Option{0x605A, 3, false},
        Option{0x605A, 5, true}, Option{0x605A, 6, true}, Option{0x605A, 7, false},
        Option{0x605D, 1, true}, Option{0x605D, 2, true}, Option{0x605D, 3, false}}) {
    bench.write(option.object, 0, option.code, 2);
    bench.write(0x607F, 0, 8388608, 4);
    bench.write(0x6087, 0, 1000, 4);
    mode(4);
    enable();
    bench.write(0x6071, 0, 500, 2);
    bench.run(ms(1000));
    ASSERT_NEAR(speed(), 1.0, 0.02) << option.code;
    option.object == 0x605A ? control(0x02) : control(0x0F, 0x01);
    bench.run(ms(300));
    EXPECT_NEAR(speed(), option.fades ? 1.0 : 0.0, 0.02) << option.object << " " << option.code;
    bench.run(ms(400));
    EXPECT_NEAR(speed(), 0.0, 1e-6) << option.object << " " << option.code;
    const bool holds = option.object == 0x605D || option.code > 4;
    EXPECT_EQ(bench.drive->truth(bench.now).power_stage_on, holds) << option.code;
    bench.write(0x6071, 0, 0, 2);
    control(0x00);
  }
}

// Disabling is not among them: 605Ch = 1 brakes by 6084h, here 2 turns/s^2.
TEST_F(Sv660c, ATorqueIsDisabledBy6084h) {
  bench.write(0x605C, 0, 1, 2);
  bench.write(0x607F, 0, 8388608, 4);
  bench.write(0x6084, 0, 16777216, 4);
  bench.write(0x6087, 0, 1000, 4);
  mode(4);
  enable();
  bench.write(0x6071, 0, 500, 2);
  bench.run(ms(1000));
  control(0x07);
  bench.run(ms(250));
  EXPECT_NEAR(bench.drive->truth(bench.now).velocity_turns, 0.5, 0.03);
  bench.run(ms(300));
  EXPECT_EQ(word(), 0x0233);
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

}  // namespace
}  // namespace cia402::sim
