// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive without a mode for a stream of positions, led to them by velocities: how closely the
// motor follows, beside drives that have such a mode, and what becomes of it where the driver is
// late. What the joint does is read from the motor.
#include <cmath>

#include "system/families_motion.h"
#include "system/interface_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;
using testing::Not;

constexpr double kPi = 3.14159265358979;
constexpr double kPerTurn = 2.0 * kPi / 50.0;  // rad of the joint
constexpr FamilyMode kLed{kId286Cnfa, "10000", "position_by_velocity"};

/// A sine of 0.5 rad and 0.25 Hz, which begins gently.
double sine(double t) {
  const double begun = std::min(1.0, t / 3.0);
  return begun * begun * 0.5 * std::sin(2.0 * kPi * 0.25 * t);
}

class Followed : public testing::TestWithParam<FamilyMode> {};

/// Largest distance of the motor from the path, and from where the path was two cycles ago, which
/// is where a motor is that does at once what it is told.
TEST_P(Followed, TrajectoriesAreKeptTo) {
  Scene scene(loadText(familyJoint(GetParam())));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  bus::TrajectoryCommand trajectory;
  trajectory.group = scene.loaded().robot.groups[0].name;
  trajectory.joints = scene.loaded().robot.groups[0].joints;
  for (int i = 1; i <= 600; ++i) {
    const double t = 0.02 * i;
    trajectory.points.push_back({{sine(t)}, {}, {}, fromSeconds(t)});
  }
  const Time begin = scene.now();
  ASSERT_TRUE(scene.call(std::move(trajectory)).success) << scene.told();
  double worst = 0.0;
  scene.watch([&] {
    const double t = toSeconds(scene.now() - begin) - 0.012;
    if (t > 0.1 && t < 11.9) worst = std::max(worst, std::fabs(scene.position("joint") - sine(t)));
  });
  scene.run(13s);
  RecordProperty("worst_rad", std::to_string(worst));
  EXPECT_LT(worst, GetParam().mode == kLed.mode ? 6e-3 : 4e-3) << scene.told();
  EXPECT_NEAR(scene.position("joint"), sine(12.0), 2e-4) << scene.told();
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-4);
  EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.02);
}

INSTANTIATE_TEST_SUITE_P(All, Followed,
                         testing::Values(kLed, FamilyMode{kNimotionStepper, "4000", "csp"},
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
  EXPECT_NEAR(scene.position("joint"), 0.4, kPerTurn / 10000.0);
}

/// As a robot of one joint, whose driver's thread can be held up.
class LatePositionByVelocity : public testing::Test {
 protected:
  void begin() {
    scene.emplace(loadText(familyJoint(kLed)), sim::BusInterface::Options());
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 20s)) << scene->told();
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success) << scene->told();
    ASSERT_TRUE(scene->move({1.0}, 2s).success) << scene->told();
    scene->run(1s);
    ASSERT_GT(speed(), 0.5);
  }
  double speed() { return scene->truth(0).velocity_turns * kPerTurn; }
  double place() { return scene->truth(0).position_turns * kPerTurn; }
  /// Runs on, and says how fast it went back at most.
  double backwards(Duration duration) {
    double back = 0.0;
    for (const Time end = scene->now() + duration; scene->now() < end;) {
      scene->run(500us);
      back = std::max(back, -speed());
    }
    return back;
  }
  std::optional<InterfaceScene> scene;
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
    EXPECT_THAT(scene->told(), HasSubstr("cycles were missed while it moved"));
    EXPECT_THAT(scene->told(), HasSubstr("trajectory stopped"));
    EXPECT_THAT(scene->told(), Not(HasSubstr("goal reached")));
    ASSERT_TRUE(scene->move({0.2}, 2s).success) << scene->told();
    scene->run(3s);
    EXPECT_NEAR(place(), 0.2, 1e-4) << "it can be commanded anew";
  }
}

TEST_F(LatePositionByVelocity, StandsStillThroughADelayAtRest) {
  ASSERT_NO_FATAL_FAILURE(begin());
  scene->run(3s);
  scene->forgetTold();
  const double before = place();
  scene->stall(200ms);
  scene->run(1s);
  EXPECT_NEAR(place(), before, 1e-6);
  EXPECT_THAT(scene->told(), Not(HasSubstr("cycles were missed while it moved")));
}

}  // namespace
}  // namespace cia402
