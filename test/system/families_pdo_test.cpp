// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// PDOs of the families' drives: how they are set up, when they come, what is refused.
#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

class FamilyPdo : public testing::TestWithParam<FamilyMode> {};

INSTANTIATE_TEST_SUITE_P(All, FamilyPdo, allFamilies(), nameOfFamily);

/// Four PDOs each way, one object in each; of the RPDOs as many as the family has targets to map.
std::string fullLayout(const FamilyMode& tested) {
  const std::string tpdos =
      ", tpdo1: [statusword], tpdo2: [position_actual], tpdo3: [velocity_actual], "
      "tpdo4: [mode_display]}";
  const std::string common =
      ", pdos: {rpdo1: [controlword], rpdo2: [target_position], rpdo3: "
      "[target_velocity], rpdo4: ";
  if (is(tested, kBusNimotion)) {
    return ", modes: [csp, csv, ip]" + common + "[interpolation_target]" + tpdos;
  }
  if (is(tested, kBusSv660c)) {
    return ", modes: [ip, pp, pv]" + common + "[interpolation_target]" + tpdos;
  }
  return ", modes: [" + std::string(tested.mode) + ", pv, pt]" + common + "[target_torque]" + tpdos;
}

// Made invalid, emptied, filled, counted, made valid; RPDO2 and TPDO2 of node 1 by hand. An SV660C
// has bit 30 in its TPDOs [L14166-14174], a Damiao got it from somebody: it stays.
TEST_P(FamilyPdo, IsTakenApartAndMappedInPreOperationalAndReadBack) {
  const bool kept = is(GetParam(), kBusSv660c) || is(GetParam(), kBusDamiao);
  TracedScene scene(busJoint(GetParam(), fullLayout(GetParam())));
  for (int i = 0; i < 4; ++i) {  // as somebody may have left it
    const auto leave = [&](fieldbus::ObjectId id, std::uint64_t number) {
      sim::Entry* entry = scene.drive("joint").dictionary().find(id);
      ASSERT_NE(entry, nullptr);
      entry->number = entry->initial_number = number;
    };
    for (const int record : {0x1400, 0x1800}) {
      const auto index = static_cast<std::uint16_t>(record + i);
      const bool rtr = record == 0x1800 && kept;
      const unsigned base = record == 0x1400 ? 0x201 : 0x181;
      leave({index, 1}, base + 0x100U * static_cast<unsigned>(i) + (rtr ? 0x40000000U : 0U));
      leave({index, 2}, 255);
      leave({static_cast<std::uint16_t>(index + 0x200), 0}, 0);
    }
  }
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  const std::string bit30 = kept ? "C0" : "80", valid = kept ? "40" : "00";
  const std::vector<std::string> steps{
      "601 23 01 14 01 01 03 00 80", "601 2F 01 16 00 00 00 00 00", "601 23 01 16 01 20 00 7A 60",
      "601 2F 01 16 00 01 00 00 00", "601 2F 01 14 02 01 00 00 00", "601 23 01 14 01 01 03 00 00",
      "601 40 01 16 01 00 00 00 00", "581 43 01 16 01 20 00 7A 60", "000 01 01"};
  EXPECT_TRUE(inOrder(scene.lines, steps));
  EXPECT_TRUE(inOrder(scene.lines,
                      {"601 23 01 18 01 81 02 00 " + bit30, "601 2F 01 1A 00 00 00 00 00",
                       "601 23 01 1A 01 20 00 64 60", "601 2F 01 1A 00 01 00 00 00",
                       "601 2F 01 18 02 01 00 00 00", "601 23 01 18 01 81 02 00 " + valid,
                       "601 40 01 1A 01 00 00 00 00", "581 43 01 1A 01 20 00 64 60", "000 01 01"}));
  for (std::uint16_t i = 0; i < 4; ++i) {
    for (const int record : {0x1400, 0x1800}) {
      const auto index = static_cast<std::uint16_t>(record + i);
      EXPECT_EQ(numberIn(scene, index, 1) & 0x80000000U, 0U) << std::hex << index;
      EXPECT_EQ(numberIn(scene, static_cast<std::uint16_t>(index + 0x200), 0), 1U);
      EXPECT_LE(numberIn(scene, index, 2), 240U) << "with SYNC";
    }
  }
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.3);
}

// All eight are valid and full from somebody; those without use are off afterwards.
TEST_P(FamilyPdo, WithoutUseIsMadeInvalid) {
  TracedScene scene(busJoint(GetParam(), ", feedback: []"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  unsigned valid = 0;
  for (std::uint16_t i = 0; i < 4; ++i) {
    for (const int record : {0x1400, 0x1800}) {
      const auto index = static_cast<std::uint16_t>(record + i);
      const bool used = (numberIn(scene, index, 1) & 0x80000000U) == 0;
      valid += used ? 1U : 0U;
      if (used) {
        EXPECT_LE(numberIn(scene, index, 2), 240U) << std::hex << index;
      }
    }
  }
  EXPECT_GE(valid, 2U);
  EXPECT_LE(valid, 4U);
}

// A drive that takes the entry and keeps another one is told, not started.
TEST_P(FamilyPdo, ThatIsNotAsWrittenIsNoticed) {
  TracedScene scene(busJoint(GetParam(), fullLayout(GetParam())));
  scene.robot().start();
  scene.drive("joint").dictionary().onRead({0x1A01, 1}, [](sim::Entry& entry) {
    entry.number = 0x606C0020;
    return 0U;
  });
  scene.run(8s);
  EXPECT_EQ(scene.state("joint").health, fieldbus::Health::failed);
  EXPECT_THAT(scene.told(), HasSubstr("the drive took all writes, but 1A01:01"));
}

/// Frames of the velocity's TPDO in a second of motion and in one of rest.
struct FamilyRates {
  double moving = 0.0, standing = 0.0;
};

FamilyRates ratesOf(const FamilyMode& tested, const std::string& how) {
  const std::string target = is(tested, kBusSv660c) ? "interpolation_target" : "target_position";
  TracedScene scene(
      busJoint(tested, ", pdos: {rpdo1: [controlword, " + target +
                           "], tpdo1: [statusword, position_actual], tpdo2: {objects: "
                           "[velocity_actual], " +
                           how + "}}"));
  FamilyRates rates;
  EXPECT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  enableJoint(scene);
  scene.run(100ms);
  scene.clear();
  EXPECT_EQ(scene.setpoint("joint", scene.state("joint").position + 1.6), "");
  scene.run(1s);
  rates.moving = static_cast<double>(scene.count("281"));
  EXPECT_GT(scene.velocity("joint"), 0.5);
  EXPECT_NEAR(scene.state("joint").velocity, scene.velocity("joint"), 0.1) << how;
  scene.run(2s);
  scene.clear();
  scene.run(1s);
  rates.standing = static_cast<double>(scene.count("281"));
  return rates;
}

TEST_P(FamilyPdo, ComesAsItsTransmissionTypeSays) {
  EXPECT_NEAR(ratesOf(GetParam(), "transmission: 1").standing, 250.0, 2.0);
  EXPECT_NEAR(ratesOf(GetParam(), "transmission: 5").standing, 50.0, 1.0);
  EXPECT_NEAR(ratesOf(GetParam(), "transmission: 240").standing, 1.0, 1.0);
  const FamilyRates acyclic = ratesOf(GetParam(), "transmission: 0");
  EXPECT_LT(acyclic.standing, 60.0) << "with the SYNC after a change only";
  for (const char* type : {"254", "255"}) {
    const bool by_timer = is(GetParam(), kBusDamiao) && type == std::string("255");
    const std::string event = "transmission: " + std::string(type);
    const FamilyRates timed = ratesOf(GetParam(), event + ", inhibit: 0.05, event_timer: 0.1");
    EXPECT_NEAR(timed.standing, 10.0, 11.0) << type;
    EXPECT_GE(timed.standing, 9.0) << "by the event timer";
    EXPECT_LE(timed.moving, 21.0) << "never more often than each 50 ms";
    if (!by_timer) {
      EXPECT_GT(ratesOf(GetParam(), event + ", inhibit: 0.01").moving, 5.0) << type;
    }
  }
}

TEST_P(FamilyPdo, IsTakenWithEachTransmissionTypeOfRpdos) {
  FamilyMode tested = GetParam();
  if (is(tested, kBusSv660c)) tested.mode = "pp";  // what its ip needs has type 1 [15961]
  for (const char* type : {"0", "1", "240", "254", "255"}) {
    Scene scene(
        loadText(busJoint(tested,
                          ", pdos: {rpdo1: {objects: [controlword, "
                          "target_position], transmission: " +
                              std::string(type) + "}, tpdo1: [statusword, position_actual]}")));
    expectBootsAndGoes(scene);
  }
}

std::string problemsOfPdo(const FamilyMode& tested, const std::string& tpdo2) {
  return problemsOfRobot(busJoint(
      tested, ", pdos: {rpdo1: [controlword, " +
                  std::string(is(tested, kBusSv660c) ? "interpolation_target" : "target_position") +
                  "], tpdo1: [statusword, position_actual], tpdo2: " + tpdo2 + "}"));
}

TEST_P(FamilyPdo, ThatTheDriveCannotHaveIsRefusedWithTheFile) {
  EXPECT_EQ(problemsOfPdo(GetParam(), "[velocity_actual, mode_display]"), "");
  const std::string more = is(GetParam(), kBusDm5) ? "torque_actual" : "error_code";
  EXPECT_THAT(problemsOfRobot(
                  busJoint(GetParam(),
                           ", pdos: {rpdo1: [controlword], tpdo1: [statusword, position_actual, "
                           "velocity_actual, " +
                               more + "]}")),
              HasSubstr("bits long"));
  const bool damiao = is(GetParam(), kBusDamiao);
  EXPECT_THAT(problemsOfPdo(GetParam(), damiao ? "[max_motor_speed]" : "[profile_acceleration]"),
              HasSubstr("cannot be mapped into a TPDO"));
  EXPECT_THAT(problemsOfPdo(GetParam(), "{objects: [velocity_actual], transmission: 241}"),
              HasSubstr("241 to 251 are reserved"));
  if (is(GetParam(), kBusDm5)) return;  // what version C has of them is not printed
  for (const char* type : {"252", "253"}) {
    EXPECT_THAT(problemsOfPdo(GetParam(), "{objects: [velocity_actual], transmission: " +
                                              std::string(type) + "}"),
                AllOf(HasSubstr("axes/joint/pdos/tpdo2/transmission"),
                      HasSubstr("this drive answers no remote frames")));
  }
}

// "Point to point" only [L1098, L1132].
TEST(Id286Pdo, KeepsToTheIdentifiersOfItsNode) {
  EXPECT_THAT(problemsOfPdo(kBusId286, "{objects: [velocity_actual], cob_id: 0x1A5}"),
              HasSubstr("axes/joint/pdos: tpdo2 would have the COB-ID 0x1A5, but this drive takes "
                        "those of its own node-ID only, as 0x181"));
  EXPECT_THAT(problemsOfPdo(kBusId286, "{objects: [velocity_actual], cob_id: \"$NODEID+0x1A0\"}"),
              HasSubstr("0x1A1"));
  EXPECT_EQ(problemsOfPdo(kBusId286, "{objects: [velocity_actual], cob_id: \"$NODEID+0x380\"}"),
            "");
  Scene scene(loadText(busJoint(kBusId286)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  const auto written = scene.call(bus::WriteObjectCommand{"joint", "1803:01 u32", "0x80000482"});
  EXPECT_FALSE(written.success);
  EXPECT_THAT(written.message, HasSubstr("0x06090030"));
}

struct LackingDrive {
  FamilyMode tested;
  const char *objects, *options;
};

// What the profile may do without, the drive may lack; on what a check counts, by `lacks` alone.
TEST(FamilyObjects, ThatAreAbsentStopNothing) {
  for (const LackingDrive& lacking :
       {LackingDrive{kBusId286, "[0x60B0, 0x6082, 0x60FE, 0x6087, 0x1009, 0x100A]",
                     ", modes: [pp, pt]"},
        LackingDrive{kBusDm5, "[0x607D, 0x1009, 0x100A]", ""},
        LackingDrive{kBusDm5, "[0x6072, 0x60E0, 0x60E1]",
                     ", lacks: [max_torque, positive_torque_limit, negative_torque_limit]"},
        LackingDrive{kBusNimotion, "[0x6080, 0x60C2, 0x1003, 0x1009]", ""}}) {
    Scene scene(loadText(
        busJoint(lacking.tested, std::string(lacking.options) +
                                     ", simulation: {with: {without: " + lacking.objects + "}}")));
    expectBootsAndGoes(scene);
  }
}

// Its count of entries is printed read-only [L768].
TEST(DamiaoPdo, IsMappedThoughItsCountIsReadOnly) {
  TracedScene scene(busJoint(
      kBusDamiao, fullLayout(kBusDamiao) +
                      ", simulation: {with: {communication: {map_count_read_only: true}}}"));
  expectBootsAndGoes(scene);
  EXPECT_TRUE(inOrder(scene.lines, {"601 2F 01 1A 00 00 00 00 00", "581 80 01 1A 00 02 00 01 06",
                                    "601 23 01 1A 01 20 00 64 60"}));
}

TEST(DamiaoPdo, HasNoPlaceForObjectsOfOtherRanges) {
  for (const char* object : {"max_motor_speed", "2004:01", "200A:01", "1001:00"}) {
    EXPECT_THAT(problemsOfPdo(kBusDamiao, "[" + std::string(object) + "]"),
                HasSubstr("axes/joint/pdos/tpdo2[0]: "));
  }
}

// 1019h is written while 1006h is 0 [L612-618]; with and without the counter.
TEST(DamiaoSync, HasACounterOrNone) {
  for (const char* counter : {"0", "240"}) {
    BusOptions bus;
    bus.more = ", sync_counter: " + std::string(counter);
    TracedScene scene(busRobot(busAxis(kBusDamiao), bus));
    expectBootsAndGoes(scene);
    const bool plain = counter == std::string("0");
    EXPECT_EQ(numberIn(scene, 0x1019), plain ? 0U : 240U);
    EXPECT_EQ(numberIn(scene, 0x1006), 4000U);
    EXPECT_EQ(scene.lines.back().size() > 0 && scene.count("080 ") > 0, !plain);
    if (plain) {
      EXPECT_TRUE(inOrder(scene.writes(), {"2F 19 10 00 00 00 00 00", "23 06 10 00 A0 0F 00 00"}));
    }
  }
}

}  // namespace
}  // namespace cia402
