// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `pdos: none`: what travels by PDO elsewhere is read and written by SDO. What the joint does is
// read from the motor.
#include <iterator>
#include <map>

#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kNoPdos[] = ", pdos: none";
constexpr char kDamiao[] = "damiao_dm";

/// A drive in one of its modes.
struct Alone {
  const char* family;
  const char* mode;
};
void PrintTo(const Alone& tested, std::ostream* out) { *out << tested.family << tested.mode; }

std::string aloneJoint(const Alone& tested, const std::string& more = {}) {
  if (tested.family != std::string(kDamiao)) {
    return busRobot(
        "  joint: {node_id: 4, drive: generic_cia402, counts_per_turn: 131072,\n"
        "    gear_ratio: 100.0, rated_torque: 0.64, mode: " +
        std::string(tested.mode) + ", modes: [" + tested.mode +
        "], limits: {lower: -2.5, upper: 2.5, velocity: 0.8, acceleration: 4.0,\n"
        "    jerk: 40.0, effort: 100.0}" +
        kNoPdos + more + "}\n");
  }
  return busRobot("  joint: {node_id: 4, drive: damiao_dm, mode: " + std::string(tested.mode) +
                  ", modes: [" + tested.mode +
                  "], limits: {lower: -2.5, upper: 2.5, velocity: 0.8, acceleration: 4.0,\n"
                  "    jerk: 40.0, effort: 5.0}" +
                  kNoPdos + more + "}\n");
}

/// Identifiers of PDOs, all of them.
bool isPdo(const std::string& line) {
  const unsigned long id = std::stoul(line.substr(0, 3), nullptr, 16);
  return id >= 0x181 && id <= 0x57F;
}

class WithoutPdos : public testing::TestWithParam<Alone> {
 protected:
  static void begin(TracedScene& scene) {
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    scene.forget();
    enableJoint(scene);
    scene.run(300ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << "nothing moves by that";
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
  }
  static ControlKind kind(Scene& scene) { return scene.state("joint").mode->kind; }
  static double value(Scene& scene) {
    return kind(scene) == ControlKind::velocity        ? 0.5
           : GetParam().family == std::string(kDamiao) ? 0.3
                                                       : 4.0;
  }
  static void sendOff(Scene& scene) {
    if (kind(scene) == ControlKind::position) {
      EXPECT_EQ(scene.setpoint("joint", scene.position("joint") + 1.2), "");
      scene.run(600ms);
    } else {
      scene.stream("joint", value(scene), 700ms);
    }
    EXPECT_GT(scene.velocity("joint"), 0.25) << scene.told();
  }
};

TEST_P(WithoutPdos, ItMovesAsItIsToldAndNoPdoIsOnTheBus) {
  TracedScene scene(aloneJoint(GetParam()));
  ASSERT_NO_FATAL_FAILURE(begin(scene));
  if (kind(scene) == ControlKind::position) {
    expectGoes(scene, 0.6);
    EXPECT_NEAR(scene.state("joint").position, scene.position("joint"), 1e-3);
  } else {
    // An effort against the limit of the speed swings: what is shown was true when it was told.
    std::map<Time, double> truth;
    scene.watch([&] { truth[scene.now()] = scene.velocity("joint"); });
    sendOff(scene);
    scene.watch({});
    const Time told = scene.state("joint").stamps.velocity;
    EXPECT_LT(scene.now() - told, 10ms);
    ASSERT_NE(truth.upper_bound(told), truth.begin());
    EXPECT_NEAR(scene.state("joint").velocity, std::prev(truth.upper_bound(told))->second, 0.05);
  }
  const bus::Answer halted = scene.procedure(ProcedureKind::halt);
  EXPECT_TRUE(halted.success) << halted.message;
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-3);
  for (const std::string& line : scene.lines) ASSERT_FALSE(isPdo(line)) << line;
  for (unsigned pdo = 0; pdo < 4; ++pdo) {
    const auto n = static_cast<std::uint16_t>(pdo);
    EXPECT_NE(numberIn(scene, static_cast<std::uint16_t>(0x1400 + n), 1) >> 31, 0U) << pdo;
    EXPECT_NE(numberIn(scene, static_cast<std::uint16_t>(0x1800 + n), 1) >> 31, 0U) << pdo;
  }
  EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.05);
  EXPECT_EQ(scene.badFloats(), 0U);
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST_P(WithoutPdos, AQuickStopComesAtOnce) {
  TracedScene scene(aloneJoint(GetParam()));
  ASSERT_NO_FATAL_FAILURE(begin(scene));
  sendOff(scene);
  const double from = scene.position("joint"), speed = scene.velocity("joint");
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-3);
  // By twice the acceleration limit, 30 ms after the call at the latest.
  EXPECT_LT(scene.position("joint") - from, 0.03 * speed + 1.2 * speed * speed / 16.0);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

TEST_P(WithoutPdos, AFaultIsToldAndClearedAndMotionThatNobodyRenewsEnds) {
  TracedScene scene(aloneJoint(GetParam()));
  ASSERT_NO_FATAL_FAILURE(begin(scene));
  sendOff(scene);
  if (kind(scene) != ControlKind::position) {
    scene.run(2s);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-3) << "the stream has ended";
  }
  scene.inject("joint", "encoder");
  scene.run(300ms);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("0x7305"));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.run(2s);
  const bus::Answer recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
  scene.forget();
  scene.run(500ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
}

// It moves on by its last set-point, until NMT stop reaches it.
TEST_P(WithoutPdos, ADriveThatAnswersNoMoreIsLostAndStopped) {
  TracedScene scene(aloneJoint(GetParam()));
  ASSERT_NO_FATAL_FAILURE(begin(scene));
  sendOff(scene);
  scene.inject("joint", "sdo_silent");
  scene.run(3s);
  EXPECT_THAT(scene.told(), HasSubstr("answers no SDO, and nothing travels by PDO"));
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-3) << scene.told();
  EXPECT_NE(scene.setpoint("joint", 0.0), "");
}

// The drive watches the driver's heartbeat, as with PDOs.
TEST_P(WithoutPdos, ItStopsWhenTheDriverFallsSilent) {
  TracedScene scene(aloneJoint(GetParam()));
  ASSERT_NO_FATAL_FAILURE(begin(scene));
  sendOff(scene);
  loseFrames(scene, 0x77F);
  loseFrames(scene, 0x604);
  scene.run(1500ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(
    All, WithoutPdos,
    testing::Values(Alone{kDamiao, "cyclic_position"}, Alone{kDamiao, "position_velocity_torque"},
                    Alone{kDamiao, "velocity_torque"}, Alone{kDamiao, "profile_torque"},
                    Alone{"generic_cia402", "profile_position"},
                    Alone{"generic_cia402", "cyclic_velocity"}),
    [](const auto& tested) { return std::string(tested.param.family) + "_" + tested.param.mode; });

// An object that the drive has not and says nothing of is waited for meanwhile, 0.5 s and more.
TEST(WithoutPdosBeside, AQuickStopWaitsForNoOtherTransfer) {
  const std::string drive = ", simulation: {with: {communication: {silent_on_missing: true}}}";
  for (const char* mode : {"velocity_torque", "position_velocity"}) {
    Scene scene(loadText(aloneJoint({kDamiao, mode}, drive)));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    enableJoint(scene);
    if (scene.state("joint").mode->kind == ControlKind::velocity) {
      scene.stream("joint", 0.7, 500ms);
    } else {
      ASSERT_EQ(scene.setpoint("joint", 2.0), "");
      scene.run(600ms);
    }
    const double speed = scene.velocity("joint");
    ASSERT_GT(speed, 0.5);
    (void)scene.ask(bus::ReadObjectCommand{"joint", "2FFF:00"});
    scene.run(20ms);
    const double from = scene.position("joint");
    const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
    EXPECT_TRUE(stopped.success) << stopped.message;
    EXPECT_LT(scene.position("joint") - from, 0.05 * speed + 1.2 * speed * speed / 16.0) << mode;
  }
}

// It stops the axis, which is heard no more while it is waited for, but loses no drive.
TEST(WithoutPdosBeside, AnObjectThatIsNotThereLosesNoDrive) {
  Scene scene(loadText(aloneJoint({kDamiao, "cyclic_position"},
                                  ", simulation: {with: {communication: {silent_on_missing: "
                                  "true}}}")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  enableJoint(scene);
  const auto read = scene.call(bus::ReadObjectCommand{"joint", "2FFF:00"});
  EXPECT_FALSE(read.success);
  scene.run(1s);
  EXPECT_EQ(scene.told().find("answers no SDO"), std::string::npos) << scene.told();
  EXPECT_EQ(scene.node("joint").health(), fieldbus::Health::ready);
}

TEST(WithoutPdosBeside, OthersHaveTheirs) {
  Scene scene(loadText(
      busRobot(busAxis(kBusDamiao, "alone", 1, kNoPdos) + busAxis(kBusDamiao, "other", 2))));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  for (const char* name : {"alone", "other"}) enableJoint(scene, name);
  for (const char* name : {"alone", "other"}) expectGoes(scene, 0.4, name);
}

TEST(WithoutPdosOf, ADeviceOfTwoAxesAreRefused) {
  EXPECT_THAT(problemsOfRobot(busJoint(kBusDamiao, ", pdos: nothing")),
              HasSubstr("axes/joint/pdos"));
}

}  // namespace
}  // namespace cia402
