// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What can be seen without a CAN interface; the rest is in test/can_vcan.
#include "can/socketcan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::can {
namespace {

using ::testing::HasSubstr;

TEST(SocketCan, IsMissingWithoutItsInterfaceAndSaysWhatToDo) {
  SocketCan can("nosuchcan7");
  EXPECT_EQ(can.state(), BusState::missing);
  EXPECT_EQ(can.fd(), -1);
  EXPECT_THAT(can.describe(), HasSubstr("nosuchcan7 does not exist"));
  EXPECT_THAT(can.describe(), HasSubstr("ip link add dev nosuchcan7 type vcan"));
}

TEST(SocketCan, RefusesAndCountsFramesWhileMissing) {
  SocketCan can("nosuchcan7");
  EXPECT_FALSE(can.send(Frame(0x080, {})));
  EXPECT_FALSE(can.send(Frame(0x201, {1})));
  EXPECT_EQ(can.counters().frames_dropped, 2u);
  EXPECT_EQ(can.counters().frames_sent, 0u);
  EXPECT_EQ(can.pending(), 0u);
}

TEST(SocketCan, ReceivesNothingWhileMissingAndGoesOnLooking) {
  SocketCan can("nosuchcan7");
  for (int ms = 0; ms < 1000; ms += 50) {
    const Time now(std::chrono::milliseconds{ms});
    can.maintain(now);
    EXPECT_FALSE(can.receive(now));
  }
  EXPECT_EQ(can.state(), BusState::missing);
}

TEST(SocketCan, RefusesAnInterfaceThatIsNotCan) {
  SocketCan can("lo");
  EXPECT_EQ(can.state(), BusState::missing);
  EXPECT_FALSE(can.send(Frame(0x080, {})));
  EXPECT_THAT(can.describe(), HasSubstr("lo is not a CAN interface"));
}

TEST(SocketCan, TakesImpossibleNamesForMissingInterfaces) {
  for (const char* name : {"", "a-name-longer-than-the-kernel-allows", "can 0/.."}) {
    SocketCan can(name);
    EXPECT_EQ(can.state(), BusState::missing) << name;
    EXPECT_FALSE(can.send(Frame(0x080, {}))) << name;
  }
}

TEST(BusState, HasWords) {
  EXPECT_STREQ(toString(BusState::missing), "missing");
  EXPECT_STREQ(toString(BusState::down), "down");
  EXPECT_STREQ(toString(BusState::error_active), "error active");
  EXPECT_STREQ(toString(BusState::error_warning), "error warning");
  EXPECT_STREQ(toString(BusState::error_passive), "error passive");
  EXPECT_STREQ(toString(BusState::bus_off), "bus-off");
}

}  // namespace
}  // namespace cia402::can
