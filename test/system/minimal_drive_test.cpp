// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// generic_cia402 on a drive that has the mandatory objects of one mode and nothing else.
#include <sstream>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string withMinimal(const std::string& more = {}) {
  return genericPair(", simulation: {drive: generic_cia402_minimal}" + more);
}

/// The lines told of node 1 that hold `words`.
std::vector<std::string> linesWith(Scene& scene, bus::Event::Severity severity,
                                   const std::string& words = "node 1") {
  std::vector<std::string> lines;
  for (const bus::Event& event : scene.robot().events()) {
    const std::string text = event.text.str();
    if (event.severity == severity && text.find("node 1") != std::string::npos &&
        text.find(words) != std::string::npos) {
      lines.push_back(text);
    }
  }
  return lines;
}

TEST(MinimalDrive, RunsATrajectory) {
  Scene scene(loadText(withMinimal()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  const bus::Answer moved = scene.move({0.8, -0.5}, 2s);
  ASSERT_TRUE(moved.success) << moved.message;
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 0.8, 0.001);
  EXPECT_NEAR(scene.position("right"), -0.5, 0.001);
  EXPECT_NEAR(scene.state("left").position, 0.8, 0.001);
  EXPECT_TRUE(std::isnan(scene.state("left").velocity)) << "it does not tell it";
  EXPECT_LT(std::abs(scene.state("left").following_error), 0.001) << "set-point minus position";
  EXPECT_TRUE(linesWith(scene, bus::Event::Severity::error).empty()) << scene.told();
}

// A servo in canopen-python/canopen#306 answers nothing where it should abort.
TEST(MinimalDrive, ThatSaysNothingOfMissingObjectsRunsATrajectory) {
  Scene scene(
      loadText(genericPair(", simulation: {drive: generic_cia402_minimal, "
                           "with: {communication: {silent_on_missing: true}}}")));
  // Each of its twenty silences takes 1.5 s: three requests without an answer.
  ASSERT_TRUE(scene.boot(120s)) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  ASSERT_TRUE(scene.move({0.8, -0.5}, 2s).success);
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 0.8, 0.001);
  EXPECT_NEAR(scene.position("right"), -0.5, 0.001);
  const auto lines = linesWith(scene, bus::Event::Severity::warning, "only defaults ask for");
  ASSERT_EQ(lines.size(), 1u) << scene.told();
  EXPECT_THAT(lines[0],
              AllOf(HasSubstr("606C:00 velocity_actual"), HasSubstr("6081:00 profile_velocity"),
                    HasSubstr("60FF:00 target_velocity"), Not(HasSubstr("6040:00"))));
  EXPECT_TRUE(linesWith(scene, bus::Event::Severity::error).empty()) << scene.told();
}

TEST(MinimalDrive, IsStoppedLikeAnyOther) {
  Scene scene(loadText(withMinimal()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (const ProcedureKind stop :
       {ProcedureKind::halt, ProcedureKind::quick_stop, ProcedureKind::disable}) {
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    const double goal = scene.position("left") > 0.0 ? -0.8 : 0.8;
    ASSERT_TRUE(scene.move({goal, 0.0}, 3s).success);
    scene.run(1s);
    ASSERT_GT(std::abs(scene.velocity("left")), 0.1);
    const bus::Answer answer = scene.procedure(stop);
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_LT(std::abs(scene.velocity("left")), 0.01) << toString(stop);
    ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
    scene.run(500ms);
  }
}

TEST(MinimalDrive, TellsOnceWhatItLacksAndTheKeyThatSaysSo) {
  Scene scene(loadText(withMinimal()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(1s);
  const auto lines = linesWith(scene, bus::Event::Severity::warning, "only defaults ask for");
  ASSERT_EQ(lines.size(), 1u) << scene.told();
  EXPECT_THAT(lines[0],
              AllOf(HasSubstr("left (node 1)"), HasSubstr("606C:00 velocity_actual"),
                    HasSubstr("6081:00 profile_velocity"), HasSubstr("60FF:00 target_velocity"),
                    HasSubstr("`lacks` of axes/left")));
  EXPECT_THAT(lines[0], Not(HasSubstr("6040:00")));
}

TEST(MinimalDrive, IsNotAskedForWhatItIsSaidToLack) {
  Scene scene(loadText(withMinimal(
      ", lacks: [velocity_actual, torque_actual, error_code, digital_inputs, following_error, "
      "profile_velocity, profile_acceleration, profile_deceleration, quick_stop_deceleration, "
      "target_velocity]")));
  bool asked = false;  // of node 1, for 606Ch or 60F4h
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id != 0x601) return;
    const unsigned index = frame.data[1] | unsigned{frame.data[2]} << 8;
    asked = asked || index == 0x606C || index == 0x60F4 || index == 0x6081;
  });
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(2s);
  EXPECT_FALSE(asked);
  EXPECT_TRUE(linesWith(scene, bus::Event::Severity::warning, "only defaults ask for").empty())
      << scene.told();
}

TEST(MinimalDrive, RefusesAModeOfWhichItHasNoTarget) {
  Scene scene(loadText(withMinimal()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, "left", "csv");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("cyclic_velocity cannot be used"), HasSubstr("60FF:00")));
}

TEST(MinimalDrive, FailsWhereWhatItLacksIsAskedForByName) {
  for (const char* asked : {", feedback: [velocity_actual]", ", modes: [csp, csv]",
                            ", write: [{object: profile_velocity, value: 1.0}]"}) {
    Scene scene(loadText(withMinimal(asked)));
    EXPECT_FALSE(scene.boot()) << asked;
    const auto lines = linesWith(scene, bus::Event::Severity::error, "boot failed");
    ASSERT_FALSE(lines.empty()) << asked;
    EXPECT_THAT(lines[0], HasSubstr("the drive refused")) << asked;
  }
}

TEST(MinimalDrive, ComesBackAfterAPowerCycle) {
  Scene scene(loadText(withMinimal()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.inject("left", "power_cycle");
  scene.run(3s);
  const bus::Answer answer = scene.procedure(ProcedureKind::recover);
  ASSERT_TRUE(answer.success) << answer.message;
  ASSERT_TRUE(scene.move({0.3, 0.3}, 1s).success);
  scene.run(2s);
  EXPECT_NEAR(scene.position("left") - scene.state("left").position, 0.0, 1.0);
  EXPECT_NEAR(scene.state("left").position, 0.3, 0.001);
}

// --- The other modes
// -------------------------------------------------------------------------------

/// One mode, and what CiA 402-2 demands of a drive that has it beside 6040h, 6041h, 6060h, 6061h;
/// 6064h, for the driver needs to know where the joint is.
struct MinimalMode {
  const char* name;
  const char* mode;
  int value;
  const char* behaviour;
  const char* objects;
};

void PrintTo(const MinimalMode& mode, std::ostream* out) { *out << mode.name; }

constexpr MinimalMode kProfilePosition{"ProfilePosition", "pp", 1, "profile_position",
                                       "0x607A 0x6081 0x6083 0x6086"};
// 6044h is demanded, too, but nobody here asks for it.
constexpr MinimalMode kVelocity{"Velocity", "vl", 2, "velocity",
                                "0x6042 0x6043 0x6046 0x6048 0x6049"};
constexpr MinimalMode kProfileVelocity{"ProfileVelocity", "pv", 3, "profile_velocity",
                                       "0x60FF 0x606B 0x606C 0x6083 0x6086"};
constexpr MinimalMode kProfileTorque{"ProfileTorque", "pt", 4, "profile_torque", "0x6071 0x6087"};
constexpr MinimalMode kInterpolatedPosition{"InterpolatedPosition", "ip", 7,
                                            "interpolated_position", "0x60C1"};
constexpr MinimalMode kCyclicPosition{"CyclicPosition", "csp", 8, "cyclic_position", "0x607A"};
constexpr MinimalMode kCyclicVelocity{"CyclicVelocity", "csv", 9, "cyclic_velocity",
                                      "0x60FF 0x606C"};
constexpr MinimalMode kCyclicTorque{"CyclicTorque", "cst", 10, "cyclic_torque", "0x6071"};

/// All that the simulated generic drive has and CiA 301 and 402 demand of nobody.
constexpr char kOptional[] =
    "0x1003 0x1006 0x1007 0x1008 0x1009 0x100A 0x1010 0x1011 0x1012 0x1015 0x1016 0x1019 0x1020 "
    "0x1029 0x1200 0x6007 0x603F 0x6042 0x6043 0x6046 0x6048 0x6049 0x604A 0x605A 0x605B 0x605C "
    "0x605D 0x605E 0x6062 0x6063 0x6065 0x6066 "
    "0x6067 0x6068 0x606B 0x606C 0x606D 0x606E 0x606F 0x6070 0x6071 0x6072 0x6076 0x6077 0x607A "
    "0x607C 0x607D 0x607F 0x6080 0x6081 0x6083 0x6084 0x6085 0x6086 0x6087 0x6098 0x6099 0x609A "
    "0x60C1 0x60C2 0x60F4 0x60FC 0x60FD 0x60FE 0x60FF 0x6502 0x67FF";

/// The pair, the left drive with what one mode demands, and with `homing` what homing demands.
std::string onlyWith(const MinimalMode& mode, bool homing, const std::string& more = {}) {
  const std::string kept = std::string(mode.objects) + (homing ? " 0x6098 0x6099" : "");
  std::istringstream all(kOptional);
  std::string without =
      "0x1400, 0x1401, 0x1402, 0x1403, 0x1600, 0x1601, 0x1602, 0x1603, 0x1800, "
      "0x1801, 0x1802, 0x1803, 0x1A00, 0x1A01, 0x1A02, 0x1A03";
  for (std::string index; all >> index;) {
    if (kept.find(index) == std::string::npos) without += ", " + index;
  }
  return genericPair(
      std::string(", mode: ") + mode.mode +
      ", unwatched_streams: true, simulation: {drive: generic_cia402, lower_limit_switch: -1.0, "
      "with: {without: [" +
      without + "], dictionary: [{rpdos: {count: 1, types: 255, maps: [[0x60400010]]}}, " +
      "{tpdos: {count: 1, types: 255, maps: [[0x60410010]]}}], modes: {0: {behaviour: hold}, " +
      std::to_string(mode.value) + ": {behaviour: " + mode.behaviour + "}" +
      (homing ? ", 6: {behaviour: homing}" : "") + "}}}" + more);
}

class MinimalDriveOf : public testing::TestWithParam<MinimalMode> {
 protected:
  /// Moves the left axis the way its mode does. @return by how much the motor went
  static double moved(Scene& scene) {
    const std::string mode = GetParam().mode;
    const double from = scene.position("left");
    if (mode == "csp" || mode == "ip") {
      EXPECT_TRUE(scene.move({scene.state("left").position + 0.4, 0.0}, 1s).success);
      scene.run(2s);
    } else if (mode == "pp") {
      EXPECT_EQ(scene.setpoint("left", scene.state("left").position + 0.4), "");
      scene.run(4s);
    } else if (mode == "vl" || mode == "pv" || mode == "csv") {
      scene.stream("left", 0.4, 1s);
      scene.run(1s);
    } else {
      scene.stream("left", 20.0, 400ms);
      scene.stream("left", 0.0, 3s);  // friction ends it
    }
    return scene.position("left") - from;
  }
};

TEST_P(MinimalDriveOf, BootsEnablesAndMoves) {
  Scene scene(loadText(onlyWith(GetParam(), false)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  const double by = moved(scene);
  const int mode = GetParam().value;
  const bool positions = mode == 1 || mode == 7 || mode == 8;
  if (positions) {
    EXPECT_NEAR(by, 0.4, 0.001) << scene.told();
  }
  EXPECT_GT(by, 0.1) << scene.told();
  EXPECT_LT(std::abs(scene.velocity("left")), 0.01) << "it comes to rest";
  EXPECT_NEAR(scene.state("left").position, scene.position("left"), 0.001);
  EXPECT_TRUE(linesWith(scene, bus::Event::Severity::error).empty()) << scene.told();
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

// 607Ch and 609Ah are optional in homing mode, 6098h and 6099h are not.
TEST_P(MinimalDriveOf, HomesWithoutAnOffsetThatNobodyConfigured) {
  Scene scene(loadText(onlyWith(
      GetParam(), true, ", homing: {method: 17, search_velocity: 0.5, zero_velocity: 0.1}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(homed.success) << homed.message;
  // The switch is the home position; the joint reads 0 there, and stands where it came to rest.
  EXPECT_NEAR(scene.state("left").position, scene.position("left") + 1.0, 0.002);
  EXPECT_NEAR(scene.position("left"), -1.0, 0.02);
  const auto lines = linesWith(scene, bus::Event::Severity::warning, "607C:00");
  ASSERT_EQ(lines.size(), 1u) << scene.told();
  EXPECT_THAT(lines[0], HasSubstr("`lacks: [home_offset]` of axes/left"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
  EXPECT_GT(moved(scene), 0.1) << scene.told();
  const bus::Answer again = scene.procedure(ProcedureKind::home, "left");
  EXPECT_TRUE(again.success) << again.message;
  EXPECT_EQ(linesWith(scene, bus::Event::Severity::warning, "607C:00").size(), 1u) << "said once";
}

INSTANTIATE_TEST_SUITE_P(Modes, MinimalDriveOf,
                         testing::Values(kProfilePosition, kVelocity, kProfileVelocity,
                                         kProfileTorque, kInterpolatedPosition, kCyclicPosition,
                                         kCyclicVelocity, kCyclicTorque),
                         [](const auto& param) { return std::string(param.param.name); });

constexpr char kHoming[] = ", homing: {method: 17, search_velocity: 0.5, zero_velocity: 0.1";

TEST(MinimalDriveHoming, CountsTheOffsetItselfWhereTheDriveIsSaidToLackIt) {
  Scene scene(loadText(onlyWith(kCyclicPosition, true,
                                kHoming + std::string(", offset: 0.7}, lacks: [home_offset]"))));
  bool asked = false;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x601) asked = asked || (frame.data[1] == 0x7C && frame.data[2] == 0x60);
  });
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.state("left").position - 0.7, scene.position("left") + 1.0, 0.002);
  EXPECT_FALSE(asked) << "607Ch";
  EXPECT_TRUE(linesWith(scene, bus::Event::Severity::warning, "607C:00").empty());
}

// 65,536 counts are half a turn of the motor, 0.031416 rad of the joint.
TEST(MinimalDriveHoming, TakesTheOffsetThatTheDriveDoesNotLetWrite) {
  Scene scene(loadText(genericPair(
      std::string(", simulation: {drive: generic_cia402, lower_limit_switch: -1.0, with: "
                  "{dictionary: [[0x607C, 0, home_offset, int32, ro, \"-\", 65536]]}}") +
      kHoming + "}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.state("left").position, scene.position("left") + 1.0, 0.002);
  EXPECT_EQ(linesWith(scene, bus::Event::Severity::warning, "607C:00").size(), 1u) << scene.told();
}

TEST(MinimalDriveHoming, FailsWhereAnOffsetIsAskedForThatTheDriveDoesNotTake) {
  Scene scene(loadText(onlyWith(kCyclicPosition, true, kHoming + std::string(", offset: 0.7}"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, AllOf(HasSubstr("607C:00"), HasSubstr("0x06020000"),
                                   HasSubstr("`lacks: [home_offset]` of axes/left")));
}

TEST(MinimalDriveHoming, FailsWhereAnAccelerationIsAskedForThatTheDriveDoesNotTake) {
  Scene scene(
      loadText(onlyWith(kCyclicPosition, true, kHoming + std::string(", acceleration: 4.0}"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, AllOf(HasSubstr("609A:00"), HasSubstr("0x06020000")));
}

}  // namespace
}  // namespace cia402
