// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive_fixture.h"
#include "folders.h"
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::milliseconds;

/// A device without node-ID; vendor 0x11223344, product 0x00000402, revision 0x00010002, serial
/// 0x0000A5F0.
class SlaveLssTest : public testing_support::SlaveTest {
 protected:
  explicit SlaveLssTest(canopen::NodeId node = 255)
      : lss_device(node, sink, dictionary, behaviour, application) {
    add(0x1018, 0, DataType::uint8, Access::constant, 4);
    add(0x1018, 1, DataType::uint32, Access::ro, 0x11223344);
    add(0x1018, 2, DataType::uint32, Access::ro, 0x00000402);
    add(0x1018, 3, DataType::uint32, Access::ro, 0x00010002);
    add(0x1018, 4, DataType::uint32, Access::ro, 0x0000A5F0);
  }
  void start() {
    lss_device.behaviour() = behaviour;
    lss_device.powerOn(now);
    pass(milliseconds(50));
  }
  void pass(Duration duration) {
    const Time end = now + duration;
    while (lss_device.nextEvent() <= end) {
      now = std::max(now, lss_device.nextEvent());
      lss_device.tick(now);
    }
    now = end;
  }
  void frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    lss_device.receive(can::Frame(id, bytes), now);
  }
  /// Sends a request of the LSS master. @return the frames it causes at once.
  std::vector<std::string> ask(std::initializer_list<std::uint8_t> bytes) {
    sink.frames.clear();
    frame(0x7E5, bytes);
    return sent();
  }
  void configure() { ask({0x04, 1, 0, 0, 0, 0, 0, 0}); }
  void wait() { ask({0x04, 0, 0, 0, 0, 0, 0, 0}); }
  void powerCycle() {
    lss_device.powerOff();
    start();
  }

  Device lss_device;
};

class ConfiguredSlaveLssTest : public SlaveLssTest {
 protected:
  ConfiguredSlaveLssTest() : SlaveLssTest(1) {}
};

TEST_F(SlaveLssTest, WithoutANodeIdNothingLeavesAndOnlyLssIsHeard) {
  start();
  pass(milliseconds(5000));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(lss_device.nmtState(), canopen::NmtState::boot_up);
  EXPECT_EQ(lss_device.node(), 255);
  frame(0x000, {0x01, 0x00});
  frame(0x6FF, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(lss_device.nmtState(), canopen::NmtState::boot_up);
}

TEST_F(SlaveLssTest, IsDeafUntilItHasStarted) {
  lss_device.powerOn(now);
  pass(milliseconds(19));
  EXPECT_THAT(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  pass(milliseconds(1));
  EXPECT_THAT(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 50 00 00 00 00 00 00 00"));
}

TEST_F(SlaveLssTest, SwitchesSelectivelyByItsFourNumbers) {
  start();
  EXPECT_THAT(ask({0x40, 0x44, 0x33, 0x22, 0x11, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x41, 0x02, 0x04, 0x00, 0x00, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x42, 0x02, 0x00, 0x01, 0x00, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x5A, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  // The inquiry did not disturb the sequence.
  EXPECT_THAT(ask({0x43, 0xF0, 0xA5, 0x00, 0x00, 0, 0, 0}),
              ElementsAre("7E4 44 00 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x5A, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5A 44 33 22 11 00 00 00"));
}

TEST_F(SlaveLssTest, AnotherSerialNumberOrALostFrameSelectsNobody) {
  start();
  ask({0x40, 0x44, 0x33, 0x22, 0x11, 0, 0, 0});
  ask({0x41, 0x02, 0x04, 0x00, 0x00, 0, 0, 0});
  ask({0x42, 0x02, 0x00, 0x01, 0x00, 0, 0, 0});
  EXPECT_THAT(ask({0x43, 0xF1, 0xA5, 0x00, 0x00, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x43, 0xF0, 0xA5, 0x00, 0x00, 0, 0, 0}), IsEmpty());
  ask({0x40, 0x44, 0x33, 0x22, 0x11, 0, 0, 0});
  ask({0x42, 0x02, 0x00, 0x01, 0x00, 0, 0, 0});
  EXPECT_THAT(ask({0x43, 0xF0, 0xA5, 0x00, 0x00, 0, 0, 0}), IsEmpty());
}

TEST_F(SlaveLssTest, ADeviceThatIsSelectedDoesNotAnswerASelection) {
  start();
  configure();
  ask({0x40, 0x44, 0x33, 0x22, 0x11, 0, 0, 0});
  ask({0x41, 0x02, 0x04, 0x00, 0x00, 0, 0, 0});
  ask({0x42, 0x02, 0x00, 0x01, 0x00, 0, 0, 0});
  EXPECT_THAT(ask({0x43, 0xF0, 0xA5, 0x00, 0x00, 0, 0, 0}), IsEmpty());
}

TEST_F(SlaveLssTest, ConfigurationServicesWorkOnlyInLssConfiguration) {
  start();
  for (const int number : {0x11, 0x13, 0x17, 0x5A, 0x5B, 0x5C, 0x5D, 0x5E}) {
    const auto command = static_cast<std::uint8_t>(number);
    EXPECT_THAT(ask({command, 5, 0, 0, 0, 0, 0, 0}), IsEmpty()) << number;
  }
}

TEST_F(SlaveLssTest, TellsItsIdentity) {
  start();
  configure();
  EXPECT_THAT(ask({0x5A, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5A 44 33 22 11 00 00 00"));
  EXPECT_THAT(ask({0x5B, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5B 02 04 00 00 00 00 00"));
  EXPECT_THAT(ask({0x5C, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5C 02 00 01 00 00 00 00"));
  EXPECT_THAT(ask({0x5D, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5D F0 A5 00 00 00 00 00"));
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5E FF 00 00 00 00 00 00"));
}

TEST_F(SlaveLssTest, BootsByItselfWithItsFirstNodeIdWhenLssIsLeft) {
  start();
  configure();
  EXPECT_THAT(ask({0x11, 0x07, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5E 07 00 00 00 00 00 00"));
  pass(milliseconds(1000));
  EXPECT_THAT(sent(), IsEmpty());
  wait();
  pass(milliseconds(19));
  EXPECT_THAT(sent(), IsEmpty());
  pass(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("707 00"));
  EXPECT_EQ(lss_device.nmtState(), canopen::NmtState::pre_operational);
  frame(0x607, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_THAT(sent(), ElementsAre("587 43 00 10 00 92 01 02 00"));
  EXPECT_THAT(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
}

TEST_F(SlaveLssTest, RefusesNodeIdsOutOfRange) {
  start();
  configure();
  EXPECT_THAT(ask({0x11, 0x00, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 11 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x11, 0x80, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 11 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x11, 0x7F, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x11, 0xFF, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
  wait();
  pass(milliseconds(1000));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveLssTest, ForgetsANodeIdThatWasNotStored) {
  start();
  configure();
  ask({0x11, 0x07, 0, 0, 0, 0, 0, 0});
  wait();
  pass(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("707 00"));
  frame(0x000, {0x82, 0x07});  // reset communication keeps it
  pass(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("707 00"));
  powerCycle();
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_THAT(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 50 00 00 00 00 00 00 00"));
}

TEST_F(SlaveLssTest, KeepsAStoredNodeIdOverAPowerCycle) {
  start();
  configure();
  ask({0x11, 0x07, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(ask({0x17, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 17 00 00 00 00 00 00 00"));
  powerCycle();
  EXPECT_THAT(sent(), ElementsAre("707 00"));
}

TEST_F(SlaveLssTest, SaysSoWhereItCannotStore) {
  behaviour.lss_store = false;
  start();
  configure();
  ask({0x11, 0x07, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(ask({0x17, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 17 01 00 00 00 00 00 00"));
  powerCycle();
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveLssTest, IdentifiesItselfWithinRangesOfRevisionAndSerial) {
  start();
  const auto identify = [this](std::uint8_t serial_low, std::uint8_t serial_high) {
    ask({0x46, 0x44, 0x33, 0x22, 0x11, 0, 0, 0});
    ask({0x47, 0x02, 0x04, 0x00, 0x00, 0, 0, 0});
    ask({0x48, 0x00, 0x00, 0x01, 0x00, 0, 0, 0});
    ask({0x49, 0xFF, 0xFF, 0x01, 0x00, 0, 0, 0});
    ask({0x4A, serial_low, 0xA5, 0x00, 0x00, 0, 0, 0});
    return ask({0x4B, serial_high, 0xA5, 0x00, 0x00, 0, 0, 0});
  };
  EXPECT_THAT(identify(0xF0, 0xF0), ElementsAre("7E4 4F 00 00 00 00 00 00 00"));
  EXPECT_THAT(identify(0x00, 0xFF), ElementsAre("7E4 4F 00 00 00 00 00 00 00"));
  EXPECT_THAT(identify(0x00, 0xEF), IsEmpty());
  EXPECT_THAT(identify(0xF1, 0xFF), IsEmpty());
  ask({0x46, 0x44, 0x33, 0x22, 0x11, 0, 0, 0});
  ask({0x47, 0x02, 0x04, 0x00, 0x00, 0, 0, 0});
  ask({0x48, 0x03, 0x00, 0x01, 0x00, 0, 0, 0});  // the lowest revision is above ours
  ask({0x49, 0xFF, 0xFF, 0x01, 0x00, 0, 0, 0});
  ask({0x4A, 0x00, 0xA5, 0x00, 0x00, 0, 0, 0});
  EXPECT_THAT(ask({0x4B, 0xFF, 0xA5, 0x00, 0x00, 0, 0, 0}), IsEmpty());
  configure();  // works there, too
  EXPECT_THAT(identify(0xF0, 0xF0), ElementsAre("7E4 4F 00 00 00 00 00 00 00"));
}

// Bytes 1 to 4 number, 5 bit, 6 number asked for, 7 number asked for next.
TEST_F(SlaveLssTest, FastscanFindsEveryBitAndSelects) {
  const auto yes = ElementsAre("7E4 4F 00 00 00 00 00 00 00");
  start();
  EXPECT_THAT(ask({0x51, 0, 0, 0, 0, 0x80, 0, 0}), yes);
  // Vendor 0x11223344: bit 31 is 0, bits 31..28 are 0001.
  EXPECT_THAT(ask({0x51, 0x00, 0x00, 0x00, 0x00, 31, 0, 0}), yes);
  EXPECT_THAT(ask({0x51, 0x00, 0x00, 0x00, 0x80, 31, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0x00, 0x00, 0x00, 0x00, 28, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0x00, 0x00, 0x00, 0x10, 28, 0, 0}), yes);
  EXPECT_THAT(ask({0x51, 0xFF, 0xFF, 0xFF, 0x1F, 28, 0, 0}), yes);  // lower bits do not count
  EXPECT_THAT(ask({0x51, 0x45, 0x33, 0x22, 0x11, 0, 0, 1}), IsEmpty());
  // The whole number is known, but the scan stays with it: nobody is selected.
  EXPECT_THAT(ask({0x51, 0x44, 0x33, 0x22, 0x11, 0, 0, 0}), yes);
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  // The product is not asked for yet.
  EXPECT_THAT(ask({0x51, 0x02, 0x04, 0x00, 0x00, 0, 1, 2}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0x44, 0x33, 0x22, 0x11, 0, 0, 1}), yes);
  EXPECT_THAT(ask({0x51, 0x44, 0x33, 0x22, 0x11, 0, 0, 1}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0x02, 0x04, 0x00, 0x00, 0, 1, 2}), yes);
  EXPECT_THAT(ask({0x51, 0x02, 0x00, 0x01, 0x00, 0, 2, 3}), yes);
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0xF0, 0xA5, 0x00, 0x00, 0, 3, 0}), yes);
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5E FF 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x51, 0, 0, 0, 0, 0x80, 0, 0}), IsEmpty());  // selected: no longer scanned
}

TEST_F(SlaveLssTest, AScanThatBeginsAnewForgetsTheOldOne) {
  start();
  ask({0x51, 0, 0, 0, 0, 0x80, 0, 0});
  ask({0x51, 0x44, 0x33, 0x22, 0x11, 0, 0, 1});
  ask({0x51, 0, 0, 0, 0, 0x80, 0, 0});
  EXPECT_THAT(ask({0x51, 0x02, 0x04, 0x00, 0x00, 0, 1, 2}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0x00, 0x00, 0x00, 0x00, 31, 0, 0}), testing::SizeIs(1));
  EXPECT_THAT(ask({0x51, 0x00, 0x00, 0x00, 0x00, 32, 0, 0}), IsEmpty());
}

TEST_F(SlaveLssTest, IgnoresFramesOfAnotherFormAndRemoteOnes) {
  start();
  EXPECT_THAT(ask({0x4C, 0, 0, 0, 0, 0, 0}), IsEmpty());
  can::Frame remote(0x7E5, {0x4C, 0, 0, 0, 0, 0, 0, 0});
  remote.remote = true;
  lss_device.receive(remote, now);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_THAT(ask({0x04, 2, 0, 0, 0, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
}

TEST_F(ConfiguredSlaveLssTest, TakesANewNodeIdWithTheNextResetOfCommunication) {
  start();
  EXPECT_THAT(sent(), ElementsAre("701 00"));
  EXPECT_THAT(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(ask({0x51, 0, 0, 0, 0, 0x80, 0, 0}), IsEmpty());
  configure();
  ask({0x11, 0x05, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5E 01 00 00 00 00 00 00"));
  wait();
  pass(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
  frame(0x000, {0x82, 0x01});
  pass(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("705 00"));
  frame(0x000, {0x81, 0x05});  // reset node: only what is stored counts
  pass(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("701 00"));
}

TEST_F(ConfiguredSlaveLssTest, ChangesItsBitRateAfterTwiceTheDelay) {
  lss_device.setBusBitrate(1000000);
  start();
  configure();
  forget();
  EXPECT_THAT(ask({0x13, 0, 5, 0, 0, 0, 0, 0}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 0, 9, 0, 0, 0, 0, 0}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 1, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 13 00 00 00 00 00 00 00"));
  // 1 Mbit/s, which the bus has: silent for 2 * 20 ms.
  EXPECT_THAT(ask({0x15, 20, 0, 0, 0, 0, 0, 0}), IsEmpty());
  pass(milliseconds(39));
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  pass(milliseconds(1));
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 5E 01 00 00 00 00 00 00"));
  // 500 kbit/s, which the bus has not: gone until the power cycle, for it was not stored.
  ask({0x13, 0, 2, 0, 0, 0, 0, 0});
  ask({0x15, 20, 0, 0, 0, 0, 0, 0});
  pass(milliseconds(100));
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
  powerCycle();
  EXPECT_THAT(sent(), ElementsAre("701 00"));
}

TEST_F(ConfiguredSlaveLssTest, AStoredBitRateOfAnotherBusLeavesItMute) {
  lss_device.setBusBitrate(1000000);
  start();
  configure();
  ask({0x13, 0, 4, 0, 0, 0, 0, 0});
  ask({0x17, 0, 0, 0, 0, 0, 0, 0});
  powerCycle();
  EXPECT_THAT(sent(), IsEmpty());
  lss_device.setBusBitrate(125000);
  powerCycle();
  EXPECT_THAT(sent(), ElementsAre("701 00"));
}

TEST_F(ConfiguredSlaveLssTest, ADeviceWithoutBitTimingServiceSaysSo) {
  behaviour.lss_bit_timing = false;
  start();
  configure();
  forget();
  EXPECT_THAT(ask({0x13, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  ask({0x15, 20, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), testing::SizeIs(1));
}

TEST_F(ConfiguredSlaveLssTest, ADeviceWithoutLssIsSilent) {
  behaviour.lss = false;
  start();
  configure();
  EXPECT_THAT(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
}

TEST(SlaveLss, TheDefaultsOfADriveFollowItsNodeId) {
  const auto definition =
      loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml");
  ASSERT_TRUE(definition.ok());
  testing_support::RecordingSink sink;
  DriveIdentity identity;
  identity.serial = 77;
  Drive drive(definition.value(), 255, sink, {}, identity);
  Time now{};
  const auto run = [&](Duration duration) {
    now += duration;
    drive.tick(now);
  };
  drive.powerOn(now);
  run(ms(100));
  for (const can::Frame& frame : {can::Frame(0x7E5, {0x04, 1, 0, 0, 0, 0, 0, 0}),
                                  can::Frame(0x7E5, {0x5D, 0, 0, 0, 0, 0, 0, 0}),
                                  can::Frame(0x7E5, {0x11, 9, 0, 0, 0, 0, 0, 0}),
                                  can::Frame(0x7E5, {0x04, 0, 0, 0, 0, 0, 0, 0})}) {
    drive.receive(frame, now);
  }
  run(ms(100));
  EXPECT_THAT(sink.frames,
              ElementsAre("7E4 5D 4D 00 00 00 00 00 00", "7E4 11 00 00 00 00 00 00 00", "709 00"));
  EXPECT_EQ(drive.dictionary().find({0x1014, 0})->number, 0x89U);
  EXPECT_EQ(drive.dictionary().find({0x1400, 1})->number, 0x209U);
  EXPECT_EQ(drive.dictionary().find({0x1200, 2})->number, 0x589U);
}

}  // namespace
}  // namespace cia402::sim
