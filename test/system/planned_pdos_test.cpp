// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The plans of PDOs on simulated drives: every mode of both families, and the following error.
#include <fstream>
#include <iterator>

#include "folders.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// In the direction of a set-point of the mode that the axis is in, as the motor itself shows.
void expectToMove(Scene& scene, const std::string& axis, const std::string& what) {
  const double before = scene.position(axis);
  const drive::ModeSpec* mode = scene.state(axis).mode;
  ASSERT_NE(mode, nullptr) << what;
  if (mode->kind == drive::ControlKind::position) {
    EXPECT_EQ(scene.setpoint(axis, scene.state(axis).position + 0.1), "") << what;
    scene.run(1s);
    EXPECT_NEAR(scene.position(axis), before + 0.1, 1e-3) << what;
  } else {
    scene.stream(axis, mode->kind == drive::ControlKind::velocity ? 0.3 : 4.0, 200ms);
    EXPECT_GT(scene.position(axis), before + 0.003) << what;
  }
}

/// Homes where it stands, which is 0.5 rad then, and comes back to the mode that the axis was in.
void expectToHome(Scene& scene, const std::string& axis, const std::string& what) {
  const drive::ModeSpec* mode = scene.state(axis).mode;
  const auto homed = scene.procedure(ProcedureKind::home, axis);
  EXPECT_TRUE(homed.success) << what << ": " << homed.message;
  EXPECT_NEAR(scene.state(axis).position, 0.5, 1e-3) << what;
  EXPECT_TRUE(scene.state(axis).homed) << what;
  EXPECT_EQ(scene.state(axis).mode, mode) << what;
}

/// Boots the plan of every mode of a family, enables it there and moves. Homing, the seventh mode
/// of the generic drive, is none to begin in (test/config/robot_test.cpp): each homes.
TEST(PlannedPdos, OfEveryModeBootOnTheGenericDrive) {
  for (const char* mode : {"pp", "pv", "pt", "csp", "csv", "cst"}) {
    for (const char* modes : {"", ", modes: []", ", modes: [csp, csv]", ", feedback: []",
                              ", feedback: [following_error, digital_inputs, velocity_actual]"}) {
      std::string yaml =
          genericPair(", homing: {method: 37, offset: 0.5}, mode: " + std::string(mode) + modes);
      yaml.erase(yaml.find("groups:"));  // not every such axis could serve one
      Scene scene(loadText(yaml));
      ASSERT_TRUE(scene.boot()) << mode << modes << scene.told();
      const auto enabled = scene.procedure(ProcedureKind::enable, "left");
      EXPECT_TRUE(enabled.success) << mode << modes << ": " << enabled.message;
      EXPECT_EQ(scene.state("left").mode->name, drive::canonicalModeName(mode));
      expectToHome(scene, "left", std::string(mode) + modes);
      expectToMove(scene, "left", std::string(mode) + modes);
    }
  }
}

TEST(PlannedPdos, OfEveryModeBootOnTheDamiao) {
  for (const char* mode :
       {"profile_position", "position_velocity", "position_velocity_torque", "cyclic_position",
        "profile_velocity", "cyclic_velocity", "velocity_torque", "profile_torque"}) {
    for (const char* modes : {"", ", modes: []"}) {
      std::string yaml = damiaoJoint(modes);
      yaml.replace(yaml.find("mode: cyclic_position"), 21, "mode: " + std::string(mode));
      Scene scene(loadText(yaml));
      ASSERT_TRUE(scene.boot()) << mode << modes << scene.told();
      const auto enabled = scene.procedure(ProcedureKind::enable);
      EXPECT_TRUE(enabled.success) << mode << modes << ": " << enabled.message;
      EXPECT_EQ(scene.state("joint").mode->name, mode);
      expectToMove(scene, "joint", std::string(mode) + modes);
    }
  }
}

/// The largest following error that is told while the joint moves, and when it was told.
double mostFollowingError(Scene& scene, int looks_per_second) {
  double most = 0.0;
  const Duration pause = Duration(1s) / looks_per_second;
  for (Duration past{}; past < 3s; past += pause) {
    scene.axis("left").look();
    scene.run(pause);
    most = std::max(most, std::abs(scene.state("left").following_error));
  }
  return most;
}

/// SDO requests to node 1 for 60F4h, from now on.
void countRequests(Scene& scene, int& requests) {
  scene.world().bus().setMonitor([&requests](const can::Frame& frame, Time) {
    if (frame.id == 0x601 && frame.data[1] == 0xF4 && frame.data[2] == 0x60) ++requests;
  });
}

// The simulated drive lags behind its set-points by speed times time constant: 0.5 rad/s, 20 ms.
constexpr char kLag[] = "time_constant: 0.02";
constexpr double kMostError = 1.5 * 1.0 / 3.0 * 0.02;  // a cubic of 1 rad in 3 s

TEST(FollowingError, TravelsByPdoWhereThereIsRoomAndIsTheDrives) {
  Scene scene(loadText(genericPair(", simulation: {" + std::string(kLag) + "}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  int requests = 0;
  countRequests(scene, requests);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  EXPECT_NEAR(mostFollowingError(scene, 100), kMostError, 0.1 * kMostError);
  EXPECT_EQ(requests, 0);
  EXPECT_LE(scene.now() - scene.state("left").stamps.following_error, 44ms);
}

TEST(FollowingError, IsPolledWhereTheDriveDoesNotMapItAndNobodyIsWarned) {
  Scene scene(loadText(
      genericPair(", simulation: {" + std::string(kLag) +
                  ", with: {dictionary: [[0x60F4, 0, following_error, int32, ro, '-', 0]]}}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(scene.told(), testing::Not(HasSubstr("only defaults ask for")));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  int requests = 0;
  countRequests(scene, requests);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  EXPECT_NEAR(mostFollowingError(scene, 10), kMostError, 0.1 * kMostError);
  EXPECT_GT(requests, 10);
  EXPECT_TRUE(scene.state("left").digital_inputs_valid) << "what stands beside it still comes";
}

TEST(FollowingError, MayBeMissingInTheDrive) {
  Scene scene(loadText(genericPair(", simulation: {with: {without: [0x60F4]}}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(scene.told(), testing::Not(HasSubstr("only defaults ask for")));
  EXPECT_TRUE(std::isnan(scene.state("left").following_error));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  scene.run(4s);
  EXPECT_NEAR(scene.position("left"), 1.0, 0.001);
  EXPECT_LT(std::abs(scene.state("left").following_error), 0.001) << "set-point minus position";
  EXPECT_TRUE(scene.state("left").digital_inputs_valid);
}

TEST(PlannedPdos, AModeThatWasNotPlannedIsRefusedInWords) {
  Scene scene(loadText(genericPair(", modes: []")));
  ASSERT_TRUE(scene.boot());
  const auto refused = scene.procedure(ProcedureKind::set_mode, "left", "cyclic_velocity");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("name the mode in `modes:` of the axis"));
}

TEST(PlannedPdos, AGenericAxisAtRestNeedsOneFrameEachWayPerCycle) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  unsigned rpdos = 0, tpdos = 0, further_rpdos = 0, syncs = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x080) ++syncs;
    if (frame.id == 0x201) ++rpdos;
    if (frame.id == 0x301) ++further_rpdos;
    if (frame.id == 0x181) ++tpdos;
  });
  scene.run(2s);
  EXPECT_NEAR(rpdos, syncs, 1.0);
  EXPECT_NEAR(tpdos, syncs, 1.0);
  EXPECT_NEAR(further_rpdos, syncs / 10.0, 1.0);
}

}  // namespace
}  // namespace cia402
