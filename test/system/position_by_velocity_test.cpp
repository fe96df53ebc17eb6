// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive without a mode for a stream of positions, led to them by velocities or by set-points: how
// closely the motor follows, beside drives that have such a mode, and what becomes of velocities
// where the driver is late. What the joint does is read from the motor.
#include "system/followed_path.h"
#include "system/late_joint.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

constexpr FamilyMode kLed{kId286Cnfa, "10000", "position_by_velocity"},
    kBySetPoints{kId286Cnfa, "10000", "position_by_set_points"};

class Followed : public testing::TestWithParam<FamilyMode> {};

TEST_P(Followed, TrajectoriesAreKeptTo) {
  FamilyScene scene(familyJoint(GetParam()));
  const double worst = worstOffSinePath(scene, "joint");
  RecordProperty("worst_rad", std::to_string(worst));
  const bool led = std::string(GetParam().family) == kId286Cnfa;
  EXPECT_LT(worst, led ? 6e-3 : 4e-3) << scene.told();
  EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.02);
}

INSTANTIATE_TEST_SUITE_P(All, Followed,
                         testing::Values(kLed, kBySetPoints,
                                         FamilyMode{kNimotionStepper, "4000", "csp"},
                                         FamilyMode{kMegmeetDm5, "8388608", "csp"}),
                         familyModeName);

TEST(PositionByVelocity, HoldsTheJointWhereItsSetPointIs) {
  Scene scene(loadText(familyJoint(kLed)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({0.4}, 2s).success);
  scene.run(3s);
  scene.forget();
  scene.run(10s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-6) << "it hunts for its place";
  EXPECT_NEAR(scene.position("joint"), 0.4, oneCount(kLed));
}

class LatePositionByVelocity : public LateJoint {
 protected:
  LatePositionByVelocity() : LateJoint(kLed) {}
};

TEST_F(LatePositionByVelocity, IsBroughtToRestFromWhereItIsAndNotTurnedBack) {
  for (const Duration delay : {Duration(12ms), Duration(40ms), Duration(200ms)}) {
    SCOPED_TRACE(toSeconds(delay));
    ASSERT_NO_FATAL_FAILURE(begin());
    scene->forgetTold();
    const double before = place(), fast = speed();
    scene->stall(delay);
    const double after = place();
    ASSERT_GT(after - before, 0.9 * toSeconds(delay) * fast) << "the drive does not turn on alone";
    EXPECT_LT(backwards(3s), 5e-3);
    EXPECT_NEAR(speed(), 0.0, 1e-4);
    // The ramp of the limit, 4 rad/s^2, and the time until the first velocity of it comes.
    EXPECT_LT(place() - after, fast * 0.03 + 1.2 * fast * fast / 8.0);
    expectGivenUp();
  }
}

TEST_F(LatePositionByVelocity, StandsStillThroughADelayAtRest) {
  ASSERT_NO_FATAL_FAILURE(begin());
  expectStandsThroughADelay();
}

}  // namespace
}  // namespace cia402
