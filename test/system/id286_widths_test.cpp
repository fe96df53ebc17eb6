// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// 6060h, 6061h and 6098h of the iD286-CNFA have one byte or two, as its manual contradicts itself
// [L1472-1476, L1565 against L1661, L1702-1709]: the drive is asked.
#include "system/families_bus_scene.h"
#include "system/id286_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// Which of the three have two bytes.
struct Id286Words2 {
  const char* name;
  bool mode, display, method;
};
void PrintTo(const Id286Words2& words, std::ostream* out) { *out << words.name; }

class Id286Widths : public testing::TestWithParam<Id286Words2> {
 protected:
  static std::string rows() {
    std::string rows;
    const auto add = [&](bool two, const char* row) {
      if (two) rows += (rows.empty() ? "" : ", ") + std::string(row);
    };
    add(GetParam().mode, "[0x6060, 0, operation_mode, int16, rw, r, 1, 0, 255]");
    add(GetParam().display, "[0x6061, 0, operation_mode_display, int16, ro, t, 0]");
    add(GetParam().method, "[0x6098, 0, homing_method, int16, rw, r, 21, 0, 100]");
    return ", simulation: {lower_limit_switch: -0.4, with: {dictionary: [" + rows + "]}}";
  }
  static std::string yaml(const std::string& more = {}) {
    return familyJointWith(kId286InPp, "[pp, pv]",
                           ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, "
                           "acceleration: 2.0}" +
                               more + rows());
  }
  static void expectWorks(Scene& scene) {
    const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
    ASSERT_TRUE(homed.success) << homed.message << scene.told();
    EXPECT_NEAR(scene.position("joint"), -0.4, 0.02);
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    ASSERT_EQ(scene.setpoint("joint", 0.3), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.3 - 0.4, 2e-3);
    const bus::Answer switched = scene.procedure(ProcedureKind::set_mode, "joint", "pv");
    ASSERT_TRUE(switched.success) << switched.message;
    EXPECT_EQ(scene.truth("joint").mode, 3);
    scene.stream("joint", 0.4, 500ms);
    EXPECT_NEAR(scene.velocity("joint"), 0.4, 2e-3);
    EXPECT_EQ(scene.state("joint").mode->name, "profile_velocity");
  }
};

TEST_P(Id286Widths, AreLearntAndUsedInWritesAndMaps) {
  TracedScene scene(yaml());
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  bool mapped = false;
  for (std::uint16_t map = 0x1A00; map < 0x1A04; ++map) {
    for (std::uint8_t i = 1; i <= numberIn(scene, map); ++i) {
      const std::uint64_t entry = numberIn(scene, map, i);
      if (entry >> 16U == 0x6061) {
        EXPECT_EQ(entry & 0xFF, GetParam().display ? 16U : 8U);
        mapped = true;
      }
    }
  }
  EXPECT_TRUE(mapped);
  ASSERT_NO_FATAL_FAILURE(expectWorks(scene));
  EXPECT_THAT(scene.lines, Contains(GetParam().method ? "601 2B 98 60 00 11 00 00 00"
                                                      : "601 2F 98 60 00 11 00 00 00"));
  EXPECT_THAT(scene.lines, Contains(GetParam().mode ? "601 2B 60 60 00 03 00 00 00"
                                                    : "601 2F 60 60 00 03 00 00 00"));
  const bus::ObjectAnswer read = scene.call(bus::ReadObjectCommand{"joint", "mode_of_operation"});
  EXPECT_TRUE(read.success) << read.message;
  EXPECT_EQ(read.number, 3.0);
}

// 6060h in an RPDO: controlword, mode and target are 7 or 8 bytes.
TEST_P(Id286Widths, CountInTheRpdoThatCarriesTheMode) {
  Scene scene(loadText(
      yaml(", pdos: {rpdo1: [controlword, mode_of_operation, target_position],"
           " rpdo2: [target_velocity], tpdo1: [statusword, mode_display, position_actual]}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_EQ(numberIn(scene, 0x1600, 2), GetParam().mode ? 0x60600010U : 0x60600008U);
  EXPECT_EQ(numberIn(scene, 0x1A00, 2), GetParam().display ? 0x60610010U : 0x60610008U);
  expectWorks(scene);
}

// A number that is not there yet: -1 in either length.
TEST_P(Id286Widths, LeaveNegativeNumbersWhatTheyAre) {
  Scene scene(loadText(replaced(yaml(), "with: {", "with: {quirks: {mode_change_time: 3.0}, ")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer late = scene.procedure(ProcedureKind::set_mode, "joint", "pv");
  EXPECT_FALSE(late.success);
  EXPECT_THAT(late.message, HasSubstr("6061:00 mode display shows -1"));
}

INSTANTIATE_TEST_SUITE_P(Of, Id286Widths,
                         testing::Values(Id286Words2{"OneByteEach", false, false, false},
                                         Id286Words2{"TwoInTheMode", true, false, false},
                                         Id286Words2{"TwoInItsDisplay", false, true, false},
                                         Id286Words2{"TwoInTheMethod", false, false, true},
                                         Id286Words2{"TwoBytesEach", true, true, true}),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Neither one byte nor two.
TEST(Id286Width, ThatNoManualHasIsRefusedInWords) {
  Scene scene(loadText(
      familyJoint(kId286InPp,
                  ", simulation: {with: {dictionary: [[0x6098, 0, homing_method, int32, rw, r, 21, "
                  "0, 100]]}}")));
  EXPECT_FALSE(scene.boot(10s));
  EXPECT_THAT(scene.told(), HasSubstr("6098:00 homing_method has 4 bytes in the drive, and not 1 "
                                      "to 2 as its profile allows"));
}

}  // namespace
}  // namespace cia402
