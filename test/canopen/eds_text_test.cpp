// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "canopen/eds/eds.h"

namespace cia402::canopen {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The sections of a text, and what is wrong with it.
struct ReadText {
  explicit ReadText(std::string_view text) : sections(text, problems_) {
    Eds eds;
    problems_.moveTo(eds);
    for (const EdsProblem& problem : eds.problems) problems.push_back(toString(problem));
  }
  std::string value(const std::string& section, const std::string& key) const {
    const EdsSection* found = sections.find(section);
    const EdsKey* line = found != nullptr ? found->find(key) : nullptr;
    return line != nullptr ? line->value : "none";
  }

 private:
  EdsProblems problems_;

 public:
  const EdsText sections;
  std::vector<std::string> problems;
};

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

TEST(EdsText, BytesBehindTheTextDoNotCount) {
  EXPECT_TRUE(isUtf8(std::string_view("a\xFF", 1)));
  EXPECT_FALSE(isUtf8(std::string_view("\xC2\x80", 1)));
}

TEST(EdsText, TheLastLineNeedsNoEnd) {
  const ReadText read("[2001]\nDataType=7");
  EXPECT_THAT(read.problems, IsEmpty());
  EXPECT_EQ(read.value("2001", "datatype"), "7");
  EXPECT_EQ(read.sections.lastLine(), 2U);
}

TEST(EdsText, BlanksBeforeALineDoNotMatter) {
  const ReadText read("  [2001]  \n \tDataType = 7 \n  ; comment\n\t# comment\n   \n");
  EXPECT_THAT(read.problems, IsEmpty());
  EXPECT_EQ(read.value("2001", "datatype"), "7");
}

TEST(EdsText, LinesBeforeTheFirstSectionAreToldOnce) {
  const ReadText read("one\ntwo=2\n[2001]\nDataType=7\n");
  EXPECT_THAT(read.problems,
              ElementsAre("line 1: error: `one` stands before the first section and is ignored"));
  EXPECT_EQ(read.value("2001", "datatype"), "7");
}

TEST(EdsText, LinesOfASectionWithoutANameAreToldWithIt) {
  const ReadText read("[ ]\none\ntwo=2\n");
  EXPECT_THAT(read.problems,
              ElementsAre("line 1: error: a section without a name; its lines are ignored"));
  EXPECT_THAT(read.sections.sections(), IsEmpty());
}

TEST(EdsText, ACommentBehindANameWithoutItsBracketIsNoPartOfIt) {
  const ReadText read("[2001 ; the gain\nDataType=7\n");
  EXPECT_EQ(read.value("2001", "datatype"), "7");
  EXPECT_THAT(read.problems, ElementsAre(HasSubstr("line 1: warning: the `]` behind")));
}

TEST(EdsText, ControlCharactersBecomeQuestionMarksAndTabulatorsBlanks) {
  const char bytes[] = "[2001]\nParameterName=a\0b\x1B[\x7F]\nDenotation=a\tb\nDataType=7\n";
  const ReadText read(std::string_view(bytes, sizeof bytes - 1));
  EXPECT_EQ(read.value("2001", "parametername"), "a?b?[?]");
  EXPECT_EQ(read.value("2001", "denotation"), "a b");
  EXPECT_EQ(read.value("2001", "datatype"), "7");
  EXPECT_THAT(read.problems, ElementsAre("line 2: warning: a control character is read as `?`"));
}

TEST(EdsText, TheLongestFileIsReadAndALongerOneIsCutOff) {
  const std::string end = "\n[2001]\nDataType=7";
  std::string text = ";" + std::string(kLongestEds - 1 - end.size(), 'x') + end;
  ASSERT_EQ(text.size(), kLongestEds);
  const ReadText longest(text);
  EXPECT_THAT(longest.problems, IsEmpty());
  EXPECT_EQ(longest.value("2001", "datatype"), "7");
  text += "89";
  const ReadText longer(text);
  EXPECT_THAT(longer.problems, ElementsAre("line 1: error: the file is longer than 32 MiB; the "
                                           "rest is not read"));
  EXPECT_EQ(longer.value("2001", "datatype"), "7");
}

}  // namespace
}  // namespace cia402::canopen
