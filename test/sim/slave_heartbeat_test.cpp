// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SlaveHeartbeatTest : public testing_support::SlaveTest {};

TEST_F(SlaveHeartbeatTest, BeginsAtOnceWhenWrittenAndCarriesTheState) {
  boot();
  send(0x601, {0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0, 0});
  forget();
  run(milliseconds(0));
  EXPECT_THAT(sent(), ElementsAre("701 7F"));
  run(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("701 7F"));
  send(0x000, {0x01, 0x01});
  run(milliseconds(200));
  EXPECT_THAT(sent(), ElementsAre("701 05", "701 05"));
  send(0x000, {0x02, 0x01});
  run(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("701 04"));
}

TEST_F(SlaveHeartbeatTest, ZeroStopsIt) {
  preset(0x1017, 0, 100);
  boot();
  run(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("701 7F"));
  sdo({0x2B, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  run(milliseconds(500));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveHeartbeatTest, WatchesOnlyAfterTheFirstHeartbeat) {
  preset(0x1016, 1, 0x007F0064);
  operate();
  run(milliseconds(1000));
  send(0x77F, {0x00});
  run(milliseconds(1000));
  EXPECT_THAT(application.calls, IsEmpty());
  send(0x77F, {0x05});
  run(milliseconds(99));
  EXPECT_THAT(application.calls, IsEmpty());
  run(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("081 30 81 11 00 00 00 00 00"));
  EXPECT_THAT(application.calls, ElementsAre("state 7F", "lost"));
  EXPECT_EQ(value(0x1001), 0x11U);
  EXPECT_EQ(value(0x1003, 1), 0x00008130U);
}

TEST_F(SlaveHeartbeatTest, ReportsTheReturnOfTheMaster) {
  preset(0x1016, 1, 0x007F0064);
  operate();
  send(0x77F, {0x05});
  run(milliseconds(300));
  forget();
  send(0x77F, {0x05});
  EXPECT_THAT(application.calls, ElementsAre("back"));
  EXPECT_THAT(sent(), ElementsAre("081 00 00 00 00 00 00 00 00"));
  EXPECT_EQ(value(0x1001), 0U);
  run(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("081 30 81 11 00 00 00 00 00"));
}

TEST_F(SlaveHeartbeatTest, DoesNotReportNoErrorWhileTheApplicationHasAFault) {
  preset(0x1016, 1, 0x007F0064);
  operate();
  send(0x77F, {0x05});
  run(milliseconds(300));
  forget();
  application.fault = true;
  send(0x77F, {0x05});
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(value(0x1001), 0x01U);
}

TEST_F(SlaveHeartbeatTest, ReactsAsTheErrorBehaviourAsks) {
  preset(0x1016, 1, 0x007F0064);
  preset(0x1029, 1, 1);
  operate();
  send(0x77F, {0x05});
  run(milliseconds(100));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::operational);
  preset(0x1029, 1, 2);
  send(0x77F, {0x05});
  run(milliseconds(100));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::stopped);
}

TEST_F(SlaveHeartbeatTest, KeepsQuietWhileHeartbeatsOfTheRightNodeCome) {
  preset(0x1016, 1, 0x007F0064);
  operate();
  for (int i = 0; i < 10; ++i) {
    send(0x77F, {0x05});
    run(milliseconds(90));
  }
  EXPECT_THAT(application.calls, IsEmpty());
  send(0x77E, {0x05});
  run(milliseconds(20));
  EXPECT_THAT(application.calls, ElementsAre("state 7F", "lost"));
}

TEST_F(SlaveHeartbeatTest, RefusesASecondEntryForTheSameNode) {
  boot();
  EXPECT_EQ(sdo({0x23, 0x16, 0x10, 0x01, 0xE8, 0x03, 0x7F, 0x00}), "581 60 16 10 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x16, 0x10, 0x02, 0x64, 0x00, 0x7F, 0x00}), "581 80 16 10 02 43 00 04 06");
  EXPECT_EQ(sdo({0x23, 0x16, 0x10, 0x01, 0x64, 0x00, 0x7F, 0x00}), "581 60 16 10 01 00 00 00 00");
}

TEST_F(SlaveHeartbeatTest, WritingTheConsumerTimeEndsTheSupervision) {
  preset(0x1016, 1, 0x007F0064);
  operate();
  send(0x77F, {0x05});
  sdo({0x23, 0x16, 0x10, 0x01, 0, 0, 0, 0});
  run(milliseconds(500));
  EXPECT_THAT(application.calls, IsEmpty());
}

}  // namespace
}  // namespace cia402::sim
