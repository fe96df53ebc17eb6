// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that know their position without power: what it means for the home, and the 64 bits that
// they tell of it.
#include "system/families_motion.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kDm5OnBattery{"megmeet_dm5", "8388608", "csp"};
constexpr double kCountsOfARad = 8388608.0 * 50.0 / 6.283185307179586;

/// As many of them as a robot has that is homed once, by a person, and never again.
std::string dm5Absolute(const std::string& simulation, const std::string& more = {}) {
  return familyJoint(kDm5OnBattery, ", homing: {method: 35, required: false}, simulation: {" +
                                        simulation + "}" + more);
}

double wideOf(Scene& scene, const std::string& object) {
  const bus::ObjectAnswer read = scene.call(bus::ReadObjectCommand{"joint", object});
  EXPECT_TRUE(read.success) << read.message;
  EXPECT_EQ(read.data.size(), 8U) << read.message;
  return read.number;
}

void switchOffAndOn(Scene& scene) {
  scene.inject("joint", "power_cycle");
  scene.run(4s);
  ASSERT_EQ(scene.state("joint").health, fieldbus::Health::ready) << scene.told();
}

TEST(Dm5Absolute, KnowsItsHomeWithoutPower) {
  Scene scene(loadText(dm5Absolute("initial_position: 1.1")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", -0.8), "");
  scene.run(3s);
  switchOffAndOn(scene);
  EXPECT_TRUE(scene.state("joint").homed);
  ASSERT_TRUE(scene.procedure(ProcedureKind::recover, "joint").success) << scene.told();
  EXPECT_NEAR(scene.state("joint").position, -0.8, 1e-4);
  ASSERT_EQ(scene.setpoint("joint", 0.4), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 1.1 + 0.4, 1e-3) << "0 was at 1.1";
}

// 200B:25h to :28h, P11.36 to P11.39 [L3514-3517]; 40 rad are 318 turns, beyond 2^31 counts.
TEST(Dm5Absolute, TellsItsPositionIn64Bits) {
  for (const double at : {40.0, -40.0, 0.3}) {
    Scene scene(loadText(
        replaced(dm5Absolute("initial_position: " + std::to_string(at), ", type: continuous"),
                 "lower: -2.5, upper: 2.5, ", "")));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.run(500ms);
    EXPECT_NEAR(wideOf(scene, "encoder_position"), at * kCountsOfARad, 2.0);
    EXPECT_NEAR(wideOf(scene, "mechanical_position"), at * kCountsOfARad, 2.0);
    ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
    EXPECT_NEAR(wideOf(scene, "mechanical_position"), 0.0, 2.0);
    EXPECT_NEAR(wideOf(scene, "encoder_position"), at * kCountsOfARad, 2.0);
    const bus::ObjectAnswer turns = scene.call(bus::ReadObjectCommand{"joint", "encoder_turns"});
    const auto whole = static_cast<int>(std::floor(at * 50.0 / 6.283185307179586));
    EXPECT_EQ(turns.number, (whole + 65536) % 65536) << turns.message;
  }
}

// The lower half goes round between the two reads: it is read again.
TEST(Dm5Absolute, TellsNoNumberOfTwoMoments) {
  Scene scene(loadText(dm5Absolute("initial_position: 0.0")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  unsigned reads = 0;
  scene.drive("joint").dictionary().onRead({0x200B, 39}, [&reads](sim::Entry& entry) {
    entry.number = reads++ == 0 ? 0xFFFFFFF0U : 0x00000010U;
    return 0U;
  });
  scene.drive("joint").dictionary().onRead({0x200B, 40}, [&reads](sim::Entry& entry) {
    entry.number = reads == 0 ? 4U : 5U;
    return 0U;
  });
  EXPECT_EQ(wideOf(scene, "encoder_position"), 5.0 * 4294967296.0 + 16.0);
}

// Er.076 at power-on: what it counted is gone, and nobody is to believe it.
TEST(Dm5Absolute, WithoutItsBatteryHasNoHomeAnyMore) {
  Scene scene(loadText(dm5Absolute("initial_position: 1.1")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  EXPECT_TRUE(scene.state("joint").homed);
  scene.inject("joint", "battery_warning");
  switchOffAndOn(scene);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("0xFF4C"), HasSubstr("encoder battery was lost (Er.076)"),
                    HasSubstr("home again")));
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable).success);
  switchOffAndOn(scene);
  EXPECT_FALSE(scene.state("joint").homed) << "also once the fault is gone";
}

// AL.075: it still counts, and goes on.
TEST(Dm5Absolute, WithALowBatteryIsWarnedOfAndGoesOn) {
  FamilyScene scene(dm5Absolute("initial_position: 0.0"));
  scene.inject("joint", "battery_warning");
  scene.run(200ms);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("encoder battery low (AL.075)"),
                                  HasSubstr("replace it while the drive is on")));
  EXPECT_TRUE(scene.state("joint").homed);
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), 0.3, 1e-3) << scene.told();
}

// P10.11 [L3379]: masked from the factory; Er.031 beyond 65535 turns, 8235 rad of the joint.
TEST(Dm5Absolute, TellsThatItsTurnsOverflow) {
  for (const char* masked : {"0", "1"}) {
    FamilyScene scene(replaced(
        replaced(dm5Absolute("initial_position: 8235.35, with: {dictionary: [[0x200A, 12, masked, "
                             "uint16, rw, -, " +
                                 std::string(masked) + ", 0, 1]]}",
                             ", type: continuous"),
                 "lower: -2.5, upper: 2.5, ", ""),
        "mode: csp, modes: [csp]", "mode: pv, modes: [pv]"));
    for (int i = 0; i < 60; ++i) {
      (void)scene.setpoint("joint", 0.5);
      scene.run(20ms);
    }
    const bool told =
        scene.told().find("more than 65535 encoder turns (Er.031)") != std::string::npos;
    EXPECT_EQ(told, masked == std::string("0")) << scene.told();
    const auto overflows = scene.call(bus::ReadObjectCommand{"joint", "turns_overflow"});
    EXPECT_EQ(overflows.number, 1.0) << overflows.message;
  }
}

/// H02.01: 0 incremental, 1 absolute, 2 rotary; counts once the power was off [L3384].
std::string sv660cSystem(int system, const std::string& rows = {},
                         const std::string& more = ", kept_by_drive: true") {
  return sv660cJoint(
      ", mode: ip, homing: {method: 35" + more + "}",
      "initial_position: 1.1, " + sv660cDelivered("[0x2002, 2, absolute_system, uint16, rw, -, " +
                                                  std::to_string(system) + ", 0, 2]" + rows),
      "0.004", "[ip]");
}

TEST(Sv660cAbsolute, KeepsItsHomeWithoutPowerAsH0201Says) {
  for (const int system : {0, 1, 2}) {
    Scene scene(loadText(sv660cSystem(system)));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    ASSERT_EQ(scene.setpoint("joint", 0.6), "");
    scene.run(2s);
    switchOffAndOn(scene);
    EXPECT_EQ(scene.state("joint").homed, system != 0);
    if (system == 0) continue;
    EXPECT_NEAR(scene.state("joint").position, 0.6, 1e-4);
    ASSERT_TRUE(scene.procedure(ProcedureKind::recover, "joint").success) << scene.told();
    ASSERT_EQ(scene.setpoint("joint", 0.2), "");
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), 1.1 + 0.2, 1e-4) << scene.told();
  }
}

// H0b.58 and .60, .77 and .79, .81 and .83 [L8921-9091]; 1.1 rad are 8.7535 turns of the motor.
TEST(Sv660cAbsolute, TellsItsPositionsIn64Bits) {
  constexpr double kAt = 1.1 * kCountsOfARad;
  Scene scene(
      loadText(sv660cSystem(2, ", [0x2005, 0x33, gear_numerator, uint16, rw, -, 5, 1, 65535]")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_NEAR(wideOf(scene, "encoder_position"), kAt, 2.0);
  EXPECT_NEAR(wideOf(scene, "absolute_position"), kAt, 2.0);
  EXPECT_NEAR(wideOf(scene, "rotary_counts"), kAt - 5.0 * 8388608.0, 2.0) << "of 5 turns";
  EXPECT_EQ(scene.call(bus::ReadObjectCommand{"joint", "encoder_turns"}).number, 8.0);
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  EXPECT_NEAR(wideOf(scene, "absolute_position"), 0.0, 2.0);
  EXPECT_NEAR(wideOf(scene, "encoder_position"), kAt, 2.0);
}

// The gear, or the counts of a turn of the load, from the robot's file [L5475-5521].
TEST(Sv660cAbsolute, HasTheGearOfItsLoadFromTheRobotsFile) {
  Scene scene(loadText(
      sv660cWrites("{object: rotary_gear_numerator, raw: 5}, {object: rotary_gear_denominator, "
                   "raw: 2}, {object: rotary_counts_of_turn, raw: 25165824}, {object: "
                   "rotary_counts_of_turn_high, raw: 0}",
                   sv660cSystem(2))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x2005, 0x33), 5U);
  EXPECT_EQ(sv660cNumber(scene, 0x2005, 0x34), 2U);
  constexpr double kAt = 1.1 * kCountsOfARad;  // 8.7535 turns, of 3 each
  EXPECT_NEAR(wideOf(scene, "rotary_counts"), kAt - 2.0 * 25165824.0, 2.0);
}

// H0d.20 = 2 [L9589]: its turns are gone, and so is the home.
TEST(Sv660cAbsolute, HasNoHomeOnceItsTurnsAreReset) {
  Scene scene(loadText(sv660cSystem(1)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  const bus::Answer running = sv660cWrite(scene, "encoder_reset", "2");
  EXPECT_FALSE(running.success) << "stopped only";
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success) << scene.told();
  scene.run(500ms);
  const bus::Answer reset = sv660cWrite(scene, "encoder_reset", "2");
  EXPECT_TRUE(reset.success) << reset.message;
  EXPECT_THAT(reset.message, HasSubstr("not homed any more"));
  EXPECT_EQ(scene.call(bus::ReadObjectCommand{"joint", "encoder_turns"}).number, 0.0);
  EXPECT_FALSE(scene.state("joint").homed);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.forget();
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  EXPECT_THAT(scene.setpoint("joint", 0.2), HasSubstr("not homed"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  EXPECT_TRUE(scene.state("joint").homed);
}

}  // namespace
}  // namespace cia402
