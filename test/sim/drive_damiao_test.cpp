// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The simulated Damiao DM: float bits, vendor modes, vendor quick stop. Bytes after the manual.
#include "drive_fixture.h"

namespace cia402::sim {
namespace {

constexpr std::uint16_t kMask = 0x03FF;

struct Damiao : DriveBench {
  explicit Damiao(double turns = 0.0) : DriveBench("damiao_dm", at(turns)) {}
  static AxisMechanics at(double turns) {
    AxisMechanics mechanics;
    mechanics.initial_position = turns;
    return mechanics;
  }
  int word() { return static_cast<int>(read(0x6041)) & kMask; }
  void mode(int number) { write(0x6060, 0, static_cast<std::uint32_t>(number), 2); }
  // 10 rad/s in mode 4.
  void spin() {
    mode(4);
    enable();
    write(0x60FF, 0, 0x41200000, 4);
    run(ms(300));
    ASSERT_NEAR(readFloat(0x606C), 10.0, 1e-3);
  }
};

TEST(DriveDamiao, ShowsItsIdentityAsPrinted) {
  Damiao b;
  EXPECT_EQ(b.read(0x1000), 0x00030000U);
  EXPECT_EQ(b.read(0x1019) & 0xFFU, 240U);
  EXPECT_EQ(b.read(0x2002, 0) & 0xFFU, 7U);
  EXPECT_EQ(b.read(0x2002, 0x0E), 10U);
  EXPECT_EQ(b.read(0x2002, 3), 0x40400000U);
  EXPECT_EQ(b.read(0x1029, 0) & 0xFFU, 1U);
  EXPECT_EQ(b.read(0x1800, 1), 0x80000181U);
  EXPECT_EQ(b.read(0x1400, 1), 0x00000201U);
  EXPECT_EQ(b.read(0x1402, 1), 0x80000401U);
  EXPECT_EQ(b.abortOf({0x40, 0x98, 0x60, 0x00, 0, 0, 0, 0}), 0x06020000U);  // no homing
  EXPECT_EQ(b.abortOf({0x40, 0x02, 0x65, 0x00, 0, 0, 0, 0}), 0x06020000U);  // no 6502h
  EXPECT_EQ(b.abortOf({0x40, 0x03, 0x10, 0x01, 0, 0, 0, 0}), 0x08000024U);  // no error stored
}

TEST(DriveDamiao, ItsNodeIdIsTheSavedValueOf2003hFromTheNextResetOn) {
  Damiao b;
  EXPECT_EQ(b.read(0x2003, 1), 1U);
  b.write(0x2003, 1, 5, 4);
  b.nmt(0x81);  // reset node: nothing was saved
  b.run(ms(100));
  EXPECT_EQ(b.drive->device().node(), 1);
  b.write(0x2003, 1, 5, 4);
  b.write(0x1010, 1, 0x65766173, 4);  // "save"
  b.run(ms(100));
  EXPECT_EQ(b.drive->device().node(), 1) << "not before the reset";
  b.nmt(0x81);
  b.sent.clear();
  b.run(ms(100));
  EXPECT_EQ(b.drive->device().node(), 5);
  ASSERT_FALSE(b.sent.empty());
  EXPECT_EQ(b.sent[0].id, 0x705U) << "boot-up";
  EXPECT_EQ(b.drive->dictionary().find({0x1400, 1})->number, 0x205U) << "as all that depends on it";
  EXPECT_EQ(b.drive->dictionary().find({0x2003, 1})->number, 5U);
}

TEST(DriveDamiao, GoesThroughTheStatuswordsOfTheManual) {
  Damiao b;
  EXPECT_EQ(b.word(), 0x0250);
  b.control(0x0006);
  EXPECT_EQ(b.word(), 0x0231);
  b.control(0x0007);
  EXPECT_EQ(b.word(), 0x0233);
  b.control(0x000F);
  EXPECT_EQ(b.word(), 0x0237);
  b.control(0x0000);
  EXPECT_EQ(b.word(), 0x0250);
  b.control(0x000F);  // printed as a start by itself, contradicting the state table
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveDamiao, ModeIsSixteenBitsWide) {
  Damiao b;
  EXPECT_EQ(b.abortOf({0x2F, 0x60, 0x60, 0x00, 0x01, 0, 0, 0}), 0x06070010U);
  EXPECT_EQ(b.sdo({0x2B, 0x60, 0x60, 0x00, 0x06, 0, 0, 0})[0], 0x60);
  const auto answer = b.sdo({0x40, 0x61, 0x60, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(answer, (std::vector<std::uint8_t>{0x4B, 0x61, 0x60, 0x00, 0x06, 0x00, 0x00, 0x00}));
  EXPECT_EQ(b.refusal(0x6060, 0, 7, 2), 0x06090030U);
  EXPECT_EQ(b.refusal(0x6060, 0, 8, 2), 0x06090030U);
}

TEST(DriveDamiao, PositionIsTheBitPatternOfRadians) {
  Damiao b(0.5);
  const auto answer = b.sdo({0x40, 0x64, 0x60, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(answer, (std::vector<std::uint8_t>{0x43, 0x64, 0x60, 0x00, 0xDB, 0x0F, 0x49, 0x40}));
  b.mode(2);
  b.write(0x607A, 0, 0x40490FDB, 4);
  b.write(0x60FF, 0, 0x41200000, 4);  // 10 rad/s
  b.enable();
  b.sdo({0x23, 0x7A, 0x60, 0x00, 0xDB, 0x0F, 0x49, 0xC0});  // -pi, no handshake
  b.run(ms(300));
  EXPECT_NEAR(b.readFloat(0x606C), -10.0, 1e-3);
  b.run(ms(1000));
  EXPECT_EQ(b.read(0x6064), 0xC0490FDBU);
  EXPECT_EQ(b.read(0x6041) & 0x1400U, 0x1400U);  // reached, zero speed
}

TEST(DriveDamiao, EnablingWithoutCopyingTheActualPositionDrivesToZero) {
  Damiao b(0.25);
  b.mode(1);
  b.enable();
  b.run(ms(2000));
  EXPECT_EQ(b.drive->truth(b.now).position_turns, 0.0);
}

TEST(DriveDamiao, ModeThreeHasNoTorqueUntilItIsWritten) {
  Damiao b;
  b.mode(3);
  b.write(0x60FF, 0, 0x41200000, 4);
  b.enable();
  b.write(0x607A, 0, 0x3E99999A, 4);  // 0.3 rad, below the following error window
  b.run(ms(500));
  EXPECT_EQ(b.read(0x6064), 0U);
  b.write(0x6071, 0, 0x3F800000, 4);  // 1 N m
  b.run(ms(1000));
  EXPECT_EQ(b.read(0x6064), 0x3E99999AU);
}

TEST(DriveDamiao, ModeThreeIsPositionNotTheStandardsVelocity) {
  Damiao b;
  b.mode(3);
  b.write(0x6071, 0, 0x40000000, 4);
  b.enable();
  b.write(0x60FF, 0, 0x41200000, 4);
  b.run(ms(500));
  EXPECT_EQ(b.read(0x606C), 0U);
}

TEST(DriveDamiao, VelocityReportsReachedAndZeroSpeed) {
  Damiao b;
  b.spin();
  b.run(ms(200));
  EXPECT_EQ(b.read(0x6041) & 0x1400U, 0x0400U);
  b.write(0x60FF, 0, 0x00000000, 4);
  b.run(ms(500));
  EXPECT_EQ(b.read(0x6041) & 0x1400U, 0x1400U);
}

TEST(DriveDamiao, TorqueModeDoesNotTurnUntilItHasASpeedLimit) {
  Damiao b;
  b.mode(6);
  b.enable();
  b.sdo({0x23, 0x71, 0x60, 0x00, 0x9A, 0x99, 0x99, 0x3E});  // 0.3 N m
  b.run(ms(500));
  EXPECT_NEAR(b.readFloat(0x606C), 0.0, 1e-3);
  b.write(0x60FF, 0, 0x41200000, 4);
  b.run(ms(2000));
  EXPECT_NEAR(b.readFloat(0x606C), 10.0, 0.1);
}

TEST(DriveDamiao, HaltDoesNotExist) {
  Damiao b;
  b.spin();
  b.control(0x010F);
  b.run(ms(500));
  EXPECT_NEAR(b.readFloat(0x606C), 10.0, 1e-3);
}

TEST(DriveDamiao, QuickStopOptionsThreeAndFourHoldThePosition) {
  for (const int option : {1, 2, 3, 4}) {
    Damiao b;
    b.write(0x605A, 0, static_cast<std::uint32_t>(option), 2);
    b.write(0x6084, 0, 0x41200000, 4);  // 10 rad/s^2: 1 s
    b.write(0x6085, 0, 0x41A00000, 4);  // 20 rad/s^2: 0.5 s
    b.spin();
    b.sdo({0x2B, 0x40, 0x60, 0x00, 0x02, 0x00, 0, 0});
    EXPECT_EQ(b.word(), 0x0217) << option;
    b.control(0x000F);  // only "after the stop has ended"
    EXPECT_EQ(b.word(), 0x0217) << option;
    b.run(ms(450));
    const bool by_6084 = option == 1 || option == 3;
    EXPECT_NEAR(b.readFloat(0x606C), by_6084 ? 5.4 : 0.8, 0.2) << option;
    b.run(ms(700));
    const bool holds = option >= 3;
    EXPECT_EQ(b.word(), holds ? 0x0217 : 0x0250) << option;
    EXPECT_EQ(b.drive->truth(b.now).power_stage_on, holds) << option;
    if (holds) {
      b.control(0x000F);
      EXPECT_EQ(b.word(), 0x0237) << option;
    }
  }
}

TEST(DriveDamiao, QuickStopWithTheFactorysOptionZeroCoasts) {
  Damiao b;
  b.spin();
  b.control(0x0002);
  EXPECT_EQ(b.word(), 0x0250);
  EXPECT_GT(b.readFloat(0x606C), 9.0);
}

TEST(DriveDamiao, NotANumberInfinityAndNegativeZeroAreFaults) {
  for (const std::uint32_t bits :
       {0x7FC00000U, 0xFFFFFFFFU, 0x7F800000U, 0xFF800000U, 0x80000000U}) {
    Damiao b;
    b.mode(4);
    b.enable();
    b.write(0x60FF, 0, bits, 4);
    b.run(ms(10));
    EXPECT_EQ(b.word(), 0x0218) << std::hex << bits;
    EXPECT_EQ(b.read(0x603F), 0xFF01U);
    EXPECT_EQ(b.drive->truth(b.now).bad_floats_received, 1U);
    EXPECT_EQ(b.velocity(), 0);
  }
}

TEST(DriveDamiao, WarningStopsItAndNeedsAReset) {
  Damiao b;
  b.spin();
  ASSERT_TRUE(b.drive->inject("overtemperature_warning", b.now).ok());
  b.run(ms(100));
  EXPECT_EQ(b.word(), 0x0298);
  b.sdo({0x2B, 0x40, 0x60, 0x00, 0x80, 0x00, 0, 0});
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveDamiao, ClearsErrorsByItsVendorObject) {
  Damiao b;
  ASSERT_TRUE(b.drive->inject("encoder", b.now).ok());
  EXPECT_EQ(b.word(), 0x0218);
  b.write(0x200B, 1, 1, 4);
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveDamiao, LosingTheMasterChangesNothingOutOfTheBox) {
  Damiao b;
  b.nmt(0x01);
  b.write(0x1016, 1, 0x007F0064, 4);
  b.frame(0x77F, {0x05});
  b.spin();
  b.run(ms(500));
  EXPECT_EQ(b.word(), 0x0237);
  EXPECT_NEAR(b.readFloat(0x606C), 10.0, 1e-3);
}

TEST(DriveDamiao, StopsWhenTheErrorBehaviourTakesItOutOfOperational) {
  Damiao b;
  b.write(0x1029, 1, 0, 1);
  b.nmt(0x01);
  b.spin();
  b.write(0x1016, 1, 0x007F0064, 4);
  b.frame(0x77F, {0x05});
  b.run(ms(500));
  EXPECT_EQ(b.word(), 0x0250);
  EXPECT_EQ(b.readFloat(0x606C), 0.0);
}

TEST(DriveDamiao, PlainSyncIsIgnoredWhileItsCounterIsOn) {
  Damiao b;
  b.write(0x1A00, 1, 0x60410010, 4);
  b.write(0x1A00, 0, 1, 1);
  b.write(0x1800, 1, 0x00000181, 4);
  b.nmt(0x01);
  b.sent.clear();
  b.sync();
  b.run(ms(2));
  for (const can::Frame& f : b.sent) EXPECT_NE(f.id, 0x181U);
  b.frame(0x080, {0x01});
  b.run(ms(2));
  EXPECT_EQ(b.sent.back(), can::Frame(0x181, {0x50, 0x02}));
}

TEST(DriveDamiao, KeepsParametersAndModeLockedWhileEnabled) {
  Damiao b;
  b.mode(4);
  b.enable();
  EXPECT_EQ(b.refusal(0x6083, 0, 0x41A00000, 4), 0x08000022U);
  EXPECT_EQ(b.refusal(0x6060, 0, 1, 2), 0x08000022U);
  EXPECT_EQ(b.refusal(0x6060, 0, 4, 2), 0U);
  EXPECT_EQ(b.refusal(0x200B, 2, 1, 4), 0x08000022U);
  b.control(0x0000);
  EXPECT_EQ(b.refusal(0x6083, 0, 0x41A00000, 4), 0U);
  EXPECT_EQ(b.refusal(0x6060, 0, 1, 2), 0U);
}

TEST(DriveDamiao, SavesZeroAndKeepsItWithoutPower) {
  Damiao b(0.25);
  b.write(0x200B, 2, 1, 4);
  EXPECT_EQ(b.read(0x6064), 0U);
  ASSERT_TRUE(b.drive->inject("power_cycle", b.now).ok());
  b.run(ms(700));
  EXPECT_EQ(b.read(0x6064), 0U);
  EXPECT_EQ(b.drive->truth(b.now).position_turns, 0.25);
}

TEST(DriveDamiao, StoresParametersOnlyWithTheSignature) {
  Damiao b;
  b.write(0x6083, 0, 0x41A00000, 4);
  EXPECT_EQ(b.refusal(0x1010, 1, 1, 4), 0x08000020U);
  EXPECT_EQ(b.sdo({0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65})[0], 0x60);
  EXPECT_EQ(b.read(0x1010, 1), 1U);
  b.write(0x6084, 0, 0x41A00000, 4);
  b.nmt(0x81);
  b.run(ms(100));
  EXPECT_EQ(b.read(0x6083), 0x41A00000U);
  EXPECT_EQ(b.read(0x6084), 0x44FA0000U);
  EXPECT_EQ(b.sdo({0x23, 0x11, 0x10, 0x01, 0x6C, 0x6F, 0x61, 0x64})[0], 0x60);
  EXPECT_EQ(b.read(0x6083), 0x41A00000U);  // until the reset
  b.nmt(0x81);
  b.run(ms(100));
  EXPECT_EQ(b.read(0x6083), 0x44FA0000U);
}

}  // namespace
}  // namespace cia402::sim
