// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "../../src/canopen/eds_text.h"

#include <gtest/gtest.h>

#include <string>

namespace cia402::canopen {
namespace {

// The Unicode Standard, table 3-7, "Well-Formed UTF-8 Byte Sequences": the ends of each row.
TEST(EdsText, WellFormedUtf8IsKnownByItsBytes) {
  for (const char* text : {
           "",
           "plain",
           "\x7F",  //
           "\xC2\x80",
           "\xDF\xBF",  // U+0080 .. U+07FF
           "\xE0\xA0\x80",
           "\xE0\xBF\xBF",  // U+0800 .. U+0FFF
           "\xE1\x80\x80",
           "\xEC\xBF\xBF",  // U+1000 .. U+CFFF
           "\xED\x80\x80",
           "\xED\x9F\xBF",  // U+D000 .. U+D7FF
           "\xEE\x80\x80",
           "\xEF\xBF\xBF",  // U+E000 .. U+FFFF
           "\xF0\x90\x80\x80",
           "\xF0\xBF\xBF\xBF",  // U+10000 .. U+3FFFF
           "\xF1\x80\x80\x80",
           "\xF3\xBF\xBF\xBF",  // U+40000 .. U+FFFFF
           "\xF4\x80\x80\x80",
           "\xF4\x8F\xBF\xBF",  // U+100000 .. U+10FFFF
           "a\xC3\xBC"
           "b\xE2\x82\xAC"
           "c\xF0\x9F\xA4\x96"
           "d",
       }) {
    EXPECT_TRUE(isUtf8(text)) << text;
  }
}

// Of a `char` without a sign all bytes of UTF-8 are above 0, of one with a sign all are below it.
TEST(EdsText, ControlCharactersAreThoseOfAsciiWhateverTheSignOfChar) {
  for (const char c : {'\0', '\t', '\x1F', '\x7F'}) EXPECT_TRUE(isControl(c)) << int{c};
  for (const char c : {' ', 'a', '~', '\x80', '\xC3', '\xFF'}) EXPECT_FALSE(isControl(c)) << int{c};
}

TEST(EdsText, BytesThatAreNoUtf8AreKnown) {
  for (const char* text : {
           "\x80",
           "\xBF",
           "\xC0\x80",
           "\xC1\xBF",  // no first bytes
           "\xF5\x80\x80\x80",
           "\xFF",  //
           "\xC2",
           "\xE1\x80",
           "\xF1\x80\x80",  // cut off
           "\xC2\x7F",
           "\xC2\xC0",
           "\xDF"
           "a",  // no continuation
           "\xE1\x80\x7F",
           "\xE1\x80\xC0",
           "\xF1\x80\x80\x7F",  //
           "\xE0\x9F\xBF",
           "\xF0\x8F\xBF\xBF",  // overlong
           "\xED\xA0\x80",
           "\xED\xBF\xBF",      // half a pair
           "\xF4\x90\x80\x80",  // beyond U+10FFFF
           "\xE1\x7F\x80",
           "\xE1\xC0\x80",
           "\xF1\x7F\x80\x80",
           "\xF1\xC0\x80\x80",
       }) {
    EXPECT_FALSE(isUtf8(text)) << testing::PrintToString(std::string(text));
  }
}

}  // namespace
}  // namespace cia402::canopen
