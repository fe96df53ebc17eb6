// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/frame_bits.h"

#include <gtest/gtest.h>

namespace cia402::can {
namespace {

TEST(FrameBitsTest, TheMostAreThoseOfIso11898WithAStuffBitAfterEachFour) {
  EXPECT_EQ(mostBits(Frame(0x123, {})), 34u + 13u + 8u);
  EXPECT_EQ(mostBits(Frame(0x123, {1, 2, 3, 4, 5, 6, 7, 8})), 98u + 13u + 24u);
  Frame remote(0x701, {});
  remote.size = 8;
  remote.remote = true;
  EXPECT_EQ(mostBits(remote), 55u) << "a remote frame carries no data whatever it asks for";
  Frame extended(0x123, {1, 2, 3, 4, 5, 6, 7, 8});
  extended.extended = true;
  EXPECT_EQ(mostBits(extended), 118u + 13u + 29u);
}

// Identifier, length and data 0: the CRC is 0 as well, and every fifth zero is followed by a one.
TEST(FrameBitsTest, OnTheWireTheTrueStuffBitsCount) {
  EXPECT_EQ(wireBits(Frame(0, {})), 34u + 34u / 5u + 13u);
}

TEST(FrameBitsTest, NoFrameIsLongerThanTheMost) {
  std::uint32_t random = 1;
  for (int i = 0; i < 20000; ++i) {
    Frame frame;
    const auto next = [&random] { return random = random * 1664525U + 1013904223U; };
    frame.extended = next() >> 31U != 0;
    frame.id = next() >> (frame.extended ? 3U : 21U);
    frame.remote = next() >> 29U == 0;
    frame.size = static_cast<std::uint8_t>(next() >> 28U & 7U);
    for (std::uint8_t& byte : frame.data) {
      byte = next() >> 30U == 0 ? static_cast<std::uint8_t>(next() >> 24U) : std::uint8_t{0};
    }
    ASSERT_LE(wireBits(frame), mostBits(frame));
    ASSERT_GE(wireBits(frame), mostBits(Frame(0, {})) - 8U);
  }
}

TEST(FrameBitsTest, AnErrorFrameIsNotSent) {
  Frame frame;
  frame.error = true;
  EXPECT_EQ(wireBits(frame), 0u);
}

}  // namespace
}  // namespace cia402::can
