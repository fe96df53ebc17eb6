// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive without a mode for a stream of positions, led to them by velocities or by set-points: how
// closely the motor follows, beside drives that have such a mode, and what becomes of velocities
// where the driver is late. What the joint does is read from the motor.
#include <deque>

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

/// A limit switch that bounces stops the motor, and lets it go on behind its set-points, which move
/// as fast as it may. It is behind them until they come to rest. While they brake by the limit it
/// catches up, and is braked by twice that at most.
TEST(PositionByVelocity, BrakesByItsLimitThoughItWasHeldBack) {
  constexpr double kRamp = 2.0;  // rad/s^2
  for (const Duration held : {180ms, 200ms, 220ms}) {
    FamilyScene scene(replaced(familyJoint(kLed), "acceleration: 4.0", "acceleration: 2.0"));
    ASSERT_EQ(scene.setpoint("joint", 1.5), "");
    scene.run(450ms);
    ASSERT_GT(scene.velocity("joint"), 0.7);
    double& limit = scene.drive("joint").mechanics(0).positive_limit_switch;
    const double before = std::exchange(limit, scene.truth("joint").position_turns);
    scene.run(held);
    limit = before;
    scene.run(400ms);  // it catches up as its drive can
    ASSERT_GT(scene.axis("joint").target() - scene.position("joint"), 0.03) << "far behind";
    std::deque<double> speeds;
    double hardest = 0.0;
    for (int ms = 0; ms < 4000; ++ms) {
      scene.run(1ms);
      speeds.push_back(scene.velocity("joint"));
      if (speeds.size() <= 20) continue;
      hardest = std::max(hardest, std::fabs(speeds.back() - speeds.front()) / 0.02);
      speeds.pop_front();
    }
    EXPECT_LT(hardest, 2.0 * kRamp) << toSeconds(held);
    EXPECT_NEAR(scene.position("joint"), 1.5, oneCount(kLed)) << toSeconds(held);
    EXPECT_LT(scene.seen("joint").highest, 1.5 + 1.5 * oneCount(kLed)) << toSeconds(held);
  }
}

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
