// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A stream of efforts that ends, or is taken away: what brakes the motor.
#include <deque>

#include "system/field_profile.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// The modes that push: effort, and what ends a stream of it.
struct Effort {
  const char* name;
  std::string yaml;
  const char* mode;
  double effort;       ///< N m, that moves the axis
  bool stays_enabled;  ///< the mode has a brake of its own
  bool waits = false;  ///< braked by another mode, which holds until the axis is enabled
  friend std::ostream& operator<<(std::ostream& out, const Effort& effort) {
    return out << effort.name;
  }
};

std::string withModes(std::string yaml, const char* modes) {
  const std::size_t at = yaml.find("mode: cyclic_position");
  return yaml.replace(at, 21, std::string("mode: cyclic_position, modes: [") + modes + "]");
}

const std::string kModeObject = "mode_of_operation: {object: \"6060:00\", type: int8, pdo: ";

/// A generic drive whose torques csv brakes. @param value of csv for 6060h @param travels 6060h may
/// be in an RPDO
std::string brakedByVelocity(int value = 9, bool travels = true) {
  std::string profile = genericProfileText();
  const std::size_t mode = profile.find(kModeObject + "rpdo}");
  EXPECT_NE(mode, std::string::npos);
  if (!travels) profile.replace(mode, kModeObject.size() + 5, kModeObject + "none}");
  const std::string csv = "  cyclic_velocity:\n    value: ";
  profile.replace(profile.find(csv) + csv.size(), 1, std::to_string(value));
  const std::string torque = "    target: target_torque\n    status_bits: {follows_command: 12}\n";
  profile.replace(profile.find(torque), torque.size(),
                  torque + "    stop: mode\n    stop_mode: csv\n");
  const std::string left =
      ", drive: " + writeProfile(profile) + ", simulation: {drive: generic_cia402}";
  return withModes(genericPair(left), "csp, cyclic_torque");
}

std::vector<Effort> efforts() {
  const char* generic = "csp, profile_torque, cyclic_torque";
  return {{"generic_pt", withModes(genericPair(), generic), "profile_torque", 6.0, true},
          {"generic_cst", withModes(genericPair(), generic), "cyclic_torque", 6.0, false},
          {"damiao_torque", withModes(damiaoJoint(), "csp, profile_torque"), "profile_torque", -0.2,
           false},
          {"generic_cst_braked_by_csv", brakedByVelocity(), "cyclic_torque", 6.0, true, true}};
}

class EffortMode : public testing::TestWithParam<Effort> {
 protected:
  explicit EffortMode(const std::string& more = {})
      : scene(GetParam().yaml + more), axis(scene.loaded().robot.axes[0].name) {
    EXPECT_TRUE(scene.boot()) << scene.told();
    const bus::Answer set = scene.procedure(ProcedureKind::set_mode, axis, GetParam().mode);
    EXPECT_TRUE(set.success) << set.message;
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable, axis);
    EXPECT_TRUE(enabled.success) << enabled.message;
    speedUp();
  }
  /// Pushes until the axis turns at half a radian a second.
  void speedUp() {
    EXPECT_TRUE(scene.runUntil(
        [&] {
          EXPECT_EQ(scene.setpoint(axis, GetParam().effort), "");
          return std::abs(scene.velocity(axis)) > 0.5;
        },
        5s))
        << scene.velocity(axis);
    scene.forget();
  }
  /// v²/2a by the slower of the two ramps, and what passes until the brake begins.
  double wayToRest(double reaction_s) const {
    const double slowest = *scene.loaded().robot.axes[0].limits.acceleration;
    const double speed = *scene.loaded().robot.axes[0].limits.velocity;  // until the effort goes
    return speed * speed / (2.0 * slowest) + speed * reaction_s;
  }
  struct Loaded : Scene {
    explicit Loaded(const std::string& yaml) : Scene(loadText(yaml)) {}
  };
  Loaded scene;
  std::string axis;
};

TEST_P(EffortMode, TheEndOfTheStreamBrakes) {
  scene.run(3s);
  EXPECT_LT(scene.seen(axis).travel(), wayToRest(0.25)) << scene.told();
  EXPECT_EQ(scene.truth(axis).power_stage_on, GetParam().stays_enabled);
  scene.forget();
  scene.run(1s);
  EXPECT_LT(scene.seen(axis).travel(), 1e-3);
}

TEST_P(EffortMode, AHaltBrakesAndIsAnsweredAtRest) {
  const bus::Answer answer = scene.procedure(ProcedureKind::halt, axis);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_LT(std::abs(scene.velocity(axis)), 0.02) << answer.message;
  EXPECT_LT(scene.seen(axis).travel(), wayToRest(0.05));
  EXPECT_EQ(scene.truth(axis).power_stage_on, GetParam().stays_enabled) << answer.message;
}

TEST_P(EffortMode, AnEffortAfterTheBrakeMovesAgainWhereItStaysEnabled) {
  scene.run(2s);
  if (!GetParam().stays_enabled || GetParam().waits) {
    EXPECT_NE(scene.setpoint(axis, GetParam().effort), "");
    EXPECT_TRUE(scene.procedure(ProcedureKind::enable, axis).success);
  }
  speedUp();
}

/// Pushes the left axis until it turns. @return false if it does not
bool pushed(Scene& scene) {
  return scene.runUntil(
      [&] {
        EXPECT_EQ(scene.setpoint("left", 6.0), "");
        return std::abs(scene.velocity("left")) > 0.5;
      },
      5s);
}

TEST(SetPoints, AnEffortIsBrakedByAnotherModeByItsRampAndHeldThere) {
  Scene scene(loadText(brakedByVelocity()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "cst").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(pushed(scene));
  std::deque<double> speeds;
  double hardest = 0.0;  // rad/s lost within 20 ms: what is measured is a cycle or two old
  scene.watch([&] {
    speeds.push_back(std::abs(scene.velocity("left")));
    if (speeds.size() > 20) speeds.pop_front();
    hardest = std::max(hardest, speeds.front() - speeds.back());
  });
  scene.run(1s);
  const double limit = *scene.loaded().robot.axes[0].limits.acceleration;
  EXPECT_GT(hardest, 0.5 * limit * 0.02);
  EXPECT_LT(hardest, 1.5 * limit * 0.02) << "it is braked by a ramp and not by a leap";
  EXPECT_EQ(scene.axis("left").modeName(), "cyclic_velocity");
  EXPECT_TRUE(scene.state("left").halted);
  EXPECT_THAT(scene.told(), HasSubstr("braked and held by mode cyclic_velocity"));
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  scene.forget();
  scene.run(1s);
  EXPECT_LT(scene.seen("left").travel(), 1e-4);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.axis("left").modeName(), "cyclic_torque");
  EXPECT_TRUE(pushed(scene));
}

void expectBrakedByVelocity(Scene& scene) {
  ASSERT_TRUE(pushed(scene));
  scene.run(1s);
  EXPECT_LT(std::abs(scene.velocity("left")), 1e-3);
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_THAT(scene.told(), HasSubstr("braked and held by mode cyclic_velocity"));
}

// The mode travels with the targets: nothing has to be answered.
TEST(SetPoints, AnEffortIsBrakedByVelocityWhereNoSdoIsAnswered) {
  Scene scene(loadText(brakedByVelocity()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "cst").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  scene.inject("left", "sdo_silent");
  expectBrakedByVelocity(scene);
}

// The profile says that 6060h may be mapped, the drive does not take it: then it is written.
TEST(SetPoints, AnEffortIsBrakedByVelocityWhereTheModeCannotTravel) {
  std::string yaml = brakedByVelocity();
  const std::string drive = "simulation: {drive: generic_cia402";
  yaml.insert(yaml.find(drive) + drive.size(),
              ", with: {dictionary: [[0x6060, 0, mode_of_operation, int8, rw, -, 0]]}");
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(scene.told(), HasSubstr("6060:00 mode_of_operation"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "cst").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  expectBrakedByVelocity(scene);
}

TEST(SetPoints, AnEffortWhoseBrakeTheDriveDoesNotTakeEndsInAQuickStop) {
  for (const bool mute : {false, true}) {
    // The drive has no mode 11; the mode of a mute one is written.
    Scene scene(loadText(brakedByVelocity(mute ? 9 : 11, !mute)));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "cst").success);
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
    if (mute) scene.inject("left", "sdo_silent");
    ASSERT_TRUE(pushed(scene));
    scene.run(3s);
    EXPECT_THAT(scene.told(), HasSubstr(mute ? "(6060:00 = 9), which is to brake, was not taken"
                                             : "(6060:00 = 11), which is to brake, was not taken"));
    EXPECT_THAT(scene.told(), HasSubstr("quick stop is commanded"));
    EXPECT_FALSE(scene.truth("left").power_stage_on);
    EXPECT_LT(std::abs(scene.velocity("left")), 1e-3);
  }
}

TEST(SetPoints, TheModeThatBrakesTheOneToStartInIsPlannedWithIt) {
  std::string yaml = brakedByVelocity();
  const std::string modes = "mode: cyclic_position, modes: [csp, cyclic_torque]";
  yaml.replace(yaml.find(modes), modes.size(), "mode: cyclic_torque, modes: [csp]");
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(pushed(scene));
  scene.run(1s);
  EXPECT_TRUE(scene.truth("left").power_stage_on) << scene.told();
  EXPECT_LT(std::abs(scene.velocity("left")), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Modes, EffortMode, testing::ValuesIn(efforts()),
                         [](const auto& tested) { return tested.param.name; });

TEST(SetPoints, AHomingBeginsAfterAnEffortWasBraked) {
  Scene scene(loadText(withModes(genericPair(", homing: {method: 34, search_velocity: 0.5}"),
                                 "csp, profile_torque, homing")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "profile_torque").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(scene.runUntil(
      [&] {
        EXPECT_EQ(scene.setpoint("left", 6.0), "");
        return std::abs(scene.velocity("left")) > 0.3;
      },
      5s));
  scene.run(2s);
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  EXPECT_TRUE(homed.success) << homed.message;
}

TEST(SetPoints, AnEffortStreamCoastsWhereThatIsAskedFor) {
  Scene scene(
      loadText(withModes(genericPair(", command_timeout_action: coast"), "csp, cyclic_torque")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "cst").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(scene.runUntil(
      [&] {
        EXPECT_EQ(scene.setpoint("left", 6.0), "");
        return std::abs(scene.velocity("left")) > 0.5;
      },
      5s));
  scene.run(2s);
  EXPECT_TRUE(scene.truth("left").power_stage_on);
}

}  // namespace
}  // namespace cia402
