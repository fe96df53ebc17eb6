// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The sections of an EDS that describe objects: their names, keys and numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "canopen/eds/eds.h"

namespace cia402::canopen {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const char* const kObjects = R"([FileInfo]
[DeviceInfo]
[MandatoryObjects]
SupportedObjects=0
[OptionalObjects]
SupportedObjects=0
[ManufacturerObjects]
SupportedObjects=2
1=0x2001
2=0x2002

[2001]
ParameterName=Gains
ObjectType=0x9
SubNumber=2

[2001sub0]
ParameterName=Highest sub-index
ObjectType=0x7
DataType=0x0005
AccessType=ro

[2001sub1]
ParameterName=First
ObjectType=0x7
DataType=0x0007
AccessType=rw
ObjFlags=0x1
LowLimit=1
HighLimit=10
DefaultValue=1
ParameterValue=10

[2002]
ParameterName=Table
Denotation=mine
ObjectType=0x8
DataType=0x0006
AccessType=rw
CompactSubObj=2

[2002Name]
NrOfEntries=1
1=
2=Second
)";

/// The file in which one line is another.
Eds objectsWith(const std::string& from, const std::string& to) {
  std::string text = kObjects;
  text.replace(text.find(from), from.size(), to);
  return readEds(text);
}

std::string problemsIn(const Eds& eds) {
  std::string texts;
  for (const EdsProblem& problem : eds.problems) texts += toString(problem) + "\n";
  return texts;
}

const DictionaryEntry& described(const Eds& eds, ObjectId id) {
  static const DictionaryEntry kNone;
  const DictionaryEntry* found = eds.dictionary.find(id);
  EXPECT_NE(found, nullptr) << toString(id);
  return found != nullptr ? *found : kNone;
}

TEST(EdsObjects, OnlyTheMandatoryObjectsAreMissedInAFileWithoutThem) {
  EXPECT_EQ(problemsIn(readEds(kObjects)),
            "line 45: warning: the mandatory object 1000h is missing\n"
            "line 45: warning: the mandatory object 1001h is missing\n"
            "line 45: warning: the mandatory object 1018h is missing\n");
}

TEST(EdsObjects, WhatIsMissingOrBeyondItsRangeIsTold) {
  const struct {
    const char *from, *to, *problem;
  } rows[] = {
      {"SubNumber=2\n", "", "line 12: warning: [2001] has no SubNumber"},
      {"ParameterName=First\n", "", "line 23: warning: [2001sub1] has no ParameterName"},
      {"NrOfEntries=1\n", "", "line 42: warning: [2002Name] has no NrOfEntries"},
      {"NrOfEntries=1", "NrOfEntries=256", "NrOfEntries=`256` is not 0 to 255"},
      {"NrOfEntries=1", "NrOfEntries=2", "[2002Name] has 1 entry, not NrOfEntries=2"},
      {"ObjFlags=0x1", "ObjFlags=0x100000000", "`0x100000000` is not 0 to 4294967295"},
      {"DataType=0x0007", "DataType=0x10000", "DataType=`0x10000` is not 0 to 65535"},
      {"ObjectType=0x9", "ObjectType=0x10000", "ObjectType=`0x10000` is not 0 to 65535"},
      {"SubNumber=2", "SubNumber=0x10000", "SubNumber=`0x10000` is not 0 to 65535"},
      {"CompactSubObj=2", "CompactSubObj=2\nSubNumber=0x10000",
       "SubNumber=`0x10000` is not 0 to 65535"},
      {"CompactSubObj=2", "CompactSubObj=255", "CompactSubObj=`255` is not 0 to 254"},
      {"DefaultValue=1", "DefaultValue=11", "DefaultValue 11 is above HighLimit 10"},
      {"DefaultValue=1", "DefaultValue=0", "DefaultValue 0 is below LowLimit 1"},
      {"ParameterValue=10", "ParameterValue=11", "ParameterValue 11 is above HighLimit 10"},
      {"ParameterValue=10", "ParameterValue=0", "ParameterValue 0 is below LowLimit 1"},
  };
  for (const auto& row : rows) {
    EXPECT_THAT(problemsIn(objectsWith(row.from, row.to)), HasSubstr(row.problem)) << row.to;
  }
}

TEST(EdsObjects, ErrorsAndWarningsAreCountedApart) {
  const Eds eds = objectsWith("NrOfEntries=1", "NrOfEntries=256");
  EXPECT_EQ(eds.count(EdsProblem::Severity::error), 1U);
  EXPECT_EQ(eds.count(EdsProblem::Severity::warning), 3U);
}

TEST(EdsObjects, SectionsOfModulesToolsAndLinksAreLeftAlone) {
  for (const char* name :
       {"Tools", "Tool1", "Tool12", "M1ModuleInfo", "M12FixedObjects", "2001ObjectLinks",
        "SupportedModules", "ConnectedModules", "DynamicChannels", "StandardDataTypes"}) {
    const std::string read =
        problemsIn(readEds(kObjects + ("\n[" + std::string(name) + "]\nx=1\n")));
    EXPECT_THAT(read, AllOf(Not(HasSubstr(name)), Not(HasSubstr("error")))) << name;
  }
}

TEST(EdsObjects, SectionsOfOtherNamesAreTold) {
  for (const char* name : {"Tool", "ToolX", "MandatoryObject", "Mx", "M1", "10180", "2001sub",
                           "2001sub100", "2001subindex", "2001sbu1", "sub1", "Name", "20x1"}) {
    EXPECT_THAT(problemsIn(readEds(kObjects + ("\n[" + std::string(name) + "]\nx=1\n"))),
                HasSubstr("unknown section [" + std::string(name) + "] is not read"));
  }
}

TEST(EdsObjects, OddWritingsOfASubIndexAreReadAndTold) {
  const struct {
    const char *name, *odd;
  } rows[] = {{"0x2001sub1", "0x"},
              {"2001sub0x1", "0x"},
              {"2001sub0X01", "0x"},
              {"2001SubIndex1", "index"}};
  for (const auto& row : rows) {
    const std::string name = "[" + std::string(row.name) + "]";
    const Eds eds = objectsWith("[2001sub1]", name);
    EXPECT_EQ(described(eds, {0x2001, 1}).name, "First") << name;
    EXPECT_THAT(problemsIn(eds), HasSubstr("line 23: warning: " + name +
                                           " should have its numbers without " + row.odd + "\n"));
  }
  const Eds eds = objectsWith("[2001sub1]", "[2001sub01]");
  EXPECT_EQ(described(eds, {0x2001, 1}).name, "First");
  EXPECT_THAT(problemsIn(eds), Not(HasSubstr("2001sub01")));
}

TEST(EdsObjects, TheSameSubIndexIsTakenFromOneSectionOnly) {
  EXPECT_THAT(problemsIn(readEds(std::string(kObjects) + "\n[2001sub01]\nParameterName=Again\n")),
              HasSubstr("describes 2001:01 a second time and is not read"));
  EXPECT_THAT(problemsIn(readEds(std::string(kObjects) + "\n[0x2001]\nParameterName=Again\n")),
              HasSubstr("describes 2001:00 a second time and is not read"));
  EXPECT_THAT(problemsIn(readEds(std::string(kObjects) + "\n[0x2002Name]\n1=Again\n")),
              HasSubstr("a second time and is not read"));
}

// CiA 306: an object of ObjectType DOMAIN needs no DataType.
TEST(EdsObjects, ASubIndexCanBeADomain) {
  const char* const from = "ObjectType=0x7\nDataType=0x0007\n";
  const Eds domain = objectsWith(from, "ObjectType=0x2\n");
  EXPECT_EQ(described(domain, {0x2001, 1}).type, DataType::domain);
  EXPECT_THAT(problemsIn(domain), Not(HasSubstr("DataType")));
  for (const char* other : {"ObjectType=0x7\n", ""}) {
    EXPECT_THAT(problemsIn(objectsWith(from, other)),
                HasSubstr("error: [2001sub1] has no DataType; read as DOMAIN"));
  }
}

// Up to 001Fh stand the simple types of CiA 301, from 0020h on types that a file may describe.
TEST(EdsObjects, ATypeOfTheFileItselfHasANumberFrom20hOn) {
  const auto withType = [](const std::string& code) {
    return objectsWith("DataType=0x0007\nAccessType=rw\n",
                       "DataType=0x" + code + "\nAccessType=rw\n[" + code +
                           "]\nParameterName=own\nObjectType=5\nDataType=7\nDefaultValue=16\n");
  };
  EXPECT_EQ(described(withType("0020"), {0x2001, 1}).type, DataType::uint16);
  EXPECT_THAT(problemsIn(withType("001F")), HasSubstr("[001F] does not say its type"));
}

TEST(EdsObjects, ACompactArrayGivesItsEntriesNamesOfTheirOwn) {
  const Eds eds = readEds(kObjects);
  EXPECT_EQ(described(eds, {0x2002, 1}).name, "Table1") << "the name of the list is empty";
  EXPECT_EQ(described(eds, {0x2002, 2}).name, "Second");
  for (const std::uint8_t subindex : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
    EXPECT_EQ(described(eds, {0x2002, subindex}).line, 34U) << int{subindex};
    EXPECT_THAT(described(eds, {0x2002, subindex}).denotation, IsEmpty()) << int{subindex};
  }
}

TEST(EdsObjects, ACompactArrayWithoutANameIsToldOnce) {
  const Eds eds = objectsWith("ParameterName=Table\n", "");
  std::vector<std::string> told;
  for (const EdsProblem& problem : eds.problems) {
    if (problem.line == 34) told.push_back(problem.message);
  }
  EXPECT_THAT(told, ElementsAre("[2002] has no ParameterName"));
}

TEST(EdsObjects, ACompactArrayCanHaveOneEntry) {
  const Eds eds = objectsWith("CompactSubObj=2", "CompactSubObj=1");
  EXPECT_EQ(described(eds, {0x2002, 0}).default_value, (ObjectValue{1}));
  EXPECT_EQ(described(eds, {0x2002, 1}).type, DataType::uint16);
  EXPECT_EQ(eds.dictionary.objects().at(0x2002).entries.size(), 2U);
}

// CiA 301: 1400h to 15FFh and 1600h to 17FFh describe RPDOs, 1800h to 1BFFh TPDOs.
TEST(EdsObjects, CompactPdosOfOneDirectionLeaveTheOtherAlone) {
  const auto indices = [](const std::string& counts) {
    const Eds eds = objectsWith("[DeviceInfo]\n", "[DeviceInfo]\nCompactPDO=0x3\n" + counts);
    std::vector<std::uint16_t> found;
    for (const auto& [index, object] : eds.dictionary.objects()) {
      if (index < 0x2000) found.push_back(index);
    }
    return found;
  };
  EXPECT_THAT(indices("NrOfRXPDO=2\n"), ElementsAre(0x1400, 0x1401, 0x1600, 0x1601));
  EXPECT_THAT(indices("NrOfTXPDO=1\n"), ElementsAre(0x1800, 0x1A00));
}

TEST(EdsObjects, EachBitOfCompactPdoIsASubIndexOfTheCommunicationParameter) {
  for (unsigned bits = 1; bits <= 0xFF; ++bits) {
    const Eds eds = objectsWith(
        "[DeviceInfo]\n", "[DeviceInfo]\nNrOfTXPDO=1\nCompactPDO=" + std::to_string(bits) + "\n");
    std::uint8_t highest = 0;
    for (std::uint8_t bit = 0; bit < 8; ++bit) {
      const auto subindex = static_cast<std::uint8_t>(bit + 1);
      const bool has = (bits >> bit & 1U) != 0 && subindex <= 6;  // SYNC start value is the last
      EXPECT_EQ(eds.dictionary.find(ObjectId{0x1800, subindex}) != nullptr, has) << bits;
      if (has) highest = subindex;
    }
    EXPECT_EQ(described(eds, {0x1800, 0}).default_value, ObjectValue{highest}) << bits;
  }
}

}  // namespace
}  // namespace cia402::canopen
