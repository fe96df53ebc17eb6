// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/pacer.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(SdoPacerTest, turns_are_as_long_as_two_frames_of_135_bits_each) {
  SdoPacer pacer(1e6);
  const Time now = Time() + milliseconds(1);
  EXPECT_EQ(pacer.turn(now), now);
  EXPECT_EQ(pacer.turn(now), now + microseconds(270));
  EXPECT_EQ(pacer.turn(now), now + microseconds(540));
  SdoPacer slow(125e3);
  slow.turn(now);
  EXPECT_EQ(slow.turn(now), now + microseconds(8 * 270));
}

TEST(SdoPacerTest, time_that_nobody_used_is_gone) {
  SdoPacer pacer(1e6);
  pacer.turn(Time());
  const Time later = Time() + milliseconds(10);
  EXPECT_EQ(pacer.turn(later), later);
  EXPECT_EQ(pacer.turn(later), later + microseconds(270));
}

TEST(SdoPacerTest, other_frames_push_back_turns_that_are_not_given_yet) {
  SdoPacer pacer(1e6);
  const Time now = Time() + milliseconds(1);
  pacer.occupied(5, now);
  EXPECT_EQ(pacer.turn(now), now) << "nobody was waiting";
  pacer.occupied(2, now);
  EXPECT_EQ(pacer.turn(now), now + microseconds(540));
}

TEST(SdoPacerTest, without_a_bit_rate_nobody_waits) {
  SdoPacer pacer(0.0);
  EXPECT_EQ(pacer.turn(Time()), Time());
  EXPECT_EQ(pacer.turn(Time()), Time());
}

}  // namespace
}  // namespace cia402::canopen
