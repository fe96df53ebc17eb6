// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/eds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/eds_file.h"

namespace cia402::canopen {
namespace {

using test::readFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> problemsOf(const Eds& eds) {
  std::vector<std::string> texts;
  for (const EdsProblem& problem : eds.problems) texts.push_back(toString(problem));
  return texts;
}

const DictionaryEntry& entry(const Eds& eds, ObjectId id) {
  static const DictionaryEntry kNone;
  const DictionaryEntry* found = eds.dictionary.find(id);
  EXPECT_NE(found, nullptr) << toString(id);
  return found != nullptr ? *found : kNone;
}

std::string defaultOf(const Eds& eds, ObjectId id) {
  const DictionaryEntry& found = entry(eds, id);
  return found.default_value ? describeValue(found.type, *found.default_value) : "none";
}

TEST(Eds, AFileWithoutDamageGivesNoProblem) {
  const Eds eds = readFile("clean.eds");
  EXPECT_THAT(problemsOf(eds), IsEmpty());
  EXPECT_EQ(eds.dictionary.size(), 7U);
  const DictionaryEntry& target = entry(eds, {0x607A, 0});
  EXPECT_EQ(target.name, "Target position");
  EXPECT_EQ(target.type, DataType::int32);
  EXPECT_EQ(target.access, Access::rww);
  EXPECT_TRUE(target.mappable);
  EXPECT_EQ(target.low, (ObjectValue{0x60, 0x79, 0xFE, 0xFF}));
  EXPECT_EQ(target.high, (ObjectValue{0xA0, 0x86, 0x01, 0x00}));
  EXPECT_EQ(target.line, 83U);
  EXPECT_EQ(eds.info.vendor_number, 0xABCU);
  EXPECT_EQ(eds.info.product_name, "Motor");
  EXPECT_THAT(eds.info.baud_rates, ElementsAre(500, 1000));
  EXPECT_TRUE(eds.info.lss_supported);
}

TEST(Eds, FormulasWithTheNodeIdAreReadInEveryShape) {
  const Eds eds = readFile("node_id.eds");
  EXPECT_THAT(problemsOf(eds),
              ElementsAre("line 132: error: DefaultValue: `$NODEID*2` is no formula; write for "
                          "example $NODEID+0x180; it is left out",
                          "line 138: error: DefaultValue: `3+$NODEID+1` is no formula; write for "
                          "example $NODEID+0x180; it is left out"));
  EXPECT_EQ(defaultOf(eds, {0x1200, 1}), "1541");
  EXPECT_TRUE(entry(eds, {0x1200, 1}).default_adds_node_id);
  EXPECT_EQ(entry(eds, {0x1200, 1}).low, (ObjectValue{0x05, 0x06, 0, 0}));
  EXPECT_EQ(defaultOf(eds, {0x1200, 2}), "1413");
  EXPECT_EQ(entry(eds, {0x1800, 1}).default_value, (ObjectValue{0x85, 0x01, 0, 0x80}));
  EXPECT_EQ(defaultOf(eds, {0x1800, 2}), "255");
  EXPECT_EQ(defaultOf(eds, {0x1800, 3}), "5");
  EXPECT_FALSE(entry(eds, {0x1000, 0}).default_adds_node_id);
}

TEST(Eds, AFormulaThatOverflowsWithThisNodeIdIsAnError) {
  const Eds eds = readFile("node_id.eds", NodeId{6});
  ASSERT_EQ(eds.problems.size(), 3U);
  EXPECT_EQ(toString(eds.problems[0]),
            "line 120: error: DefaultValue: `$NODEID+250` does not fit uint8 (0..255); it is left "
            "out");
}

TEST(Eds, EveryDataTypeOfTheStandardIsRead) {
  const Eds eds = readFile("types.eds");
  EXPECT_THAT(problemsOf(eds),
              ElementsAre("line 129: warning: DefaultValue: `0377` is octal, 255"));
  const auto value = [&](std::uint16_t type) {
    return entry(eds, {static_cast<std::uint16_t>(0x2000 + type), 0}).default_value;
  };
  EXPECT_EQ(value(0x01), (ObjectValue{1}));
  EXPECT_EQ(value(0x02), (ObjectValue{0x80}));
  EXPECT_EQ(value(0x03), (ObjectValue{0x00, 0x80}));
  EXPECT_EQ(value(0x04), (ObjectValue{0, 0, 0, 0x80}));
  EXPECT_EQ(value(0x05), (ObjectValue{0xFF}));
  EXPECT_EQ(value(0x06), (ObjectValue{0xFF, 0xFF}));
  EXPECT_EQ(value(0x07), (ObjectValue{0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(value(0x08), (ObjectValue{0, 0, 0xC0, 0xBF}));
  EXPECT_EQ(value(0x09), (ObjectValue{'M', 'o', 't', 'o', 'r', ' ', '7'}));
  EXPECT_EQ(value(0x0A), (ObjectValue{1, 2, 0xFF}));
  EXPECT_EQ(value(0x0B), (ObjectValue{'G', 0, 'r', 0, 0xFC, 0, 'n', 0, ' ', 0, 0xAC, 0x20}));
  EXPECT_EQ(value(0x0C), (ObjectValue{0xBC, 0x9A, 0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(value(0x0D), (ObjectValue{1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(value(0x0F), (ObjectValue{0xDE, 0xAD, 0xBE, 0xEF}));
  EXPECT_EQ(value(0x10), (ObjectValue{0xFE, 0xFF, 0xFF}));
  EXPECT_EQ(value(0x11), (ObjectValue{0xFC, 0xA9, 0xF1, 0xD2, 0x4D, 0x62, 0x50, 0x3F}));
  EXPECT_EQ(value(0x12), (ObjectValue{0xFD, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(value(0x13), (ObjectValue{0xFC, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(value(0x14), (ObjectValue{0xFB, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(value(0x15), ObjectValue(8, 0xFF));
  EXPECT_EQ(value(0x16), (ObjectValue{0xEF, 0xCD, 0xAB}));
  EXPECT_EQ(value(0x18), (ObjectValue{0x55, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(value(0x19), (ObjectValue{0x66, 0x55, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(value(0x1A), (ObjectValue{0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(value(0x1B), ObjectValue(8, 0xFF));
}

TEST(Eds, NumbersThatDoNotFitTheirTypeAreToldAndLeftOut) {
  const Eds eds = readFile("numbers.eds");
  EXPECT_THAT(
      problemsOf(eds),
      ElementsAre(
          "line 90: warning: DefaultValue: `0.0` should be a whole number, as the type is uint32",
          "line 96: error: DefaultValue: `1.5` is no whole number, but the type is uint32; it is "
          "left out",
          "line 102: error: DefaultValue: `-1` is negative, but the type is uint8; it is left out",
          "line 103: error: LowLimit: `-10` is negative, but the type is uint8; it is left out",
          "line 110: error: DefaultValue: `256` does not fit uint8 (0..255); it is left out",
          "line 116: warning: LowLimit: `0xFFFF8000` is taken as -32768, the int16 of these bits",
          "line 118: warning: DefaultValue: `65535` is taken as -1, the int16 of these bits",
          "line 124: warning: DefaultValue: `08` begins with 0, but is no octal number; read as "
          "decimal",
          "line 130: warning: DefaultValue: `010` is octal, 8",
          "line 136: warning: DefaultValue: `1Fh` should be written 0x1F",
          "line 142: warning: LowLimit is above HighLimit; both are left out",
          "line 149: warning: LowLimit and HighLimit are 0, which would allow no other value; both "
          "are left out",
          "line 159: warning: DefaultValue 0 is below LowLimit 1",
          "line 165: warning: DefaultValue: `1,5` should have a point, not a comma",
          "line 171: warning: DefaultValue: `TRUE` should be 1",
          "line 185: error: DefaultValue: `100 ms` is no whole number, but the type is uint16; it "
          "is left out",
          "line 191: warning: DefaultValue: `0` should be hexadecimal bytes, as the type is "
          "octet_string; taken as text"));
  EXPECT_EQ(defaultOf(eds, {0x2001, 0}), "0");
  EXPECT_EQ(defaultOf(eds, {0x2002, 0}), "none");
  EXPECT_EQ(defaultOf(eds, {0x2003, 0}), "none");
  EXPECT_FALSE(entry(eds, {0x2003, 0}).low);
  EXPECT_EQ(entry(eds, {0x2003, 0}).high, (ObjectValue{10}));
  EXPECT_EQ(entry(eds, {0x2005, 0}).low, (ObjectValue{0x00, 0x80}));
  EXPECT_EQ(defaultOf(eds, {0x2005, 0}), "-1");
  EXPECT_EQ(defaultOf(eds, {0x2006, 0}), "8");
  EXPECT_EQ(defaultOf(eds, {0x2007, 0}), "8");
  EXPECT_EQ(defaultOf(eds, {0x2008, 0}), "31");
  EXPECT_FALSE(entry(eds, {0x2009, 0}).high);
  EXPECT_FALSE(entry(eds, {0x200A, 0}).low);
  EXPECT_EQ(defaultOf(eds, {0x200A, 0}), "5");
  EXPECT_EQ(defaultOf(eds, {0x200C, 0}), "1.5");
  EXPECT_EQ(defaultOf(eds, {0x200D, 0}), "1");
  EXPECT_EQ(defaultOf(eds, {0x200E, 0}), "none");
}

TEST(Eds, CompactArraysAreExpandedWithTheirNamesAndValues) {
  const Eds eds = readFile("compact.eds");
  EXPECT_THAT(
      problemsOf(eds),
      ElementsAre(
          "line 91: warning: [2100Value] has 1 entry, not NrOfEntries=2",
          "line 93: error: `9` in [2100Value] is no sub-index of the object",
          "line 100: warning: [2101] has both SubNumber and CompactSubObj",
          "line 103: warning: [2102] has both CompactSubObj and sections for its sub-indices; the "
          "sections are read",
          "line 128: error: [2104Name] belongs to no object",
          "line 132: error: [2105] is an ARRAY, but no sub-index is described",
          "line 132: warning: [2105] stands in none of the three lists",
          "line 137: error: CompactSubObj=`255` is not 0 to 254"));
  EXPECT_EQ(defaultOf(eds, {0x2100, 0}), "3");
  EXPECT_EQ(entry(eds, {0x2100, 0}).access, Access::ro);
  EXPECT_EQ(entry(eds, {0x2100, 1}).name, "Proportional gain");
  EXPECT_EQ(entry(eds, {0x2100, 2}).name, "Gain2");
  EXPECT_EQ(entry(eds, {0x2100, 3}).name, "Derivative gain");
  EXPECT_EQ(entry(eds, {0x2100, 3}).type, DataType::uint32);
  EXPECT_EQ(defaultOf(eds, {0x2100, 3}), "7");
  EXPECT_EQ(entry(eds, {0x2100, 2}).value, (ObjectValue{40, 0, 0, 0}));
  EXPECT_FALSE(entry(eds, {0x2100, 1}).value);
  EXPECT_EQ(eds.dictionary.find(ObjectId{0x2100, 4}), nullptr);
  EXPECT_EQ(eds.dictionary.objects().at(0x2102).entries.size(), 2U);
  EXPECT_EQ(entry(eds, {0x2103, 2}).type, DataType::uint16);
}

TEST(Eds, CompactPdosFillUpToTheNumberOfPdos) {
  const Eds eds = readFile("compact_pdo.eds");
  EXPECT_THAT(problemsOf(eds), IsEmpty());
  EXPECT_EQ(entry(eds, {0x1800, 2}).name, "Transmission type");
  EXPECT_EQ(eds.dictionary.find(ObjectId{0x1800, 1}), nullptr);
  EXPECT_EQ(entry(eds, {0x1A00, 64}).type, DataType::uint32);
  EXPECT_EQ(defaultOf(eds, {0x1801, 0}), "5");
  EXPECT_EQ(entry(eds, {0x1801, 1}).type, DataType::uint32);
  EXPECT_EQ(entry(eds, {0x1801, 5}).type, DataType::uint16);
  EXPECT_EQ(eds.dictionary.find(ObjectId{0x1801, 3}), nullptr);
  EXPECT_EQ(entry(eds, {0x1A01, 1}).name, "Mapped object 1");
  EXPECT_EQ(entry(eds, {0x1400, 1}).access, Access::rw);
  EXPECT_EQ(entry(eds, {0x1600, 0}).access, Access::rw);
  EXPECT_EQ(eds.dictionary.find(ObjectId{0x1802, 0}), nullptr);
  EXPECT_EQ(eds.dictionary.find(ObjectId{0x1401, 0}), nullptr);
}

TEST(Eds, SubIndicesNeedNeitherBeCompleteNorCountedRightly) {
  const Eds eds = readFile("sparse.eds");
  EXPECT_THAT(problemsOf(eds),
              ElementsAre("line 79: warning: [1003] has 2 sub-indices, not SubNumber=254",
                          "line 91: warning: [1010] is a VAR, but has sub-indices; read as RECORD",
                          "line 108: warning: [60FE] has no ObjectType; read as RECORD",
                          "line 108: warning: [60FE] has no sub-index 0",
                          "line 110: warning: [60FE] has 2 sub-indices, not SubNumber=0xFFF",
                          "line 122: error: [2200] is a RECORD, but no sub-index is described",
                          "line 127: warning: [2201sub0] has no section [2201]"));
  EXPECT_EQ(entry(eds, {0x60FE, 0x0A}).name, "Bit mask");
  EXPECT_EQ(entry(eds, {0x1010, 1}).name, "Save all parameters");
  EXPECT_EQ(entry(eds, {0x2201, 1}).type, DataType::int16);
}

TEST(Eds, BrokenLinesAreToldAndTheRestIsRead) {
  const Eds eds = readFile("broken_lines.eds");
  EXPECT_THAT(
      problemsOf(eds),
      ElementsAre(
          "line 1: error: `CANopen EDS` stands before the first section and is ignored",
          "line 81: error: `this line has no equals sign` has no `=` and is ignored",
          "line 82: error: `=5` has nothing before the `=` and is ignored",
          "line 84: error: DefaultValue in [2001] stands in line 83 already, with `1`, which is "
          "taken; not `2`",
          "line 85: warning: AccessType in [2001] stands in line 80 already",
          "line 86: warning: comments begin with `;`, not with `//`",
          "line 88: warning: the `]` behind `[2002` is missing",
          "line 93: warning: `trailing` behind `[2003]` is ignored",
          "line 98: error: a section without a name; its lines are ignored",
          "line 101: warning: section [2001] stands in line 77 already; both are taken together",
          "line 108: warning: an end-of-file character (Ctrl-Z) stands here; what follows it is "
          "not read"));
  EXPECT_EQ(entry(eds, {0x2001, 0}).name, "Something; with a semicolon");
  EXPECT_EQ(entry(eds, {0x2001, 0}).type, DataType::uint16);
  EXPECT_EQ(defaultOf(eds, {0x2001, 0}), "1");
  EXPECT_EQ(entry(eds, {0x2002, 0}).name, "No bracket");
  EXPECT_EQ(entry(eds, {0x2004, 0}).name, "Blanks everywhere");
  EXPECT_EQ(entry(eds, {0x2004, 0}).access, Access::rw);
}

TEST(Eds, MissingAndUnknownAccessAndTypesAreTold) {
  const Eds eds = readFile("access.eds");
  EXPECT_THAT(
      problemsOf(eds),
      ElementsAre(
          "line 83: error: AccessType=`on` is none of ro, wo, rw, rwr, rww, const; read as rw",
          "line 85: error: [2002] has no AccessType; read as rw",
          "line 94: warning: [2004] has no ParameterName",
          "line 98: error: [2005] has no DataType; read as DOMAIN",
          "line 104: error: DataType=0x00A0 is unknown, and there is no section [00A0] for it; "
          "read as DOMAIN, bytes of any length",
          "line 109: error: ObjectType=0x77 is unknown; read as VAR",
          "line 117: error: PDOMapping=`2` is not 0 to 1",
          "line 129: warning: DownloadFile makes sense for a DOMAIN only, not for uint16"));
  EXPECT_EQ(entry(eds, {0x2003, 0}).access, Access::rww);
  EXPECT_EQ(entry(eds, {0x2009, 0}).upload_file, "firmware.bin");
  EXPECT_EQ(entry(eds, {0x2009, 0}).flags, 3U);
  EXPECT_EQ(entry(eds, {0x2009, 0}).type, DataType::domain);
}

TEST(Eds, TypesThatTheFileDefinesItselfAreResolved) {
  const Eds eds = readFile("deftypes.eds");
  EXPECT_THAT(problemsOf(eds),
              ElementsAre("line 119: error: DataType=0x42: [0042] does not say its type; read as "
                          "DOMAIN, bytes of any length",
                          "line 142: error: DataType=0x0042: [0042] does not say its type; read as "
                          "DOMAIN, bytes of any length"));
  EXPECT_EQ(entry(eds, {0x2001, 0}).type, DataType::uint16);
  EXPECT_EQ(defaultOf(eds, {0x2001, 0}), "4660");
  EXPECT_EQ(entry(eds, {0x2002, 0}).type, DataType::int16);
  EXPECT_EQ(entry(eds, {0x2003, 0}).type, DataType::uint8);
  EXPECT_EQ(entry(eds, {0x2004, 0}).type, DataType::domain);
}

TEST(Eds, ListsAndSectionsAreCheckedAgainstEachOther) {
  const Eds eds = readFile("lists.eds", {});
  EXPECT_THAT(problemsOf(eds),
              ElementsAre("line 5: error: ProductNumber=`12345678901` is not 0 to 4294967295",
                          "line 6: error: NrOfRXPDO=`many` is no whole number",
                          "line 7: error: BaudRate_1000=`yes` is no whole number",
                          "line 10: warning: [Comments] has 2 lines, not 3",
                          "line 18: warning: `Dummy00XX` is no data type like Dummy0005",
                          "line 21: warning: [MandatoryObjects] lists 3 objects, not 2",
                          "line 24: error: object 1018h is listed, but there is no section [1018]",
                          "line 26: warning: [OptionalObjects] has no SupportedObjects",
                          "line 28: warning: object 1008h is listed twice",
                          "line 29: error: object 1009h is listed, but there is no section [1009]",
                          "line 30: warning: `x` in [OptionalObjects] is no position like 1=0x1000",
                          "line 31: error: 4= in [OptionalObjects] names no object",
                          "line 32: error: 5=`0x110008` is not 0 to 65535",
                          "line 50: warning: [100B] stands in none of the three lists",
                          "line 55: warning: [0x100C] should have its numbers without 0x",
                          "line 55: warning: [0x100C] stands in none of the three lists",
                          "line 60: warning: [100 D] stands in none of the three lists",
                          "line 65: warning: unknown section [1018 sbu1] is not read",
                          "line 71: warning: [DeviceCommissioning] should be [DeviceComissioning]",
                          "line 72: warning: section [FileInfo] is missing",
                          "line 72: warning: section [ManufacturerObjects] is missing"));
  EXPECT_EQ(eds.info.vendor_number, 1U);
  EXPECT_EQ(eds.info.node_id, NodeId{5});
  EXPECT_THAT(eds.info.comments, ElementsAre("one", "two"));
  EXPECT_THAT(eds.info.dummies, ElementsAre(5));
  EXPECT_EQ(entry(eds, {0x100C, 0}).type, DataType::uint16);
  EXPECT_EQ(entry(eds, {0x100D, 0}).name, "Life time factor");
}

TEST(Eds, LettersInLatin1AndLineEndsOfOldMacintoshesAreRead) {
  const Eds eds = readFile("latin1.eds");
  EXPECT_THAT(problemsOf(eds), ElementsAre("line 73: warning: there are letters in Latin-1 here; "
                                           "CiA 306 allows ASCII only"));
  EXPECT_EQ(entry(eds, {0x2001, 0}).name, "K\xC3\xBChlk\xC3\xB6rpertemperatur");
  EXPECT_EQ(entry(eds, {0x2002, 0}).name, "Drehmoment [Nm]");
}

TEST(Eds, ADcfTellsValuesDenotationsAndTheNode) {
  const Eds eds = readFile("drive.dcf", {});
  EXPECT_THAT(problemsOf(eds),
              ElementsAre("line 109: error: 2: `x1000` is no whole number, but the type is int32; "
                          "it is left out"));
  EXPECT_EQ(eds.info.node_id, NodeId{0x20});
  EXPECT_EQ(eds.info.node_name, "shoulder");
  EXPECT_EQ(eds.info.baud_rate, 1000U);
  EXPECT_EQ(eds.info.lss_serial, 0x1234U);
  EXPECT_EQ(defaultOf(eds, {0x1800, 1}), "416");
  EXPECT_EQ(entry(eds, {0x1800, 1}).value, (ObjectValue{0x20, 0, 0, 0x80}));
  EXPECT_EQ(entry(eds, {0x1800, 1}).denotation, "Feedback of the shoulder");
  EXPECT_EQ(entry(eds, {0x607D, 1}).value, (ObjectValue{0x18, 0xFC, 0xFF, 0xFF}));
  EXPECT_EQ(entry(eds, {0x607D, 2}).denotation, "Highest position");
}

TEST(Eds, WhatIsNoEdsAtAllIsTold) {
  EXPECT_THAT(problemsOf(readEds("")),
              ElementsAre("line 1: error: this is no EDS file: there is not one section in it"));
  EXPECT_THAT(problemsOf(readEds(std::string("\xFF\xFE[\0F\0i\0", 8))).front(),
              "line 1: error: the file is in UTF-16; save it as plain text (ASCII, Latin-1 or "
              "UTF-8)");
}

TEST(Eds, AFloodOfProblemsIsCountedNotKept) {
  std::string text = "[2001]\n";
  const std::size_t others = readEds(text).problems.size();
  for (int i = 0; i < 5000; ++i) text += "no equals sign\n";
  const Eds eds = readEds(text);
  EXPECT_EQ(eds.problems.size(), kMostEdsProblems);
  EXPECT_EQ(eds.problems_left_out, others + 5000 - kMostEdsProblems);
}

TEST(Eds, AFileThatUnfoldsIntoTooManyEntriesIsCutOff) {
  const auto name = [](unsigned index) {
    return toString(ObjectId{static_cast<std::uint16_t>(index), 0}).substr(0, 4);
  };
  const std::string keys = "]\nParameterName=x\nDataType=7\nAccessType=rw\n";
  std::string text;
  // 1176 arrays of 255 sub-indices are 299880; of the 200 of [5000] there is room for 120.
  for (unsigned i = 0; i < 1176; ++i) {
    text += "[" + name(0x2000 + i) + keys + "ObjectType=8\nCompactSubObj=254\n";
  }
  text += "[5000" + keys + "ObjectType=9\nSubNumber=200\n";
  for (unsigned i = 0; i < 200; ++i) text += "[5000sub" + name(i).substr(2) + keys;
  text += "[5001" + keys;
  const Eds eds = readEds(text);
  EXPECT_EQ(eds.dictionary.size(), kMostEdsEntries);
  EXPECT_EQ(eds.dictionary.objects().at(0x5000).entries.size(), 120U);
  EXPECT_EQ(eds.dictionary.objects().count(0x5001), 0U);
  // Each array has six lines, [5000] too, each of its sub-indices four.
  std::vector<std::string> cut_off;
  for (const std::string& problem : problemsOf(eds)) {
    if (problem.find("more than") != std::string::npos) cut_off.push_back(problem);
  }
  EXPECT_THAT(cut_off,
              ElementsAre("line 7543: error: more than 300000 entries; the rest is not read"));
}

}  // namespace
}  // namespace cia402::canopen
