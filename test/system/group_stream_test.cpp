// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Set-points for a whole group as its motors follow them, in the kinds of mode that there are.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr char kModes[] = ", modes: [csp, csv, cst]";

/// Gives the pair its set-points once. @return why it was refused; empty if not
std::string command(Scene& scene, std::vector<double> values) {
  const auto answer = scene.ask(bus::GroupSetpointsCommand{0, std::move(values)});
  return *answer ? (*answer)->message : std::string();
}

void streamPair(Scene& scene, const std::vector<double>& values, Duration duration) {
  const Time end = scene.now() + duration;
  while (scene.now() < end) {
    ASSERT_EQ(command(scene, values), "");
    scene.run(20ms);
  }
}

TEST(GroupStream, OfPositionsMovesAllMotorsFromTheSameMomentOn) {
  ReadyScene scene(genericPair(kModes, kModes));
  Time began[2] = {Time::max(), Time::max()};
  scene.watch([&] {
    for (std::size_t i = 0; i < 2; ++i) {
      if (std::abs(scene.velocity(i)) > 0.002) began[i] = std::min(began[i], scene.now());
    }
  });
  ASSERT_EQ(command(scene, {0.5, -0.8}), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("left"), 0.5, 1e-3);
  EXPECT_NEAR(scene.position("right"), -0.8, 1e-3);
  EXPECT_EQ(began[0], began[1]);
  EXPECT_LE(scene.seen("left").fastest, 1.5 * 1.01);
}

TEST(GroupStream, OfVelocitiesEndsAllMotorsWhenItIsNotRepeated) {
  ReadyScene scene(genericPair(kModes, kModes), "csv");
  streamPair(scene, {1.0, -0.6}, 1s);
  EXPECT_NEAR(scene.velocity("left"), 1.0, 0.02);
  EXPECT_NEAR(scene.velocity("right"), -0.6, 0.02);
  scene.run(200ms + 300ms + 20ms);  // command_timeout, 1 rad/s at 4 rad/s^2, and the motor's lag
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2);
  EXPECT_NEAR(scene.velocity("right"), 0.0, 1e-2);
  EXPECT_THAT(scene.told(),
              HasSubstr("left (node 1): its stream of velocities ended without a zero"));
}

TEST(GroupStream, OfEffortsPushesAllMotorsAndIsBraked) {
  ReadyScene scene(genericPair(kModes, kModes), "cst");
  streamPair(scene, {10.0, -10.0}, 200ms);
  EXPECT_GT(scene.velocity("left"), 0.02);
  EXPECT_LT(scene.velocity("right"), -0.02);
  scene.run(3s);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2) << scene.told();
  EXPECT_NEAR(scene.velocity("right"), 0.0, 1e-2);
}

TEST(GroupStream, MovesNoMotorWhereOneJointCannot) {
  ReadyScene scene(genericPair(kModes, kModes));
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "right").success);
  scene.forget();
  EXPECT_THAT(command(scene, {0.5, 0.5}), HasSubstr("right (node 2): not enabled"));
  EXPECT_THAT(command(scene, {0.5}), HasSubstr("1 came for 2 joints"));
  scene.run(500ms);
  expectNothingMoved(scene, "left");
  expectNothingMoved(scene, "right");
}

TEST(GroupStream, ALostJointEndsTheVelocitiesOfAll) {
  ReadyScene scene(genericPair(kModes, kModes), "csv");
  streamPair(scene, {1.0, 1.0}, 500ms);
  scene.inject("right", "overcurrent");
  scene.run(20ms);
  for (int i = 0; i < 30; ++i) {
    EXPECT_NE(command(scene, {1.0, 1.0}), "");
    scene.run(20ms);
  }
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2) << "nothing was taken for it either";
}

}  // namespace
}  // namespace cia402
