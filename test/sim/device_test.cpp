// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class DeviceTest : public testing_support::SlaveTest {};

TEST_F(DeviceTest, SendsOneBootUpAfterTheBootTimeAndIsPreOperational) {
  behaviour.boot_time = milliseconds(50);
  device.behaviour() = behaviour;
  EXPECT_EQ(device.nmtState(), canopen::NmtState::unknown);
  device.powerOn(now);
  EXPECT_EQ(device.nmtState(), canopen::NmtState::boot_up);
  run(milliseconds(49));
  EXPECT_THAT(sent(), IsEmpty());
  run(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("701 00"));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::pre_operational);
  run(milliseconds(1000));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(device.nextEvent(), kNever);
}

TEST_F(DeviceTest, ObeysNmtCommandsToItselfAndToAll) {
  boot();
  send(0x000, {0x01, 0x01});
  EXPECT_EQ(device.nmtState(), canopen::NmtState::operational);
  send(0x000, {0x02, 0x00});
  EXPECT_EQ(device.nmtState(), canopen::NmtState::stopped);
  send(0x000, {0x80, 0x01});
  EXPECT_EQ(device.nmtState(), canopen::NmtState::pre_operational);
  EXPECT_THAT(application.calls, ElementsAre("state 05", "state 04", "state 7F"));
}

TEST_F(DeviceTest, IgnoresNmtCommandsToOthersOrOfWrongLength) {
  boot();
  send(0x000, {0x01, 0x02});
  send(0x000, {0x01});
  send(0x000, {0x01, 0x01, 0x00});
  send(0x000, {0x03, 0x01});
  EXPECT_EQ(device.nmtState(), canopen::NmtState::pre_operational);
}

TEST_F(DeviceTest, ResetNodeRestoresEverythingAndBootsAgain) {
  operate();
  sdo({0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x00, 0x00});
  sdo({0x23, 0x65, 0x60, 0x00, 0x07, 0x00, 0x00, 0x00});
  forget();
  send(0x000, {0x81, 0x01});
  EXPECT_EQ(device.nmtState(), canopen::NmtState::boot_up);
  EXPECT_THAT(application.calls, ElementsAre("power on", "state 00"));
  EXPECT_EQ(value(0x1017), 0U);
  EXPECT_EQ(value(0x6065), 0U);
  send(0x000, {0x01, 0x01});
  send(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_THAT(sent(), IsEmpty());
  run(milliseconds(20));
  EXPECT_THAT(sent(), ElementsAre("701 00"));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::pre_operational);
}

TEST_F(DeviceTest, ResetCommunicationRestoresOnlyTheCommunicationObjects) {
  boot();
  sdo({0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x00, 0x00});
  sdo({0x23, 0x65, 0x60, 0x00, 0x07, 0x00, 0x00, 0x00});
  send(0x000, {0x82, 0x00});
  forget();
  run(milliseconds(20));
  EXPECT_THAT(sent(), ElementsAre("701 00"));
  EXPECT_EQ(value(0x1017), 0U);
  EXPECT_EQ(value(0x6065), 7U);
}

TEST_F(DeviceTest, SomeDevicesIgnoreResets) {
  behaviour.ignores_nmt_reset = true;
  operate();
  send(0x000, {0x81, 0x01});
  send(0x000, {0x82, 0x01});
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(device.nmtState(), canopen::NmtState::operational);
}

TEST_F(DeviceTest, IsSilentAndDeafWithoutPower) {
  preset(0x1017, 0, 10);
  operate();
  device.powerOff();
  EXPECT_FALSE(device.powered());
  send(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  device.sendEmergency(0x1000, 1, {}, now);
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(device.nextEvent(), kNever);
  device.powerOn(now);
  run(milliseconds(20));
  EXPECT_THAT(sent(), ElementsAre("701 00"));
}

TEST_F(DeviceTest, IgnoresExtendedAndErrorFrames) {
  boot();
  can::Frame frame(0x000, {0x01, 0x01});
  frame.extended = true;
  device.receive(frame, now);
  frame.extended = false;
  frame.error = true;
  device.receive(frame, now);
  EXPECT_EQ(device.nmtState(), canopen::NmtState::pre_operational);
}

TEST_F(DeviceTest, ReleasesTheHooksOfItsObjects) {
  {
    testing_support::RecordingSink other_sink;
    Device other(2, other_sink, dictionary, behaviour, application);
    other.powerOn(now);
    EXPECT_EQ(dictionary.write({0x1019, 0}, {1}), 0x06090030U);
  }
  EXPECT_EQ(dictionary.write({0x1019, 0}, {1}), 0U);
}

}  // namespace
}  // namespace cia402::sim
