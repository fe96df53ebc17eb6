// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The PDOs of a NiMotion as they come from the factory, its digital outputs in the fourth RPDO.
#include "bus/jobs/output_job.h"
#include "system/families_motion.h"
#include "system/traced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// [2461-2517]
const std::string kDefaultMaps =
    ", pdos: {rpdo1: [controlword, mode_of_operation],"
    " rpdo2: [target_position, interpolation_target],"
    " rpdo3: [vl_target_velocity, target_velocity], rpdo4: [digital_outputs],"
    " tpdo1: [statusword, mode_display], tpdo2: [position_internal, position_actual],"
    " tpdo3: [velocity_actual], tpdo4: [digital_inputs]}";

std::string defaultMapsJoint() {
  return familyJointWith(nimotionIn("pp"), "[pp, vl, pv, ip, csp, csv]", kDefaultMaps);
}

TEST(NimotionMaps, AreThoseOfTheFactory) {
  const std::pair<std::uint16_t, std::vector<std::uint64_t>> maps[] = {
      {0x1600, {0x60400010, 0x60600008}},
      {0x1601, {0x607A0020, 0x60C10120}},
      {0x1602, {0x60420010, 0x60FF0020}},
      {0x1603, {0x20040110}},
      {0x1A00, {0x60410010, 0x60610008}},
      {0x1A01, {0x60630020, 0x60640020}},
      {0x1A02, {0x606C0020}},
      {0x1A03, {0x200B0310}}};
  FamilyScene scene(defaultMapsJoint());
  for (const auto& [index, entries] : maps) {
    EXPECT_EQ(scene.number(index), entries.size()) << std::hex << index;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      EXPECT_EQ(scene.number(index, static_cast<std::uint8_t>(i + 1)), entries[i])
          << std::hex << index;
    }
    const auto parameters = static_cast<std::uint16_t>(index - 0x0200);
    EXPECT_EQ(scene.number(parameters, 1) & 0x80000000U, 0U) << "it is in use";
  }
}

TEST(NimotionMaps, OfTheFactoryServeEachMode) {
  FamilyScene scene(defaultMapsJoint());
  for (const char* mode : {"pp", "vl", "pv", "ip", "csp", "csv"}) {
    scene.mustSucceed(ProcedureKind::set_mode, mode);
    scene.expectStands(300ms);
    const double from = scene.position("joint");
    if (scene.kind() == ControlKind::position) {
      ASSERT_EQ(scene.setpoint("joint", from + 0.3), "") << mode;
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), from + 0.3, 1e-3) << mode << scene.told();
    } else {
      scene.stream("joint", -0.4, 600ms);
      EXPECT_NEAR(scene.velocity("joint"), -0.4, 3e-3) << mode << scene.told();
      scene.run(1s);
    }
  }
}

TEST(NimotionMaps, CarryTheDigitalOutputsInTheFourth) {
  TracedScene scene(defaultMapsJoint());
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_EQ(scene.truth("joint").outputs & 3U, 0U);
  scene.clear();
  const auto set = [&](std::vector<std::string> names, std::vector<bool> values) {
    const auto answer =
        scene.call(bus::SetOutputsCommand{"joint", std::move(names), std::move(values)});
    EXPECT_TRUE(answer.success) << answer.message;
    scene.run(20ms);
    return scene.truth("joint").outputs & 3U;
  };
  EXPECT_EQ(set({"do1"}, {true}), 2U);
  EXPECT_EQ(set({"do0"}, {true}), 3U) << "the other one stays";
  EXPECT_EQ(set({"do1"}, {false}), 1U);
  EXPECT_THAT(scene.lines, Contains(HasSubstr("501 02 00")));
  EXPECT_THAT(scene.writes(), Not(Contains(HasSubstr("04 20 01")))) << "not by SDO";
  scene.run(1s);
  EXPECT_EQ(scene.truth("joint").outputs & 3U, 1U);
}

// By SDO where no RPDO has them; functions 0 to 5 and logic by the file [1907-1963].
TEST(NimotionOutputs, AreSetByServiceAndHaveTheFunctionsOfTheFile) {
  FamilyScene scene(
      familyJoint(nimotionIn("csp"),
                  ", write: [{object: do0_function, raw: 0}, {object: do0_logic, raw: 0}, "
                  "{object: do1_function, raw: 3}, {object: do1_logic, raw: 1}]"));
  EXPECT_EQ(scene.number(0x2004, 2), 0U);
  EXPECT_EQ(scene.number(0x2004, 3), 0U);
  EXPECT_EQ(scene.number(0x2004, 4), 3U);
  EXPECT_EQ(scene.number(0x2004, 5), 1U);
  const auto answer = scene.call(bus::SetOutputsCommand{"joint", {"do0"}, {true}});
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(scene.truth("joint").outputs & 3U, 3U) << "do1 while the motor has power";
  scene.mustSucceed(ProcedureKind::disable);
  scene.run(200ms);
  EXPECT_EQ(scene.truth("joint").outputs & 3U, 1U);
  for (const auto& [name, value] : {std::pair("do0_function", "6"), std::pair("do1_function", "6"),
                                    std::pair("do0_logic", "2"), std::pair("do1_logic", "2")}) {
    const auto refused = scene.call(bus::WriteObjectCommand{"joint", name, value});
    EXPECT_FALSE(refused.success) << name;
  }
}

}  // namespace
}  // namespace cia402
