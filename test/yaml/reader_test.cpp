// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "yaml/reader.h"
#include "folders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace cia402::yaml {
namespace {

using testing::HasSubstr;

struct Reader {
  explicit Reader(const char* yaml, const char* source = "")
      : section(Value(YAML::Load(yaml), "top", problems, source)) {}
  Problems problems;
  Section section;
  std::string text() const { return problems.text(); }
};

TEST(YamlReader, ComesToAnEndWithATextThatEndsBehindAColon) {
  EXPECT_THROW(parse("a: {b:"), YAML::ParserException);
  EXPECT_EQ(parse("a: {b: 1}")["a"]["b"].as<int>(), 1);
}

TEST(YamlReader, SuggestsTheNearestKnownKey) {
  Reader reader("{velocty: 1.0}");
  double velocity = 0.0;
  reader.section.read("velocity", velocity);
  reader.section.finish();
  EXPECT_EQ(reader.text(), "  top/velocty: unknown key, did you mean `velocity`?\n");
}

TEST(YamlReader, ListsTheKnownKeysWhereNothingIsNear) {
  Reader reader("{colour: red}");
  reader.section.has("gear_ratio");
  reader.section.has("lead");
  reader.section.finish();
  EXPECT_EQ(reader.text(), "  top/colour: unknown key; known are gear_ratio, lead\n");
}

TEST(YamlReader, NoticesAKeyThatIsGivenTwice) {
  Reader reader("{a: 1, a: 2}");
  reader.section.has("a");
  reader.section.finish();
  EXPECT_EQ(reader.text(), "  top/a: is given twice\n");
}

TEST(YamlReader, NamesFileAndLine) {
  Reader reader("a: 1\nb:\n  - x\n", "file.yaml");
  double b = 0.0;
  EXPECT_FALSE(reader.section.read("b", b));
  EXPECT_EQ(reader.text(), "  file.yaml:3: top/b: must be a number, not a list\n");
}

TEST(YamlReader, ReadsWholeNumbersInDecimalAndHexadecimalOnly) {
  EXPECT_EQ(parseInteger("010"), 10);
  EXPECT_EQ(parseInteger("-7"), -7);
  EXPECT_EQ(parseInteger("0x80000181"), 0x80000181);
  for (const char* bad : {"", "-", "1.0", "12a", " 1", "0x", "99999999999999999999"}) {
    EXPECT_FALSE(parseInteger(bad)) << bad;
  }
}

TEST(YamlReader, RefusesNumbersThatAreNoneOrOutOfRange) {
  Reader reader("{nan: .nan, inf: -.inf, word: fast, zero: 0, big: 200, map: {}}");
  double number = 5.0;
  EXPECT_FALSE(reader.section.read("nan", number));
  EXPECT_FALSE(reader.section.read("inf", number));
  EXPECT_FALSE(reader.section.read("word", number));
  EXPECT_FALSE(reader.section.read("zero", number, kPositive));
  EXPECT_EQ(number, 5.0);
  int id = 3;
  EXPECT_FALSE(reader.section.readInteger("big", id, 1, 127));
  EXPECT_FALSE(reader.section.readInteger("map", id, 1, 127));
  EXPECT_EQ(id, 3);
  EXPECT_EQ(reader.text(),
            "  top/nan: must be a finite number, not `.nan`\n"
            "  top/inf: must be a finite number, not `-.inf`\n"
            "  top/word: must be a number, not `fast`\n"
            "  top/zero: must be greater than 0, not `0`\n"
            "  top/big: must be between 1 and 127, not `200`\n"
            "  top/map: must be a whole number, not a mapping\n");
}

TEST(YamlReader, ReadsTruthWordsAndParameterServerNumbers) {
  Reader reader("{a: true, b: 0, c: maybe}");
  bool a = false, b = true, c = true;
  EXPECT_TRUE(reader.section.read("a", a));
  EXPECT_TRUE(reader.section.read("b", b));
  EXPECT_FALSE(reader.section.read("c", c));
  EXPECT_TRUE(a && !b && c);
  EXPECT_THAT(reader.text(), HasSubstr("top/c: must be true or false"));
}

TEST(YamlReader, ReadsListsOfAKnownLength) {
  Reader reader("{xyz: [1, 2, 3], short: [1, 2], odd: [1, x, 3], none: 1}");
  EXPECT_EQ(reader.section.get("xyz")->numbers(3), (std::vector<double>{1, 2, 3}));
  EXPECT_FALSE(reader.section.get("short")->numbers(3));
  EXPECT_FALSE(reader.section.get("odd")->numbers(3));
  EXPECT_FALSE(reader.section.get("none")->numbers(3));
  EXPECT_THAT(reader.text(), HasSubstr("top/short: must be a list of 3 numbers, not of 2"));
  EXPECT_THAT(reader.text(), HasSubstr("top/odd[1]: must be a number"));
  EXPECT_THAT(reader.text(), HasSubstr("top/none: must be a list"));
}

TEST(YamlReader, WhatIsNoTextNoWordAndNoNameIsTold) {
  Reader reader("{empty: \"\", list: [1], word: thee, [a]: 1}");
  std::string text = "kept";
  EXPECT_FALSE(reader.section.read("empty", text));
  EXPECT_FALSE(reader.section.read("list", text));
  EXPECT_EQ(text, "kept");
  EXPECT_FALSE(reader.section.get("word")->oneOf({"one", "two", "three"}));
  EXPECT_EQ(reader.section.entries().size(), 3U);
  EXPECT_THAT(reader.text(), HasSubstr("  top/empty: must be a text, not "));
  EXPECT_THAT(reader.text(), HasSubstr("  top/list: must be a text, not a list\n"));
  EXPECT_THAT(reader.text(), HasSubstr("  top/word: unknown word `thee`, did you mean `three`?\n"));
  EXPECT_THAT(reader.text(), HasSubstr("  top: has a key that is not a name\n"));
}

TEST(YamlReader, TheBoundsThemselvesAreAllowed) {
  Reader reader("{low: 1, high: 127, below: 0, above: 128}");
  int id = 0;
  EXPECT_TRUE(reader.section.readInteger("low", id, 1, 127));
  EXPECT_EQ(id, 1);
  EXPECT_TRUE(reader.section.readInteger("high", id, 1, 127));
  EXPECT_EQ(id, 127);
  EXPECT_FALSE(reader.section.readInteger("below", id, 1, 127));
  EXPECT_FALSE(reader.section.readInteger("above", id, 1, 127));
  double number = 5.0;
  EXPECT_TRUE(reader.section.read("low", number, Range{1.0, 127.0, false}));
  EXPECT_EQ(number, 1.0);
  EXPECT_TRUE(reader.section.read("high", number, Range{1.0, 127.0, false}));
  EXPECT_EQ(number, 127.0);
  EXPECT_FALSE(reader.section.read("low", number, Range{1.0, 127.0, true}));
  EXPECT_FALSE(reader.section.read("below", number, Range{1.0, 127.0, false}));
  EXPECT_FALSE(reader.section.read("above", number, Range{1.0, 127.0, false}));
}

TEST(YamlReader, AScalarIsNoMapping) {
  Reader reader("just a text");
  EXPECT_EQ(reader.text(), "  top: must be a mapping (key: value), not `just a text`\n");
  EXPECT_FALSE(reader.section.has("a"));
}

TEST(YamlReader, FindsSwappedLettersButNotEveryShortWord) {
  EXPECT_EQ(nearestName("shoudler", {"elbow", "shoulder"}), "shoulder");
  EXPECT_EQ(nearestName("xyz", {"abc"}), "");
}

TEST(YamlReader, ListsEachKnownKeyOnceAndInOrder) {
  Reader reader("{colour: red}");
  for (const char* key : {"mode", "lead", "gear_ratio", "mode", "lead"}) reader.section.has(key);
  reader.section.finish();
  EXPECT_EQ(reader.text(), "  top/colour: unknown key; known are gear_ratio, lead, mode\n");
}

TEST(YamlReader, ListsSixtyNamesAndNotMore) {
  std::vector<std::string> names(60, "gear_ratio");
  EXPECT_EQ(suggestion("xy", names).substr(0, 22), "; known are gear_ratio");
  names.emplace_back("gear_ratio");
  EXPECT_EQ(suggestion("xy", names), "") << "would hide what is said";
  EXPECT_EQ(suggestion("gear_rato", names), ", did you mean `gear_ratio`?");
  EXPECT_EQ(suggestion("xy", {}), "");
}

TEST(YamlReader, TheNearestNameIsMeantUpToTwoMistakesOrAThirdOfItsLetters) {
  EXPECT_EQ(nearestName("veloc", {"volec", "veloce"}), "veloce");
  EXPECT_EQ(nearestName("lead", {"load"}), "load");           // one replaced
  EXPECT_EQ(nearestName("laed", {"lead"}), "lead");           // two neighbours swapped
  EXPECT_EQ(nearestName("mode", {"modes"}), "modes");         // one missing
  EXPECT_EQ(nearestName("modess", {"mode"}), "mode");         // two too many
  EXPECT_EQ(nearestName("modesss", {"mode"}), "");            // three
  EXPECT_EQ(nearestName("abcdefxyz", {"abcdef"}), "abcdef");  // three of nine
  EXPECT_EQ(nearestName("abcdefwxyz", {"abcdef"}), "");       // four of ten
  EXPECT_EQ(nearestName("pqcdefrs", {"xpcdefyr"}), "") << "moved and swapped are not the same";
  EXPECT_EQ(nearestName("xy", {"ab"}), "") << "nothing of it is left";
}

TEST(YamlReader, ReadsFilesAsText) {
  const YAML::Node profile =
      parseFile(cia402::test::configFolder() + "/drives/generic_cia402.yaml");
  EXPECT_EQ(profile["name"].as<std::string>(), "generic_cia402");
  EXPECT_THROW(parseFile("/nowhere/x.yaml"), YAML::BadFile);
}

TEST(YamlReader, ReadsNumbersAsPeopleWriteThem) {
  EXPECT_EQ(parseNumber("1.5"), 1.5);
  EXPECT_EQ(parseNumber("-2e-3"), -2e-3);
  EXPECT_EQ(parseNumber("0x1F"), 31.0);
  EXPECT_EQ(parseNumber("010"), 10.0);
  EXPECT_EQ(parseInteger("+7"), 7);
  EXPECT_EQ(parseInteger("0X1f"), 31);
  EXPECT_EQ(parseInteger("-0x10"), -16);
  EXPECT_EQ(parseInteger("9223372036854775807"), 9223372036854775807);
  for (const char* bad : {"", "fast", "1.5x", "--1", "+ 7", "9223372036854775808"}) {
    EXPECT_FALSE(parseInteger(bad)) << bad;
  }
  for (const char* bad : {"", "fast", "1.5x"}) EXPECT_FALSE(parseNumber(bad)) << bad;
}

TEST(YamlReader, SaysWhichNumbersAKeyTakes) {
  Reader reader("{a: 3}");
  double number = 0.0;
  EXPECT_FALSE(reader.section.read("a", number, Range{4.0, 5.0, false}));
  EXPECT_FALSE(reader.section.read("a", number, Range{3.0, 5.0, true}));
  EXPECT_FALSE(reader.section.read("a", number, Range{-std::numeric_limits<double>::max(), 2.0}));
  EXPECT_FALSE(reader.section.read("a", number, Range{4.0}));
  EXPECT_EQ(reader.text(),
            "  top/a: must be at least 4 and at most 5, not `3`\n"
            "  top/a: must be greater than 3 and at most 5, not `3`\n"
            "  top/a: must be at most 2, not `3`\n"
            "  top/a: must be at least 4, not `3`\n");
}

TEST(YamlReader, WhatIsNotThereKeepsItsValue) {
  Reader reader("{wrong: [1], right: 2.5}");
  std::optional<double> maybe;
  EXPECT_FALSE(reader.section.read("missing", maybe));
  EXPECT_FALSE(reader.section.read("wrong", maybe));
  EXPECT_FALSE(maybe);
  EXPECT_TRUE(reader.section.read("right", maybe));
  EXPECT_EQ(maybe, 2.5);
  std::optional<int> whole;
  EXPECT_FALSE(reader.section.readInteger("missing", whole, 0, 9));
  EXPECT_FALSE(whole);
  bool truth = true;
  EXPECT_FALSE(reader.section.read("missing", truth));
  EXPECT_TRUE(truth);
  EXPECT_FALSE(reader.section.require("missing", "write it"));
  EXPECT_TRUE(reader.section.require("right", "write it"));
  EXPECT_EQ(reader.text(),
            "  top/wrong: must be a number, not a list\n"
            "  top: `missing` is missing: write it\n");
}

TEST(YamlReader, AListMayHaveAnyLength) {
  Reader reader("{three: [1, 2, 3], none: [], map: {a: 1}, word: x}");
  EXPECT_EQ(reader.section.get("three")->numbers(), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(reader.section.get("none")->numbers(), std::vector<double>());
  EXPECT_EQ(reader.text(), "");
  EXPECT_FALSE(reader.section.get("map")->numbers());
  EXPECT_TRUE(reader.section.get("word")->list().empty());
  EXPECT_EQ(reader.text(),
            "  top/map: must be a list, not a mapping\n"
            "  top/word: must be a list, not `x`\n");
}

TEST(YamlReader, AListIsNoMapping) {
  Reader list("[a, b]");
  list.section.finish();
  EXPECT_TRUE(list.section.entries().empty());
  EXPECT_EQ(list.text(), "  top: must be a mapping (key: value), not a list\n");
}

TEST(YamlReader, NothingAtAllIsAnEmptyMapping) {
  Reader nothing("");
  nothing.section.finish();
  EXPECT_TRUE(nothing.section.entries().empty());
  EXPECT_EQ(nothing.text(), "");
}

}  // namespace
}  // namespace cia402::yaml
