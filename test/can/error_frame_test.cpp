// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/error_frame.h"

#include <gtest/gtest.h>

namespace cia402::can {
namespace {

// Identifiers and bytes are written as in linux/can/error.h.
Frame errorFrame(std::uint32_t classes, std::initializer_list<std::uint8_t> bytes) {
  Frame frame(classes, bytes);
  frame.size = 8;
  frame.error = true;
  return frame;
}

TEST(DescribeErrorFrame, NamesEveryClass) {
  EXPECT_EQ(describeErrorFrame(errorFrame(0x001, {})), "transmission timed out");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x002, {})), "lost arbitration");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x002, {13})), "lost arbitration in bit 13");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x004, {})), "unspecified controller problem");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x008, {})), "protocol violation: unspecified");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x010, {})), "transceiver fault");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x020, {})), "no other node acknowledged a frame");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x040, {})), "bus-off: the controller has left the bus");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x080, {})), "bus error");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x100, {})), "controller restarted after bus-off");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x200, {0, 0, 0, 0, 0, 0, 200, 7})),
            "transmit errors 200, receive errors 7");
}

TEST(DescribeErrorFrame, SpellsOutTheDetails) {
  EXPECT_EQ(describeErrorFrame(errorFrame(0x204, {0, 0x20, 0, 0, 0, 0, 128, 0})),
            "controller error passive (transmit); transmit errors 128, receive errors 0");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x004, {0, 0x41})),
            "receive buffer overflow, frames were lost, controller error active again");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x088, {0, 0, 0x84, 0x0A})),
            "protocol violation: bit stuffing error, on transmission at data; bus error");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x0A8, {0, 0, 0, 0x19})),
            "no other node acknowledged a frame; protocol violation: unspecified at ACK slot; "
            "bus error");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x010, {0, 0, 0, 0, 0x80})),
            "transceiver fault: CANL is shorted to CANH");
}

TEST(DescribeErrorFrame, GivesUnknownCodesAsNumbers) {
  EXPECT_EQ(describeErrorFrame(errorFrame(0x400, {})), "unknown error class 0x400");
  EXPECT_EQ(describeErrorFrame(errorFrame(0x008, {0, 0, 0x01, 0x1F})),
            "protocol violation: single bit error at code 0x1F");
  EXPECT_EQ(describeErrorFrame(errorFrame(0, {})), "error frame without a class");
}

TEST(StateAfter, FollowsTheControllerStatus) {
  const BusState active = BusState::error_active;
  EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x04}), active), BusState::error_warning);
  EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x08}), active), BusState::error_warning);
  EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x10}), active), BusState::error_passive);
  EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x20}), active), BusState::error_passive);
  EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x28}), active), BusState::error_passive);
  EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x40}), BusState::error_passive), active);
  EXPECT_EQ(stateAfter(errorFrame(0x040, {}), active), BusState::bus_off);
  EXPECT_EQ(stateAfter(errorFrame(0x044, {0, 0x20}), active), BusState::bus_off);
  EXPECT_EQ(stateAfter(errorFrame(0x100, {}), BusState::bus_off), active);
}

TEST(StateAfter, IsNotChangedByEventsThatSayNothingAboutIt) {
  for (BusState before : {BusState::error_active, BusState::error_passive, BusState::bus_off}) {
    EXPECT_EQ(stateAfter(errorFrame(0x002, {5}), before), before);
    EXPECT_EQ(stateAfter(errorFrame(0x088, {0, 0x20, 0x04}), before), before);
    EXPECT_EQ(stateAfter(errorFrame(0x004, {0, 0x01}), before), before);
    EXPECT_EQ(stateAfter(errorFrame(0x020, {}), before), before);
  }
}

TEST(StateAfter, IgnoresFramesThatAreNoErrorFrames) {
  EXPECT_EQ(stateAfter(Frame(0x040, {}), BusState::error_active), BusState::error_active);
}

TEST(ReportsReceiveOverflow, LooksAtTheControllerStatusOnly) {
  EXPECT_TRUE(reportsReceiveOverflow(errorFrame(0x004, {0, 0x01})));
  EXPECT_FALSE(reportsReceiveOverflow(errorFrame(0x004, {0, 0x02})));
  EXPECT_FALSE(reportsReceiveOverflow(errorFrame(0x008, {0, 0x01})));
  EXPECT_FALSE(reportsReceiveOverflow(Frame(0x004, {0, 0x01})));
}

TEST(CountErrorFrame, CountsEveryClassOfAFrameAndWhatWasLost) {
  BusCounters counters;
  countErrorFrame(errorFrame(0x002, {5}), counters);
  countErrorFrame(errorFrame(0x0A8, {0, 0, 0, 0x19}), counters);
  countErrorFrame(errorFrame(0x204, {0, 0x01}), counters);
  EXPECT_EQ(counters.error_frames, 3u);
  EXPECT_EQ(counters.error_classes, (std::array<std::uint64_t, 10>{0, 1, 1, 1, 0, 1, 0, 1, 0, 1}));
  EXPECT_EQ(counters.receive_overflows, 1u);
}

TEST(ErrorClassName, NamesTheBits) {
  EXPECT_STREQ(errorClassName(0), "transmission timeout");
  EXPECT_STREQ(errorClassName(1), "lost arbitration");
  EXPECT_STREQ(errorClassName(6), "bus-off");
  EXPECT_STREQ(errorClassName(9), "error counters");
  EXPECT_STREQ(errorClassName(10), "unknown");
}

}  // namespace
}  // namespace cia402::can
