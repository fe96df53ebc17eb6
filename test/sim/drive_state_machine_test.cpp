// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// State machine of the simulated drive, seen through SDO bytes (CiA 402-2, finite state automaton).
#include "drive_fixture.h"

namespace cia402::sim {
namespace {

constexpr std::uint16_t kMask = 0x03FF;  // bits 0-9, as the tables print them

struct MachineBench : DriveBench {
  explicit MachineBench(const AxisMechanics& mechanics = {})
      : DriveBench("generic_cia402", mechanics) {}
  int word() { return static_cast<int>(read(0x6041)) & kMask; }
  // Runs at 1 turn/s in profile velocity mode.
  void spin() {
    write(0x6060, 0, 3, 1);
    write(0x60FF, 0, 131072, 4);
    enable();
    run(ms(300));
    ASSERT_NEAR(velocity(), 131072, 10);
  }
};

TEST(DriveStateMachine, GoesThroughAllCommandedTransitionsAndBack) {
  MachineBench b;
  EXPECT_EQ(b.word(), 0x0250);  // 1
  b.control(0x0006);
  EXPECT_EQ(b.word(), 0x0231);  // 2
  b.control(0x0007);
  EXPECT_EQ(b.word(), 0x0233);  // 3
  b.control(0x000F);
  EXPECT_EQ(b.word(), 0x0237);  // 4
  b.control(0x0007);
  b.run(ms(5));
  EXPECT_EQ(b.word(), 0x0233);  // 5
  b.control(0x0006);
  EXPECT_EQ(b.word(), 0x0231);  // 6
  b.control(0x0000);
  EXPECT_EQ(b.word(), 0x0250);  // 7, disable voltage
  b.enable();
  b.control(0x0006);
  EXPECT_EQ(b.word(), 0x0231);  // 8
  b.control(0x0002);
  EXPECT_EQ(b.word(), 0x0250);  // 7, quick stop
  b.enable();
  b.control(0x0000);
  EXPECT_EQ(b.word(), 0x0250);  // 9
  b.control(0x0006);
  b.control(0x0007);
  b.control(0x0000);
  EXPECT_EQ(b.word(), 0x0250);  // 10, disable voltage
  b.control(0x0006);
  b.control(0x0007);
  b.control(0x0002);
  EXPECT_EQ(b.word(), 0x0250);  // 10, quick stop
}

TEST(DriveStateMachine, EnablesInOneStepFromReadyToSwitchOn) {
  MachineBench b;
  b.control(0x0006);
  b.control(0x000F);
  EXPECT_EQ(b.word(), 0x0237);  // 3 and 4
}

TEST(DriveStateMachine, ShutdownDoesNotCareAboutBitThree) {
  MachineBench b;
  b.control(0x000E);
  EXPECT_EQ(b.word(), 0x0231);
}

TEST(DriveStateMachine, IgnoresCommandsThatMeanNothingInAState) {
  MachineBench b;
  for (const int word : {0x0007, 0x000F, 0x0002, 0x0000, 0x0080}) {
    b.control(static_cast<std::uint16_t>(word));
    EXPECT_EQ(b.word(), 0x0250) << std::hex << word;
  }
  b.control(0x0086);  // bit 7 forbids everything else
  EXPECT_EQ(b.word(), 0x0250);
  b.control(0x0006);
  EXPECT_EQ(b.word(), 0x0231);
  b.control(0x0007);
  b.control(0x0087);
  EXPECT_EQ(b.word(), 0x0233);
}

TEST(DriveStateMachine, QuickStopSlowsDownBy6085AndDisables) {
  MachineBench b;
  b.write(0x6085, 0, 262144, 4);  // 2 turns/s^2: half a second from 1 turn/s
  b.spin();
  b.control(0x0002);
  EXPECT_EQ(b.word(), 0x0217);  // 11
  b.run(ms(400));
  EXPECT_EQ(b.word(), 0x0217);
  EXPECT_NEAR(b.velocity(), 26214, 3000);  // 0.2 turns/s left
  b.run(ms(200));
  EXPECT_EQ(b.word(), 0x0250);  // 12
  EXPECT_EQ(b.velocity(), 0);
}

TEST(DriveStateMachine, QuickStopOptionSixStaysAndResumes) {
  MachineBench b;
  b.write(0x605A, 0, 6, 2);
  b.spin();
  b.control(0x0002);
  b.run(ms(500));
  EXPECT_EQ(b.word(), 0x0217);
  EXPECT_TRUE(b.drive->truth(b.now).power_stage_on);
  b.control(0x000F);
  EXPECT_EQ(b.word(), 0x0237);  // 16
  b.run(ms(500));
  EXPECT_NEAR(b.velocity(), 131072, 10);
  b.control(0x0002);
  b.control(0x0000);
  EXPECT_EQ(b.word(), 0x0250);  // 12, disable voltage
}

TEST(DriveStateMachine, QuickStopOptionTwoCannotBeResumed) {
  MachineBench b;
  b.write(0x6085, 0, 262144, 4);
  b.spin();
  b.control(0x0002);
  b.control(0x000F);
  EXPECT_EQ(b.word(), 0x0217);
  b.run(ms(1000));
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveStateMachine, QuickStopOptionZeroCoasts) {
  MachineBench b;
  b.write(0x605A, 0, 0, 2);
  b.spin();
  b.control(0x0002);
  EXPECT_EQ(b.word(), 0x0250);
  EXPECT_FALSE(b.drive->truth(b.now).power_stage_on);
  EXPECT_GT(b.velocity(), 100000);  // only friction brakes
}

TEST(DriveStateMachine, DisableOperationRampsDownByDefaultAndShutdownCoasts) {
  MachineBench b;
  b.write(0x6084, 0, 262144, 4);
  b.spin();
  b.control(0x0007);
  EXPECT_EQ(b.word(), 0x0237);  // still slowing down
  b.run(ms(400));
  EXPECT_TRUE(b.drive->truth(b.now).power_stage_on);
  b.run(ms(200));
  EXPECT_EQ(b.word(), 0x0233);
  b.control(0x000F);
  b.run(ms(500));
  b.control(0x0006);
  EXPECT_EQ(b.word(), 0x0231);
  EXPECT_FALSE(b.drive->truth(b.now).power_stage_on);
  EXPECT_GT(b.velocity(), 60000);
}

TEST(DriveStateMachine, ShutdownOptionOneRampsAndEnableOperationCancelsIt) {
  MachineBench b;
  b.write(0x605B, 0, 1, 2);
  b.write(0x6084, 0, 262144, 4);
  b.spin();
  b.control(0x0006);
  b.run(ms(100));
  EXPECT_EQ(b.word(), 0x0237);
  b.control(0x000F);
  b.run(ms(500));
  EXPECT_EQ(b.word(), 0x0237);
  EXPECT_NEAR(b.velocity(), 131072, 10);
  b.control(0x0006);
  b.run(ms(600));
  EXPECT_EQ(b.word(), 0x0231);
}

TEST(DriveStateMachine, HaltStopsInOperationEnabledAndReleases) {
  MachineBench b;
  b.spin();
  b.control(0x010F);
  b.run(ms(300));
  EXPECT_EQ(b.word(), 0x0237);
  EXPECT_EQ(b.velocity(), 0);
  EXPECT_EQ(b.read(0x6041) & 0x0400U, 0x0400U);  // pv with halt: bit 10 = stands
  b.control(0x000F);
  b.run(ms(300));
  EXPECT_NEAR(b.velocity(), 131072, 10);
}

TEST(DriveStateMachine, FaultReactionDeceleratesThenFault) {
  MachineBench b;
  b.write(0x6085, 0, 262144, 4);
  b.spin();
  ASSERT_TRUE(b.drive->inject("overtemperature", b.now).ok());
  EXPECT_EQ(b.word(), 0x021F);  // 13
  EXPECT_EQ(b.read(0x603F), 0x4210U);
  EXPECT_EQ(b.emergencies().back(), std::make_pair(0x4210, 0x09));
  b.run(ms(600));
  EXPECT_EQ(b.word(), 0x0218);  // 14
  EXPECT_EQ(b.velocity(), 0);
}

TEST(DriveStateMachine, FaultThatBreaksTheStageCoastsAtOnce) {
  MachineBench b;
  b.spin();
  ASSERT_TRUE(b.drive->inject("overcurrent", b.now).ok());
  EXPECT_EQ(b.word(), 0x0218);
  EXPECT_FALSE(b.drive->truth(b.now).power_stage_on);
  EXPECT_GT(b.velocity(), 100000);
  EXPECT_EQ(b.emergencies().back(), std::make_pair(0x2310, 0x03));
}

TEST(DriveStateMachine, ResetsAFaultOnlyOnARisingEdgeOfBitSeven) {
  MachineBench b;
  b.control(0x0080);  // bit 7 is set already when the fault comes
  ASSERT_TRUE(b.drive->inject("encoder", b.now).ok());
  EXPECT_EQ(b.word(), 0x0218);
  b.control(0x0080);
  EXPECT_EQ(b.word(), 0x0218);
  b.control(0x000F);
  EXPECT_EQ(b.word(), 0x0218);
  b.control(0x0080);
  EXPECT_EQ(b.word(), 0x0250);  // 15
  EXPECT_EQ(b.read(0x603F), 0U);
  EXPECT_EQ(b.read(0x1001), 0U);
  EXPECT_EQ(b.emergencies().back(), std::make_pair(0, 0));
  b.control(0x0086);
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveStateMachine, RefusesTheResetWhileTheCauseLasts) {
  MachineBench b;
  ASSERT_TRUE(b.drive->inject("overtemperature", b.now).ok());  // lasts 1 s
  const auto before = b.emergencies().size();
  b.control(0x0080);
  EXPECT_EQ(b.word(), 0x0218);
  EXPECT_EQ(b.emergencies().size(), before + 1);
  EXPECT_EQ(b.read(0x603F), 0x4210U);
  b.run(ms(1000));
  b.control(0x0000);
  b.control(0x0080);
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveStateMachine, FaultThatNeedsAPowerCycleStaysUntilThen) {
  MachineBench b;
  ASSERT_TRUE(b.drive->inject("hardware", b.now).ok());
  b.run(ms(5000));
  b.control(0x0080);
  EXPECT_EQ(b.word(), 0x0218);
  ASSERT_TRUE(b.drive->inject("power_cycle", b.now).ok());
  b.run(ms(600));
  EXPECT_EQ(b.sent.back().id, 0x701U);  // boot-up
  EXPECT_EQ(b.word(), 0x0250);
}

TEST(DriveStateMachine, UndervoltageTakesTheVoltageBitAway) {
  MachineBench b;
  ASSERT_TRUE(b.drive->inject("undervoltage", b.now).ok());
  EXPECT_EQ(b.word(), 0x0208);
  b.run(ms(200));
  EXPECT_EQ(b.word(), 0x0218);
}

TEST(DriveStateMachine, WarningSetsBitSevenAndBitSevenClearsIt) {
  MachineBench b;
  b.enable();
  ASSERT_TRUE(b.drive->inject("overtemperature_warning", b.now).ok());
  EXPECT_EQ(b.word(), 0x02B7);
  b.control(0x008F);
  EXPECT_EQ(b.word(), 0x0237);
}

TEST(DriveStateMachine, WarningEndsWithWhatItWarnsOf) {
  MachineBench b;
  b.enable();
  ASSERT_TRUE(b.drive->inject("overtemperature_warning", b.now).ok());
  EXPECT_EQ(b.word(), 0x02B7);
  EXPECT_EQ(b.read(0x603F), 0x4210U);
  ASSERT_TRUE(b.drive->inject("clear", b.now).ok());
  EXPECT_EQ(b.word(), 0x0237);
  EXPECT_EQ(b.read(0x603F), 0U);
  EXPECT_EQ(b.read(0x1001), 0U);
}

TEST(DriveStateMachine, UnknownFaultNamesTheKnownOnes) {
  MachineBench b;
  const auto refused = b.drive->inject("gremlin", b.now);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("overcurrent"), std::string::npos);
  ASSERT_TRUE(b.drive->inject("0x7305", b.now).ok());
  EXPECT_EQ(b.read(0x603F), 0x7305U);
  EXPECT_FALSE(b.drive->inject("0xZZ", b.now).ok());
}

TEST(DriveStateMachine, LostHeartbeatOfTheMasterStopsByTheQuickStopRampThenFault) {
  MachineBench b;
  b.write(0x6085, 0, 262144, 4);
  b.nmt(0x01);
  b.spin();
  b.write(0x1016, 1, 0x007F0064, 4);  // node 127 within 100 ms
  for (int i = 0; i < 6; ++i) {
    b.frame(0x77F, {0x05});
    b.run(ms(50));
  }
  EXPECT_EQ(b.word(), 0x0237);
  b.run(ms(70));
  EXPECT_EQ(b.word(), 0x021F);
  EXPECT_EQ(b.read(0x603F), 0x8130U);
  b.run(ms(600));
  EXPECT_EQ(b.word(), 0x0218);
  EXPECT_EQ(b.velocity(), 0);
}

TEST(DriveStateMachine, AbortConnectionOptionZeroGoesOnWhateverHappensToTheMaster) {
  MachineBench b;
  b.write(0x6007, 0, 0, 2);
  b.write(0x1029, 1, 1, 1);  // no change of NMT state
  b.write(0x1016, 1, 0x007F0064, 4);
  b.nmt(0x01);
  b.frame(0x77F, {0x05});
  b.enable();
  b.run(ms(500));
  EXPECT_EQ(b.word(), 0x0237);
}

TEST(DriveStateMachine, LeavingOperationalStopsAndDisables) {
  MachineBench b;
  b.write(0x6085, 0, 262144, 4);
  b.nmt(0x01);
  b.spin();
  b.nmt(0x80);
  EXPECT_EQ(b.word(), 0x0217);
  b.run(ms(600));
  EXPECT_EQ(b.word(), 0x0250);
  EXPECT_EQ(b.velocity(), 0);
}

TEST(DriveStateMachine, ResultDoesNotDependOnHowOftenItIsTicked) {
  MachineBench often;
  MachineBench seldom;
  for (MachineBench* b : {&often, &seldom}) {
    b->write(0x6060, 0, 3, 1);
    b->write(0x60FF, 0, 131072, 4);
    b->enable();
  }
  ASSERT_EQ(often.now, seldom.now);
  for (int i = 0; i < 4000; ++i) {
    often.now += std::chrono::microseconds(100);
    often.drive->tick(often.now);
  }
  seldom.now += ms(400);
  EXPECT_EQ(often.drive->truth(often.now).position_turns,
            seldom.drive->truth(seldom.now).position_turns);
}

TEST(DriveStateMachine, RefusesUnsupportedModesBySdoAndIgnoresThemByPdo) {
  MachineBench b;
  b.write(0x6060, 0, 3, 1);
  EXPECT_EQ(b.abortOf({0x2F, 0x60, 0x60, 0x00, 0x05, 0, 0, 0}), 0x06090030U);
  EXPECT_EQ(b.read(0x6061) & 0xFFU, 3U);
  b.nmt(0x01);
  b.frame(0x301, {0x06, 0x00, 0x05});  // RPDO2: controlword, mode
  EXPECT_EQ(b.read(0x6061) & 0xFFU, 3U);
  EXPECT_EQ(b.state(), 0x21);
  b.frame(0x301, {0x06, 0x00, 0x08});
  EXPECT_EQ(b.read(0x6061) & 0xFFU, 8U);
  EXPECT_EQ(b.read(0x6502), 0x000003EFU);
}

TEST(DriveStateMachine, SendsItsStatusByTpdoWhenItChanges) {
  MachineBench b;
  b.nmt(0x01);
  b.run(ms(2));
  b.sent.clear();
  b.frame(0x201, {0x06, 0x00});
  b.run(ms(2));
  ASSERT_EQ(b.sent.size(), 1U);
  EXPECT_EQ(b.sent[0], can::Frame(0x181, {0x31, 0x02}));
}

}  // namespace
}  // namespace cia402::sim
