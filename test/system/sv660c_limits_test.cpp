// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Travel, speed, windows and torque of the SV660C, and what of them counts in the drive.
#include <cmath>

#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

std::string sv660cProblems(const std::string& yaml) {
  Problems problems;
  config::loadRobot(YAML::Load(yaml), config::profilesIn({test::configFolder() + "/drives"}),
                    problems);
  return problems.text();
}

/// At the factory's 1:1 of 6091h.
std::string sv660cOneToOne(const std::string& limits, const std::string& more = {},
                           const std::string& simulation = {}) {
  std::string yaml = sv660cJoint(more, simulation);
  yaml = sv660cWith(yaml, "counts_per_turn: 100000", "counts_per_turn: 8388608");
  yaml = sv660cWith(yaml,
                    "write: [{object: gear_numerator, raw: 262144},\n"
                    "            {object: gear_denominator, raw: 3125}],\n",
                    "");
  return sv660cWith(yaml, "lower: -2.5, upper: 2.5, velocity: 1.5", limits);
}

// 2^31 units / 2^23 a turn = 256 turns of the motor, 32.17 rad of the joint.
TEST(Sv660cTravel, BeyondTheDrivesNumbersIsRefused) {
  EXPECT_EQ(sv660cProblems(sv660cOneToOne("lower: -32.0, upper: 32.0, velocity: 1.5")), "");
  EXPECT_THAT(sv660cProblems(sv660cOneToOne("lower: -32.0, upper: 32.5, velocity: 1.5")),
              HasSubstr("would wrap around inside these limits"));
  EXPECT_THAT(sv660cProblems(sv660cOneToOne("lower: -32.5, upper: 32.0, velocity: 1.5")),
              HasSubstr("would wrap around inside these limits"));
}

// 2^29 units/s are 3840 rpm at 1:1 [L15614], 8.042 rad/s of the joint; 607Fh gets a tenth more.
TEST(Sv660cSpeed, BeyondTheDrivesNumbersIsRefused) {
  EXPECT_EQ(sv660cProblems(sv660cOneToOne("lower: -2.5, upper: 2.5, velocity: 7.3")), "");
  EXPECT_THAT(sv660cProblems(sv660cOneToOne("lower: -2.5, upper: 2.5, velocity: 8.1")),
              HasSubstr("profile_velocity (6081:00): 8.1 does not fit"));
  EXPECT_THAT(sv660cProblems(sv660cOneToOne("lower: -2.5, upper: 2.5, velocity: 7.5")),
              HasSubstr("max_profile_velocity (607F:00): 8.25 does not fit"));
}

// 6064h wraps at 32.17 rad of the joint.
TEST(Sv660cContinuous, IsToldAndCommandedWithoutAStepAtTheWrap) {
  for (const double sign : {1.0, -1.0}) {
    Scene scene(loadText(sv660cOneToOne("velocity: 1.5", ", type: continuous, mode: ip",
                                        "initial_position: " + std::to_string(sign * 31.5))));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    const double begun = scene.state("joint").position, truly = scene.position("joint");
    double last = begun, step = 0.0, off = 0.0;
    scene.watch([&] {
      const double told = scene.state("joint").position;
      step = std::max(step, std::fabs(told - last));
      off = std::max(off, std::fabs(told - begun - (scene.position("joint") - truly)));
      last = told;
    });
    for (const double goal : {33.0, 31.8}) {
      ASSERT_EQ(scene.setpoint("joint", sign * goal), "");
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), sign * goal, 1e-4) << scene.told();
      EXPECT_NEAR(scene.state("joint").position, sign * goal, 1e-4);
    }
    EXPECT_LT(step, 1.5 * 0.004 * 1.1) << "of what is told, from cycle to cycle";
    EXPECT_LT(off, 1.5 * 0.012);
  }
}

// [L688]: other parameters of a move count with the next edge of bit 4.
TEST(Sv660cProfile, TakesANewSpeedWithTheNextSetPoint) {
  Sv660cReady scene(sv660cJoint({}, "initial_position: -2.0"), "pp");
  ASSERT_EQ(scene.setpoint("joint", 2.3), "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") > 1.49; }, 2s));
  EXPECT_TRUE(sv660cWrite(scene, "profile_velocity", "238732").success) << "0.3 rad/s";
  scene.run(300ms);
  EXPECT_NEAR(scene.velocity("joint"), 1.5, 0.01) << "that of the move";
  ASSERT_EQ(scene.setpoint("joint", 2.2), "");
  scene.run(800ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.3, 0.003) << "that of the next one";
}

// 795775 and 1591549 units/s^2 are 1 and 2 rad/s^2.
TEST(Sv660cProfile, TakesNewRampsWithTheNextSetPoint) {
  Sv660cReady scene(sv660cJoint({}, "initial_position: -2.0"), "pp");
  ASSERT_EQ(scene.setpoint("joint", 2.0), "");
  scene.run(100ms);
  for (const auto& [object, value] : {std::pair("profile_acceleration", "795775"),
                                      std::pair("profile_deceleration", "1591549")}) {
    const bus::Answer written = sv660cWrite(scene, object, value);
    EXPECT_TRUE(written.success) << written.message;
  }
  const auto ramp = [&] {
    const double before = scene.velocity("joint");
    scene.run(100ms);
    return (scene.velocity("joint") - before) / 0.1;
  };
  EXPECT_NEAR(ramp(), 4.0, 0.1) << "that of the move";
  scene.run(6s);
  ASSERT_NEAR(scene.position("joint"), 2.0, 1e-4);
  ASSERT_EQ(scene.setpoint("joint", -1.0), "");
  scene.run(100ms);
  EXPECT_NEAR(ramp(), -1.0, 0.05) << "those of the next one";
  double fastest = 0.0;
  ASSERT_TRUE(scene.runUntil(
      [&] {
        fastest = std::min(fastest, scene.velocity("joint"));
        return scene.velocity("joint") > fastest + 0.05;
      },
      10s));
  EXPECT_NEAR(ramp(), 2.0, 0.1);
}

// 60E0h and 60E1h at run time: a tenth of the rated torque, less 0.03 of friction, gives 70
// turns/s^2, 8.80 rad/s^2 of the joint, where 6083h asks for 40.
TEST(Sv660cTorqueLimit, BoundsTheMotorAtRunTime) {
  Sv660cReady scene(sv660cWith(sv660cJoint(), "acceleration: 4.0", "acceleration: 40.0"), "pv");
  const auto speedsUp = [&](double velocity) {
    scene.stream("joint", velocity, 20ms);
    const double before = scene.velocity("joint");
    scene.stream("joint", velocity, 20ms);
    const double gained = (scene.velocity("joint") - before) / 0.02;
    scene.stream("joint", 0.0, 1s);
    return std::fabs(gained);
  };
  for (const char* object : {"positive_torque_limit", "negative_torque_limit"}) {
    EXPECT_TRUE(sv660cWrite(scene, object, "100").success) << object;
  }
  EXPECT_NEAR(speedsUp(1.4), 8.8, 0.3);
  EXPECT_NEAR(speedsUp(-1.4), 8.8, 0.3);
  EXPECT_TRUE(sv660cWrite(scene, "positive_torque_limit", "200").success);
  EXPECT_GT(speedsUp(1.4), 12.0) << "the other way";
  EXPECT_NEAR(speedsUp(-1.4), 8.8, 0.3);
  EXPECT_TRUE(sv660cWrite(scene, "negative_torque_limit", "3500").success);
  EXPECT_TRUE(sv660cWrite(scene, "max_torque", "100").success);
  EXPECT_NEAR(speedsUp(-1.4), 8.8, 0.3) << "6072h bounds both";
}

/// When statusword bits have their value first, s since now.
double sv660cTakes(Scene& scene, unsigned mask, unsigned value) {
  const Time begun = scene.now();
  EXPECT_TRUE(scene.runUntil(
      [&] { return (unsigned{scene.truth("joint").statusword} & mask) == value; }, 5s));
  return toSeconds(scene.now() - begun);
}

// 6067h, 6068h [L15295-15325] in rad and s; the last 0.02 rad by 4 rad/s^2 take 0.1 s.
TEST(Sv660cWindows, OfThePositionSayWhenATargetIsReached) {
  for (const auto& [window, time, takes] :
       {std::tuple("0.02", "0.0", -0.1), std::tuple("0.02", "0.3", 0.2),
        std::tuple("0.00002", "0.0", 0.0)}) {
    Sv660cReady scene(sv660cWrites("{object: position_window, value: " + std::string(window) +
                                   "}, {object: position_window_time, value: " + time + "}"),
                      "pp");
    ASSERT_EQ(scene.setpoint("joint", 1.0), "");
    scene.run(200ms);
    const Time begun = scene.now() - 200ms;
    (void)sv660cTakes(scene, 0x0400, 0x0400);
    // 1.0 rad with 1.5 rad/s and 4 rad/s^2: 1.0 / 1.5 + 1.5 / 4 = 1.042 s, and what the hand-over
    // and the position loop take.
    EXPECT_NEAR(toSeconds(scene.now() - begun), 1.042 + takes, 0.05) << window << " " << time;
    scene.run(100ms);
    EXPECT_TRUE(scene.state("joint").target_reached);
  }
}

/// How long the motor had been within `window` of `velocity` when the bit came, s.
double sv660cWithin(Scene& scene, unsigned bit, double commanded, double velocity, double window) {
  Time inside = kNever;
  const auto shown = [&] { return (unsigned{scene.truth("joint").statusword} & bit) != 0; };
  const Time end = scene.now() + 3s;
  bool was_away = false;
  while (scene.now() < end) {
    scene.stream("joint", commanded, 20ms);
    const bool within = std::fabs(scene.velocity("joint") - velocity) <= window;
    if (!within) inside = kNever;
    if (within && inside == kNever) inside = scene.now();
    was_away = was_away || !shown();
    if (was_away && shown()) break;
  }
  EXPECT_TRUE(was_away && shown());
  return inside == kNever ? -1.0 : toSeconds(scene.now() - inside);
}

// 606Dh to 6070h [L15342-15424] in rad/s of the joint and s; their numbers are rpm of the motor:
// 0.005 rad/s are 2.4 rpm, so 2, which are 0.0042 rad/s; 0.1 rad/s are 47.7, so 48.
TEST(Sv660cWindows, OfTheVelocitySayWhenItIsReachedAndWhenItStands) {
  Sv660cReady scene(sv660cWrites("{object: velocity_window, value: 0.005}, "
                                 "{object: velocity_window_time, value: 0.4}, "
                                 "{object: velocity_threshold, value: 0.1}, "
                                 "{object: velocity_threshold_time, value: 0.2}"),
                    "pv");
  EXPECT_EQ(sv660cNumber(scene, 0x606D), 2U);
  EXPECT_EQ(sv660cNumber(scene, 0x606E), 400U);
  EXPECT_EQ(sv660cNumber(scene, 0x606F), 48U);
  EXPECT_EQ(sv660cNumber(scene, 0x6070), 200U);
  EXPECT_EQ(unsigned{scene.truth("joint").statusword} & 0x1000U, 0x1000U) << "it stands";
  EXPECT_NEAR(sv660cWithin(scene, 0x0400, 1.0, 1.0, 0.0042), 0.4, 0.045);
  EXPECT_EQ(unsigned{scene.truth("joint").statusword} & 0x1000U, 0U);
  EXPECT_NEAR(sv660cWithin(scene, 0x1000, 0.0, 0.0, 0.1005), 0.2, 0.045);
}

// 6067h, 60C5h and 60C6h do not stay as the factory left them for 1:1.
TEST(Sv660cRawNumbers, OfWindowsAndLargestRampsAreWritten) {
  Scene scene(loadText(sv660cJoint(
      {}, sv660cDelivered("[0x60C5, 0, a, uint32, rw, -, 1000], [0x60C6, 0, d, uint32, rw, -, "
                          "1000]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x6067), 796U) << "0.001 rad * 5000000 / 2 pi";
  EXPECT_EQ(sv660cNumber(scene, 0x60C5), 0xFFFFFFFFU);
  EXPECT_EQ(sv660cNumber(scene, 0x60C6), 0xFFFFFFFFU);
  scene.inject("joint", "power_cycle");
  scene.run(4s);
  EXPECT_EQ(sv660cNumber(scene, 0x6067), 796U) << "anew at every boot";
  EXPECT_EQ(sv660cNumber(scene, 0x60C5), 0xFFFFFFFFU);
}

}  // namespace
}  // namespace cia402
