// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Numbers of the DM5: rpm beside counts, windows, positions that wrap, gains, parameters that it
// takes at standstill only; its touch probes and its brake.
#include "system/families_bus_scene.h"
#include "system/families_motion.h"
#include "system/touch_probe_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kCspDm5{"megmeet_dm5", "8388608", "csp"},
    kPvDm5{"megmeet_dm5", "8388608", "pv"}, kPpDm5{"megmeet_dm5", "8388608", "pp"};

bus::ObjectAnswer readFrom(Scene& scene, const std::string& object) {
  return scene.call(bus::ReadObjectCommand{"joint", object});
}
bus::Answer writeTo(Scene& scene, const std::string& object, const std::string& value) {
  return scene.call(bus::WriteObjectCommand{"joint", object, value});
}

// 1 rpm of the motor is 2 pi / 60 / 50 = 2.0943951e-3 rad/s of the joint.
TEST(Dm5Speeds, InRpmAreThoseOfTheJoint) {
  Scene scene(loadText(familyJoint(kPvDm5)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  struct Speed {
    const char* name;
    fieldbus::ObjectId id;
    bool written;
  };
  for (const Speed& speed :
       {Speed{"velocity_sensor", {0x6069, 0}, false}, Speed{"velocity_demand", {0x606B, 0}, false},
        Speed{"velocity_window", {0x606D, 0}, true}, Speed{"velocity_threshold", {0x606F, 0}, true},
        Speed{"max_motor_speed", {0x6080, 0}, true},
        Speed{"homing_search_velocity", {0x6099, 1}, true},
        Speed{"homing_zero_velocity", {0x6099, 2}, true}}) {
    sim::Entry* entry = scene.drive("joint").dictionary().find(speed.id);
    if (speed.written) {
      // 0.2 rad/s are 95.49 rpm; by name a write is the drive's own number
      EXPECT_TRUE(writeTo(scene, speed.name, "95").success) << speed.name;
      EXPECT_EQ(entry->number, 95U);
    } else {
      scene.drive("joint").dictionary().onRead(speed.id, [](sim::Entry& e) {
        e.number = 95;
        return 0U;
      });
    }
    EXPECT_THAT(readFrom(scene, speed.name).message, HasSubstr("0.19896")) << speed.name;
  }
}

/// Milliseconds from when `near` holds first to statusword bit 10; -1: never
template <typename Near>
int untilBit10(FamilyScene& scene, const Near& near) {
  int waited = -1;
  for (int ms = 0; ms < 4000; ++ms) {
    scene.run(1ms);
    if (waited < 0 && near()) waited = 0;
    if (waited >= 0 && (scene.truth("joint").statusword & 0x0400) != 0) return waited;
    if (waited >= 0) ++waited;
  }
  return -1;
}

// 6067h in counts, 6068h in ms.
TEST(Dm5Windows, OfPositionSayWhenBit10Comes) {
  for (const auto& [window, time] : {std::pair(0.002, 0.05), std::pair(0.1, 0.3)}) {
    FamilyScene scene(familyJoint(
        kPpDm5, ", write: [{object: position_window, value: " + std::to_string(window) +
                    "}, {object: position_window_time, value: " + std::to_string(time) + "}]"));
    EXPECT_NEAR(static_cast<double>(scene.number(0x6067)), window / oneCount(kPpDm5), 1.0);
    EXPECT_EQ(scene.number(0x6068), static_cast<std::uint64_t>(1000.0 * time + 0.5));
    ASSERT_EQ(scene.setpoint("joint", 0.6), "");
    const double wide = window;
    const int waited =
        untilBit10(scene, [&] { return std::abs(scene.position("joint") - 0.6) <= wide; });
    EXPECT_NEAR(waited, 1000.0 * time, 15.0) << window;
  }
}

// 606Dh in rpm, 606Eh in ms; 606Fh and 6070h say when bit 12 goes.
TEST(Dm5Windows, OfVelocitySayWhenBits10And12Come) {
  FamilyScene scene(
      familyJoint(kPvDm5,
                  ", write: [{object: velocity_window, raw: 1}, {object: "
                  "velocity_window_time, raw: 250}, {object: velocity_threshold, raw: 80}, "
                  "{object: velocity_threshold_time, raw: 0}]"));
  EXPECT_EQ(scene.number(0x606D), 1U);
  EXPECT_EQ(scene.number(0x606E), 250U);
  EXPECT_EQ(scene.number(0x606F), 80U);
  constexpr double kRpm = 2.0943951e-3;
  int fast = -1, reached = -1;
  for (int ms = 0; ms < 900; ++ms) {
    if (ms % 20 == 0) (void)scene.setpoint("joint", 0.5);
    scene.run(1ms);
    const unsigned word = scene.truth("joint").statusword;
    const double speed = scene.velocity("joint");
    if (speed < 70 * kRpm) {
      EXPECT_NE(word & 0x1000, 0U) << ms;
    }
    if (speed > 95 * kRpm) {
      EXPECT_EQ(word & 0x1000, 0U) << ms;
    }
    if (fast < 0 && speed > 0.5 - kRpm) fast = ms;
    if (reached < 0 && fast >= 0 && (word & 0x0400) != 0) reached = ms;
  }
  ASSERT_GE(fast, 0);
  EXPECT_NEAR(reached - fast, 250, 15);
}

// 2^31 counts are 256 turns of the motor, 32.170 rad of the joint.
TEST(Dm5Positions, CountOnWhereTheNumbersOfTheDriveBeginAnew) {
  for (const FamilyMode& tested : {kPvDm5, kCspDm5}) {
    std::string yaml =
        familyJoint(tested, ", type: continuous, simulation: {initial_position: 31.9}");
    yaml = replaced(yaml, "lower: -2.5, upper: 2.5, ", "");
    FamilyScene scene(yaml);
    EXPECT_NEAR(scene.state("joint").position, 31.9, 1e-4);
    if (scene.kind() == drive::ControlKind::position) {
      ASSERT_EQ(scene.setpoint("joint", 32.7), "");
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), 32.7, 1e-3) << scene.told();
    } else {
      scene.stream("joint", 0.7, 1200ms);
      EXPECT_GT(scene.position("joint"), 32.4);
    }
    EXPECT_GT(sim::asSigned(*scene.drive("joint").dictionary().find({0x6064, 0})), -2147483647 - 1);
    EXPECT_LT(sim::asSigned(*scene.drive("joint").dictionary().find({0x6064, 0})), 0)
        << "the drive's own number has wrapped";
    EXPECT_NEAR(scene.state("joint").position, scene.position("joint"), 0.02) << scene.told();
    EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.05) << "no leap";
  }
}

// 2008h and 2009h from the robot's file.
TEST(Dm5Gains, ComeFromTheFile) {
  FamilyScene scene(familyJoint(
      kCspDm5,
      ", write: [{object: speed_gain, raw: 355}, {object: speed_integral, raw: 2500}, "
      "{object: position_gain, raw: 44}, {object: speed_output_filter, raw: 7}, {object: "
      "velocity_feed_forward, raw: 5000}, {object: torque_feed_forward, raw: 300}, "
      "{object: stiffness, raw: 13}, {object: inertia_ratio, raw: 250}]"));
  for (const auto& [id, number] :
       {std::pair(fieldbus::ObjectId{0x2008, 1}, 355U),
        std::pair(fieldbus::ObjectId{0x2008, 2}, 2500U),
        std::pair(fieldbus::ObjectId{0x2008, 3}, 44U), std::pair(fieldbus::ObjectId{0x2008, 4}, 7U),
        std::pair(fieldbus::ObjectId{0x2008, 0x10}, 5000U),
        std::pair(fieldbus::ObjectId{0x2008, 0x12}, 300U),
        std::pair(fieldbus::ObjectId{0x2009, 8}, 13U),
        std::pair(fieldbus::ObjectId{0x2009, 0x27}, 250U)}) {
    EXPECT_EQ(scene.number(id.index, id.subindex), number) << fieldbus::toString(id);
  }
}

// Class S of the manual: at standstill alone.
TEST(Dm5Parameters, OfStandstillAreRefusedInWordsWhileItRuns) {
  FamilyScene scene(familyJoint(kPvDm5));
  const char* objects[] = {"di2_function",    "software_limit_mode", "positive_torque_channel",
                           "inertia_ratio",   "overspeed_threshold", "homing_time_limit",
                           "hard_stop_torque"};
  for (const char* object : objects) {
    const double before = readFrom(scene, object).number;
    const bus::Answer refused = writeTo(scene, object, "1");
    EXPECT_FALSE(refused.success) << object;
    EXPECT_THAT(refused.message, AllOf(HasSubstr("not written"), HasSubstr("0x08000022")));
    EXPECT_EQ(readFrom(scene, object).number, before) << object;
  }
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  for (const char* object : objects) {
    const bus::Answer written = writeTo(scene, object, "1");
    EXPECT_TRUE(written.success) << written.message;
  }
}

/// Both probes, each edge, and the index pulse.
TEST(Dm5Probes, TellWhereTheMotorWasAtEachEdge) {
  FamilyScene scene(familyJoint(kPvDm5, ", simulation: {index_offset: 0.25}"));
  for (const unsigned probe : {1U, 2U}) {
    for (const char* edges : {"rising", "falling", "both"}) {
      const bool rising = edges != std::string("falling"), falling = edges != std::string("rising");
      if (!rising) touch(scene, "joint", true, probe);
      Waiting waiting(scene, probeOf("joint", edges, 5.0, probe));
      scene.stream("joint", 0.4, 300ms);
      double up = 0.0, down = 0.0;
      if (rising) up = touch(scene, "joint", true, probe);
      scene.stream("joint", 0.4, 60ms);
      if (falling) down = touch(scene, "joint", false, probe);
      const bus::TouchProbeAnswer answer = waiting.await();
      ASSERT_TRUE(answer.success) << answer.message;
      if (rising) {
        EXPECT_NEAR(answer.rising, up, 3e-4);
      }
      if (falling) {
        EXPECT_NEAR(answer.falling, down, 3e-4);
      }
      touch(scene, "joint", false, probe);
      scene.run(600ms);
    }
  }
  bus::ArmTouchProbeCommand command = probeOf("joint");
  command.index_pulse = true;
  Waiting waiting(scene, command);
  scene.stream("joint", 0.4, 500ms);
  const bus::TouchProbeAnswer answer = waiting.await();
  ASSERT_TRUE(answer.success) << answer.message;
  const double turns = answer.rising / 6.283185307179586 * 50.0;
  EXPECT_NEAR(turns - std::floor(turns), 0.25, 1e-6);
}

TEST(Dm5Probes, ThatAreContinuousGoOnStoring) {
  FamilyScene scene(familyJoint(kPvDm5));
  bus::ArmTouchProbeCommand command = probeOf("joint");
  command.continuous = true;
  Waiting waiting(scene, command);
  touch(scene, "joint", true);
  ASSERT_TRUE(waiting.await().success);
  EXPECT_EQ(objectOf(scene, "joint", 0x60B8) & 0x3U, 0x3U) << "it stays armed";
  touch(scene, "joint", false);
  scene.stream("joint", 0.4, 400ms);
  const double again = touch(scene, "joint", true);
  scene.run(50ms);
  const double stored = readFrom(scene, "touch_probe_1_rising").number * oneCount(kPvDm5);
  EXPECT_NEAR(stored, again, 3e-4);
  EXPECT_GT(again, 0.05);
}

// P02.10: what is commanded while the brake opens is lost.
TEST(Dm5Brake, IsWaitedForAsLongAsP0210Says) {
  for (const int delay : {20, 250, 500}) {
    Scene scene(loadText(familyJoint(
        kPpDm5,
        ", simulation: {with: {dictionary: [[0x2002, 11, brake_on_command_delay, uint16, "
        "rw, -, " +
            std::to_string(delay) + ", 20, 500]]}}")));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    Time on = kNever;
    scene.watch([&] {
      const bool enabled = (scene.truth("joint").statusword & 0x6F) == 0x27;
      if (on == kNever && enabled) on = scene.now();
    });
    scene.forget();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    const double waited = toSeconds(scene.now() - on);
    EXPECT_GE(waited, 1e-3 * delay - 0.005) << delay;
    EXPECT_LT(waited, 1e-3 * delay + 0.1) << delay;
    EXPECT_LT(scene.seen("joint").travel(), 1e-6);
    ASSERT_EQ(scene.setpoint("joint", 0.4), "");
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), 0.4, 1e-3) << "and nothing is lost";
  }
}

// Er.073 beyond 100 rpm [L3781]: a motor that coasts is not enabled before it is slow enough.
TEST(Dm5Enabling, WaitsForAMotorThatCoasts) {
  FamilyScene scene(familyJoint(kPvDm5, ", write: [{object: quick_stop_option, raw: 0}]"));
  constexpr double kRpm100 = 100.0 / 60.0 * 6.283185307179586 / 50.0;  // of the joint, rad/s
  scene.stream("joint", 0.8, 600ms);
  ASSERT_GT(scene.velocity("joint"), 2.0 * kRpm100);
  bool on = true;
  double fastest = 0.0;
  scene.watch([&] {
    const bool now = scene.truth("joint").power_stage_on;
    if (now && !on) fastest = std::max(fastest, std::abs(scene.velocity("joint")));
    on = now;
  });
  (void)scene.begin(ProcedureKind::quick_stop, "joint");
  scene.run(30ms);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  scene.run(2s);
  EXPECT_EQ(scene.state("joint").error_code, 0) << enabled.message << scene.told();
  EXPECT_LT(fastest, kRpm100);
  scene.mustSucceed(ProcedureKind::enable);
}

// The drive's own fault, where somebody enables it all the same.
TEST(Dm5Enabling, OfATurningMotorIsAFaultOfTheDrive) {
  FamilyScene scene(familyJoint(kPvDm5));
  scene.inject("joint", "turning_at_enable");
  scene.run(300ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("0xFF49"), HasSubstr("faster than 100 rpm")));
}

// P01.01 to P01.16 [L3127-3145].
TEST(Dm5Parameters, ThatCountOnceThePowerWasOffSaySo) {
  Scene scene(loadText(familyJoint(kPvDm5, ", write: [{object: motor_max_torque, raw: 290}]")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("2001:06 motor_max_torque was written"),
                                  HasSubstr("once the drive was switched off and on")));
  scene.run(500ms);
  const bus::Answer told = writeTo(scene, "motor_rated_torque", "127");
  EXPECT_TRUE(told.success) << told.message;
  EXPECT_THAT(told.message, HasSubstr("it counts once the drive was switched off and on"));
  const bus::Answer plain = writeTo(scene, "position_gain", "50");
  EXPECT_TRUE(plain.success) << plain.message;
  EXPECT_THAT(plain.message, testing::Not(HasSubstr("switched off")));
}

/// Controlwords that left for the node, each once where it changed.
std::vector<std::string> controlwords(const TracedScene& scene) {
  std::vector<std::string> words;
  for (const std::string& line : scene.beginning("201 ")) {
    const std::string word = line.substr(4, 5);
    if (words.empty() || words.back() != word) words.push_back(word);
  }
  return words;
}

// Bit 4 rises once, is held, and is taken back by an abort.
TEST(Dm5Homing, BeginsByOneEdgeOfBit4WhichIsHeldUntilItEnds) {
  const std::string search =
      ", write: [{object: di1_function, raw: 36}], homing: {method: 17, search_velocity: 0.3, "
      "zero_velocity: 0.05, acceleration: 2.0}, simulation: {lower_limit_switch: -0.4}";
  TracedScene scene(familyJoint(kCspDm5, search));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.clear();
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_TRUE(inOrder(controlwords(scene), {"06 00", "0F 00", "1F 00", "0F 00"}));
  EXPECT_EQ(std::count(scene.lines.begin(), scene.lines.end(), std::string()), 0);
  std::size_t edges = 0;
  for (const std::string& word : controlwords(scene)) edges += word == "1F 00" ? 1U : 0U;
  EXPECT_EQ(edges, 1U);
}

}  // namespace
}  // namespace cia402
