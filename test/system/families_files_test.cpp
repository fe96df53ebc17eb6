// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Profile and simulated drive of a family were written one by one from the same tables of its
// manual: each object must be the same in both, but for what is named here with its reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "config/drive_family.h"
#include "folders.h"
#include "sim/definition/drive_definition.h"

namespace cia402 {
namespace {

struct Files {
  const char* family;
  std::size_t objects;
  std::vector<fieldbus::ObjectId> access;  ///< objects that differ in that
  std::vector<fieldbus::ObjectId> sign;    ///< likewise
  std::vector<fieldbus::ObjectId> mapped;  ///< likewise
};
void PrintTo(const Files& files, std::ostream* out) { *out << files.family; }

class FamilyFiles : public testing::TestWithParam<Files> {
 protected:
  FamilyFiles() {
    const std::string folder = test::configFolder();
    const std::string name = std::string(GetParam().family) + ".yaml";
    profile_ = config::loadDriveFamily(folder + "/drives/" + name, problems_).drive;
    const auto definition = sim::loadDriveDefinition(folder + "/simulated_drives/" + name);
    EXPECT_TRUE(definition.ok()) << (definition.ok() ? "" : definition.error().message);
    if (definition.ok()) dictionary_ = (*definition)->dictionary.build(canopen::NodeId{1});
  }
  static bool isIn(const std::vector<fieldbus::ObjectId>& list, fieldbus::ObjectId id) {
    return std::find(list.begin(), list.end(), id) != list.end();
  }

  Problems problems_;
  drive::DriveProfile profile_;
  sim::ObjectDictionary dictionary_;
};

TEST_P(FamilyFiles, AgreeOnTypeAccessAndMapping) {
  EXPECT_TRUE(problems_.empty()) << problems_.text();
  EXPECT_GE(profile_.objects.size(), GetParam().objects);
  for (const drive::ObjectSpec& object : profile_.objects) {
    const std::string text = object.name + " " + fieldbus::toString(object.id);
    const sim::Entry* entry = dictionary_.find(object.id);
    ASSERT_NE(entry, nullptr) << text;
    EXPECT_EQ(object.type == entry->type, !isIn(GetParam().sign, object.id)) << text;
    EXPECT_EQ(fieldbus::sizeBits(object.type), fieldbus::sizeBits(entry->type)) << text;
    const bool maps = object.rpdo == entry->rpdo && object.tpdo == entry->tpdo;
    EXPECT_EQ(maps, !isIn(GetParam().mapped, object.id)) << text;
    const bool writable = entry->access == sim::Access::rw || entry->access == sim::Access::wo;
    EXPECT_EQ(object.writable == writable, !isIn(GetParam().access, object.id)) << text;
    EXPECT_EQ(object.readable, entry->access != sim::Access::wo) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, FamilyFiles,
    testing::Values(
        // 605Eh is printed read-only and described as if it were not: the driver tries.
        Files{"nimotion_stepper", 150, {{0x605E, 0}}, {}, {}},
        // Ranges are printed with another sign than the standard has: 605Ah to 65535, the others
        // from -2147483647 on.
        Files{"id286_cnfa", 70, {}, {{0x605A, 0}, {0x6080, 0}, {0x6083, 0}}, {}},
        // 603Fh is printed writable; what enables and homes at the drive itself is left alone.
        Files{"megmeet_dm5", 150, {{0x603F, 0}, {0x2002, 2}, {0x200C, 1}}, {}, {}},
        // The windows are printed read-only here, and are written in its section on them [L257-259,
        // L1224-1236]: the driver tries. Its temperatures are printed writable [L1127-1128], the
        // bits of 607Eh are described nowhere [L1272]: nothing that a driver writes, or maps.
        Files{"damiao_dm",
              50,
              {{0x606D, 0}, {0x606E, 0}, {0x606F, 0}, {0x200A, 1}, {0x200A, 2}},
              {},
              {{0x607E, 0}}}),
    [](const auto& tested) { return std::string(tested.param.family); });

}  // namespace
}  // namespace cia402
