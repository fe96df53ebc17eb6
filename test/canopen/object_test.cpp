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

TEST(DataType, knows_size_sign_and_name) {
  EXPECT_EQ(sizeBits(DataType::boolean), 1U);
  EXPECT_EQ(sizeBits(DataType::int8), 8U);
  EXPECT_EQ(sizeBits(DataType::uint16), 16U);
  EXPECT_EQ(sizeBits(DataType::real32), 32U);
  EXPECT_EQ(sizeBits(DataType::uint64), 64U);
  EXPECT_EQ(sizeBits(DataType::visible_string), 0U);
  EXPECT_TRUE(isSigned(DataType::int32));
  EXPECT_TRUE(isSigned(DataType::real64));
  EXPECT_FALSE(isSigned(DataType::uint32));
  EXPECT_STREQ(toString(DataType::uint16), "uint16");
}

TEST(DataType, names_are_read_back) {
  for (const DataType type :
       {DataType::boolean, DataType::int8, DataType::int16, DataType::int32, DataType::int64,
        DataType::uint8, DataType::uint16, DataType::uint32, DataType::uint64, DataType::real32,
        DataType::real64, DataType::visible_string, DataType::octet_string, DataType::domain}) {
    EXPECT_EQ(parseDataType(toString(type)), type) << toString(type);
  }
  EXPECT_FALSE(parseDataType("float").has_value());
}

}  // namespace
}  // namespace cia402::canopen
