// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The maker's own modes of a NiMotion (2002h:01): no state machine, a motor that inputs enable
// [1585-1763]. To the driver the axis stays disabled.
#include <tuple>

#include "bus/jobs/output_job.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kRadPerTurn = 6.283185307179586 / 50.0;  ///< of the motor

/// VDI4 enables, VDI5 steps, VDI6 pauses: high, by its rising edge, high [1851-1866].
constexpr char kByVirtualInputs[] =
    ", write: [{object: vdi4_function, raw: 1}, {object: vdi4_logic, raw: 0}, "
    "{object: vdi5_function, raw: 20}, {object: vdi5_logic, raw: 1}, "
    "{object: vdi6_function, raw: 12}, {object: vdi6_logic, raw: 0}]";

struct MakerScene : Scene {
  explicit MakerScene(const std::string& more)
      : Scene(loadText(familyJoint(nimotionIn("pp"), more))) {
    drive("joint").setInput(0, true, now());  // high: not active
    drive("joint").setInput(2, true, now());
    EXPECT_TRUE(boot(20s)) << told();
    run(300ms);
  }
  void write(const char* object, const std::string& number) {
    const bus::Answer written =
        cia402::call(*this, bus::WriteObjectCommand{"joint", object, number});
    EXPECT_TRUE(written.success) << written.message;
  }
  void set(const char* output, bool on) {
    const bus::Answer done = call(bus::SetOutputsCommand{"joint", {output}, {on}});
    EXPECT_TRUE(done.success) << done.message;
    run(20ms);
  }
  /// A rising edge of VDI5.
  void step() {
    set("maker_step", true);
    set("maker_step", false);
    run(1s);
  }
  double turns() { return position("joint") / kRadPerTurn; }
};

// 2005h:02 in increments of the encoder, 2005h:03 in rpm, at once [1603-1604].
TEST(NimotionSteps, OfTheirAmountAndSpeedComeByVirtualInputs) {
  MakerScene scene(kByVirtualInputs);
  scene.write("step_amount", "2000");
  scene.write("step_speed", "60");
  scene.write("control_mode_select", "1");
  scene.step();
  EXPECT_EQ(scene.turns(), 0.0) << "the motor must be enabled before [1612]";
  scene.set("maker_enable", true);
  scene.run(300ms);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  EXPECT_NEAR(scene.turns(), 0.0, 1e-4);
  scene.forget();
  scene.step();
  EXPECT_NEAR(scene.turns(), 0.5, 1e-3) << scene.told();
  EXPECT_NEAR(scene.seen("joint").fastest, 1.0 * kRadPerTurn, 0.03 * kRadPerTurn);
  EXPECT_NEAR(scene.state("joint").position, scene.position("joint"), 1e-3) << "it is watched";
  scene.step();
  EXPECT_NEAR(scene.turns(), 1.0, 1e-3) << "each edge is a step";
  scene.set("maker_enable", false);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.write("step_amount", "-1000");
  scene.write("step_speed", "30");
  scene.set("maker_enable", true);
  scene.forget();
  scene.step();
  EXPECT_NEAR(scene.turns(), 0.75, 1e-3) << "backwards";
  EXPECT_NEAR(scene.seen("joint").fastest, 0.5 * kRadPerTurn, 0.03 * kRadPerTurn);
}

// Function 12 [1803], and the end of the enabling.
TEST(NimotionSteps, AreHeldByThePauseAndEndedWithTheEnabling) {
  MakerScene scene(kByVirtualInputs);
  scene.write("step_amount", "8000");
  scene.write("step_speed", "60");
  scene.write("control_mode_select", "1");
  scene.set("maker_enable", true);
  scene.set("maker_step", true);
  scene.run(500ms);
  scene.set("maker_pause", true);
  scene.run(200ms);
  const double at = scene.turns();
  EXPECT_GT(at, 0.3);
  EXPECT_LT(at, 1.0);
  scene.run(1s);
  EXPECT_NEAR(scene.turns(), at, 1e-3);
  scene.set("maker_pause", false);
  scene.run(500ms);
  ASSERT_GT(scene.velocity("joint"), 0.9 * kRadPerTurn);
  scene.set("maker_enable", false);
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.velocity("joint"), 0.0);
  EXPECT_LT(scene.turns(), 1.9);
  scene.run(1s);
  scene.set("maker_enable", true);
  scene.forget();
  scene.run(1s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4) << "what was left of it is gone";
}

// DI0 active low, DI1 by its rising, falling, both edges [1642-1652].
TEST(NimotionSteps, ComeByTheEdgesOfATerminal) {
  for (const auto& [logic, rising, falling] :
       {std::tuple("2", true, false), std::tuple("3", false, true), std::tuple("4", true, true)}) {
    MakerScene scene(
        ", write: [{object: di0_function, raw: 1}, {object: di0_logic, raw: 0}, "
        "{object: di1_function, raw: 20}, {object: di1_logic, raw: " +
        std::string(logic) + "}]");
    scene.write("step_amount", "1000");
    scene.write("control_mode_select", "1");
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << "DI0 is high";
    scene.drive("joint").setInput(0, false, scene.now());
    scene.run(100ms);
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
    double expected = 0.0;
    for (const bool level : {true, false, true}) {
      scene.drive("joint").setInput(1, level, scene.now());
      scene.run(500ms);
      if (level ? rising : falling) expected += 0.25;
      EXPECT_NEAR(scene.turns(), expected, 1e-3) << logic;
    }
    scene.drive("joint").setInput(0, true, scene.now());
    scene.run(50ms);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }
}

/// Seconds until the motor has `turns` a second, or -1.
double secondsTo(Scene& scene, double turns) {
  const Time begin = scene.now();
  const double wanted = turns * kRadPerTurn;
  const bool up = scene.velocity("joint") < wanted;
  const bool there = scene.runUntil(
      [&] {
        const double is = scene.velocity("joint");
        return up ? is >= wanted - 1e-4 : is <= wanted + 1e-4;
      },
      3s);
  return there ? toSeconds(scene.now() - begin) : -1.0;
}

// 2006h:01 = 0: 2006h:02 in rpm, 2006h:03 and 04 in ms from 0 to 1000 rpm and back [1667,
// 1709-1728].
TEST(NimotionMakersSpeed, IsThatOfItsObjectByItsRamps) {
  MakerScene scene(kByVirtualInputs);
  scene.write("maker_velocity_source", "0");
  scene.write("maker_acceleration_time", "2000");
  scene.write("maker_deceleration_time", "4000");
  scene.write("maker_velocity", "120");
  scene.write("control_mode_select", "2");
  scene.run(300ms);
  EXPECT_EQ(scene.turns(), 0.0);
  scene.set("maker_enable", true);
  EXPECT_NEAR(secondsTo(scene, 1.98), 0.24, 0.03) << "120 of 1000 in 2 s";
  scene.run(200ms);
  EXPECT_NEAR(scene.velocity("joint"), 2.0 * kRadPerTurn, 0.01 * kRadPerTurn);
  EXPECT_NEAR(scene.state("joint").velocity, 2.0 * kRadPerTurn, 2.1e-3) << "it is watched";
  scene.write("maker_velocity", "60");
  EXPECT_NEAR(secondsTo(scene, 1.02), 0.24, 0.03) << "60 of 1000 in 4 s";
  scene.write("maker_velocity", "-60");
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), -1.0 * kRadPerTurn, 0.01 * kRadPerTurn);
  scene.write("maker_velocity", "0");
  scene.run(500ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-4) << "stopped by its ramp";
  scene.set("maker_enable", false);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

// 2006h:01 = 3: DI0 is the pulse width, DI1 the direction, DI2 enables [1730-1763].
TEST(NimotionMakersSpeed, IsThatOfAPulseWidthWhichIsShown) {
  MakerScene scene(
      ", write: [{object: di0_function, raw: 44}, {object: di0_logic, raw: 0}, "
      "{object: di1_function, raw: 45}, {object: di1_logic, raw: 0}, "
      "{object: di2_function, raw: 1}, {object: di2_logic, raw: 0}, "
      "{object: maker_velocity_source, raw: 3}, {object: maker_acceleration_time, raw: 100}, "
      "{object: maker_deceleration_time, raw: 100}]");
  scene.write("control_mode_select", "2");
  scene.drive("joint").setPulseWidth(0.2, scene.now());
  scene.run(300ms);
  EXPECT_EQ(scene.turns(), 0.0) << "not enabled";
  scene.drive("joint").setInput(2, false, scene.now());
  scene.run(500ms);
  const double slow = scene.velocity("joint");
  EXPECT_GT(slow, 0.1 * kRadPerTurn);
  auto seen = scene.call(bus::ReadObjectCommand{"joint", "pwm_duty"});
  EXPECT_EQ(seen.number, 20.0) << seen.message;
  scene.drive("joint").setPulseWidth(-0.4, scene.now());
  scene.run(500ms);
  EXPECT_NEAR(scene.velocity("joint"), -2.0 * slow, 0.05 * slow) << "twice as wide, the other way";
  seen = scene.call(bus::ReadObjectCommand{"joint", "pwm_duty"});
  EXPECT_EQ(seen.number, 40.0) << seen.message;
  scene.drive("joint").setInput(2, true, scene.now());
  scene.run(500ms);
  EXPECT_EQ(scene.velocity("joint"), 0.0);
}

// What speed a pulse width is, no manual tells: whatever it is, the driver shows that of the motor.
TEST(NimotionMakersSpeed, OfAPulseWidthIsShownWhateverItIs) {
  for (const double full : {5.0, 10.0, 40.0}) {
    MakerScene scene(
        ", write: [{object: di0_function, raw: 44}, {object: di1_function, raw: 45}, "
        "{object: di2_function, raw: 1}, {object: di2_logic, raw: 0}, "
        "{object: maker_velocity_source, raw: 3}, {object: maker_acceleration_time, raw: 10}], "
        "simulation: {with: {full_pulse_width: " +
        std::to_string(full) + "}}");
    scene.write("control_mode_select", "2");
    scene.drive("joint").setPulseWidth(0.25, scene.now());
    scene.drive("joint").setInput(2, false, scene.now());
    scene.run(500ms);
    const double speed = scene.velocity("joint");
    EXPECT_NEAR(std::fabs(speed), 0.25 * full * kRadPerTurn, 0.01 * full * kRadPerTurn) << full;
    EXPECT_NEAR(scene.state("joint").velocity, speed, 0.02 * full * kRadPerTurn) << full;
    const auto told = scene.call(bus::ReadObjectCommand{"joint", "drive_state"});
    EXPECT_EQ(told.number, 2.0) << told.message;
    scene.drive("joint").setInput(2, true, scene.now());
    scene.run(500ms);
  }
}

/// The axis is in the modes of CiA 402 again, and goes where it is told.
void expectServedAgain(Scene& scene) {
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x2002, 1})->number, 0U);
  ASSERT_TRUE(declare(scene, "joint", 0.0).success);
  const double from = scene.position("joint");
  ASSERT_EQ(scene.setpoint("joint", 0.2), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint") - from, 0.2, 1e-3) << scene.told();
}

TEST(NimotionMakersModes, AreLeftByEnablingOnceTheMotorStands) {
  MakerScene scene(kByVirtualInputs);
  scene.write("step_amount", "1000");
  scene.write("control_mode_select", "1");
  scene.set("maker_enable", true);
  scene.step();
  EXPECT_NEAR(scene.turns(), 0.25, 1e-3);
  scene.set("maker_enable", false);
  scene.run(300ms);
  expectServedAgain(scene);
}

// A terminal keeps the motor enabled, and it turns: nothing is written, nothing goes on by itself.
TEST(NimotionMakersModes, AreNotLeftWhileATerminalKeepsTheMotorTurning) {
  MakerScene scene(", write: [{object: di0_function, raw: 1}, {object: di0_logic, raw: 0}]");
  scene.write("maker_velocity", "60");
  scene.write("control_mode_select", "2");
  scene.drive("joint").setInput(0, false, scene.now());
  scene.run(1s);
  ASSERT_NEAR(scene.velocity("joint"), 1.0 * kRadPerTurn, 0.02 * kRadPerTurn);
  const bus::Answer back =
      call(scene, bus::WriteObjectCommand{"joint", "control_mode_select", "0"});
  EXPECT_FALSE(back.success) << back.message;
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("joint (node 1): is not"));
  EXPECT_NEAR(scene.velocity("joint"), 1.0 * kRadPerTurn, 0.02 * kRadPerTurn) << "the terminal's";
  scene.drive("joint").setInput(0, true, scene.now());
  scene.run(1s);
  EXPECT_EQ(scene.velocity("joint"), 0.0);
  expectServedAgain(scene);
}

}  // namespace
}  // namespace cia402
