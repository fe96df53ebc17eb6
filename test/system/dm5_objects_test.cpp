// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Objects of a DM5: those that version C may have otherwise than the manual of version N, or not at
// all, its maps, outputs, and what it tells of itself.
#include "bus/jobs/output_job.h"
#include "system/families_bus_scene.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kDm5InCsp{"megmeet_dm5", "8388608", "csp"};

// --- Identity: 1018h, which the robot's file gives, for no number is printed --------------------

TEST(Dm5Identity, IsComparedWithWhatTheRobotsFileSays) {
  struct Row {
    const char *key, *words;
    std::uint8_t subindex;
  };
  for (const Row& row : {Row{"vendor_id", "1018:01", 1}, Row{"product_code", "1018:02", 2},
                         Row{"revision", "1018:03", 3}, Row{"serial", "1018:04", 4}}) {
    Scene scene(loadText(busJoint(kBusDm5, ", identity: {" + std::string(row.key) + ": 0x1234}")));
    sim::Entry* entry = scene.drive("joint").dictionary().find({0x1018, row.subindex});
    entry->number = entry->initial_number = 0x1234;
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    Scene other(loadText(busJoint(kBusDm5, ", identity: {" + std::string(row.key) + ": 0x1234}")));
    entry = other.drive("joint").dictionary().find({0x1018, row.subindex});
    entry->number = entry->initial_number = 0x4711;
    other.robot().start();
    other.run(8s);
    EXPECT_EQ(other.state("joint").health, fieldbus::Health::failed);
    EXPECT_THAT(other.told(), AllOf(HasSubstr("is another drive than configured: "),
                                    HasSubstr(row.words), HasSubstr("0x00004711")));
    EXPECT_FALSE(other.procedure(ProcedureKind::enable).success);
  }
}

// --- PDOs whose maps version N does not let change [L1548-1561] ----------------------------------

/// Maps of the second to fourth PDO that answer each write by "read-only".
std::string dm5WithFixedMaps() {
  std::string rows;
  const auto add = [&](unsigned index, std::initializer_list<unsigned> entries) {
    const auto row = [&](unsigned sub, const char* type, unsigned number) {
      rows += (rows.empty() ? "[" : ", [") + std::to_string(index) + ", " + std::to_string(sub) +
              ", fixed, " + type + ", ro, -, " + std::to_string(number) + "]";
    };
    row(0, "uint8", static_cast<unsigned>(entries.size()));
    unsigned sub = 0;
    for (const unsigned entry : entries) row(++sub, "uint32", entry);
  };
  add(0x1601, {0x60400010, 0x60FF0020});
  add(0x1602, {0x60400010, 0x607A0020});
  add(0x1603, {0x60400010, 0x60710010});
  add(0x1A02, {0x60410010, 0x60640020});
  add(0x1A03, {0x60410010, 0x60640020, 0x60770010});
  return "simulation: {with: {dictionary: [" + rows + "]}}";
}

struct FixedPdos {
  const char *mode, *pdos;
};
void PrintTo(const FixedPdos& fixed, std::ostream* out) { *out << fixed.mode; }

class Dm5FixedPdo : public testing::TestWithParam<FixedPdos> {};

TEST_P(Dm5FixedPdo, IsUsedAsItIsAndNeverWritten) {
  const FamilyMode tested{"megmeet_dm5", "8388608", GetParam().mode};
  TracedScene scene(familyJointWith(
      tested, "[" + std::string(tested.mode) + (isTorqueMode(tested) ? ", csv]" : "]"),
      ", pdos: {" + std::string(GetParam().pdos) + "}, " + dm5WithFixedMaps()));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  const double from = scene.position("joint");
  if (scene.state("joint").mode->kind == drive::ControlKind::position) {
    ASSERT_EQ(scene.setpoint("joint", 0.3), "");
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), 0.3, 1e-3) << scene.told();
  } else {
    scene.stream("joint", isTorqueMode(tested) ? 5.0 : 0.4, 500ms);
    EXPECT_GT(scene.position("joint"), from + 0.05) << scene.told();
  }
  EXPECT_NEAR(scene.state("joint").position, scene.position("joint"), 0.02);
  for (const char* write :
       {"601 2F 01 16", "601 23 01 16", "601 2F 02 16", "601 23 02 16", "601 2F 03 16",
        "601 23 03 16", "601 2F 02 1A", "601 23 02 1A", "601 2F 03 1A", "601 23 03 1A"}) {
    EXPECT_TRUE(scene.beginning(write).empty()) << write;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, Dm5FixedPdo,
    testing::Values(
        FixedPdos{"csv",
                  "rpdo1: [mode_of_operation], rpdo2: [controlword, target_velocity], "
                  "tpdo1: [mode_display, error_code], tpdo3: [statusword, position_actual]"},
        FixedPdos{"csp",
                  "rpdo1: [mode_of_operation], rpdo3: [controlword, target_position], "
                  "tpdo1: [mode_display, velocity_actual], "
                  "tpdo3: [statusword, position_actual]"},
        FixedPdos{"pp",
                  "rpdo3: [controlword, target_position], tpdo1: [mode_display], "
                  "tpdo4: [statusword, position_actual, torque_actual]"},
        FixedPdos{"cst",
                  "rpdo1: [mode_of_operation, target_velocity], "
                  "rpdo4: [controlword, target_torque], tpdo1: [mode_display], "
                  "tpdo4: [statusword, position_actual, torque_actual]"}),
    [](const auto& tested) { return std::string(tested.param.mode); });

// --- Any object of the 6000h that a TPDO may carry [L3626-3683] ----------------------------------

TEST(Dm5Mapped, IsEachObjectThatATpdoMayCarry) {
  Scene known(loadText(busJoint(kBusDm5)));
  unsigned tried = 0;
  for (const drive::ObjectSpec& object : known.loaded().robot.axes[0].profile->objects) {
    const bool cyclic = object.name == "statusword" || object.name == "position_actual";
    if (!object.tpdo || cyclic) continue;
    ++tried;
    Scene scene(
        loadText(busJoint(kBusDm5,
                          ", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, "
                          "position_actual], tpdo2: [" +
                              object.name + "]}")));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << object.name << scene.told();
    const unsigned bits = fieldbus::sizeBits(object.type);
    EXPECT_EQ(numberIn(scene, 0x1A01, 1), std::uint64_t{object.id.index} << 16U |
                                              std::uint64_t{object.id.subindex} << 8U | bits)
        << object.name;
    const fieldbus::Slot slot = scene.node("joint").image().inputSlot(object.id);
    ASSERT_NE(slot, fieldbus::kNoSlot) << object.name;
    scene.drive("joint").dictionary().onRead(object.id, [bits](sim::Entry& entry) {
      entry.number = 0x5A5A5A5AU & ((std::uint64_t{1} << bits) - 1);
      return 0U;
    });
    scene.run(100ms);
    EXPECT_EQ(scene.node("joint").image().input(slot).raw,
              0x5A5A5A5AU & ((std::uint64_t{1} << bits) - 1))
        << object.name;
  }
  EXPECT_EQ(tried, 15U);
}

// --- What it tells of itself when it boots -------------------------------------------------------

TEST(Dm5Nameplate, IsReadAtEachBootAndTold) {
  Scene scene(loadText(busJoint(kBusDm5)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.run(1s);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("joint (node 1): the drive tells of itself: "),
                                  HasSubstr("software_version (2000:02) 1,"),
                                  HasSubstr("voltage_class (2000:05) 2 (24 to 70 V)"),
                                  HasSubstr("drive_rated_current (2000:06) 15 A"),
                                  HasSubstr("drive_max_current (2000:07) 48 A"),
                                  HasSubstr("motor_rated_torque (2001:05) 1.27")));
  EXPECT_THAT(scene.told(),
              AllOf(HasSubstr("motor_rated_speed (2001:07) 30000"),
                    HasSubstr("pulses_per_turn (2005:06) 8388608"),
                    HasSubstr("torque_unit (2014:0F) 0"), HasSubstr("velocity_unit (2014:10) 0")));
  for (const bus::Event& event : scene.robot().events()) {
    if (event.text.str().find("tells of itself") == std::string::npos) continue;
    EXPECT_EQ(event.severity, bus::Event::Severity::info);
  }
}

TEST(Dm5Nameplate, WhoseTorqueIsAnotherOneIsWarnedOf) {
  Scene scene(loadText(
      busJoint(kBusDm5,
               ", simulation: {with: {dictionary: [[0x2001, 5, motor_rated_torque, uint16, rw, -, "
               "239, 10, 65535]]}}")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("rated torque is 2.39 N m by the drive"),
                                  HasSubstr("motor_rated_torque (2001:05) = 239")));
}

// --- Objects that it does not have ---------------------------------------------------------------

class Dm5Absent : public testing::TestWithParam<const char*> {};

// Everything that the driver reads, compares or writes by itself beyond what moves the joint.
TEST_P(Dm5Absent, ObjectIsPassedOverAndTheOthersCount) {
  Scene scene(loadText(
      familyJointWith(kDm5InCsp, "[csp, pp, pv]",
                      ", simulation: {with: {without: [" + std::string(GetParam()) + "]}}")));
  expectBootsAndGoes(scene);
  EXPECT_EQ(scene.state("joint").error_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Of, Dm5Absent,
                         testing::Values("0x1008", "0x2000", "0x2001", "0x2002", "0x2003", "0x2005",
                                         "0x2006", "0x2007", "0x200A", "0x200B", "0x200C", "0x2014",
                                         "0x603F", "0x605A", "0x605B", "0x605C", "0x605D", "0x6069",
                                         "0x606B", "0x6072", "0x6077", "0x607C", "0x607D", "0x607E",
                                         "0x607F", "0x6080", "0x6081", "0x6083", "0x6084", "0x6085",
                                         "0x6087", "0x6091", "0x6098", "0x6099", "0x609A", "0x60B8",
                                         "0x60E0", "0x60E1", "0x60F4", "0x60FD", "0x60FE"),
                         [](const auto& tested) { return "Object" + std::string(tested.param); });

// What is missing is said, once each.
TEST(Dm5Absences, AreTold) {
  Scene scene(loadText(
      busJoint(kBusDm5, ", simulation: {with: {without: [0x2014, 0x605A, 0x607F, 0x6091]}}")));
  expectBootsAndGoes(scene);
  EXPECT_THAT(scene.told(),
              AllOf(HasSubstr("the drive does not have "), HasSubstr("velocity_unit (2014:10)"),
                    HasSubstr("torque_unit (2014:0F)"), HasSubstr("gear_numerator (6091:01)"),
                    HasSubstr("max_profile_velocity (607F:00)"), HasSubstr("see that it is")));
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("605A:00 quick_stop_option"),
                                  HasSubstr("607F:00 max_profile_velocity")));
}

// --- Digital outputs [L3065-3081, L3199-3204] ----------------------------------------------------

bus::Answer setDm5Output(Scene& scene, const std::string& name, bool on) {
  return scene.call(bus::SetOutputsCommand{"joint", {name}, {on}});
}

std::string dm5Outputs(unsigned function, unsigned on_loss = 0) {
  return busJoint(kBusDm5, ", write: [{object: do1_function, raw: " + std::to_string(function) +
                               "}, {object: do2_function, raw: 28}, {object: outputs_on_loss, "
                               "raw: " +
                               std::to_string(on_loss) + "}]");
}

TEST(Dm5Outputs, FollowTheirBitsWhereTheirFunctionIs28) {
  Scene scene(loadText(dm5Outputs(28)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_EQ(scene.truth("joint").outputs, 0U) << "off until somebody sets them";
  EXPECT_TRUE(setDm5Output(scene, "do1", true).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0x10000U) << "the mask of the other is closed";
  EXPECT_EQ(numberIn(scene, 0x60FE, 2), 0x10000U);
  enableJoint(scene);
  EXPECT_TRUE(setDm5Output(scene, "do2", true).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0x30000U);
  EXPECT_TRUE(setDm5Output(scene, "do1", false).success);
  EXPECT_EQ(scene.truth("joint").outputs, 0x20000U);
}

TEST(Dm5Outputs, OfAnotherFunctionAreRefusedInWords) {
  Scene scene(loadText(dm5Outputs(5)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  const bus::Answer refused = setDm5Output(scene, "do1", true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("do1_function (2003:10) is 5, not 28"));
  EXPECT_EQ(scene.truth("joint").outputs, 0U);
}

// P03.22: a bit each, 0 keeps the last level, 1 switches off.
TEST(Dm5Outputs, OutOfOperationAreAsP0322Says) {
  for (const auto& [on_loss, kept] :
       {std::pair(0U, 0x30000U), std::pair(1U, 0x20000U), std::pair(3U, 0U)}) {
    for (const char* state : {"pre_operational", "stop"}) {
      Scene scene(loadText(dm5Outputs(28, on_loss)));
      ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
      EXPECT_TRUE(setDm5Output(scene, "do1", true).success);
      EXPECT_TRUE(setDm5Output(scene, "do2", true).success);
      ASSERT_EQ(scene.truth("joint").outputs, 0x30000U);
      const auto left = scene.call(bus::NmtServiceCommand{"joint", state});
      EXPECT_TRUE(left.success) << left.message;
      scene.run(20ms);
      EXPECT_EQ(scene.truth("joint").outputs, kept) << on_loss << " " << state;
    }
  }
}

}  // namespace
}  // namespace cia402
