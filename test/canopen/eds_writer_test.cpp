// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "canopen/eds/eds.h"
#include "canopen/eds_file.h"

namespace cia402::canopen {
namespace {

using test::readFile;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Everything but the lines of the file.
auto fields(const DictionaryEntry& e) {
  return std::tie(e.id, e.name, e.denotation, e.type, e.access, e.mappable, e.flags, e.low, e.high,
                  e.default_value, e.value, e.default_adds_node_id, e.upload_file, e.download_file);
}

auto fields(const EdsInfo& i) {
  return std::tie(i.file_name, i.description, i.created_by, i.modified_by, i.creation_date,
                  i.creation_time, i.modification_date, i.modification_time, i.vendor_name,
                  i.product_name, i.order_code, i.vendor_number, i.product_number,
                  i.revision_number, i.baud_rates, i.rpdo_count, i.tpdo_count, i.compact_pdo,
                  i.granularity, i.lss_supported, i.boot_up_master, i.boot_up_slave,
                  i.group_messaging, i.dynamic_channels, i.dummies, i.comments, i.last_eds,
                  i.node_id, i.node_name, i.baud_rate, i.lss_serial);
}

void expectEqual(const Eds& a, const Eds& b, const std::string& what) {
  EXPECT_TRUE(fields(a.info) == fields(b.info)) << what;
  ASSERT_EQ(a.dictionary.size(), b.dictionary.size()) << what;
  for (const auto& [index, object] : a.dictionary.objects()) {
    const auto found = b.dictionary.objects().find(index);
    ASSERT_NE(found, b.dictionary.objects().end()) << what << " " << index;
    EXPECT_EQ(object.name, found->second.name);
    EXPECT_EQ(object.code, found->second.code);
    for (const auto& [subindex, entry] : object.entries) {
      const DictionaryEntry* other = b.dictionary.find(entry.id);
      ASSERT_NE(other, nullptr) << what << " " << toString(entry.id);
      EXPECT_TRUE(fields(entry) == fields(*other)) << what << " " << toString(entry.id);
    }
  }
}

TEST(EdsWriter, WhatIsWrittenReadsBackEqual) {
  for (const char* name :
       {"clean.eds", "node_id.eds", "types.eds", "compact.eds", "compact_pdo.eds", "sparse.eds",
        "deftypes.eds", "latin1.eds", "access.eds", "drive.dcf", "lists.eds"}) {
    Eds first = readFile(name, NodeId{5});
    first.info.node_id = NodeId{5};
    // An object without a sub-index cannot be written, for it says nothing.
    first.dictionary.objects().erase(0x2200);
    first.dictionary.objects().erase(0x2105);
    const std::string text = writeDcf(first.info, first.dictionary);
    expectEqual(first, readEds(text), name);
  }
}

TEST(EdsWriter, AWrittenFileGivesNoProblem) {
  for (const char* name : {"clean.eds", "types.eds", "compact.eds", "compact_pdo.eds"}) {
    Eds first = readFile(name, NodeId{5});
    first.info.node_id = NodeId{5};
    first.dictionary.objects().erase(0x2105);
    std::vector<std::string> problems;
    for (const EdsProblem& problem : readEds(writeDcf(first.info, first.dictionary)).problems) {
      problems.push_back(toString(problem));
    }
    EXPECT_THAT(problems, IsEmpty()) << name;
  }
}

TEST(EdsWriter, TheTextIsThatOfTheStandard) {
  EdsInfo info;
  info.node_id = NodeId{0x20};
  info.baud_rate = 1000;
  ObjectDictionary dictionary;
  DictionaryObject object{0x1800, "TPDO", ObjectCode::record, {}};
  DictionaryEntry& entry = object.entries[1];
  entry.id = {0x1800, 1};
  entry.name = "COB-ID\n; used";
  entry.default_value = ObjectValue{0xA0, 0x01, 0, 0};
  entry.default_adds_node_id = true;
  entry.value = ObjectValue{0xA0, 0x01, 0, 0x80};
  dictionary.set(object);
  const std::string text = writeDcf(info, dictionary);
  EXPECT_THAT(text, HasSubstr("[DeviceComissioning]\r\nNodeID=0x20\r\nBaudrate=1000\r\n"));
  EXPECT_THAT(text, HasSubstr("[OptionalObjects]\r\nSupportedObjects=1\r\n1=0x1800\r\n"));
  EXPECT_THAT(text, HasSubstr("[1800]\r\nParameterName=TPDO\r\nObjectType=0x9\r\nSubNumber=1\r\n"));
  EXPECT_THAT(text, HasSubstr("[1800sub1]\r\nParameterName=COB-ID , used\r\nObjectType=0x7\r\n"
                              "DataType=0x0007\r\nAccessType=rw\r\nDefaultValue=$NODEID+0x180\r\n"
                              "PDOMapping=0\r\nParameterValue=0x800001A0\r\n"));
}

// CiA 306: 1000h, 1001h and 1018h are mandatory, 2000h to 5FFFh the manufacturer's, the others
// optional. Data types stand below 1000h and in no list.
TEST(EdsWriter, EachObjectStandsInTheListOfItsKind) {
  ObjectDictionary dictionary;
  for (const unsigned index : {0x0FFFU, 0x1000U, 0x1001U, 0x1002U, 0x1017U, 0x1018U, 0x1019U,
                               0x1FFFU, 0x2000U, 0x5FFFU, 0x6000U, 0x9FFFU}) {
    DictionaryObject object{static_cast<std::uint16_t>(index), "x", ObjectCode::variable, {}};
    object.entries[0].id.index = object.index;
    dictionary.set(object);
  }
  EXPECT_THAT(
      writeDcf({}, dictionary),
      HasSubstr("[MandatoryObjects]\r\nSupportedObjects=3\r\n1=0x1000\r\n2=0x1001\r\n3=0x1018\r\n"
                "\r\n[OptionalObjects]\r\nSupportedObjects=6\r\n1=0x1002\r\n2=0x1017\r\n3=0x1019"
                "\r\n4=0x1FFF\r\n5=0x6000\r\n6=0x9FFF\r\n"
                "\r\n[ManufacturerObjects]\r\nSupportedObjects=2\r\n1=0x2000\r\n2=0x5FFF\r\n"));
}

TEST(EdsWriter, NoNameEndsItsLineOrBeginsAComment) {
  const auto line = [](const char* name) {
    ObjectDictionary dictionary;
    DictionaryObject object{0x2001, name, ObjectCode::variable, {}};
    object.entries[0].id.index = 0x2001;
    dictionary.set(object);
    return readEds(writeDcf({}, dictionary)).dictionary.objects().at(0x2001).name;
  };
  EXPECT_EQ(line(";first"), ",first");
  EXPECT_EQ(line("a;b"), "a;b");
  EXPECT_EQ(line("a ; b ;;"), "a , b ,;");
  EXPECT_EQ(line("two\r\nlines"), "two  lines");
  EXPECT_EQ(line(" blanks\t"), "blanks");
}

TEST(EdsWriter, WhatWasTakenBackIsNotWritten) {
  ObjectDictionary dictionary;
  DictionaryEntry& entry = dictionary.set({0x2001, "x", ObjectCode::variable, {}}).entries[0];
  entry.id.index = 0x2001;
  entry.low = entry.high = entry.default_value = entry.value = ObjectValue{1, 0, 0, 0};
  const std::string text = writeDcf({}, dictionary);
  for (const char* key : {"LowLimit", "HighLimit", "DefaultValue", "ParameterValue"}) {
    EXPECT_THAT(text, HasSubstr(key + std::string("=0x00000001\r\n")));
  }
  entry.low.reset();
  entry.high.reset();
  entry.default_value.reset();
  entry.value.reset();
  EXPECT_THAT(writeDcf({}, dictionary),
              HasSubstr("[2001]\r\nParameterName=x\r\nObjectType=0x7\r\nDataType=0x0007\r\n"
                        "AccessType=rw\r\nPDOMapping=0\r\n"));
}

TEST(EdsWriter, AValueThatNoLineCanHoldIsLeftOut) {
  ObjectDictionary dictionary;
  DictionaryObject object{0x1008, "Device name", ObjectCode::variable, {}};
  DictionaryEntry& entry = object.entries[0];
  entry.id = {0x1008, 0};
  entry.name = "Device name";
  entry.type = DataType::visible_string;
  for (const ObjectValue& value :
       {ObjectValue{'a', '\n', 'b'}, ObjectValue{' ', 'a'}, ObjectValue{'a', 0}, ObjectValue{0xFF},
        ObjectValue{';'}, ObjectValue{'a', ' ', ';'}, ObjectValue{}}) {
    entry.value = value;
    dictionary.set(object);
    EXPECT_EQ(writeDcf({}, dictionary).find("ParameterValue"), std::string::npos);
  }
  entry.value = ObjectValue{'a', ';', 'b'};
  dictionary.set(object);
  EXPECT_THAT(writeDcf({}, dictionary), HasSubstr("ParameterValue=a;b\r\n"));
}

}  // namespace
}  // namespace cia402::canopen
