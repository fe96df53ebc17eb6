// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/dcf_draft.h"

#include <gmock/gmock.h>

#include "bus/dcf_world.h"

namespace cia402::bus {
namespace {

using canopen::ObjectId;
using test::Bytes;
using test::RobotWorld;
using testing::HasSubstr;
using testing::Not;

struct DcfDraftTest : test::DcfWorld {
  /// The file, or why there is none.
  Answer save(std::size_t axis = 0) {
    DcfDraft draft(world.axis(axis).config(), stamp());
    const Answer answer = world.call(draft.command());
    return answer.success ? draft.finish() : answer;
  }
};

TEST_F(DcfDraftTest, ReadsWhatTheEdsCallsReadableAndTellsWhatCouldNotBeRead) {
  const Answer answer = save();
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
  const Answer answer = save();
  ASSERT_TRUE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("2 objects read, 1 of them left out because no line"));
  EXPECT_FALSE(canopen::readEds(answer.text).dictionary.find(ObjectId{0x2005, 0})->value);
}

TEST_F(DcfDraftTest, WithoutAnEdsTheProfileAndTheCommunicationObjectsAreRead) {
  test::FakeDrive& drive = world.drives[1];
  for (std::uint32_t index = 0x1000; index < 0x2000; ++index) {
    for (std::uint8_t subindex = 0; subindex < 9; ++subindex) {
      const ObjectId id{static_cast<std::uint16_t>(index), subindex};
      if (index != 0x1017) drive.aborts[id] = subindex == 0 ? 0x06020000 : 0x06090011;
    }
  }
  const auto give = [&](ObjectId id, const Bytes& data) {
    drive.aborts.erase(id);
    drive.objects[id] = data;
  };
  give({0x1000, 0}, {0x92, 0x01, 0x02, 0x00});
  give({0x1018, 0}, {4});
  give({0x1018, 1}, {0xBC, 0x0A, 0, 0});
  give({0x1018, 2}, {7, 0, 0, 0});
  give({0x1018, 3}, {2, 0, 1, 0});
  give({0x1018, 4}, {0x39, 0x30, 0, 0});
  give({0x1017, 0}, {100, 0});
  give({0x6065, 0}, {0x10, 0x27, 0, 0});
  const Answer answer = save(1);
  ASSERT_TRUE(answer.success) << answer.message;
  const canopen::Eds dcf = canopen::readEds(answer.text);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1000, 0})->value, (Bytes{0x92, 0x01, 0x02, 0x00}));
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x6065, 0})->value, (Bytes{0x10, 0x27, 0, 0}));
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x6065, 0})->name, "following_error_window");
  EXPECT_EQ(dcf.info.vendor_number, 0xABCU);
  EXPECT_EQ(dcf.info.product_number, 7U);
  EXPECT_EQ(dcf.info.revision_number, 0x00010002U);
  EXPECT_EQ(dcf.info.lss_serial, 12345U);
  EXPECT_EQ(dcf.dictionary.objects().at(0x1018).entries.size(), 5U);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1018, 1})->access, canopen::Access::ro);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1800, 1}), nullptr);
  EXPECT_THAT(answer.message, Not(HasSubstr("could not be read")));
}

// CiA 301: 1400h.. and 1800h.. are the parameters of PDOs, 1600h.. and 1A00h.. their mappings.
TEST_F(DcfDraftTest, WithoutAnEdsThePdosThatTheProfileAllowsAreRead) {
  test::FakeDrive& drive = world.drives[1];
  const std::size_t sizes[] = {1, 4, 1, 2, 1, 2, 1};
  for (std::uint32_t index = 0x1000; index < 0x2000; ++index) {
    const std::uint32_t kind = index & 0xFE00;
    const bool mapping = kind == 0x1600 || kind == 0x1A00;
    const bool parameter = kind == 0x1400 || kind == 0x1800;
    for (std::uint8_t subindex = 0; subindex < 9; ++subindex) {
      const ObjectId id{static_cast<std::uint16_t>(index), subindex};
      if (parameter && subindex < 7) {
        drive.objects[id] = Bytes(sizes[subindex], subindex);
      } else if (mapping) {
        drive.objects[id] = Bytes(subindex == 0 ? 1 : 4, subindex);
      } else if (index != 0x1017) {
        drive.aborts[id] = 0x06020000;
      }
    }
  }
  const Answer answer = save(1);
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, Not(HasSubstr("could not be read"))) << answer.message;
  const canopen::Eds dcf = canopen::readEds(answer.text);
  for (const std::uint16_t base : {std::uint16_t{0x1400}, std::uint16_t{0x1600},
                                   std::uint16_t{0x1800}, std::uint16_t{0x1A00}}) {
    const bool mapping = (base & 0x0200) != 0, receive = base < 0x1800;
    const std::string name = receive ? "RPDO " : "TPDO ";
    for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
      const auto index = static_cast<std::uint16_t>(base + pdo);
      SCOPED_TRACE(canopen::toString(ObjectId{index, 0}));
      const auto object = dcf.dictionary.objects().find(index);
      ASSERT_NE(object, dcf.dictionary.objects().end());
      EXPECT_EQ(object->second.name,
                name + (mapping ? "mapping parameter" : "communication parameter"));
      EXPECT_EQ(object->second.entries.size(), mapping ? 9u : 7u);
      EXPECT_EQ(object->second.entries.at(0).access,
                mapping ? canopen::Access::rw : canopen::Access::ro);
      const canopen::DictionaryEntry& first = object->second.entries.at(1);
      EXPECT_EQ(first.name, mapping ? "Mapped object 1" : "COB-ID");
      EXPECT_EQ(first.type, canopen::DataType::uint32);
      EXPECT_EQ(first.access, canopen::Access::rw);
      EXPECT_EQ(first.value, (Bytes{1, 1, 1, 1}));
    }
    EXPECT_EQ(dcf.dictionary.objects().count(static_cast<std::uint16_t>(base + 4)), 0u);
  }
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1803, 5})->name, "Event timer");
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1803, 5})->value, (Bytes{5, 5}));
  EXPECT_EQ(dcf.info.rpdo_count, 4u);
  EXPECT_EQ(dcf.info.tpdo_count, 4u);
  // They are counted by their communication parameters.
  drive.aborts[ObjectId{0x1600, 0}] = drive.aborts[ObjectId{0x1A00, 0}] = 0x06020000;
  const canopen::Eds without = canopen::readEds(save(1).text);
  EXPECT_EQ(without.info.rpdo_count, 4u);
  EXPECT_EQ(without.info.tpdo_count, 4u);
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
  DcfDraft draft(world.axis(0).config(), {"shoulder.dcf", "11-21-2026", "03:40PM"});
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

TEST(DcfDraft, ObjectsOfTheProfileKeepTheirNamesAndAreRecordsWhereTheyHaveSubIndices) {
  config::RobotConfig config = test::testRobot();
  auto profile = std::make_shared<drive::DriveProfile>(*config.axes[0].profile);
  const auto add = [&](ObjectId id, const char* name) {
    drive::ObjectSpec spec;
    spec.id = id;
    spec.name = name;
    spec.type = canopen::DataType::uint32;
    profile->objects.push_back(spec);
  };
  add({0x2010, 1}, "gain");
  add({0x1018, 1}, "maker");
  add({0x1014, 0}, "emergency_identifier");
  config.axes[0].profile = profile;
  RobotWorld world(config);
  world.boot();
  world.drives[0].objects[ObjectId{0x2010, 0}] = {1};
  world.drives[0].objects[ObjectId{0x2010, 1}] = {7, 0, 0, 0};
  world.drives[0].objects[ObjectId{0x1018, 0}] = {4};
  world.drives[0].objects[ObjectId{0x6041, 0}] = {0x50, 0x02};
  DcfDraft draft(world.axis(0).config(), {"shoulder.dcf", "11-21-2026", "03:40PM"});
  ASSERT_TRUE(world.call(draft.command()).success);
  const canopen::Eds dcf = canopen::readEds(draft.finish().text);
  const auto& objects = dcf.dictionary.objects();
  ASSERT_EQ(objects.count(0x2010), 1u);
  EXPECT_EQ(objects.at(0x2010).code, canopen::ObjectCode::record);
  EXPECT_EQ(objects.at(0x2010).name, "2010");
  EXPECT_EQ(objects.at(0x2010).entries.at(0).name, "Highest sub-index supported");
  EXPECT_EQ(objects.at(0x2010).entries.at(1).name, "gain");
  EXPECT_EQ(objects.at(0x2010).entries.at(1).value, (Bytes{7, 0, 0, 0}));
  EXPECT_EQ(objects.at(0x6041).code, canopen::ObjectCode::variable);
  EXPECT_EQ(objects.at(0x6041).name, "statusword");
  EXPECT_TRUE(objects.at(0x6041).entries.at(0).mappable) << "in a TPDO";
  EXPECT_FALSE(objects.at(0x6065).entries.at(0).mappable);
  EXPECT_EQ(objects.at(0x1018).entries.at(1).name, "maker");
  EXPECT_EQ(objects.at(0x1018).entries.size(), 2u);
  EXPECT_EQ(objects.at(0x1014).entries.at(0).name, "emergency_identifier");
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
    DcfDraft draft(world.axis(0).config(), {"shoulder.dcf", "11-21-2026", "03:40PM"});
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
  const Answer answer = save();
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "shoulder (node 1): no DCF: the drive gave none of its objects");
}

}  // namespace
}  // namespace cia402::bus
