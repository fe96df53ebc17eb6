// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/dcf_draft.h"

#include <gmock/gmock.h>

#include "bus/dcf_draft_world.h"

namespace cia402::bus {
namespace {

using fieldbus::ObjectId;
using test::Bytes;
using test::DcfDraftTest;
using test::RobotWorld;
using test::word;
using testing::HasSubstr;
using testing::Not;

TEST_F(DcfDraftTest, ReadsWhatTheEdsCallsReadableAndTellsWhatCouldNotBeRead) {
  const DcfAnswer answer = save();
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(answer.message,
            "shoulder (node 1): 2 objects read, 2 could not be read: 2003:00 Length differs (2 "
            "bytes, but it should be uint32); 2004:00 Not there (the drive refused: 0x06020000 "
            "(object does not exist in the object dictionary))");
  const canopen::Eds dcf = canopen::readEds(answer.text);
  EXPECT_EQ(dcf.info.node_id, canopen::NodeId{1});
  EXPECT_EQ(dcf.info.node_name, "shoulder");
  EXPECT_EQ(dcf.info.baud_rate, 1000U);
  EXPECT_EQ(dcf.info.file_name, "shoulder.dcf");
  EXPECT_EQ(dcf.info.last_eds, "motor.eds");
  EXPECT_EQ(dcf.info.modification_date, "11-21-2026");
  EXPECT_EQ(dcf.info.vendor_number, 0x123U);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x2001, 0})->value, (Bytes{0x34, 0x12}));
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x2001, 0})->default_value, (Bytes{5, 0}));
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x2005, 0})->value, (Bytes{'M', '7'}));
  for (const std::uint16_t index : {std::uint16_t{0x2002}, std::uint16_t{0x2003},
                                    std::uint16_t{0x2004}, std::uint16_t{0x2006}}) {
    EXPECT_FALSE(dcf.dictionary.find(ObjectId{index, 0})->value) << index;
  }
}

TEST_F(DcfDraftTest, TextThatNoLineCanHoldIsLeftOutAndTold) {
  world.drives[0].objects[ObjectId{0x2005, 0}] = {'M', '\n', '7'};
  const DcfAnswer answer = save();
  ASSERT_TRUE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("2 objects read, 1 of them left out because no line"));
  EXPECT_FALSE(canopen::readEds(answer.text).dictionary.find(ObjectId{0x2005, 0})->value);
}

TEST_F(DcfDraftTest, WithAnEdsItsHeadIsKept) {
  const DcfAnswer answer = saveWithEds(
      "[FileInfo]\nCreationDate=01-02-2020\nCreationTime=09:10AM\nCreatedBy=somebody\n"
      "Description=a motor\n[DeviceInfo]\nProductName=Motor\nNrOfRXPDO=2\nNrOfTXPDO=3\n" +
      word("2001"));
  ASSERT_TRUE(answer.success) << answer.message;
  const canopen::EdsInfo info = canopen::readEds(answer.text).info;
  EXPECT_EQ(info.creation_date, "01-02-2020");
  EXPECT_EQ(info.creation_time, "09:10AM");
  EXPECT_EQ(info.created_by, "somebody");
  EXPECT_EQ(info.modification_date, "11-21-2026");
  EXPECT_EQ(info.modification_time, "03:40PM");
  EXPECT_EQ(info.modified_by, "cia402_driver");
  EXPECT_EQ(info.description, "a motor");
  EXPECT_EQ(info.product_name, "Motor");
  EXPECT_EQ(info.rpdo_count, 2);
  EXPECT_EQ(info.tpdo_count, 3);
}

TEST_F(DcfDraftTest, AValueOfTheEdsThatTheDriveDidNotConfirmIsNotWritten) {
  const DcfAnswer answer =
      saveWithEds(word("2001") + "ParameterValue=1\n" + word("3001") + "ParameterValue=2\n");
  ASSERT_TRUE(answer.success) << answer.message;
  const canopen::Eds dcf = canopen::readEds(answer.text);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x2001, 0})->value, (Bytes{0x34, 0x12}));
  EXPECT_FALSE(dcf.dictionary.find(ObjectId{0x3001, 0})->value);
}

TEST_F(DcfDraftTest, ARecordOfTheEdsIsReadWithoutItsSubIndex0Too) {
  world.drives[0].objects[ObjectId{0x3001, 1}] = {7, 0};
  const DcfAnswer answer = saveWithEds("[3001]\nParameterName=x\nObjectType=9\nSubNumber=2\n" +
                                       word("3001sub0") + word("3001sub1"));
  ASSERT_TRUE(answer.success) << answer.message;
  const canopen::Eds dcf = canopen::readEds(answer.text);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x3001, 1})->value, (Bytes{7, 0}));
  EXPECT_FALSE(dcf.dictionary.find(ObjectId{0x3001, 0})->value);
}

TEST_F(DcfDraftTest, TenObjectsThatCouldNotBeReadAreNamedAndNoMore) {
  std::string text = word("2001");
  for (const char last : {'0', '1', '2', '3', '4', '5', '6', '7', '8', '9'}) {
    text += word(std::string("300") + last);
  }
  const std::string ten = saveWithEds(text).message;
  EXPECT_THAT(ten, HasSubstr("10 could not be read: 3000:00 Word 3000"));
  EXPECT_THAT(ten, HasSubstr("3009:00 Word 3009"));
  EXPECT_THAT(ten, Not(HasSubstr("...")));
  const std::string eleven = saveWithEds(text + word("300A")).message;
  EXPECT_THAT(eleven, HasSubstr("11 could not be read: 3000:00 Word 3000"));
  EXPECT_THAT(eleven, HasSubstr("3009:00 Word 3009"));
  EXPECT_THAT(eleven, HasSubstr("; ..."));
  EXPECT_THAT(eleven, Not(HasSubstr("300A")));
}

TEST_F(DcfDraftTest, TheFileSaysWhatItIsAndWhoMadeIt) {
  world.drives[1].objects[ObjectId{0x1008, 0}] = {'D', 'M', 0, 0};
  const canopen::EdsInfo made = canopen::readEds(save(1).text).info;
  EXPECT_EQ(made.description, "Written without an EDS, by profile test_drive");
  EXPECT_EQ(made.granularity, 8u);
  EXPECT_EQ(made.product_name, "DM");
  EXPECT_EQ(made.modification_date, "11-21-2026");
  EXPECT_EQ(made.modification_time, "03:40PM");
  EXPECT_EQ(made.modified_by, "cia402_driver");
  EXPECT_EQ(made.creation_date, "11-21-2026");
  EXPECT_EQ(made.creation_time, "03:40PM");
  EXPECT_EQ(made.created_by, "cia402_driver");
  EXPECT_EQ(made.last_eds, "");
}

TEST(DcfDraft, ADcfTakesOverWhoMadeTheEdsButNoneOfItsValues) {
  RobotWorld world(test::robotWithEds(R"([FileInfo]
CreationDate=01-02-2003
CreationTime=04:05AM
CreatedBy=maker
[DeviceInfo]
ProductName=M9
[1008]
ParameterName=Name
DataType=9
AccessType=const
[2001]
ParameterName=Gain
DataType=6
AccessType=rw
ParameterValue=5
[2002]
ParameterName=Offset
DataType=6
AccessType=rw
ParameterValue=6
)"));
  world.boot();
  world.drives[0].objects[ObjectId{0x1008, 0}] = {'D', 'M', 0, 0};
  world.drives[0].objects[ObjectId{0x2001, 0}] = {0x34, 0x12};
  DcfDraft draft(world.axis(0).config(), world.device(0),
                 {"shoulder.dcf", "11-21-2026", "03:40PM"});
  ASSERT_TRUE(world.call(draft.command()).success);
  const canopen::Eds dcf = canopen::readEds(draft.finish().text);
  EXPECT_EQ(dcf.info.creation_date, "01-02-2003");
  EXPECT_EQ(dcf.info.creation_time, "04:05AM");
  EXPECT_EQ(dcf.info.created_by, "maker");
  EXPECT_EQ(dcf.info.modified_by, "cia402_driver");
  EXPECT_EQ(dcf.info.product_name, "M9");
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x2001, 0})->value, (Bytes{0x34, 0x12}));
  EXPECT_FALSE(dcf.dictionary.find(ObjectId{0x2002, 0})->value) << "the drive has no such object";
}

TEST_F(DcfDraftTest, ASubIndexThatTheDriveDoesNotHaveIsLeftOut) {
  test::FakeDrive& drive = world.drives[1];
  drive.objects[ObjectId{0x1018, 0}] = {3};
  drive.aborts[ObjectId{0x1018, 4}] = 0x06090011;
  const canopen::Eds dcf = canopen::readEds(save(1).text);
  EXPECT_EQ(dcf.dictionary.objects().at(0x1018).entries.size(), 4u);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1018, 4}), nullptr);
}

TEST(DcfDraft, NamesTenObjectsThatCouldNotBeReadAtMost) {
  for (const unsigned absent : {10U, 11U}) {
    std::string eds = "[2001]\nParameterName=Gain\nDataType=6\nAccessType=rw\n";
    for (unsigned i = 0; i < absent; ++i) {
      eds += "[30" + std::to_string(10 + i) + "]\nParameterName=Absent\nDataType=6\n" +
             "AccessType=rw\n";
    }
    RobotWorld world(test::robotWithEds(eds));
    world.boot();
    world.drives[0].objects[ObjectId{0x2001, 0}] = {1, 0};
    DcfDraft draft(world.axis(0).config(), world.device(0),
                   {"shoulder.dcf", "11-21-2026", "03:40PM"});
    ASSERT_TRUE(world.call(draft.command()).success);
    const std::string message = draft.finish().message;
    EXPECT_THAT(message, HasSubstr(std::to_string(absent) + " could not be read: 3010:00"));
    EXPECT_THAT(message, HasSubstr("3019:00"));
    EXPECT_THAT(message, Not(HasSubstr("3020:00")));
    EXPECT_EQ(message.find("; ...") != std::string::npos, absent == 11) << message;
  }
}

TEST_F(DcfDraftTest, ADriveThatGivesNothingHasNoFile) {
  for (const auto& [id, data] : world.drives[0].objects) world.drives[0].aborts[id] = 0x08000022;
  const DcfAnswer answer = save();
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "shoulder (node 1): no DCF: the drive gave none of its objects");
}

}  // namespace
}  // namespace cia402::bus
