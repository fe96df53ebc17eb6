// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Who a file says that it is and what its device can do: every key of CiA 306 with a value of its
// own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/eds/eds.h"

namespace cia402::canopen {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char* const kHead =
    "[FileInfo]\r\n"
    "FileName=motor.dcf\r\n"
    "FileVersion=1\r\n"
    "FileRevision=0\r\n"
    "EDSVersion=3.1\r\n"
    "Description=drives something\r\n"
    "CreationTime=01:02PM\r\n"
    "CreationDate=03-04-2025\r\n"
    "CreatedBy=somebody\r\n"
    "ModificationTime=05:06AM\r\n"
    "ModificationDate=07-08-2026\r\n"
    "ModifiedBy=another\r\n"
    "LastEDS=motor.eds\r\n"
    "\r\n"
    "[DeviceInfo]\r\n"
    "VendorName=Maker\r\n"
    "VendorNumber=0x00000ABC\r\n"
    "ProductName=Motor\r\n"
    "ProductNumber=0x00000DEF\r\n"
    "RevisionNumber=0x00010002\r\n"
    "OrderCode=M-7\r\n"
    "BaudRate_10=0\r\n"
    "BaudRate_20=1\r\n"
    "BaudRate_50=0\r\n"
    "BaudRate_125=1\r\n"
    "BaudRate_250=0\r\n"
    "BaudRate_500=1\r\n"
    "BaudRate_800=0\r\n"
    "BaudRate_1000=1\r\n"
    "SimpleBootUpMaster=1\r\n"
    "SimpleBootUpSlave=1\r\n"
    "Granularity=8\r\n"
    "DynamicChannelsSupported=5\r\n"
    "GroupMessaging=1\r\n"
    "NrOfRXPDO=3\r\n"
    "NrOfTXPDO=4\r\n"
    "LSS_Supported=1\r\n"
    "CompactPDO=6\r\n"
    "\r\n"
    "[DeviceComissioning]\r\n"
    "NodeID=0x20\r\n"
    "NodeName=shoulder\r\n"
    "Baudrate=500\r\n"
    "LSS_SerialNumber=0x00003039\r\n"
    "\r\n"
    "[DummyUsage]\r\n"
    "Dummy0001=0\r\n"
    "Dummy0002=1\r\n"
    "Dummy0003=0\r\n"
    "Dummy0004=0\r\n"
    "Dummy0005=1\r\n"
    "Dummy0006=0\r\n"
    "Dummy0007=1\r\n"
    "Dummy001B=1\r\n"
    "\r\n"
    "[Comments]\r\n"
    "Lines=2\r\n"
    "Line1=one\r\n"
    "Line2=two\r\n"
    "\r\n";
const char* const kLists =
    "[MandatoryObjects]\r\n"
    "SupportedObjects=0\r\n"
    "\r\n"
    "[OptionalObjects]\r\n"
    "SupportedObjects=0\r\n"
    "\r\n"
    "[ManufacturerObjects]\r\n"
    "SupportedObjects=0\r\n";

TEST(EdsInfo, EveryKeyIsRead) {
  const EdsInfo info = readEds(std::string(kHead) + kLists).info;
  EXPECT_EQ(info.file_name, "motor.dcf");
  EXPECT_EQ(info.eds_version, "3.1");
  EXPECT_EQ(info.description, "drives something");
  EXPECT_EQ(info.creation_time, "01:02PM");
  EXPECT_EQ(info.creation_date, "03-04-2025");
  EXPECT_EQ(info.created_by, "somebody");
  EXPECT_EQ(info.modification_time, "05:06AM");
  EXPECT_EQ(info.modification_date, "07-08-2026");
  EXPECT_EQ(info.modified_by, "another");
  EXPECT_EQ(info.last_eds, "motor.eds");
  EXPECT_EQ(info.vendor_name, "Maker");
  EXPECT_EQ(info.vendor_number, 0xABCU);
  EXPECT_EQ(info.product_name, "Motor");
  EXPECT_EQ(info.product_number, 0xDEFU);
  EXPECT_EQ(info.revision_number, 0x00010002U);
  EXPECT_EQ(info.order_code, "M-7");
  EXPECT_THAT(info.baud_rates, ElementsAre(20, 125, 500, 1000));
  EXPECT_TRUE(info.boot_up_master);
  EXPECT_TRUE(info.boot_up_slave);
  EXPECT_EQ(info.granularity, 8);
  EXPECT_EQ(info.dynamic_channels, 5);
  EXPECT_TRUE(info.group_messaging);
  EXPECT_EQ(info.rpdo_count, 3);
  EXPECT_EQ(info.tpdo_count, 4);
  EXPECT_TRUE(info.lss_supported);
  EXPECT_EQ(info.compact_pdo, 6);
  EXPECT_EQ(info.node_id, NodeId{0x20});
  EXPECT_EQ(info.node_name, "shoulder");
  EXPECT_EQ(info.baud_rate, 500U);
  EXPECT_EQ(info.lss_serial, 12345U);
  EXPECT_THAT(info.dummies, ElementsAre(2, 5, 7, 0x1B));
  EXPECT_THAT(info.comments, ElementsAre("one", "two"));
}

TEST(EdsInfo, EveryKeyIsWrittenAsItWasRead) {
  const std::string text = std::string(kHead) + kLists;
  EXPECT_EQ(writeDcf(readEds(text).info, {}), text);
}

TEST(EdsInfo, WhatIsNotThereIsNotWritten) {
  const std::string text = writeDcf({}, {});
  for (const char* key :
       {"FileName", "Description", "Creation", "CreatedBy", "Modification", "ModifiedBy", "LastEDS",
        "VendorN", "ProductN", "RevisionNumber", "OrderCode", "DeviceComissioning", "Comments"}) {
    EXPECT_EQ(text.find(key), std::string::npos) << key;
  }
  EXPECT_THAT(text, HasSubstr("EDSVersion=4.0\r\n"));
  EXPECT_THAT(text, HasSubstr("Dummy0007=0\r\n\r\n")) << "the last one that is always told";
}

// 1Bh, UNSIGNED64, is the last simple data type of CiA 301, table 44.
TEST(EdsInfo, OnlySimpleDataTypesAreWrittenAsDummies) {
  EdsInfo info;
  info.dummies = {0x1B, 0x1C};
  const std::string text = writeDcf(info, {});
  EXPECT_THAT(text, HasSubstr("Dummy001B=1\r\n"));
  EXPECT_EQ(text.find("Dummy001C"), std::string::npos);
}

/// A file of all keys in which one line is another.
Eds headWith(const std::string& from, const std::string& to) {
  std::string text = std::string(kHead) + kLists;
  text.replace(text.find(from), from.size(), to);
  return readEds(text);
}

TEST(EdsInfo, NodeId0IsNone) {
  EXPECT_FALSE(headWith("NodeID=0x20\r\n", "NodeID=0\r\n").info.node_id);
  EXPECT_FALSE(headWith("NodeID=0x20\r\n", "NodeID=\r\n").info.node_id);
  EXPECT_EQ(headWith("NodeID=0x20\r\n", "NodeID=1\r\n").info.node_id, NodeId{1});
  EXPECT_EQ(headWith("NodeID=0x20\r\n", "NodeID=127\r\n").info.node_id, NodeId{127});
}

TEST(EdsInfo, CommentsAreReadWithoutTheirNumberToo) {
  EXPECT_THAT(headWith("Lines=2\r\n", "").info.comments, ElementsAre("one", "two"));
  EXPECT_THAT(headWith("Lines=2\r\n", "Lines=1\r\n").info.comments, ElementsAre("one", "two"));
}

TEST(EdsInfo, ANumberOfCommentsThatIsNoneIsNotComparedToo) {
  const Eds eds = headWith("Lines=2\r\n", "Lines=many\r\n");
  std::vector<std::string> problems;
  for (const EdsProblem& problem : eds.problems) {
    if (problem.line == 57) problems.push_back(problem.message);
  }
  EXPECT_THAT(problems, ElementsAre("Lines=`many` is no whole number"));
  EXPECT_THAT(eds.info.comments, ElementsAre("one", "two"));
}

TEST(EdsInfo, NumbersBeyondTheirRangeAreToldAndLeftOut) {
  struct Row {
    const char *from, *to, *problem;
  };
  const Row rows[] = {
      {"NrOfRXPDO=3", "NrOfRXPDO=513", "NrOfRXPDO=`513` is not 0 to 512"},
      {"NrOfTXPDO=4", "NrOfTXPDO=513", "NrOfTXPDO=`513` is not 0 to 512"},
      {"CompactPDO=6", "CompactPDO=256", "CompactPDO=`256` is not 0 to 255"},
      {"Granularity=8", "Granularity=65", "Granularity=`65` is not 0 to 64"},
      {"NodeID=0x20", "NodeID=128", "NodeID=`128` is not 0 to 127"},
      {"Baudrate=500", "Baudrate=1001", "Baudrate=`1001` is not 0 to 1000"},
      {"LSS_SerialNumber=0x00003039", "LSS_SerialNumber=0x100000000",
       "LSS_SerialNumber=`0x100000000` is not 0 to 4294967295"},
      {"NrOfRXPDO=3", "NrOfRXPDO=010", "NrOfRXPDO: `010` is octal, 8"},
      {"NrOfRXPDO=3", "NrOfRXPDO=-1", "NrOfRXPDO=`-1` is not 0 to 512"},
      {"NrOfRXPDO=3", "NrOfRXPDO=many", "NrOfRXPDO=`many` is no whole number"},
      {"Dummy0005=1", "Dummy0000=1", "`Dummy0000` is no data type like Dummy0005"},
      {"Dummy0005=1", "Dummy0100=1", "`Dummy0100` is no data type like Dummy0005"},
      {"Lines=2", "Lines=3", "[Comments] has 2 lines, not 3"},
      {"Lines=2\r\n", "", "[Comments] has no Lines"},
      {"[DeviceComissioning]", "[DeviceCommissioning]",
       "[DeviceCommissioning] should be [DeviceComissioning]"},
      {"[FileInfo]", "[FileInf]", "section [FileInfo] is missing"},
      {"[DeviceInfo]", "[DeviceInf]", "section [DeviceInfo] is missing"},
  };
  for (const Row& row : rows) {
    std::string problems;
    const Eds eds = headWith(row.from, row.to);
    for (const EdsProblem& problem : eds.problems) problems += toString(problem) + "\n";
    EXPECT_THAT(problems, HasSubstr(row.problem)) << row.to;
  }
}

}  // namespace
}  // namespace cia402::canopen
