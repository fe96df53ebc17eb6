// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SlaveEmergencyTest : public testing_support::SlaveTest {};

TEST_F(SlaveEmergencyTest, SendsCodeRegisterAndVendorBytes) {
  boot();
  device.sendEmergency(0x8611, 0x21, {1, 2, 3, 4, 5}, now);
  EXPECT_THAT(sent(), ElementsAre("081 11 86 21 01 02 03 04 05"));
  EXPECT_EQ(value(0x1001), 0x21U);
  EXPECT_EQ(value(0x1003, 0), 1U);
  EXPECT_EQ(value(0x1003, 1), 0x02018611U);
}

TEST_F(SlaveEmergencyTest, ClearingReportsNoErrorAndKeepsTheHistory) {
  boot();
  device.sendEmergency(0x8611, 0x21, {}, now);
  forget();
  device.clearEmergency(now);
  EXPECT_THAT(sent(), ElementsAre("081 00 00 00 00 00 00 00 00"));
  EXPECT_EQ(value(0x1001), 0U);
  EXPECT_EQ(value(0x1003, 0), 1U);
}

TEST_F(SlaveEmergencyTest, KeepsTheNewestErrorsFirst) {
  boot();
  for (const int code : {0x2310, 0x3210, 0x4310, 0x7305}) {
    device.sendEmergency(static_cast<std::uint16_t>(code), 0x01, {}, now);
  }
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x00, 0, 0, 0, 0}), "581 4F 03 10 00 03 00 00 00");
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x01, 0, 0, 0, 0}), "581 43 03 10 01 05 73 00 00");
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x03, 0, 0, 0, 0}), "581 43 03 10 03 10 32 00 00");
}

TEST_F(SlaveEmergencyTest, RefusesToReadErrorsThatAreNotStored) {
  boot();
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x01, 0, 0, 0, 0}), "581 80 03 10 01 24 00 00 08");
  device.sendEmergency(0x8611, 0x21, {}, now);
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x01, 0, 0, 0, 0}), "581 43 03 10 01 11 86 00 00");
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x02, 0, 0, 0, 0}), "581 80 03 10 02 24 00 00 08");
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x04, 0, 0, 0, 0}), "581 80 03 10 04 11 00 09 06");
}

TEST_F(SlaveEmergencyTest, OnlyZeroClearsTheHistory) {
  boot();
  device.sendEmergency(0x8611, 0x21, {}, now);
  EXPECT_EQ(sdo({0x2F, 0x03, 0x10, 0x00, 1, 0, 0, 0}), "581 80 03 10 00 30 00 09 06");
  EXPECT_EQ(value(0x1003, 0), 1U);
  EXPECT_EQ(sdo({0x2F, 0x03, 0x10, 0x00, 0, 0, 0, 0}), "581 60 03 10 00 00 00 00 00");
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0x01, 0, 0, 0, 0}), "581 80 03 10 01 24 00 00 08");
}

TEST_F(SlaveEmergencyTest, HoldsFramesBackForTheInhibitTime) {
  preset(0x1015, 0, 50);
  boot();
  device.sendEmergency(0x2310, 0x03, {}, now);
  device.sendEmergency(0x3210, 0x05, {}, now);
  EXPECT_THAT(sent(), ElementsAre("081 10 23 03 00 00 00 00 00"));
  run(microseconds(4999));
  EXPECT_THAT(sent(), IsEmpty());
  run(microseconds(1));
  EXPECT_THAT(sent(), ElementsAre("081 10 32 05 00 00 00 00 00"));
}

TEST_F(SlaveEmergencyTest, FollowsItsCobIdAndCanBeDisabled) {
  boot();
  EXPECT_EQ(sdo({0x23, 0x14, 0x10, 0x00, 0xF1, 0, 0, 0}), "581 80 14 10 00 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x14, 0x10, 0x00, 0x81, 0, 0, 0x80}), "581 60 14 10 00 00 00 00 00");
  device.sendEmergency(0x2310, 0x03, {}, now);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(sdo({0x23, 0x14, 0x10, 0x00, 0xF1, 0, 0, 0}), "581 60 14 10 00 00 00 00 00");
  device.sendEmergency(0x2310, 0x03, {}, now);
  EXPECT_THAT(sent(), ElementsAre("0F1 10 23 03 00 00 00 00 00"));
}

TEST_F(SlaveEmergencyTest, WaitsWhileStopped) {
  operate();
  send(0x000, {0x02, 0x01});
  device.sendEmergency(0x2310, 0x03, {}, now);
  EXPECT_THAT(sent(), IsEmpty());
  send(0x000, {0x80, 0x01});
  EXPECT_THAT(sent(), ElementsAre("081 10 23 03 00 00 00 00 00"));
}

}  // namespace
}  // namespace cia402::sim
