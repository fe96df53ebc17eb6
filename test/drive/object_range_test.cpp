// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/object_range.h"

#include <gtest/gtest.h>

namespace cia402::drive {
namespace {

using fieldbus::ObjectId;

void expectRange(const char* text, ObjectId first, ObjectId last) {
  const auto range = parseObjectRange(text);
  ASSERT_TRUE(range) << text;
  EXPECT_EQ(range->first, first) << text;
  EXPECT_EQ(range->last, last) << text;
}

TEST(ObjectRange, IsReadFromIndicesAndSubIndices) {
  expectRange("2004", {0x2004, 0}, {0x2004, 0xFF});
  expectRange("2004:01", {0x2004, 1}, {0x2004, 1});
  expectRange("2002:01-0C", {0x2002, 1}, {0x2002, 0x0C});
  expectRange("2002:01-2006:02", {0x2002, 1}, {0x2006, 2});
  expectRange("2003-20FF", {0x2003, 0}, {0x20FF, 0xFF});
  expectRange("0x2003-0x20FF", {0x2003, 0}, {0x20FF, 0xFF});
  expectRange("2003:02-2004", {0x2003, 2}, {0x2004, 0xFF});
}

TEST(ObjectRange, RefusesWhatIsNone) {
  for (const char* text : {"", "-", "2004-", "-2004", "gain", "2004:", "2004-2003", "2004:03-02",
                           "2004:01-02-03", "20041", "2004:100"}) {
    EXPECT_FALSE(parseObjectRange(text)) << text;
  }
}

TEST(ObjectRanges, TheNarrowestCounts) {
  ObjectRanges<int> ranges;
  EXPECT_EQ(ranges.find({0x2000, 0}), nullptr);
  ranges.add(*parseObjectRange("2004:01"), 1);
  ranges.add(*parseObjectRange("2000-20FF"), 2);
  ranges.add(*parseObjectRange("2004"), 3);
  ranges.add(*parseObjectRange("2005"), 4);
  ranges.add(*parseObjectRange("2005"), 5);
  EXPECT_EQ(*ranges.find({0x2004, 1}), 1);
  EXPECT_EQ(*ranges.find({0x2004, 2}), 3);
  EXPECT_EQ(*ranges.find({0x2005, 0}), 5);
  EXPECT_EQ(*ranges.find({0x20FF, 0xFF}), 2);
  EXPECT_EQ(ranges.find({0x2100, 0}), nullptr);
}

}  // namespace
}  // namespace cia402::drive
