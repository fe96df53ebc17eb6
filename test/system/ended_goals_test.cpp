// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Goals that a drive goes to by itself, ended by an empty trajectory to the group of the joint:
// judged by the motor. The stops of docs/stops.md do the same in profile position modes.
#include "system/stations.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

/// @param streams the mode in which it follows trajectories, without which it is in no group
std::string groupedJoint(const FamilyMode& tested, const std::string& streams) {
  const std::string mode = tested.mode;
  if (tested.family == std::string(kSv660c)) {
    return sv660cJoint(", mode: " + mode, {}, "0.004", "[ip, " + mode + "]");
  }
  return familyJointWith(tested, "[" + mode + ", " + streams + "]") +
         "\ngroups:\n  arm: {joints: [joint]}\n";
}

class EndedGoal : public testing::TestWithParam<FamilyMode> {
 protected:
  static std::string yaml() {
    const bool id286 = GetParam().family == std::string(kId286Cnfa);
    return groupedJoint(GetParam(), id286 ? "position_by_velocity" : "csp");
  }
  static bool distances() {
    return std::string(GetParam().mode).find("relative") != std::string::npos;
  }
  static bool queued() { return std::string(GetParam().mode).find("queued") != std::string::npos; }
};

/// Stops the group. @return how that ended, told in the very millisecond
bus::TrajectoryOutcome stopAndWait(Stations& scene) {
  bus::TrajectoryOutcome outcome;
  bool ended = false;
  bus::TrajectoryCommand stop;
  stop.group = "arm";
  stop.ended = [&](const bus::TrajectoryOutcome& told) {
    outcome = told;
    ended = true;
  };
  EXPECT_EQ(scene.call(stop).message, "arm: stopping");
  EXPECT_TRUE(scene.runUntil([&] { return ended; }, 3s)) << scene.told();
  return outcome;
}

TEST_P(EndedGoal, StandsWhenThatIsToldAndIsNotGoneOnTo) {
  Stations scene(yaml());
  scene.give({1.2});
  if (queued()) scene.give({0.5, -0.3});
  scene.run(700ms);
  EXPECT_GT(scene.velocity("joint"), 0.3);
  const bus::TrajectoryOutcome outcome = stopAndWait(scene);
  EXPECT_LT(std::fabs(scene.velocity("joint")), 0.01);
  EXPECT_EQ(outcome.message, "arm: stands");
  const double held = scene.position("joint");
  EXPECT_LT(held, 1.1);
  scene.expectStands(2s);
  EXPECT_FALSE(scene.state("joint").halted);
  EXPECT_FALSE(queued() && scene.bit(12)) << "nothing waits in the drive";
  scene.give({distances() ? -0.2 : held - 0.2});
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), held - 0.2, 3 * Stations::kOneStep) << scene.told();
}

// Before feedback shows that the drive has set off, or that it has not taken the goal yet.
TEST_P(EndedGoal, IsEndedBeforeItsDriveHasSetOff) {
  for (const Duration after : {0ms, 4ms, 8ms, 12ms, 16ms, 20ms, 28ms, 40ms}) {
    Stations scene(yaml());
    scene.give({1.2});
    scene.run(after);
    const bus::TrajectoryOutcome outcome = stopAndWait(scene);
    EXPECT_EQ(outcome.message, "arm: stands");
    EXPECT_LT(std::fabs(scene.velocity("joint")), 0.01) << toSeconds(after);
    EXPECT_LT(scene.position("joint"), 0.02) << toSeconds(after);
    scene.expectStands(1s);
  }
}

TEST_P(EndedGoal, IsHaltedByAHaltThatComesMeanwhile) {
  Stations scene(yaml());
  scene.give({1.2});
  scene.run(700ms);
  EXPECT_TRUE(scene.stopGroup().success);
  scene.run(60ms);
  scene.mustSucceed(ProcedureKind::halt);
  EXPECT_TRUE(scene.state("joint").halted);
  scene.expectStands(2s);
  EXPECT_EQ(scene.setpoint("joint", 0.1).find("joint"), 0U) << "refused, it is halted";
  scene.mustSucceed(ProcedureKind::enable);
  scene.expectStands(1s);
}

INSTANTIATE_TEST_SUITE_P(
    All, EndedGoal,
    testing::Values(FamilyMode{kMegmeetDm5, "8388608", "queued_position"},
                    FamilyMode{kMegmeetDm5, "8388608", "relative_position"},
                    FamilyMode{kMegmeetDm5, "8388608", "queued_relative_position"},
                    FamilyMode{kMegmeetDm5, "8388608", "pp"},
                    FamilyMode{kSv660c, "100000", "queued_position"},
                    FamilyMode{kSv660c, "100000", "relative_position"},
                    FamilyMode{kSv660c, "100000", "queued_relative_position"},
                    FamilyMode{kSv660c, "100000", "pp"},
                    FamilyMode{kId286Cnfa, "10000", "relative_position"},
                    FamilyMode{kId286Cnfa, "10000", "pp"}, nimotionIn("queued_position"),
                    nimotionIn("relative_position"), nimotionIn("pp")),
    familyModeName);

}  // namespace
}  // namespace cia402
