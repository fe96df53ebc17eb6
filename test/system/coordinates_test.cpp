// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The limits that a drive keeps (607Dh) count from its own zero. Whatever that zero is: enabling
// moves nothing, and motion ends where it was told to.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

TEST(Coordinates, MinusZeroIsNeverSentBackToTheDrive) {
  LoadedRobot loaded = loadText(damiaoJoint());
  loaded.axes[0].mechanics.initial_position = -0.0;
  Scene scene(std::move(loaded));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_EQ(scene.drive("joint").dictionary().find({0x6064, 0})->number, 0x80000000u);
  const auto recovered = scene.procedure(ProcedureKind::recover);
  EXPECT_TRUE(recovered.success) << recovered.message;
  scene.run(200ms);
  EXPECT_EQ(scene.badFloats(), 0u);
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
}

TEST(Coordinates, AGoalThatTheDriveDidNotReachIsNotCalledReached) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  // Somebody else's limit in the drive: +0.6 rad.
  scene.drive("left").dictionary().find({0x607D, 2})->number = 1251645;
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  scene.run(6s);
  ASSERT_NEAR(scene.position("left"), 0.6, 1e-3) << "the drive clamps";
  EXPECT_THAT(scene.told(), Not(HasSubstr("goal reached")));
  EXPECT_THAT(scene.told(), HasSubstr("left"));
}

}  // namespace
}  // namespace cia402
