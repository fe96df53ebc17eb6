// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/value.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <locale>
#include <string>

#include "canopen/eds/eds.h"
#include "canopen/eds/problems.h"

namespace cia402::canopen {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr NodeId kNode = 5;

ObjectValue textBytes(const std::string& bytes) { return {bytes.begin(), bytes.end()}; }

/// In its scope numbers have a decimal comma and dots between thousands, as in Germany.
class GermanNumbers {
 public:
  ~GermanNumbers() { std::locale::global(before_); }

 private:
  struct Punctuation : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::locale before_ = std::locale::global(std::locale(std::locale::classic(), new Punctuation));
};

TEST(EdsValue, TextIsReadAsItsType) {
  const struct {
    DataType type;
    const char* text;
    ObjectValue bytes;
  } rows[] = {
      {DataType::uint8, "7", {7}},
      {DataType::uint16, "2.0", {2, 0}},
      {DataType::int8, "-3.0", {0xFD}},
      {DataType::boolean, "true", {1}},
      {DataType::boolean, "FALSE", {0}},
      // IEEE 754: 1.5 is 1.1b * 2^0, 3FC00000h and 3FF8000000000000h.
      {DataType::real32, "1.5", {0, 0, 0xC0, 0x3F}},
      {DataType::real32, "0x3FC00000", {0, 0, 0xC0, 0x3F}},
      {DataType::real32, "0x0", {0, 0, 0, 0}},
      {DataType::real64, "0x3FF8000000000000", {0, 0, 0, 0, 0, 0, 0xF8, 0x3F}},
      {DataType::octet_string, "0xDEADBEEF", {0xDE, 0xAD, 0xBE, 0xEF}},
      {DataType::octet_string, "de ad\tBE EF", {0xDE, 0xAD, 0xBE, 0xEF}},
      {DataType::domain, "0X01", {1}},
      {DataType::visible_string, "0x01", {'0', 'x', '0', '1'}},
  };
  for (const auto& row : rows) {
    const EdsValue value = parseEdsValue(row.text, row.type, kNode);
    EXPECT_EQ(value.bytes, row.bytes) << row.text << " as " << toString(row.type);
    EXPECT_THAT(value.error, IsEmpty()) << row.text;
  }
}

TEST(EdsValue, TextThatIsNoneOfItsTypeIsRefusedWithTheReason) {
  const struct {
    DataType type;
    const char *text, *error;
  } rows[] = {
      {DataType::boolean, "maybe", "is no whole number"},
      {DataType::uint8, "true", "is no whole number"},
      {DataType::int32, "0.5", "is no whole number"},
      {DataType::real32, "0x3FC0000", "nor all 8 digits of the bits of a real32"},
      {DataType::real32, "0x3FC000000", "nor all 8 digits of the bits of a real32"},
      {DataType::real32, "0x3FC0000G", "nor all 8 digits of the bits of a real32"},
      {DataType::real64, "0x3FC00000", "nor all 16 digits of the bits of a real64"},
      {DataType::real32, "1e39", "does not fit real32"},
      {DataType::real32, "fast", "is no number"},
  };
  for (const auto& row : rows) {
    const EdsValue value = parseEdsValue(row.text, row.type, kNode);
    EXPECT_FALSE(value.bytes) << row.text << " as " << toString(row.type);
    EXPECT_THAT(value.error, HasSubstr(row.error)) << row.text << " as " << toString(row.type);
  }
}

// Two's complement of n bits: -2^(n-1) to 2^(n-1) - 1.
TEST(EdsValue, TheLowestNumberOfASignedTypeIsTakenAndTheOneBelowItRefused) {
  const struct {
    DataType type;
    const char *lowest, *below, *range;
  } rows[] = {
      {DataType::int8, "-128", "-129", "int8 (-128..127)"},
      {DataType::int16, "-32768", "-32769", "int16 (-32768..32767)"},
      {DataType::int24, "-8388608", "-8388609", "int24 (-8388608..8388607)"},
      {DataType::int32, "-2147483648", "-2147483649", "int32 (-2147483648..2147483647)"},
      {DataType::int64, "-9223372036854775808", "-9223372036854775809",
       "int64 (-9223372036854775808..9223372036854775807)"},
  };
  for (const auto& row : rows) {
    ObjectValue lowest(sizeBits(row.type) / 8, 0);
    lowest.back() = 0x80;
    EXPECT_EQ(parseEdsValue(row.lowest, row.type, kNode).bytes, lowest) << row.lowest;
    const EdsValue below = parseEdsValue(row.below, row.type, kNode);
    EXPECT_FALSE(below.bytes) << row.below;
    EXPECT_THAT(below.error, HasSubstr(row.range)) << row.below;
  }
}

// Who writes FFFFh for an int16 means its bits and says so; who writes 65535 may have erred.
TEST(EdsValue, BitsOfASignedTypeAreToldOnlyWhereTheyAreWrittenAsANumber) {
  const auto note = [](const char* text) {
    const EdsValue value = parseEdsValue(text, DataType::int16, kNode);
    EXPECT_EQ(value.bytes, (ObjectValue{0xFF, 0xFF})) << text;
    return value.note;
  };
  EXPECT_THAT(note("0xFFFF"), IsEmpty());
  EXPECT_EQ(note("FFFFh"), "`FFFFh` should be written 0xFFFF");
  EXPECT_EQ(note("0177777"), "`0177777` is octal, 65535");
  EXPECT_THAT(note("65535"), HasSubstr("is taken as -1"));
}

TEST(EdsValue, AFormulaIsTheNodeIdWithOneNumberAddedToIt) {
  const auto sum = [](const char* text) { return parseEdsValue(text, DataType::uint64, kNode); };
  EXPECT_EQ(sum("$NODEID").bytes, (ObjectValue{5, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sum("$nodeid + 0x7FFFFFFFFFFFFFFF").bytes, (ObjectValue{4, 0, 0, 0, 0, 0, 0, 0x80}));
  EXPECT_EQ(sum("0x180+$NODEID").bytes, (ObjectValue{0x85, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sum("$NODEID+0xFFFFFFFFFFFFFFFA").bytes, ObjectValue(8, 0xFF));
  EXPECT_FALSE(sum("$NODEID+0xFFFFFFFFFFFFFFFB").bytes);
  EXPECT_THAT(sum("$NODEID+0xFFFFFFFFFFFFFFFB").error, HasSubstr("does not fit uint64"));
  for (const char* wrong : {"$NODEID+", "+$NODEID", "$NODEID-5", "$NODEID+-5", "-5+$NODEID",
                            "$NODEID+x", "x+$NODEID", "$NODEID 5", "5 $NODEID"}) {
    EXPECT_FALSE(sum(wrong).bytes) << wrong;
    EXPECT_THAT(sum(wrong).error, HasSubstr("is no formula")) << wrong;
  }
}

// The first and the last character of each length in UTF-8 and UTF-16, and some between. Unicode
// Standard, tables 3-5 and 3-6.
TEST(EdsValue, UnicodeTextIsUtf16OnTheWireAndUtf8InTheFile) {
  const struct {
    const char* utf8;
    ObjectValue utf16;
  } rows[] = {
      {"\x7E", {0x7E, 0x00}},                          // U+007E
      {"\xC2\x80", {0x80, 0x00}},                      // U+0080
      {"\xDF\xBF", {0xFF, 0x07}},                      // U+07FF
      {"\xE0\xA0\x80", {0x00, 0x08}},                  // U+0800
      {"\xEE\x80\x80", {0x00, 0xE0}},                  // U+E000
      {"\xEF\xBF\xBF", {0xFF, 0xFF}},                  // U+FFFF
      {"\xF0\x90\x80\x80", {0x00, 0xD8, 0x00, 0xDC}},  // U+10000
      {"\xF0\x9F\xA4\x96", {0x3E, 0xD8, 0x16, 0xDD}},  // U+1F916
      {"\xF4\x8F\xBF\xBF", {0xFF, 0xDB, 0xFF, 0xDF}},  // U+10FFFF
      {"\xF0\x9F\xA4\x96 is a robot",
       {0x3E, 0xD8, 0x16, 0xDD, ' ', 0,   'i', 0,   's', 0,   ' ', 0,   'a',
        0,    ' ',  0,    'r',  0,   'o', 0,   'b', 0,   'o', 0,   't', 0}},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(parseEdsValue(row.utf8, DataType::unicode_string, kNode).bytes, row.utf16)
        << row.utf8;
    EXPECT_EQ(formatEdsValue(row.utf16, DataType::unicode_string), row.utf8);
  }
}

TEST(EdsValue, HalfACharacterOfUtf16IsWrittenToNoLine) {
  for (const ObjectValue& value :
       {ObjectValue{'a'}, ObjectValue{'a', 0, 'b'},
        ObjectValue{0x3E, 0xD8},  // the first half, then nothing
        ObjectValue{0x3E, 0xD8, 'a', 0}, ObjectValue{0x3E, 0xD8, 0xFF, 0xDB},
        ObjectValue{0x3E, 0xD8, 0x00, 0xE0}, ObjectValue{0x00, 0xDC},  // the second half alone
        ObjectValue{0xFF, 0xDF}}) {
    EXPECT_EQ(formatEdsValue(value, DataType::unicode_string), std::nullopt)
        << testing::PrintToString(value);
  }
}

TEST(EdsValue, NumbersAreWrittenSoThatTheyReadBackEqual) {
  const struct {
    DataType type;
    ObjectValue bytes;
    const char* text;
  } rows[] = {
      {DataType::uint8, {5}, "0x05"},
      {DataType::uint16, {0xCD, 0xAB}, "0xABCD"},
      {DataType::uint24, {0x01, 0, 0}, "0x000001"},
      {DataType::boolean, {1}, "0x01"},
      {DataType::int16, {0xFE, 0xFF}, "-2"},
      {DataType::int64, ObjectValue(8, 0xFF), "-1"},
      // IEEE 754: nine digits tell any two numbers of 32 bits apart, seventeen any two of 64.
      {DataType::real32, {0xCD, 0xCC, 0xCC, 0x3D}, "0.100000001"},
      {DataType::real64, {0x9A, 0x99, 0x99, 0x99, 0x99, 0x99, 0xB9, 0x3F}, "0.10000000000000001"},
      {DataType::real32, {0, 0, 0x80, 0x7F}, "0x7F800000"},  // infinite
      {DataType::octet_string, {0, 0xAB}, "00AB"},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(formatEdsValue(row.bytes, row.type), row.text);
    EXPECT_EQ(parseEdsValue(row.text, row.type, kNode).bytes, row.bytes) << row.text;
  }
}

TEST(EdsValue, ALanguageWithADecimalCommaChangesNothing) {
  const GermanNumbers german;
  EXPECT_EQ(parseEdsValue("1.5", DataType::real32, kNode).bytes, (ObjectValue{0, 0, 0xC0, 0x3F}));
  EXPECT_EQ(formatEdsValue({0, 0, 0xC0, 0x3F}, DataType::real32), "1.5");
  EXPECT_EQ(formatEdsValue({0xFF, 0xFF, 0xFF, 0xFF}, DataType::uint32), "0xFFFFFFFF");
}

TEST(EdsValue, WhatALineCanHoldIsKnown) {
  const struct {
    DataType type;
    ObjectValue bytes;
    bool fits;
  } rows[] = {
      {DataType::uint16, {1, 2}, true},
      {DataType::uint16, {1}, false},
      {DataType::uint16, {1, 2, 3}, false},
      {DataType::boolean, {1}, true},
      {DataType::boolean, {2}, false},
      {DataType::visible_string, textBytes("a;b c"), true},
      {DataType::visible_string, textBytes("a ;b"), false},  // would begin a comment
      {DataType::visible_string, textBytes("a\nb"), false},
      {DataType::visible_string, {}, false},
      {DataType::domain, {0}, true},
      {DataType::domain, {}, false},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(fitsDcf(row.type, row.bytes), row.fits)
        << toString(row.type) << " " << testing::PrintToString(row.bytes);
  }
}

TEST(EdsValue, LongTextIsCutInMessages) {
  EXPECT_EQ(quoteEds(std::string(60, 'x')), "`" + std::string(60, 'x') + "`");
  EXPECT_EQ(quoteEds(std::string(61, 'x')), "`" + std::string(60, 'x') + "...`");
  EXPECT_EQ(quoteEds("a\x1B[31m"), "`a?[31m`");
}

}  // namespace
}  // namespace cia402::canopen
