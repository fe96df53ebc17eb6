// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can_vcan/vcan_fixture.h"

namespace cia402::can {
namespace {

TEST_F(SocketCanOnVcan, CarriesEveryKindOfFrameToTheOtherSocketsButNotToItself) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  PlainSocket other_program;
  ASSERT_EQ(a.state(), BusState::error_active) << a.describe();
  Frame extended(0x1ABCDEF0, {1, 2, 3, 4, 5, 6, 7, 8});
  extended.extended = true;
  Frame remote(0x701, {});
  remote.remote = true;
  remote.size = 1;
  for (const Frame& frame : {Frame(0x000, {0x01, 0x00}), Frame(0x7FF, {}), extended, remote}) {
    ASSERT_TRUE(a.send(frame));
    const auto received = receiveWithin(b, kPatience);
    ASSERT_TRUE(received);
    EXPECT_EQ(received->frame, frame);
  }
  EXPECT_FALSE(receiveWithin(a, kQuiet));
  EXPECT_EQ(other_program.receivedId(), 0x000u);
  EXPECT_EQ(other_program.receivedId(), 0x7FFu);
  EXPECT_EQ(other_program.receivedId(), 0x9ABCDEF0u);  // CAN_EFF_FLAG
  EXPECT_EQ(other_program.receivedId(), 0x40000701u);  // CAN_RTR_FLAG
  EXPECT_EQ(a.counters().frames_sent, 4u);
  EXPECT_EQ(a.counters().frames_received, 0u);
  EXPECT_EQ(b.counters().frames_received, 4u);
  EXPECT_EQ(a.counters().frames_dropped, 0u);
}

TEST_F(SocketCanOnVcan, ReceivesMoreFramesThanOneBatchInOrder) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_TRUE(a.send(Frame(i, {})));
  const auto ids = receivedIds(b);
  ASSERT_EQ(ids.size(), 100u);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(ids[i], i);
}

TEST_F(SocketCanOnVcan, FiltersInTheKernel) {
  SocketCan::Options options = this->options();
  options.filters = {{0x180, 0x780, false}, {0x701, 0x7FF, false}, {0x181, 0x1FFFFFFF, true}};
  SocketCan filtered("vcan0", options);
  SocketCan sender("vcan0");
  const auto sendAll = [&] {
    for (std::uint32_t id : {0x080U, 0x181U, 0x1FFU, 0x200U, 0x701U, 0x702U}) {
      sender.send(Frame(id, {}));
    }
    Frame extended(0x181, {0xEE});
    extended.extended = true;
    sender.send(extended);
    extended.id = 0x701;
    sender.send(extended);
  };
  sendAll();
  EXPECT_THAT(receivedIds(filtered), ElementsAre(0x181, 0x1FF, 0x701, 0x181));
  filtered.setFilters({{0x080, 0x7FF, false}});
  sendAll();
  EXPECT_THAT(receivedIds(filtered), ElementsAre(0x080));
  filtered.setFilters({});
  sendAll();
  EXPECT_EQ(receivedIds(filtered).size(), 8u);
}

void expectStampBetweenSendAndReceive(SocketCan& sender, SocketCan& receiver) {
  const Time before = now();
  ASSERT_TRUE(sender.send(Frame(0x080, {})));
  const auto received = receiveWithin(receiver, kPatience);
  const Time after = now();
  ASSERT_TRUE(received);
  // The two clocks are compared by software: a millisecond is for user-mode Linux.
  EXPECT_GE(received->stamp, before - milliseconds(1));
  EXPECT_LE(received->stamp, after);
}

TEST_F(SocketCanOnVcan, StampsOnTheMonotonicClock) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  for (int i = 0; i < 20; ++i) expectStampBetweenSendAndReceive(a, b);
}

TEST_F(SocketCanOnVcan, StampsWhenAFrameCameNotWhenItWasFetched) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  const Time before = now();
  a.send(Frame(0x080, {}));
  const Time sent = now();
  std::this_thread::sleep_for(milliseconds(100));
  const auto received = receiveWithin(b, kPatience);
  ASSERT_TRUE(received);
  EXPECT_GE(received->stamp, before - milliseconds(1));
  EXPECT_LE(received->stamp, sent + milliseconds(20));
}

TEST_F(SocketCanOnVcan, KeepsItsStampsWhenTheWallClockIsStepped) {
  // Only where the clock is nobody else's; the arithmetic is tested in wall_clock_test.cpp.
  const auto step = [](std::int64_t seconds) {
    if (!onUserModeLinux()) return;
    timespec wall{};
    ::clock_gettime(CLOCK_REALTIME, &wall);
    wall.tv_sec += seconds;
    ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &wall), 0);
  };
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  for (const std::int64_t seconds : {-3600, 7200, -3600}) {
    expectStampBetweenSendAndReceive(a, b);
    const Time before = now();
    ASSERT_TRUE(a.send(Frame(0x080, {})));
    step(seconds);  // with the frame in the socket
    const auto received = receiveWithin(b, kPatience);
    ASSERT_TRUE(received);
    EXPECT_GE(received->stamp, before - milliseconds(1));
    EXPECT_LE(received->stamp, now());
    expectStampBetweenSendAndReceive(a, b);
  }
}

}  // namespace
}  // namespace cia402::can
