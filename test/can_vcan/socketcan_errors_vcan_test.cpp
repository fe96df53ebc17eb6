// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cerrno>

#include "can/link_settings.h"
#include "can_vcan/vcan_fixture.h"

namespace cia402::can {
namespace {

TEST_F(SocketCanOnVcan, FollowsTheErrorFramesOfTheController) {
  SocketCan can("vcan0", options());
  PlainSocket driver;
  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x204, {0, 0x20, 0, 0, 0, 0, 128, 3}));
  auto received = receiveWithin(can, kPatience);
  ASSERT_TRUE(received);
  EXPECT_TRUE(received->frame.error);
  EXPECT_EQ(received->frame.id, 0x204u);
  EXPECT_EQ(can.state(), BusState::error_passive);
  EXPECT_THAT(can.describe(), HasSubstr("transmit errors 128, receive errors 3"));
  EXPECT_TRUE(can.send(Frame(0x080, {})));

  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x004, {0, 0x01, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.counters().receive_overflows, 1u);

  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x040, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.state(), BusState::bus_off);
  EXPECT_THAT(can.describe(), HasSubstr("vcan0 is bus-off, nothing is sent"));
  EXPECT_FALSE(can.send(Frame(0x080, {})));
  EXPECT_EQ(can.counters().bus_off_events, 1u);
  std::this_thread::sleep_for(milliseconds(30));
  can.maintain(now());  // the carrier of vcan never goes: no proof that the controller is back yet
  EXPECT_EQ(can.state(), BusState::bus_off);

  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x100, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.state(), BusState::error_active);
  EXPECT_TRUE(can.send(Frame(0x080, {})));
  EXPECT_EQ(can.counters().error_frames, 4u);
  EXPECT_EQ(can.counters().error_classes[2], 2u);
  EXPECT_EQ(can.counters().restarts, 1u);
  EXPECT_EQ(can.counters().frames_received, 0u);
}

TEST_F(SocketCanOnVcan, DoesNotSufferFromErrorFramesItDoesNotWant) {
  SocketCan::Options deaf = options();
  deaf.error_frames = false;
  SocketCan can("vcan0", deaf);
  PlainSocket driver;
  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x040, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(driver.send(0x701, {5}));
  const auto received = receiveWithin(can, kPatience);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame.id, 0x701u);
  EXPECT_EQ(can.state(), BusState::error_active);
  EXPECT_EQ(can.counters().error_frames, 0u);
}

TEST_F(SocketCanOnVcan, TakesAFrameFromTheBusAsProofThatBusOffIsOver) {
  SocketCan can("vcan0", options());
  PlainSocket driver;
  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x040, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  ASSERT_EQ(can.state(), BusState::bus_off);
  ASSERT_TRUE(driver.send(0x701, {5}));  // may be from before
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.state(), BusState::bus_off);
  std::this_thread::sleep_for(milliseconds(60));
  ASSERT_TRUE(driver.send(0x701, {5}));
  std::optional<ReceivedFrame> received;  // without maintain(), which would find out by itself
  for (const Time end = now() + kPatience; !received && now() < end;) received = can.receive(now());
  ASSERT_TRUE(received);
  EXPECT_EQ(can.state(), BusState::error_active);
}

TEST_F(SocketCanOnVcan, TakesAnInterfaceWithoutAControllerAsBackAfterTheDelay) {
  SocketCan can("vcan0", options());
  PlainSocket driver;
  for (const int delay : {100, 200}) {
    ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x040, {0, 0, 0, 0, 0, 0, 0, 0}));
    ASSERT_TRUE(becomes(can, BusState::bus_off));
    const Time off = now();
    ASSERT_TRUE(becomes(can, BusState::error_active)) << "no frame came, no error frame";
    EXPECT_GE(now() - off, milliseconds(delay - 5)) << "the delay grows";
    EXPECT_TRUE(can.send(Frame(0x080, {})));
  }
  EXPECT_EQ(can.counters().restart_attempts, 0u) << "there is nothing to restart";
  EXPECT_EQ(can.counters().bus_off_events, 2u);
}

TEST_F(SocketCanOnVcan, ShowsTheErrorCountersOfTheLastErrorFrame) {
  SocketCan can("vcan0", options());
  PlainSocket driver;
  EXPECT_FALSE(can.errorCounters());
  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x200, {0, 0, 0, 0, 0, 0, 97, 12}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  ASSERT_TRUE(can.errorCounters());
  EXPECT_EQ(can.errorCounters()->transmit, 97);
  EXPECT_EQ(can.errorCounters()->receive, 12);
}

TEST_F(SocketCanOnVcan, ReadsTheSettingsOfAnInterfaceWithoutAController) {
  const LinkReader reader;
  const auto link = reader.read("vcan0");
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "vcan");
  EXPECT_TRUE(link->up && link->carrier);
  EXPECT_TRUE(link->tx_queue_length);
  EXPECT_FALSE(link->bitrate || link->controller || link->restart_ms);
  EXPECT_EQ(reader.restart(*link), EOPNOTSUPP);
}

}  // namespace
}  // namespace cia402::can
