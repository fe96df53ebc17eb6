// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/position_unwrap.h"

#include <gtest/gtest.h>

namespace cia402::drive {
namespace {

TEST(PositionUnwrap, CountsWrapsBothWays) {
  PositionUnwrap unwrap(32, true);
  EXPECT_FALSE(unwrap.update(0x7FFFFFF0));
  EXPECT_TRUE(unwrap.update(0x80000010));
  EXPECT_EQ(unwrap.wraps(), 1);
  EXPECT_FALSE(unwrap.update(0xFFFFFFFF));
  EXPECT_FALSE(unwrap.update(0x00000001)) << "zero is no wrap";
  EXPECT_FALSE(unwrap.update(0x7FFFFFFF));
  EXPECT_TRUE(unwrap.update(0x80000000));
  EXPECT_EQ(unwrap.wraps(), 2);
  EXPECT_TRUE(unwrap.update(0x7FFFFFFF));
  EXPECT_EQ(unwrap.wraps(), 1);
}

TEST(PositionUnwrap, UnsignedNumbersWrapAtZero) {
  PositionUnwrap unwrap(16, false);
  EXPECT_FALSE(unwrap.update(0x0010));
  EXPECT_TRUE(unwrap.update(0xFFF0));
  EXPECT_EQ(unwrap.wraps(), -1);
  EXPECT_FALSE(unwrap.update(0x8001));
  EXPECT_FALSE(unwrap.update(0x7FFF)) << "the middle is no wrap";
}

TEST(PositionUnwrap, TakesTheShorterWayAfterASilence) {
  PositionUnwrap unwrap(32, true);
  unwrap.update(0x40000000);
  EXPECT_TRUE(unwrap.update(0xA0000000)) << "0x60000000 up, less than half the range";
  EXPECT_EQ(unwrap.wraps(), 1);
  EXPECT_FALSE(unwrap.update(0xE0000000));
}

TEST(PositionUnwrap, AnotherZeroIsNoMotion) {
  PositionUnwrap unwrap(32, true);
  unwrap.update(0x7FFFFFFF);
  unwrap.update(0x80000000);
  unwrap.restart(true);
  EXPECT_EQ(unwrap.wraps(), 0);
  unwrap.update(0x90000000);
  EXPECT_FALSE(unwrap.update(0x7F000000)) << "the drive has set its position";
  unwrap.resume();
  EXPECT_TRUE(unwrap.update(0x80000000));
  EXPECT_EQ(unwrap.wraps(), 1);
}

TEST(PositionUnwrap, CountsNothingUnlessAsked) {
  PositionUnwrap unwrap;
  unwrap.update(0x7FFFFFFF);
  EXPECT_FALSE(unwrap.update(0x80000000));
  EXPECT_EQ(unwrap.wraps(), 0);
}

}  // namespace
}  // namespace cia402::drive
