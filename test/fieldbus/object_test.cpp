// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/object.h"

#include <gtest/gtest.h>

namespace cia402::fieldbus {
namespace {

TEST(ObjectId, prints_four_and_two_upper_case_digits) {
  EXPECT_EQ(toString(ObjectId{0x6041, 0}), "6041:00");
  EXPECT_EQ(toString(ObjectId{0x1A0F, 0xAB}), "1A0F:AB");
  EXPECT_EQ(toString(ObjectId{0x0005, 1}), "0005:01");
}

TEST(ObjectId, reads_every_documented_spelling) {
  for (const char* text :
       {"6041:00", "0x6041:0", "0x6041", "6041", "0X6041:0x00", "6041h:0", "6041h", "6041H:00h"}) {
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

// What `rosservice call ... 0x6041` and an unquoted `object: 6041:00` arrive as.
TEST(ObjectId, reads_what_yaml_makes_of_an_address) {
  EXPECT_EQ(parseObjectAddress("24641"), (ObjectId{0x6041, 0}));      // 0x6041
  EXPECT_EQ(parseObjectAddress("12289"), (ObjectId{0x3001, 0}));      // 0x3001
  EXPECT_EQ(parseObjectAddress("49151"), (ObjectId{0xBFFF, 0}));      // 0xBFFF
  EXPECT_EQ(parseObjectAddress("362460"), (ObjectId{0x6041, 0}));     // 6041:00 = 6041 * 60
  EXPECT_EQ(parseObjectAddress("363840"), (ObjectId{0x6064, 0}));     // 6064:00
  EXPECT_EQ(parseObjectAddress("61081"), (ObjectId{0x1018, 1}));      // 1018:1
  EXPECT_EQ(parseObjectAddress("60000"), (ObjectId{0x1000, 0}));      // 1000:00
  EXPECT_EQ(parseObjectAddress("61090"), (ObjectId{0x1018, 0x10}));   // 1018:10
  EXPECT_EQ(parseObjectAddress("599999"), (ObjectId{0x9999, 0x59}));  // 9999:59
  EXPECT_EQ(parseObjectAddress("6041h:0"), (ObjectId{0x6041, 0}));
  for (const char* text : {"49152", "59999", "600000", "024641", "4294967296"}) {
    EXPECT_FALSE(parseObjectAddress(text).has_value()) << text;
  }
}

TEST(ObjectId, knows_what_cannot_be_told_apart) {
  EXPECT_TRUE(isAmbiguousIndex("4120"));  // 4120h, or 0x1018
  EXPECT_TRUE(isAmbiguousIndex("4096"));
  for (const char* text : {"4095", "1018", "24641", "4120h", "0x4120", "4120:0", "41A0", ""}) {
    EXPECT_FALSE(isAmbiguousIndex(text)) << text;
  }
  EXPECT_EQ(unambiguousIndex("4120"), "4120h or, if 0x1018 is meant, 1018h");
}

TEST(ObjectId, is_ordered_by_index_then_sub_index) {
  EXPECT_LT((ObjectId{0x1018, 4}), (ObjectId{0x1019, 0}));
  EXPECT_LT((ObjectId{0x1018, 1}), (ObjectId{0x1018, 2}));
  EXPECT_FALSE((ObjectId{0x1018, 1}) < (ObjectId{0x1018, 1}));
}

// CiA 301, 7.5.2.8 to 7.5.2.10: device name, hardware and software version.
TEST(ObjectId, knows_the_texts_that_every_device_has) {
  for (const std::uint16_t index :
       {std::uint16_t{0x1008}, std::uint16_t{0x1009}, std::uint16_t{0x100A}}) {
    EXPECT_TRUE(isStandardText({index, 0})) << std::hex << index;
    EXPECT_FALSE(isStandardText({index, 1})) << std::hex << index;
  }
  for (const std::uint16_t index :
       {std::uint16_t{0x1007}, std::uint16_t{0x100B}, std::uint16_t{0x6041}}) {
    EXPECT_FALSE(isStandardText({index, 0})) << std::hex << index;
  }
}

TEST(DataType, has_short_words) {
  EXPECT_EQ(parseTypeWord("u8"), DataType::uint8);
  EXPECT_EQ(parseTypeWord("u24"), DataType::uint24);
  EXPECT_EQ(parseTypeWord("i16"), DataType::int16);
  EXPECT_EQ(parseTypeWord("i64"), DataType::int64);
  EXPECT_EQ(parseTypeWord("f32"), DataType::real32);
  EXPECT_EQ(parseTypeWord("f64"), DataType::real64);
  EXPECT_EQ(parseTypeWord("text"), DataType::visible_string);
  EXPECT_EQ(parseTypeWord("bytes"), DataType::octet_string);
  EXPECT_EQ(parseTypeWord("uint16"), DataType::uint16);
  for (const char* word : {"", "u", "i", "u7", "int", "u08", "U8", "ui8", "f16"}) {
    EXPECT_FALSE(parseTypeWord(word).has_value()) << word;
  }
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
}  // namespace cia402::fieldbus
