// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Keys of a drive profile for what a maker's manual leaves open: floats of two widths, doubtful
// objects, values that are read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/full_profile.h"

namespace cia402::config {
namespace {

using fieldbus::Encoding;
using fieldbus::ObjectId;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kOpenHead[] = R"(name: open
units: {position: rad, torque: N.m}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int16}
  mode_display: {object: "6061:00", type: int16, access: ro, pdo: tpdo}
  target_position: {object: "607A:00", type: int32, encoding: float32, quantity: position, pdo: both}
  position_actual: {object: "6064:00", type: int32, encoding: float32, quantity: position,
    access: ro, pdo: tpdo, doubt: printed twice}
  torque_actual: {object: "6077:00", type: int32, encoding: float32, quantity: torque, access: ro}
  silent: {object: "6078:00", type: int32, encoding: float32, access: wo}
  clear: {object: "200B:01", type: uint32}
modes:
  pp: {value: 1, control: position, target: target_position}
)";

DriveFamily parsed(const std::string& rest, Problems& problems) {
  return parseDriveFamily(kOpenHead + rest, "open.yaml", problems);
}

TEST(OpenQuestions, AreReadFromAProfile) {
  Problems problems;
  const DriveFamily family = parsed(
      "half_floats: {encoding: float32_by_65535_signed, objects: [torque_actual, "
      "position_actual]}\n"
      "doubtful: {\"2004:03\": printed twice, \"2005\": nobody knows}\n"
      "counts_after_power: [\"2001:02-11\"]\n"
      "fault_reset_object: clear\n"
      "reads_back: true\n"
      "pdo_rules: {sync_starts: true}\n"
      "pdos: {tpdo1: {objects: [statusword], transmission: 4, sync_start: 9}, tpdo2: {objects: "
      "[position_actual], transmission: 4}, rpdo1: [controlword]}\n",
      problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_THAT(family.device.half_floats, ElementsAre("torque_actual", "position_actual"));
  EXPECT_EQ(family.device.half_float_encoding, Encoding::float32_by_65535_signed);
  ASSERT_NE(family.drive.doubtful.find({0x2004, 3}), nullptr);
  EXPECT_EQ(*family.drive.doubtful.find({0x2004, 3}), "printed twice");
  EXPECT_EQ(family.drive.doubtful.find({0x2004, 2}), nullptr);
  EXPECT_NE(family.drive.doubtful.find({0x2005, 200}), nullptr);
  EXPECT_NE(family.drive.after_power.find({0x2001, 0x11}), nullptr);
  EXPECT_EQ(family.drive.after_power.find({0x2001, 0x12}), nullptr);
  EXPECT_EQ(family.drive.fault_reset.object, "clear");
  EXPECT_TRUE(family.drive.reads_back);
  EXPECT_TRUE(family.device.sync_starts);
  EXPECT_EQ(family.drive.find("position_actual")->doubt, "printed twice");
  ASSERT_EQ(family.device.pdos.size(), 3U);
  for (const canopen::PdoLayout& pdo : family.device.pdos) {
    const bool given = pdo.direction == canopen::PdoDirection::tpdo && pdo.number == 1;
    EXPECT_EQ(pdo.sync_start.has_value(), given);
    if (given) {
      EXPECT_EQ(*pdo.sync_start, 9);
    }
  }
}

TEST(OpenQuestions, AreNoneWithoutTheseKeys) {
  Problems problems;
  const DriveFamily family = parsed("", problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_THAT(family.device.half_floats, IsEmpty());
  EXPECT_EQ(family.device.half_float_encoding, Encoding::bfloat16);
  EXPECT_TRUE(family.drive.doubtful.empty());
  EXPECT_TRUE(family.drive.after_power.empty());
  EXPECT_EQ(family.drive.fault_reset.object, "");
  EXPECT_FALSE(family.drive.reads_back);
  EXPECT_FALSE(family.device.sync_starts);
}

TEST(OpenQuestions, ThatAreWrongAreToldWithTheirPath) {
  struct Wrong {
    const char *text, *problem;
  };
  for (const Wrong& wrong :
       {Wrong{"half_floats: {encoding: float32, objects: [torque_actual]}\n",
              "half_floats/encoding: unknown word `float32`"},
        Wrong{"half_floats: {encoding: bfloat16}\n", "`objects` is missing"},
        Wrong{"half_floats: {objects: [torque]}\n", "the profile has no object `torque`"},
        Wrong{"half_floats: {objects: [clear]}\n",
              "`clear` is no float32 that the drive lets be read"},
        Wrong{"half_floats: {objects: [silent]}\n", "`silent` is no float32"},
        Wrong{"half_floats: {objects: [torque_actual, torque_actual]}\n", "is given twice"},
        Wrong{"doubtful: {gains: why}\n", "`gains` is no range of objects"},
        Wrong{"counts_after_power: [gains]\n", "`gains` is no range of objects"},
        Wrong{"fault_reset_object: statusword\n",
              "no object `statusword` that is a number and can be written"},
        Wrong{"fault_reset_object: clar\n", "did you mean `clear`"},
        Wrong{"reads_back: 3\n", "reads_back"},
        Wrong{"pdo_rules: {sync_starts: 3}\n", "sync_starts"},
        Wrong{"pdos: {tpdo1: {objects: [statusword], sync_start: 3}}\n",
              "pdos/tpdo1/sync_start: this drive has no SYNC start values"},
        Wrong{"pdo_rules: {sync_starts: true}\npdos: {tpdo1: {objects: [statusword], sync_start: "
              "241}}\n",
              "must be between 0 and 240"},
        Wrong{"pdo_rules: {sync_starts: true}\npdos: {rpdo1: {objects: [controlword], sync_start: "
              "3}}\n",
              "is for TPDOs of transmission types 1 to 240"}}) {
    Problems problems;
    (void)parsed(wrong.text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(wrong.problem)) << wrong.text;
  }
}

}  // namespace
}  // namespace cia402::config
