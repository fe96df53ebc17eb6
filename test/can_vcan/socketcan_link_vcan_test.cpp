// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can_vcan/vcan_fixture.h"

namespace cia402::can {
namespace {

TEST_F(SocketCanOnVcan, SurvivesTheInterfaceGoingDownAndUp) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  ASSERT_TRUE(run("ip link set vcan0 down"));
  ASSERT_TRUE(becomes(a, BusState::down));
  EXPECT_THAT(a.describe(), HasSubstr("ip link set vcan0 up"));
  EXPECT_FALSE(a.send(Frame(0x201, {1})));
  EXPECT_EQ(a.counters().frames_dropped, 1u);

  ASSERT_TRUE(run("ip link set vcan0 up"));
  ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
  ASSERT_TRUE(becomes(b, BusState::error_active)) << b.describe();
  EXPECT_TRUE(a.send(Frame(0x202, {2})));
  EXPECT_THAT(receivedIds(b), ElementsAre(0x202));
  EXPECT_EQ(a.counters().interface_losses, 1u);
}

TEST_F(SocketCanOnVcan, NoticesADownInterfaceBySendingBeforeItLooks) {
  SocketCan a("vcan0");
  ASSERT_TRUE(run("ip link set vcan0 down"));
  EXPECT_FALSE(a.send(Frame(0x201, {1})));
  EXPECT_EQ(a.state(), BusState::down);
  EXPECT_EQ(a.counters().frames_dropped, 1u);
}

TEST_F(SocketCanOnVcan, WaitsForAnInterfaceThatIsDownAtTheStart) {
  ASSERT_TRUE(run("ip link set vcan0 down"));
  SocketCan a("vcan0", options());
  EXPECT_EQ(a.state(), BusState::down);
  ASSERT_TRUE(run("ip link set vcan0 up"));
  ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
  EXPECT_TRUE(a.send(Frame(0x080, {})));
}

TEST_F(SocketCanOnVcan, SurvivesTheInterfaceBeingRemovedAndCreatedAgain) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(run("ip link del vcan0"));
    ASSERT_TRUE(becomes(a, BusState::missing));
    EXPECT_EQ(a.fd(), -1);
    EXPECT_THAT(a.describe(), HasSubstr("vcan0 does not exist"));
    EXPECT_FALSE(a.send(Frame(0x201, {1})));

    ASSERT_TRUE(run("ip link add dev vcan0 type vcan"));
    ASSERT_TRUE(becomes(a, BusState::down)) << a.describe();
    EXPECT_FALSE(a.send(Frame(0x201, {1})));
    ASSERT_TRUE(run("ip link set vcan0 up"));
    ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
    ASSERT_TRUE(becomes(b, BusState::error_active)) << b.describe();
    EXPECT_TRUE(a.send(Frame(0x202, {2})));
    EXPECT_THAT(receivedIds(b), ElementsAre(0x202));
  }
  EXPECT_EQ(a.counters().frames_dropped, 4u);
  EXPECT_EQ(a.counters().frames_sent, 2u);
}

TEST_F(SocketCanOnVcan, NoticesAnInterfaceExchangedBetweenTwoLooks) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  ASSERT_TRUE(run("ip link del vcan0 && ip link add dev vcan0 type vcan && ip link set vcan0 up"));
  // By looking alone: no receive() has met the error that the old socket holds.
  a.maintain(now());
  b.maintain(now());
  ASSERT_EQ(a.state(), BusState::error_active) << a.describe();
  EXPECT_EQ(a.counters().interface_losses, 1u) << "told by nothing else";
  EXPECT_TRUE(a.send(Frame(0x202, {2})));
  EXPECT_THAT(receivedIds(b), ElementsAre(0x202));
}

}  // namespace
}  // namespace cia402::can
