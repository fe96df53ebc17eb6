// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/object.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

TEST(ObjectId, prints_four_and_two_upper_case_digits) {
  EXPECT_EQ(toString(ObjectId{0x6041, 0}), "6041:00");
  EXPECT_EQ(toString(ObjectId{0x1A0F, 0xAB}), "1A0F:AB");
  EXPECT_EQ(toString(ObjectId{0x0005, 1}), "0005:01");
}

TEST(ObjectId, reads_every_documented_spelling) {
  for (const char* text : {"6041:00", "0x6041:0", "0x6041", "6041", "0X6041:0x00"}) {
    EXPECT_EQ(parseObjectId(text), (ObjectId{0x6041, 0})) << text;
  }
  EXPECT_EQ(parseObjectId("1a00:0b"), (ObjectId{0x1A00, 0x0B}));
}

TEST(ObjectId, refuses_what_is_no_address) {
  for (const char* text : {"", ":", "6041:", ":00", "0x", "60410", "6041:100", "6041:00:00",
                           "statusword", "6041 ", " 6041", "-1", "6041:-1"}) {
    EXPECT_FALSE(parseObjectId(text).has_value()) << text;
  }
}

TEST(ObjectId, is_ordered_by_index_then_sub_index) {
  EXPECT_LT((ObjectId{0x1018, 4}), (ObjectId{0x1019, 0}));
  EXPECT_LT((ObjectId{0x1018, 1}), (ObjectId{0x1018, 2}));
  EXPECT_FALSE((ObjectId{0x1018, 1}) < (ObjectId{0x1018, 1}));
}

// CiA 301, table 44; strings and domains have no fixed length.
TEST(DataType, knows_size_sign_and_name) {
  struct Row {
    DataType type;
    const char* name;
    unsigned bits;
    bool is_signed;
  };
  const Row rows[] = {
      {DataType::boolean, "boolean", 1, false},
      {DataType::int8, "int8", 8, true},
      {DataType::int16, "int16", 16, true},
      {DataType::int24, "int24", 24, true},
      {DataType::int32, "int32", 32, true},
      {DataType::int40, "int40", 40, true},
      {DataType::int48, "int48", 48, true},
      {DataType::int56, "int56", 56, true},
      {DataType::int64, "int64", 64, true},
      {DataType::uint8, "uint8", 8, false},
      {DataType::uint16, "uint16", 16, false},
      {DataType::uint24, "uint24", 24, false},
      {DataType::uint32, "uint32", 32, false},
      {DataType::uint40, "uint40", 40, false},
      {DataType::uint48, "uint48", 48, false},
      {DataType::uint56, "uint56", 56, false},
      {DataType::uint64, "uint64", 64, false},
      {DataType::real32, "real32", 32, true},
      {DataType::real64, "real64", 64, true},
      {DataType::visible_string, "visible_string", 0, false},
      {DataType::octet_string, "octet_string", 0, false},
      {DataType::unicode_string, "unicode_string", 0, false},
      {DataType::time_of_day, "time_of_day", 48, false},
      {DataType::time_difference, "time_difference", 48, false},
      {DataType::domain, "domain", 0, false},
  };
  for (const Row& row : rows) {
    EXPECT_STREQ(toString(row.type), row.name);
    EXPECT_EQ(sizeBits(row.type), row.bits) << row.name;
    EXPECT_EQ(isSigned(row.type), row.is_signed) << row.name;
    EXPECT_EQ(parseDataType(row.name), row.type) << row.name;
  }
  EXPECT_FALSE(parseDataType("float").has_value());
}

}  // namespace
}  // namespace cia402::canopen
