// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "common/text.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace cia402 {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(Text, joins_a_list) {
  std::string list;
  append(list, "a");
  append(list, "b");
  EXPECT_EQ(list, "a; b");
  EXPECT_EQ(joined({"a", "b", "c"}, ", "), "a, b, c");
  EXPECT_EQ(joined({}), "");
}

TEST(Text, writes_hexadecimal_numbers_in_at_least_so_many_digits) {
  EXPECT_EQ(hexText(0x237, 4), "0x0237");
  EXPECT_EQ(hexText(0x18FEEE31, 3), "0x18FEEE31");
  EXPECT_EQ(hexText(~std::uint64_t{0}, 16), "0xFFFFFFFFFFFFFFFF");
}

TEST(Text, writes_bytes_in_their_order) {
  const std::array<std::uint8_t, 3> bytes = {0x08, 0x00, 0xFA};
  EXPECT_EQ(hexBytes(bytes.data(), bytes.size()), "08 00 FA");
  EXPECT_EQ(hexBytes(bytes.data(), 0), "");
}

TEST(Text, writes_numbers_in_as_many_digits_as_it_takes) {
  EXPECT_EQ(numberText(0.25), "0.25");
  EXPECT_EQ(numberText(1.0 / 3.0, 3), "0.333");
  EXPECT_EQ(numberText(std::nan("")), "nan");
}

TEST(Text, writes_durations) {
  EXPECT_EQ(secondsText(milliseconds(250)), "0.25 s");
  EXPECT_EQ(secondsText(milliseconds(150000)), "150 s");
  EXPECT_EQ(secondsText(milliseconds(250), 3), "0.250 s");
  EXPECT_EQ(millisecondsText(microseconds(1250)), "1.25 ms");
  EXPECT_EQ(millisecondsText(microseconds(1256), 3), "1.26 ms");
}

}  // namespace
}  // namespace cia402
