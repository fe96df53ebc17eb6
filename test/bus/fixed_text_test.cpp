// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/fixed_text.h"

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

TEST(FixedText, IsEmptyAtFirst) {
  EXPECT_TRUE(FixedText<8>().empty());
  EXPECT_EQ(FixedText<8>().str(), "");
}

TEST(FixedText, HoldsATextThatJustFits) {
  const FixedText<8> text("12345678");
  EXPECT_EQ(text.str(), "12345678");
  EXPECT_TRUE(text == "12345678");
}

TEST(FixedText, CutsALongerTextAndMarksIt) {
  EXPECT_EQ(FixedText<8>("123456789").str(), "12345...");
}

TEST(FixedText, ForgetsTheOldTextWhenAssigned) {
  FixedText<8> text("long one");
  text.assign("s");
  EXPECT_EQ(text.str(), "s");
  EXPECT_TRUE(text != "long one");
}

TEST(FixedText, KeepsZeroBytes) {
  EXPECT_EQ(FixedText<8>(std::string_view("a\0b", 3)).view().size(), 3u);
}

}  // namespace
}  // namespace cia402::bus
