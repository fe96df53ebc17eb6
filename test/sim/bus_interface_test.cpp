// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/interface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/bus_recorder.h"

namespace cia402::sim {
namespace {

using can::BusState;
using can::Frame;
using ::testing::HasSubstr;

class BusInterfaceTest : public ::testing::Test {
 protected:
  BusInterface::Options options() {
    BusInterface::Options options;
    options.receive_capacity = 4;
    options.restart_after = std::chrono::milliseconds(100);
    return options;
  }
  Bus bus{1e6};
  BusRecorder drive;
  Port& drive_port{bus.attach(drive, "drive")};
  BusInterface interface { bus, "sim", options() };
};

TEST_F(BusInterfaceTest, SendsAndReceivesInTheTimeOfTheBus) {
  interface.maintain(atUs(100));
  EXPECT_TRUE(interface.send(kSync));
  interface.maintain(atUs(147));
  EXPECT_TRUE(drive.frames.empty());
  interface.maintain(atUs(148));
  EXPECT_EQ(drive.frames.size(), 1u);
  EXPECT_EQ(interface.counters().frames_sent, 1u);

  drive_port.send(Frame(0x080, {}), atUs(200));
  EXPECT_FALSE(interface.receive(atUs(247)));
  const auto received = interface.receive(atUs(300));
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame, kSync);
  EXPECT_EQ(received->stamp, atUs(248));
  EXPECT_FALSE(interface.receive(atUs(300)));
  EXPECT_EQ(interface.counters().frames_received, 1u);
  EXPECT_EQ(interface.fd(), -1);
}

TEST_F(BusInterfaceTest, CountsFramesThatNobodyFetched) {
  for (std::uint8_t i = 0; i < 6; ++i) drive_port.send(Frame(0x181, {i}), atUs(0));
  interface.maintain(atUs(5000));
  EXPECT_EQ(interface.counters().receive_overflows, 2u);
  for (std::uint8_t i = 0; i < 4; ++i) {
    const auto received = interface.receive(atUs(5000));
    ASSERT_TRUE(received);
    EXPECT_EQ(received->frame.data[0], i);
  }
  EXPECT_FALSE(interface.receive(atUs(5000)));
}

TEST_F(BusInterfaceTest, ReportsBusOffAndRestartsAfterTheConfiguredTime) {
  interface.maintain(atUs(0));
  interface.port().forceBusOff();
  EXPECT_EQ(interface.state(), BusState::bus_off);
  EXPECT_EQ(interface.counters().bus_off_events, 1u);
  EXPECT_THAT(interface.describe(), HasSubstr("bus-off"));
  EXPECT_FALSE(interface.send(kSync));
  EXPECT_EQ(interface.counters().frames_dropped, 1u);
  const auto report = interface.receive(atUs(1));
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->frame.error);
  EXPECT_EQ(report->frame.id, 0x40u);  // CAN_ERR_BUSOFF

  interface.maintain(atUs(99'999));
  interface.maintain(atUs(100'000));
  interface.maintain(atUs(100'000 + 1407));
  EXPECT_EQ(interface.state(), BusState::bus_off);
  interface.maintain(atUs(100'000 + 1408));
  EXPECT_EQ(interface.state(), BusState::error_active);
  EXPECT_TRUE(interface.send(kSync));
}

TEST_F(BusInterfaceTest, NamesTheErrorCountersWhenTheCableIsPulled) {
  interface.maintain(atUs(0));
  interface.port().setAttached(false);
  interface.send(kSync);
  EXPECT_EQ(interface.state(), BusState::error_passive);
  EXPECT_THAT(interface.describe(), HasSubstr("error passive (transmit errors 128"));
  const auto report = interface.receive(atUs(1));
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->frame.error);
  EXPECT_EQ(report->frame.data[1], 0x20);  // CAN_ERR_CRTL_TX_PASSIVE
  EXPECT_EQ(report->frame.data[6], 128);
}

TEST_F(BusInterfaceTest, LetsAWorldAdvanceTheBusInItsPlace) {
  std::vector<Time> times;
  interface.setAdvance([&](Time now) {
    times.push_back(now);
    bus.advance(now);
  });
  drive_port.send(kSync, atUs(0));
  EXPECT_TRUE(interface.receive(atUs(60)));
  interface.maintain(atUs(70));
  EXPECT_EQ(times, (std::vector<Time>{atUs(60), atUs(70)}));
}

}  // namespace
}  // namespace cia402::sim
