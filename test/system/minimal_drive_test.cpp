// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// generic_cia402 on a drive that has the mandatory objects of one mode and nothing else.
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

}  // namespace
}  // namespace cia402
