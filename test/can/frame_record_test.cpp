// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/frame_record.h"

#include <gtest/gtest.h>

namespace cia402::can {
namespace {

using namespace std::chrono_literals;

TEST(FrameRecord, KeepsFrameStampAndDirection) {
  Frame frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8});
  const FrameRecord received(frame, Time(1234567891ns), false);
  EXPECT_EQ(received.frame(), frame);
  EXPECT_EQ(received.stamp(), Time(1234567891ns));
  EXPECT_EQ(received.direction(), Direction::received);
  frame.extended = frame.remote = true;
  const FrameRecord sent(frame, Time(-3ns), true);
  EXPECT_EQ(sent.frame(), frame);
  EXPECT_EQ(sent.stamp(), Time(-3ns));
  EXPECT_EQ(sent.direction(), Direction::transmitted);
}

TEST(FrameRecord, AnEmptyFrameWithItsPauseTakes47Bits) {
  EXPECT_EQ(mostFrames(1e6, 10s), 212766U);  // 10^7 bits / 47 = 212765.96
  EXPECT_EQ(mostFrames(125e3, 1s), 2660U);
}

}  // namespace
}  // namespace cia402::can
