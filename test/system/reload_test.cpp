// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What is changed while the driver runs: what the drives hold by then, and how the motors move.
#include "bus/canopen/reload_command.h"
#include "system/families_motion.h"
#include "system/followed_path.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

std::string changedBy(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Has the robot become the one of `yaml`.
bus::ReloadAnswer reload(Scene& scene, const std::string& yaml, bool at_rest) {
  const LoadedRobot& now = scene.loaded();
  const LoadedRobot next = loadText(yaml);
  return scene.call(bus::ReloadCommand{
      bus::makeReload({now.robot, now.master}, {next.robot, next.master}, at_rest)});
}

double heldBy(Scene& scene, const std::string& axis, const std::string& object) {
  const bus::ObjectAnswer read = scene.call(bus::ReadObjectCommand{axis, object});
  EXPECT_TRUE(read.success) << read.message;
  return read.number;
}

struct ReloadedPair : testing::Test {
  bus::ReloadAnswer change(const std::string& from, const std::string& to, bool at_rest = true) {
    return reload(scene, changedBy(genericPair(), from, to), at_rest);
  }
  void enable() {
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    scene.run(100ms);
    scene.forget();
  }
  void disable() { ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success); }
  ReadyScene scene{genericPair()};
};

TEST_F(ReloadedPair, ASlowerLimitIsKeptByStreamsTrajectoriesAndTheDrive) {
  const double before = heldBy(scene, "left", "profile_velocity");
  scene.forget();
  scene.stream("left", 1.0, 2s);
  ASSERT_GT(scene.seen("left").fastest, 1.0) << "it was faster before";
  disable();
  ASSERT_TRUE(change("velocity: 1.5", "velocity: 0.5").success);
  EXPECT_NEAR(heldBy(scene, "left", "profile_velocity"), before / 3.0, 1.0);
  enable();
  scene.stream("left", -1.0, 6s);
  EXPECT_NEAR(scene.seen("left").fastest, 0.5, 0.01) << "also no slower than it may";
  EXPECT_THAT(scene.move({-1.0, 1.0}, 1s).message,
              AllOf(HasSubstr("right"), HasSubstr("velocity")));
  scene.forget();
  ASSERT_TRUE(scene.move({-1.0, 0.5}, 4s).success) << scene.told();
  scene.run(5s);
  EXPECT_NEAR(scene.position("right"), 0.5, 1e-3);
  EXPECT_LT(scene.seen("right").fastest, 0.51);
}

TEST_F(ReloadedPair, AFasterOneIsUsedUp) {
  disable();
  ASSERT_TRUE(change("velocity: 1.5", "velocity: 2.0").success);
  enable();
  scene.stream("left", 2.0, 3s);
  EXPECT_NEAR(scene.seen("left").fastest, 2.0, 0.02) << scene.told();
}

TEST_F(ReloadedPair, AStopIsAsHardAsTheNewLimit) {
  disable();
  ASSERT_TRUE(change("acceleration: 4.0", "acceleration: 1.0").success);
  enable();
  ASSERT_TRUE(scene.move({2.0, 0.0}, 4s).success) << scene.told();
  scene.run(2s);
  const double from = scene.position("left"), fast = scene.velocity("left");
  ASSERT_GT(fast, 0.7);
  ASSERT_TRUE(scene.stopGroup().success);
  scene.run(3s);
  EXPECT_NEAR(scene.position("left") - from, fast * fast / 2.0, 0.05);
}

TEST_F(ReloadedPair, ANarrowerLimitOfPositionIsInTheDriveAndKept) {
  const double before = heldBy(scene, "left", "software_limit_max");
  disable();
  ASSERT_TRUE(change("upper: 2.5", "upper: 0.5").success);
  enable();
  EXPECT_NEAR(heldBy(scene, "left", "software_limit_max"), before / 5.0, 2.0);
  EXPECT_THAT(scene.move({1.0, 0.0}, 3s).message, AllOf(HasSubstr("left"), HasSubstr("0.5")));
  scene.stream("left", 1.0, 2s);
  EXPECT_NEAR(scene.position("left"), 0.5, 1e-3);
  EXPECT_LT(scene.seen("left").highest, 0.501);
}

TEST_F(ReloadedPair, AnAxisThatStandsOutsideOfTheNewLimitIsOnlyMovedBack) {
  ASSERT_TRUE(scene.move({1.0, 0.0}, 2s).success);
  scene.run(3s);
  disable();
  ASSERT_TRUE(change("upper: 2.5", "upper: 0.5").success);
  enable();
  scene.run(1s);
  expectNothingMoved(scene, "left");
  scene.stream("left", 1.5, 1s);
  EXPECT_NEAR(scene.position("left"), 1.0, 2e-3) << "further out";
  scene.stream("left", 0.2, 2s);
  EXPECT_NEAR(scene.position("left"), 0.2, 1e-3);
  scene.stream("left", 1.5, 2s);
  EXPECT_NEAR(scene.position("left"), 0.5, 1e-3);
}

TEST_F(ReloadedPair, InMotionTheLimitsStayAndNothingIsFeltOfTheAttempt) {
  ASSERT_TRUE(scene.move({1.0, 0.0}, 2s).success);
  scene.run(500ms);
  const bus::ReloadAnswer answer = change("velocity: 1.5", "velocity: 0.1");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("left (node 1): the axis is not disabled"));
  scene.run(2s);
  EXPECT_NEAR(scene.position("left"), 1.0, 1e-3);
}

TEST_F(ReloadedPair, ADriveThatLostItsPowerGetsTheNewLimitAgain) {
  disable();
  ASSERT_TRUE(change("velocity: 1.5", "velocity: 0.5").success);
  const double held = heldBy(scene, "left", "profile_velocity");
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return !scene.node("left").ready(); }, 5s));
  ASSERT_TRUE(scene.runUntil([&] { return scene.node("left").ready(); }, 20s));
  EXPECT_EQ(heldBy(scene, "left", "profile_velocity"), held);
}

TEST(ReloadedTimeout, EndsAStreamOfVelocitiesAsSoonAsItSays) {
  ReadyScene scene(genericPair(), "csv");
  scene.stream("left", 0.5, 1s);
  ASSERT_TRUE(
      reload(scene, changedBy(genericPair(), "command_timeout: 0.2", "command_timeout: 1.0"), false)
          .success);
  scene.run(900ms);
  EXPECT_NEAR(scene.velocity("left"), 0.5, 0.01) << "it was stopped by the time of before";
  scene.run(400ms);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 0.01);
}

TEST(ReloadedLimits, OfVelocityModesCountToo) {
  ReadyScene scene(genericPair(), "csv");
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  const std::string slow = changedBy(changedBy(genericPair(), "velocity: 1.5", "velocity: 0.5"),
                                     "acceleration: 4.0", "acceleration: 1.0");
  ASSERT_TRUE(reload(scene, slow, true).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(100ms);
  scene.forget();
  scene.stream("left", 1.0, 250ms);
  EXPECT_LT(scene.velocity("left"), 0.26);
  scene.stream("left", 1.0, 750ms);
  EXPECT_NEAR(scene.velocity("left"), 0.5, 0.01);
  EXPECT_LT(scene.seen("left").fastest, 0.51);
}

constexpr FamilyMode kLedByVelocity{kId286Cnfa, "10000", "position_by_velocity"};

std::string withLoop(const std::string& loop) {
  return changedBy(familyJoint(kLedByVelocity),
                   "node_id:", "position_loop: {" + loop + "}, node_id:");
}

/// How far the motor is behind a motion of 0.5 rad/s.
double behind(Scene& scene) { return scene.axis("joint").target() - scene.position("joint"); }

// Without feed-forward a motor is behind by its velocity over the gain, so that a step of the gain
// would be one of the velocity.
TEST(ReloadedPositionLoop, CountsInMotionWithoutAJerk) {
  Scene scene(loadText(withLoop("gain: 5, feed_forward: 0")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  const Duration cycle = scene.loaded().robot.bus.sync_period;
  bus::TrajectoryCommand way;
  way.group = scene.loaded().robot.groups[0].name;
  way.joints = {"joint"};
  way.points = {{{0.25}, {0.5}, {}, 1s}, {{1.75}, {0.5}, {}, 4s}, {{2.0}, {0.0}, {}, 5s}};
  ASSERT_TRUE(scene.call(way).success) << scene.told();
  scene.run(2500ms);
  ASSERT_NEAR(behind(scene), 0.1, 0.01);
  double hardest = 0.0, last = scene.velocity("joint");
  scene.watch([&] {
    hardest = std::max(hardest, std::fabs(scene.velocity("joint") - last) / 1e-3);
    last = scene.velocity("joint");
  });
  scene.forget();
  ASSERT_TRUE(reload(scene, withLoop("gain: 10, feed_forward: 0"), false).success);
  scene.run(1400ms);
  EXPECT_NEAR(behind(scene), 0.05, 0.005) << toSeconds(cycle);
  EXPECT_LT(scene.seen("joint").fastest, 0.7);
  EXPECT_LT(hardest, 4.0) << "rad/s^2; a step would be 0.5 rad/s in some milliseconds";
}

}  // namespace
}  // namespace cia402
