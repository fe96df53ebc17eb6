// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Profile and simulated drive of the SV660C were typed from the same pages of its manual: each
// object must be the same in both.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "config/drive_family.h"
#include "folders.h"
#include "sim/definition/drive_definition.h"

namespace cia402 {
namespace {

std::string text(const drive::ObjectSpec& object) {
  return object.name + " " + fieldbus::toString(object.id);
}

class Sv660cFiles : public testing::Test {
 protected:
  Sv660cFiles() {
    const std::string folder = test::configFolder();
    profile_ = config::loadDriveFamily(folder + "/drives/sv660c.yaml", problems_).drive;
    const auto definition = sim::loadDriveDefinition(folder + "/simulated_drives/sv660c.yaml");
    EXPECT_TRUE(definition.ok()) << (definition.ok() ? "" : definition.error().message);
    if (definition.ok()) dictionary_ = (*definition)->dictionary.build(canopen::NodeId{1});
  }

  Problems problems_;
  drive::DriveProfile profile_;
  sim::ObjectDictionary dictionary_;
};

TEST_F(Sv660cFiles, Load) {
  EXPECT_TRUE(problems_.empty()) << problems_.text();
  EXPECT_GT(profile_.objects.size(), 150U);
  EXPECT_GT(dictionary_.entries().size(), 700U);
}

TEST_F(Sv660cFiles, AgreeOnTypeAndAccess) {
  for (const drive::ObjectSpec& object : profile_.objects) {
    const sim::Entry* entry = dictionary_.find(object.id);
    ASSERT_NE(entry, nullptr) << text(object);
    EXPECT_EQ(object.type, entry->type) << text(object);
    const bool writable = entry->access == sim::Access::rw || entry->access == sim::Access::wo;
    EXPECT_EQ(object.writable, writable) << text(object);
    EXPECT_EQ(object.readable, entry->access != sim::Access::wo) << text(object);
  }
}

TEST_F(Sv660cFiles, AgreeOnRanges) {
  unsigned compared = 0;
  for (const drive::ObjectSpec& object : profile_.objects) {
    const sim::Entry* entry = dictionary_.find(object.id);
    if (!object.range || entry == nullptr) continue;
    if (object.range->high == 536870912.0) continue;  // 2^29 units/s, by a note [L15614]
    if (object.name == "do3_function") continue;      // has the holding brake, and keeps it
    ++compared;
    ASSERT_TRUE(entry->low && entry->high) << text(object);
    EXPECT_EQ(object.range->low, *entry->low) << text(object);
    EXPECT_EQ(object.range->high, *entry->high) << text(object);
  }
  EXPECT_EQ(compared, 23U);
}

// The manual does not say of 603Fh, 60F4h and 60FDh whether they can be mapped: the driver tries,
// the simulated drive refuses. Of 6099h and 609Ah the driver makes no use in an RPDO, as the former
// is taken while stopped only.
TEST_F(Sv660cFiles, AgreeOnWhatCanBeMapped) {
  const std::vector<std::uint16_t> tried = {0x603F, 0x60F4, 0x60FD};
  const std::vector<std::uint16_t> unused = {0x6099, 0x609A};
  const auto among = [](const std::vector<std::uint16_t>& list, std::uint16_t index) {
    return std::find(list.begin(), list.end(), index) != list.end();
  };
  for (const drive::ObjectSpec& object : profile_.objects) {
    const sim::Entry* entry = dictionary_.find(object.id);
    ASSERT_NE(entry, nullptr) << text(object);
    EXPECT_EQ(object.tpdo, entry->tpdo || among(tried, object.id.index)) << text(object);
    EXPECT_EQ(object.rpdo, entry->rpdo && !among(unused, object.id.index)) << text(object);
  }
}

}  // namespace
}  // namespace cia402
