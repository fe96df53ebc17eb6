// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/bus_listener.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

canopen::MasterConfig master() {
  canopen::MasterConfig config;
  config.node_id = 127;
  canopen::NodeConfig node;
  node.node_id = 3;
  node.name = "shoulder";
  canopen::PdoConfig pdo;
  pdo.direction = canopen::PdoDirection::rpdo;
  pdo.number = 1;
  pdo.cob_id = 0x203;
  pdo.enabled = true;
  node.pdos.push_back(pdo);
  pdo.direction = canopen::PdoDirection::tpdo;
  pdo.cob_id = 0x183;
  node.pdos.push_back(pdo);
  config.nodes.push_back(node);
  return config;
}

class BusListenerTest : public testing::Test {
 protected:
  BusListenerTest() { listener.start(now); }
  bool hear(const can::Frame& frame) { return listener.receive(frame, now); }
  static can::Frame remote(std::uint32_t id) {
    can::Frame frame(id, {});
    frame.remote = true;
    return frame;
  }

  Time now{10s};
  BusListener listener{master(), 150ms};
};

TEST_F(BusListenerTest, WhatOnlyMastersSendIsHeard) {
  const std::pair<can::Frame, const char*> telling[] = {
      {can::Frame(0x000, {0x01, 0x00}), "NMT (COB-ID 0x000)"},
      {can::Frame(0x080, {}), "SYNC (COB-ID 0x080)"},
      {can::Frame(0x77F, {0x05}), "a heartbeat with the master's node-ID (COB-ID 0x77F)"},
      {can::Frame(0x203, {0x06, 0x00}), "RPDO 1 of shoulder (COB-ID 0x203)"},
      {can::Frame(0x603, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}),
       "an SDO request to node 3 (COB-ID 0x603)"},
      {can::Frame(0x7E5, {0x04, 0x01, 0, 0, 0, 0, 0, 0}), "an LSS request (COB-ID 0x7E5)"},
      {remote(0x705), "node guarding of node 5 (COB-ID 0x705)"}};
  for (const auto& [frame, text] : telling) {
    listener.start(now);
    EXPECT_FALSE(listener.heard());
    EXPECT_TRUE(hear(frame)) << text;
    EXPECT_TRUE(listener.heard()) << text;
    EXPECT_EQ(listener.text(), std::string("another master is on the bus, heard: ") + text +
                                   "; nothing is sent until none for 0.15 s; stop the other one");
  }
}

TEST_F(BusListenerTest, WhatDrivesSendMeansNothing) {
  for (const can::Frame& frame :
       {can::Frame(0x703, {0x05}), can::Frame(0x703, {0x00}), can::Frame(0x183, {0x37, 0x02}),
        can::Frame(0x083, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}),
        can::Frame(0x583, {0x60, 0x40, 0x60, 0, 0, 0, 0, 0}),
        can::Frame(0x7E4, {0x50, 0, 0, 0, 0, 0, 0, 0}), can::Frame(0x303, {1}), remote(0x183)}) {
    EXPECT_FALSE(hear(frame)) << frame.id;
  }
  EXPECT_FALSE(listener.heard());
  EXPECT_EQ(listener.text(), "");
  EXPECT_EQ(listener.deadline(), now + 150ms);
}

TEST_F(BusListenerTest, IsOverOnceTheBusWasFreeForLongEnough) {
  EXPECT_EQ(listener.deadline(), Time(10s) + 150ms);
  now += 100ms;
  EXPECT_TRUE(hear(can::Frame(0x080, {})));
  EXPECT_EQ(listener.deadline(), Time(10s) + 250ms);
  now += 100ms;
  EXPECT_FALSE(hear(can::Frame(0x080, {}))) << "no news";
  EXPECT_EQ(listener.deadline(), Time(10s) + 350ms);
  listener.finish();
  EXPECT_FALSE(listener.listening());
  EXPECT_FALSE(hear(can::Frame(0x080, {})));
  EXPECT_FALSE(hear(can::Frame(0x000, {0x01, 0x00}))) << "news, but nobody listens";
  EXPECT_FALSE(listener.listening());
}

TEST_F(BusListenerTest, AllKindsAreNamedUpToThree) {
  EXPECT_TRUE(hear(can::Frame(0x080, {})));
  EXPECT_TRUE(hear(can::Frame(0x203, {1})));
  EXPECT_THAT(listener.text(),
              HasSubstr("heard: SYNC (COB-ID 0x080), RPDO 1 of shoulder (COB-ID 0x203);"));
  EXPECT_TRUE(hear(can::Frame(0x000, {1, 0})));
  EXPECT_FALSE(hear(can::Frame(0x77F, {5}))) << "enough is told";
}

TEST(BusListener, SyncThatIsToLeadMeansNothing) {
  canopen::MasterConfig config = master();
  config.external_sync = true;
  BusListener listener(config, 150ms);
  listener.start(Time(1s));
  EXPECT_FALSE(listener.receive(can::Frame(0x080, {}), Time(1s)));
  EXPECT_FALSE(listener.heard());
}

TEST(BusListener, AnSdoChannelOfAnotherIdentifierIsKnown) {
  canopen::MasterConfig config = master();
  config.nodes[0].sdo_channel.request = 0x6A3;
  BusListener listener(config, 150ms);
  listener.start(Time(1s));
  EXPECT_TRUE(listener.receive(can::Frame(0x6A3, {0x40}), Time(1s)));
  EXPECT_THAT(listener.text(), HasSubstr("an SDO request to shoulder (COB-ID 0x6A3)"));
}

TEST(BusListener, WithADurationOfZeroNobodyListens) {
  BusListener listener(master(), 0ms);
  listener.start(Time(1s));
  EXPECT_FALSE(listener.listening());
  EXPECT_EQ(listener.deadline(), kNever);
}

TEST_F(BusListenerTest, ErrorFramesAndIdentifiersOf29BitsMeanNothing) {
  can::Frame frame(0x080, {});
  frame.extended = true;
  EXPECT_FALSE(hear(frame));
  frame.extended = false;
  frame.error = true;
  EXPECT_FALSE(hear(frame));
  EXPECT_FALSE(listener.heard());
  EXPECT_EQ(listener.deadline(), now + 150ms);
}

}  // namespace
}  // namespace cia402::bus
