// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a DCF is made of where no EDS tells what the drive holds.
#include "bus/canopen/dcf_draft.h"

#include <gmock/gmock.h>

#include "bus/dcf_draft_world.h"

namespace cia402::bus {
namespace {

using fieldbus::ObjectId;
using test::Bytes;
using test::DcfDraftTest;
using test::RobotWorld;
using testing::HasSubstr;
using testing::Not;

TEST_F(DcfDraftTest, WithoutAnEdsTheProfileAndTheCommunicationObjectsAreRead) {
  bareDrive();
  give({0x1000, 0}, {0x92, 0x01, 0x02, 0x00});
  give({0x1018, 0}, {4});
  give({0x1018, 1}, {0xBC, 0x0A, 0, 0});
  give({0x1018, 2}, {7, 0, 0, 0});
  give({0x1018, 3}, {2, 0, 1, 0});
  give({0x1018, 4}, {0x39, 0x30, 0, 0});
  give({0x1017, 0}, {100, 0});
  give({0x6065, 0}, {0x10, 0x27, 0, 0});
  const DcfAnswer answer = save(1);
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
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1018, 1})->access, fieldbus::Access::ro);
  EXPECT_EQ(dcf.dictionary.find(ObjectId{0x1800, 1}), nullptr);
  EXPECT_THAT(answer.message, Not(HasSubstr("could not be read")));
}

TEST_F(DcfDraftTest, WithoutAnEdsTheFileTellsWhatItWasMadeBy) {
  bareDrive();
  give({0x1008, 0}, {'M', '7', 0, 0});
  give({0x1400, 0}, {1});  // a PDO whose mapping cannot be read
  const canopen::EdsInfo info = canopen::readEds(save(1).text).info;
  EXPECT_THAT(info.description, HasSubstr("test_drive"));
  EXPECT_EQ(info.product_name, "M7");
  EXPECT_EQ(info.granularity, 8);
  EXPECT_EQ(info.rpdo_count, 1);
  EXPECT_EQ(info.tpdo_count, 0);
  EXPECT_EQ(info.creation_date, "11-21-2026");
  EXPECT_EQ(info.creation_time, "03:40PM");
  EXPECT_EQ(info.created_by, "cia402_driver");
  EXPECT_EQ(info.modification_date, "11-21-2026");
  EXPECT_EQ(info.modification_time, "03:40PM");
  EXPECT_EQ(info.modified_by, "cia402_driver");
}

// Access and types of CiA 301, 7.5.2.
TEST_F(DcfDraftTest, WithoutAnEdsTheObjectsAreWhatTheProfileAndTheStandardSay) {
  drive::AxisConfig config = world.axis(1).config();
  auto profile = std::make_shared<drive::DriveProfile>(*config.profile);
  canopen::DeviceConfig device = world.device(1);
  auto family = std::make_shared<canopen::DeviceProfile>(*device.profile);
  family->max_rpdos = 1;
  family->max_tpdos = 2;
  device.profile = family;
  const auto name = [&](const char* word, ObjectId id, fieldbus::DataType type, bool writable) {
    drive::ObjectSpec spec;
    spec.name = word;
    spec.id = id;
    spec.type = type;
    spec.writable = writable;
    profile->objects.push_back(spec);
  };
  name("lower_limit", {0x607D, 1}, fieldbus::DataType::int32, true);
  name("upper_limit", {0x607D, 2}, fieldbus::DataType::int32, true);
  name("serial", {0x1018, 4}, fieldbus::DataType::uint32, false);
  config.profile = profile;
  bareDrive();
  for (const std::uint16_t index :
       {std::uint16_t{0x607D}, std::uint16_t{0x1016}, std::uint16_t{0x1018}, std::uint16_t{0x1400},
        std::uint16_t{0x1401}, std::uint16_t{0x1600}, std::uint16_t{0x1800}, std::uint16_t{0x1A00},
        std::uint16_t{0x1801}, std::uint16_t{0x1A01}, std::uint16_t{0x1802}}) {
    give({index, 0}, {4});
    give({index, 1}, {1, 0, 0, 0});
  }
  give({0x607D, 2}, {2, 0, 0, 0});
  give({0x1018, 4}, {0x39, 0x30, 0, 0});
  give({0x1400, 2}, {1});
  give({0x1400, 5}, {100, 0});  // and no inhibit time, sub-index 3
  give({0x6040, 0}, {0, 0});
  give({0x6041, 0}, {0, 0});
  const DcfAnswer answer = save(config, device);
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, Not(HasSubstr("could not be read")));
  const canopen::Eds dcf = canopen::readEds(answer.text);

  using fieldbus::Access;
  using fieldbus::DataType;
  const struct {
    ObjectId id;
    const char* name;
    DataType type;
    Access access;
    bool mappable;
  } entries[] = {
      {{0x1016, 0}, "Highest sub-index supported", DataType::uint8, Access::ro, false},
      {{0x1016, 1}, "Consumer heartbeat time 1", DataType::uint32, Access::rw, false},
      {{0x1018, 4}, "serial", DataType::uint32, Access::ro, false},
      {{0x1400, 0}, "Highest sub-index supported", DataType::uint8, Access::ro, false},
      {{0x1400, 1}, "COB-ID", DataType::uint32, Access::rw, false},
      {{0x1400, 2}, "Transmission type", DataType::uint8, Access::rw, false},
      {{0x1400, 5}, "Event timer", DataType::uint16, Access::rw, false},
      {{0x1600, 0}, "Number of mapped objects", DataType::uint8, Access::rw, false},
      {{0x1600, 1}, "Mapped object 1", DataType::uint32, Access::rw, false},
      {{0x6040, 0}, "controlword", DataType::uint16, Access::rw, true},
      {{0x6041, 0}, "statusword", DataType::uint16, Access::ro, true},
      {{0x6065, 0}, "following_error_window", DataType::uint32, Access::rw, false},
      {{0x607D, 0}, "Highest sub-index supported", DataType::uint8, Access::ro, false},
      {{0x607D, 2}, "upper_limit", DataType::int32, Access::rw, false},
  };
  for (const auto& row : entries) {
    const fieldbus::DictionaryEntry* entry = dcf.dictionary.find(row.id);
    ASSERT_NE(entry, nullptr) << toString(row.id);
    EXPECT_EQ(entry->name, row.name) << toString(row.id);
    EXPECT_EQ(entry->type, row.type) << toString(row.id);
    EXPECT_EQ(entry->access, row.access) << toString(row.id);
    EXPECT_EQ(entry->mappable, row.mappable) << toString(row.id);
    EXPECT_TRUE(entry->value) << toString(row.id);
  }
  const auto object = [&](std::uint16_t index) { return dcf.dictionary.objects().at(index); };
  EXPECT_EQ(object(0x1400).name, "RPDO communication parameter");
  EXPECT_EQ(object(0x1600).name, "RPDO mapping parameter");
  EXPECT_EQ(object(0x1801).name, "TPDO communication parameter");
  EXPECT_EQ(object(0x1A01).name, "TPDO mapping parameter");
  EXPECT_EQ(object(0x607D).name, "607D");
  EXPECT_EQ(object(0x607D).code, fieldbus::ObjectCode::record);
  EXPECT_EQ(object(0x6065).code, fieldbus::ObjectCode::variable);
  EXPECT_EQ(object(0x1400).entries.size(), 4U) << "the drive lacks sub-indices 3, 4 and 6";
  EXPECT_EQ(object(0x1018).entries.size(), 2U) << "the profile names one";
  for (const std::uint16_t index : {std::uint16_t{0x1401}, std::uint16_t{0x1802}}) {
    EXPECT_EQ(dcf.dictionary.objects().count(index), 0U) << "the profile has no more PDOs";
  }
  EXPECT_EQ(dcf.info.rpdo_count, 1);
  EXPECT_EQ(dcf.info.tpdo_count, 2);
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
  const DcfAnswer answer = save(1);
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, Not(HasSubstr("could not be read"))) << answer.message;
  const canopen::Eds dcf = canopen::readEds(answer.text);
  for (const std::uint16_t base : {std::uint16_t{0x1400}, std::uint16_t{0x1600},
                                   std::uint16_t{0x1800}, std::uint16_t{0x1A00}}) {
    const bool mapping = (base & 0x0200) != 0, receive = base < 0x1800;
    const std::string name = receive ? "RPDO " : "TPDO ";
    for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
      const auto index = static_cast<std::uint16_t>(base + pdo);
      SCOPED_TRACE(fieldbus::toString(ObjectId{index, 0}));
      const auto object = dcf.dictionary.objects().find(index);
      ASSERT_NE(object, dcf.dictionary.objects().end());
      EXPECT_EQ(object->second.name,
                name + (mapping ? "mapping parameter" : "communication parameter"));
      EXPECT_EQ(object->second.entries.size(), mapping ? 9u : 7u);
      EXPECT_EQ(object->second.entries.at(0).access,
                mapping ? fieldbus::Access::rw : fieldbus::Access::ro);
      const fieldbus::DictionaryEntry& first = object->second.entries.at(1);
      EXPECT_EQ(first.name, mapping ? "Mapped object 1" : "COB-ID");
      EXPECT_EQ(first.type, fieldbus::DataType::uint32);
      EXPECT_EQ(first.access, fieldbus::Access::rw);
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

TEST(DcfDraft, ObjectsOfTheProfileKeepTheirNamesAndAreRecordsWhereTheyHaveSubIndices) {
  config::RobotConfig config = test::testRobot();
  auto profile = std::make_shared<drive::DriveProfile>(*config.axes[0].profile);
  const auto add = [&](ObjectId id, const char* name) {
    drive::ObjectSpec spec;
    spec.id = id;
    spec.name = name;
    spec.type = fieldbus::DataType::uint32;
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
  DcfDraft draft(world.axis(0).config(), world.device(0),
                 {"shoulder.dcf", "11-21-2026", "03:40PM"});
  ASSERT_TRUE(world.call(draft.command()).success);
  const canopen::Eds dcf = canopen::readEds(draft.finish().text);
  const auto& objects = dcf.dictionary.objects();
  ASSERT_EQ(objects.count(0x2010), 1u);
  EXPECT_EQ(objects.at(0x2010).code, fieldbus::ObjectCode::record);
  EXPECT_EQ(objects.at(0x2010).name, "2010");
  EXPECT_EQ(objects.at(0x2010).entries.at(0).name, "Highest sub-index supported");
  EXPECT_EQ(objects.at(0x2010).entries.at(1).name, "gain");
  EXPECT_EQ(objects.at(0x2010).entries.at(1).value, (Bytes{7, 0, 0, 0}));
  EXPECT_EQ(objects.at(0x6041).code, fieldbus::ObjectCode::variable);
  EXPECT_EQ(objects.at(0x6041).name, "statusword");
  EXPECT_TRUE(objects.at(0x6041).entries.at(0).mappable) << "in a TPDO";
  EXPECT_FALSE(objects.at(0x6065).entries.at(0).mappable);
  EXPECT_EQ(objects.at(0x1018).entries.at(1).name, "maker");
  EXPECT_EQ(objects.at(0x1018).entries.size(), 2u);
  EXPECT_EQ(objects.at(0x1014).entries.at(0).name, "emergency_identifier");
}

}  // namespace
}  // namespace cia402::bus
