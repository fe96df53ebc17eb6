// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Two motors on one joint. Judged by the motors: how far apart they are, and when they stand.
#include <optional>
#include <string>

#include "system/scene.h"

namespace cia402 {
namespace {

using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr double kGantryVelocity = 0.3, kAcceleration = 1.0;  // m/s, m/s²
constexpr Duration kCycle = 4ms;

/// A portal x, of which each side has a motor with a spindle of 20 mm.
/// @param one, two more of the sides, e.g. ", homing: {...}"; @param skew the key
std::string portal(const std::string& one = {}, const std::string& two = {},
                   const std::string& skew = "{window: 0.004}") {
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "defaults: {drive: generic_cia402, counts_per_turn: 131072, type: prismatic, lead: 0.02,\n"
         "  rated_torque: 0.64, mode: cyclic_position,\n"
         "  limits: {lower: -0.5, upper: 0.5, velocity: 0.3, acceleration: 1.0}}\n"
         "axes:\n"
         "  x1: {node_id: 1" +
         one +
         "}\n"
         "  x2: {node_id: 2, direction: -1" +
         two +
         "}\n"
         "couplings:\n"
         "  - {joints: [x], axes: [x1, x2], skew: " +
         skew + "}\n";
}

/// @param method 17, or 18 where the drive counts the other way round
std::string standing(double at, double lower_switch, int method) {
  return ", homing: {method: " + std::to_string(method) +
         ", search_velocity: 0.05, zero_velocity: 0.01, acceleration: 1.0}, "
         "simulation: {initial_position: " +
         std::to_string(at) + ", lower_limit_switch: " + std::to_string(lower_switch) + "}";
}

struct Portal : Scene {
  explicit Portal(const std::string& yaml = portal()) : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot()) << told();
  }
  void enable() {
    const bus::Answer answer = procedure(ProcedureKind::enable, "x1");
    ASSERT_TRUE(answer.success) << answer.message;
    run(100ms);
  }
  bool on(const std::string& side) { return state(side).state == State::operation_enabled; }
  double apart() { return std::abs(position("x1") - position("x2")); }
  double fastest() { return std::max(std::abs(velocity("x1")), std::abs(velocity("x2"))); }
  void watchApart() {
    widest = 0.0;
    watch([this] { widest = std::max(widest, apart()); });
  }
  /// Runs until both motors stand. @return how long that took
  Duration untilRest() {
    const Time begun = now();
    EXPECT_TRUE(runUntil([this] { return fastest() < 1e-3; }, 5s)) << told();
    return now() - begun;
  }
  bus::JointState shown() {
    bus::JointState state;
    robot().network().cycle().joints().find("x")->show(state);
    return state;
  }

  double widest = 0.0;
};

/// Of the drives' quick stop (6085h is twice the limit), from that speed.
Duration rampFrom(double velocity) { return fromSeconds(velocity / (2.0 * kAcceleration)); }

TEST(Gantry, BothSidesGetTheSetPointsOfTheJoint) {
  Portal scene;
  scene.enable();
  scene.watchApart();
  ASSERT_TRUE(scene.move({0.2}, 2s).success);
  scene.run(1s);
  EXPECT_EQ(scene.axis("x1").target(), scene.axis("x2").target());
  EXPECT_NEAR(scene.shown().velocity, 0.15, 0.005);
  scene.run(1500ms);
  EXPECT_NEAR(scene.position("x1"), 0.2, 1e-6);
  EXPECT_NEAR(scene.position("x2"), 0.2, 1e-6);
  EXPECT_NEAR(scene.shown().position, 0.2, 1e-6);
  EXPECT_LT(scene.widest, 1e-4);
}

TEST(Gantry, EffortsOfTheSidesAddUp) {
  Portal scene;
  scene.enable();
  ASSERT_TRUE(scene.move({0.2}, 2s).success);
  scene.run(300ms);
  const double sum = scene.state("x1").effort + scene.state("x2").effort;
  ASSERT_GT(std::abs(sum), 1e-3);
  EXPECT_NEAR(scene.shown().effort, sum, 1e-9);
}

TEST(Gantry, WhatIsAskedOfOneSideIsDoneToBoth) {
  Portal scene;
  EXPECT_THAT(scene.procedure(ProcedureKind::enable, "x2").message,
              HasSubstr("enable done on 2 of 2 axes"));
  EXPECT_TRUE(scene.on("x1") && scene.on("x2"));
  EXPECT_TRUE(scene.procedure(ProcedureKind::halt, "x1").success);
  EXPECT_TRUE(scene.state("x1").halted && scene.state("x2").halted);
  EXPECT_TRUE(scene.procedure(ProcedureKind::disable, "x1").success);
  EXPECT_FALSE(scene.on("x1") || scene.on("x2"));
}

TEST(Gantry, OneSideThatCannotBeEnabledKeepsTheOtherOff) {
  Portal scene;
  scene.inject("x2", "0x7305");
  scene.run(50ms);
  for (const char* name : {"x1", ""}) {
    const bus::Answer answer = scene.procedure(ProcedureKind::enable, name);
    EXPECT_FALSE(answer.success);
    scene.run(200ms);
    EXPECT_FALSE(scene.on("x1")) << name;
    EXPECT_FALSE(scene.on("x2")) << name;
  }
}

TEST(Gantry, AFaultOfOneSideStopsBothWithinACycleAndTheDrivesRamp) {
  for (const char* side : {"x1", "x2"}) {
    Portal scene;
    scene.enable();
    ASSERT_TRUE(scene.move({0.3}, 2s).success);
    scene.run(1s);
    ASSERT_NEAR(scene.fastest(), 0.225, 0.01);
    scene.inject(side, "0x7305");
    // The cycle in which it is told, that in which the quick stop arrives, and the motors' lag.
    const Duration took = scene.untilRest();
    EXPECT_LT(took, 2 * kCycle + rampFrom(0.235) + 20ms) << side;
    scene.run(500ms);
    EXPECT_FALSE(scene.on("x1") || scene.on("x2"));
    EXPECT_THAT(scene.told(), HasSubstr(std::string("x (gantry): one side has no power, ") + side));
    EXPECT_FALSE(scene.move({0.0}, 2s).success);
  }
}

/// When a side tells its fault (CiA 402: statusword x0xx 1111 or x0xx 1000), and the other one is
/// told the quick stop (controlword 0xxx x01x).
struct StopOnTheWire {
  StopOnTheWire(Portal& scene, unsigned faulty, unsigned other) {
    scene.world().bus().setMonitor([this, faulty, other](const can::Frame& frame, Time time) {
      const unsigned word = frame.data[0] | static_cast<unsigned>(frame.data[1]) << 8;
      const bool fault = (word & 0x4Fu) == 0x0Fu || (word & 0x4Fu) == 0x08u;
      if (frame.id == 0x180u + faulty && fault && !told) told = time;
      if (frame.id == 0x200u + other && (word & 0x86u) == 0x02u && !answered) answered = time;
    });
  }
  std::optional<Time> told, answered;
};

TEST(Gantry, TheOtherSideGetsItsQuickStopWithinACycleOfTheStatuswordWithTheFault) {
  for (const unsigned faulty : {1u, 2u}) {
    Portal scene;
    scene.enable();
    ASSERT_TRUE(scene.move({0.3}, 2s).success);
    scene.run(1s);
    const StopOnTheWire wire(scene, faulty, 3 - faulty);
    scene.inject("x" + std::to_string(faulty), "0x7305");
    scene.run(100ms);
    ASSERT_TRUE(wire.told && wire.answered) << faulty;
    EXPECT_GT(*wire.answered, *wire.told);
    EXPECT_LE(*wire.answered - *wire.told, kCycle) << faulty;
    scene.world().bus().setMonitor({});
  }
}

TEST(Gantry, ALostSideStopsTheOther) {
  Portal scene;
  scene.enable();
  ASSERT_TRUE(scene.move({0.3}, 2s).success);
  scene.run(1s);
  scene.inject("x2", "silent");
  EXPECT_TRUE(scene.runUntil([&] { return !scene.on("x1"); }, 1s));
  scene.run(500ms);
  EXPECT_LT(std::abs(scene.velocity("x1")), 1e-3);
}

TEST(Gantry, ASideThatIsHeldStopsBothWithinTheWindow) {
  Portal scene;
  scene.enable();
  ASSERT_TRUE(scene.move({0.3}, 3s).success);
  scene.run(1s);
  const double speed = scene.fastest();
  ASSERT_GT(speed, 0.1);
  scene.watchApart();
  scene.inject("x2", "blocked_rotor");
  EXPECT_TRUE(scene.runUntil([&] { return scene.apart() > 0.004; }, 1s)) << "the window";
  const Duration took = scene.untilRest();
  EXPECT_LT(took, 3 * kCycle + rampFrom(speed) + 20ms);
  const double ramp = speed * speed / (4.0 * kAcceleration);
  EXPECT_LT(scene.widest, 0.004 + speed * 4 * 0.004 + ramp);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("x (gantry): x1 is 0.00"),
                                  HasSubstr("m ahead of x2, and skew/window is 0.004 m")));
  EXPECT_THAT(scene.told(), HasSubstr("joints: trajectory stopped: x (axes x1, x2): x1 is 0.00"));
  scene.run(500ms);
  EXPECT_FALSE(scene.on("x1") || scene.on("x2"));
}

TEST(Gantry, ThatStandsSkewCanBeEnabledButNotMoved) {
  Portal scene;
  scene.enable();
  ASSERT_TRUE(scene.move({0.3}, 3s).success);
  scene.run(1s);
  scene.inject("x2", "blocked_rotor");
  scene.run(1s);
  ASSERT_GT(scene.apart(), 0.004);
  scene.inject("x2", "clear");
  scene.run(50ms);
  const double x1 = scene.position("x1"), x2 = scene.position("x2");
  scene.enable();
  EXPECT_THAT(scene.move({0.0}, 3s).message,
              AllOf(HasSubstr("x1 and x2 stand 0.0"), HasSubstr("skew/window is 0.004 m: home")));
  scene.run(500ms);
  EXPECT_TRUE(scene.on("x1") && scene.on("x2")) << "they do not get further apart";
  EXPECT_NEAR(scene.position("x1"), x1, 1e-5);
  EXPECT_NEAR(scene.position("x2"), x2, 1e-5);
}

TEST(Gantry, TakesBackASmallSkewWhileItMovesAndNeverJumps) {
  Portal scene(
      portal(", simulation: {initial_position: 0.0}", ", simulation: {initial_position: 0.003}"));
  scene.enable();
  EXPECT_NEAR(scene.apart(), 0.003, 1e-6);
  scene.run(1s);
  EXPECT_NEAR(scene.apart(), 0.003, 1e-6) << "at rest it stays";
  double last = scene.axis("x2").target(), before = 0.0, hardest = 0.0;
  Time seen = scene.now();
  scene.watch([&] {
    const double target = scene.axis("x2").target();
    if (target == last && scene.now() - seen < kCycle) return;
    const double step = target - last;
    hardest = std::max(hardest, std::abs(step - before));
    last = target;
    before = step;
    seen = scene.now();
  });
  ASSERT_TRUE(scene.move({0.25}, 3s).success);
  scene.run(4s);
  EXPECT_NEAR(scene.position("x1"), 0.25, 1e-6);
  EXPECT_NEAR(scene.position("x2"), 0.25, 1e-6);
  EXPECT_LE(hardest, kAcceleration * 0.004 * 0.004 * 1.5);
}

TEST(Gantry, HomesBothSidesTogetherEachOnItsSwitch) {
  // The sides stand 2 mm skew, and home where it is square: both switches count as 0.
  Portal scene(
      portal(standing(0.0, -0.1, 17), standing(0.002, -0.1, 18), "{window: 0.004, homing: 0.01}"));
  scene.enable();
  scene.watchApart();
  EXPECT_THAT(scene.move({0.1}, 2s).message, HasSubstr("not homed"));
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "x2");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_THAT(homed.message, HasSubstr("home done on 2 of 2 axes"));
  EXPECT_NEAR(scene.position("x1"), -0.1, 0.001);
  EXPECT_LT(scene.apart(), 5e-4) << "square";
  EXPECT_LT(scene.widest, 0.004);
  ASSERT_TRUE(scene.move({0.1}, 2s).success) << scene.told();
  scene.run(3s);
  EXPECT_NEAR(scene.state("x1").position, 0.1, 1e-6);
  EXPECT_NEAR(scene.state("x2").position, 0.1, 1e-6);
}

TEST(Gantry, ASideThatIsHeldWhileBothHomeStopsBoth) {
  Portal scene(
      portal(standing(0.0, -0.1, 17), standing(0.0, -0.1, 18), "{window: 0.004, homing: 0.01}"));
  scene.enable();
  const auto homing = scene.begin(ProcedureKind::home, "x1");
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("x1") < -0.04; }, 3s));
  scene.watchApart();
  scene.inject("x2", "blocked_rotor");
  scene.run(2s);
  EXPECT_FALSE(scene.on("x1") || scene.on("x2"));
  EXPECT_LT(scene.widest, 0.01 + 0.05 * 0.016 + 0.05 * 0.05 / (4.0 * kAcceleration));
  ASSERT_TRUE(homing->has_value());
  EXPECT_FALSE((*homing)->success);
}

TEST(Gantry, SidesThatSearchToDifferentEndsAreStoppedWithinTheWindow) {
  Portal scene(
      portal(standing(0.0, -0.1, 17), standing(0.0, -0.1, 17), "{window: 0.004, homing: 0.01}"));
  scene.enable();
  scene.watchApart();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "x1");
  EXPECT_FALSE(homed.success);
  scene.run(500ms);
  EXPECT_FALSE(scene.on("x1") || scene.on("x2"));
  EXPECT_LT(scene.widest, 0.01 + 0.1 * 0.016 + 2.0 * 0.05 * 0.05 / (4.0 * kAcceleration));
  EXPECT_THAT(scene.told(), HasSubstr("x2 is 0.01"));
  EXPECT_THAT(scene.told(), HasSubstr("m ahead of x1, and skew/homing is 0.01 m"));
}

TEST(Gantry, ASideWhoseHomingEndsStopsTheOther) {
  Portal scene(
      portal(standing(0.0, -0.1, 17), standing(0.0, -0.1, 18), "{window: 0.004, homing: 0.05}"));
  scene.enable();
  const auto homing = scene.begin(ProcedureKind::home, "x1");
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("x1") < -0.03; }, 3s));
  scene.axis("x2").cancel("for a test", scene.now());
  EXPECT_LT(scene.untilRest(), 250ms) << "x2 comes to rest by its halt first";
  scene.run(500ms);
  EXPECT_GT(scene.position("x1"), -0.04) << "it goes on for its switch no more";
  EXPECT_FALSE(scene.on("x1"));
  EXPECT_THAT(scene.told(), HasSubstr("x (gantry): both sides home together, and x2 does no more"));
}

TEST(Gantry, AFaultWhileBothHomeStopsBoth) {
  Portal scene(
      portal(standing(0.0, -0.1, 17), standing(0.0, -0.1, 18), "{window: 0.004, homing: 0.01}"));
  scene.enable();
  const auto homing = scene.begin(ProcedureKind::home, "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("x1") < -0.04; }, 3s));
  scene.inject("x1", "0x7305");
  EXPECT_LT(scene.untilRest(), 2 * kCycle + rampFrom(0.05) + 20ms);
  scene.run(300ms);
  EXPECT_FALSE(scene.on("x1") || scene.on("x2"));
  ASSERT_TRUE(homing->has_value());
  EXPECT_FALSE((*homing)->success);
}

TEST(Gantry, HomesNotWhereOneSideCannot) {
  Portal scene(
      portal(standing(0.0, -0.1, 17), standing(0.0, -0.1, 18), "{window: 0.004, homing: 0.01}"));
  scene.inject("x2", "0x7305");
  scene.run(50ms);
  scene.forget();
  for (const char* name : {"x1", ""}) {
    EXPECT_FALSE(scene.procedure(ProcedureKind::home, name).success);
    scene.run(300ms);
    EXPECT_LT(scene.seen("x1").travel(), 0.002) << name;
    EXPECT_FALSE(scene.on("x1"));
  }
}

TEST(Gantry, MissedCyclesOfOneSidesFeedbackAreNoSkew) {
  Portal scene;
  scene.enable();
  ASSERT_TRUE(scene.move({0.4}, 3s).success);
  scene.run(1400ms);
  ASSERT_GT(scene.fastest(), 0.19);
  scene.robot().freeze(60ms);
  scene.run(3s);
  EXPECT_NEAR(scene.position("x1"), 0.4, 1e-6) << scene.told();
}

TEST(Gantry, TheRobotInTheRepositoryHomesAndMoves) {
  Scene scene(loadFile("portal.yaml"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message;
  ASSERT_TRUE(scene.move({0.5, -0.1}, 4s, 0).success);
  ASSERT_TRUE(scene.move({0.5, 2.0}, 3s, 1).success);
  scene.run(5s);
  EXPECT_NEAR(scene.position("x1"), 0.5, 1e-3);
  EXPECT_NEAR(scene.position("x2"), 0.5, 1e-3);
  EXPECT_NEAR(scene.position("z"), -0.1, 1e-6);
  EXPECT_NEAR(scene.position("m5"), 1.5, 2e-6);
  EXPECT_NEAR(scene.position("m6"), -0.5, 2e-6);
}

}  // namespace
}  // namespace cia402
