// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/widths.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

constexpr ObjectId kMode{0x6060, 0}, kOther{0x6061, 0};

TEST(ObjectWidths, make_what_is_written_as_long_as_the_drive_has_it) {
  ObjectWidths widths;
  widths.add({kMode, 1, 2, true});
  EXPECT_EQ(widths.toDrive(kMode, {0x03}), (Bytes{0x03, 0x00}));
  EXPECT_EQ(widths.toDrive(kMode, {0xFF}), (Bytes{0xFF, 0xFF})) << "-1 stays -1";
  EXPECT_EQ(widths.toDrive(kOther, {0xFF}), (Bytes{0xFF}));
  EXPECT_EQ(widths.toDrive(kMode, {0x03, 0x00}), (Bytes{0x03, 0x00})) << "it is as long already";
}

TEST(ObjectWidths, fill_numbers_without_a_sign_with_zeros) {
  ObjectWidths widths;
  widths.add({kMode, 1, 4, false});
  EXPECT_EQ(widths.toDrive(kMode, {0xFF}), (Bytes{0xFF, 0, 0, 0}));
}

TEST(ObjectWidths, make_what_is_read_as_short_as_it_is_assumed) {
  ObjectWidths widths;
  widths.add({kMode, 1, 2, true});
  EXPECT_EQ(widths.fromDrive(kMode, {0xFF, 0xFF}), (Bytes{0xFF}));
  EXPECT_EQ(widths.fromDrive(kMode, {0x03}), (Bytes{0x03}));
  EXPECT_EQ(widths.fromDrive(kOther, {0x03, 0x00}), (Bytes{0x03, 0x00}));
  widths.clear();
  EXPECT_EQ(widths.fromDrive(kMode, {0xFF, 0xFF}), (Bytes{0xFF, 0xFF})) << "another drive";
}

}  // namespace
}  // namespace cia402::canopen
