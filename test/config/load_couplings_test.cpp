// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Couplings: what may be said of them, and what is refused in which words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"
#include "motion/coupling.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> namesOf(const std::vector<motion::Joint>& joints) {
  std::vector<std::string> names;
  for (const motion::Joint& joint : joints) names.push_back(joint.name);
  return names;
}

/// Axes m5 and m6, limits 3 rad/s and 12 rad/s², and one that is not coupled.
LoadedRobot coupled(const std::string& coupling, const std::string& m5 = {},
                    const std::string& root = {}) {
  return loadText(
      "bus: {interface: can0}\n" + root +
      "\ndefaults: {drive: generic_cia402, counts_per_turn: 4000, limits: {velocity: 3.0, "
      "acceleration: 12.0}}\naxes:\n  m5: {node_id: 1" +
      m5 + "}\n  m6: {node_id: 2}\n  base: {node_id: 3}\ncouplings: [{" + coupling + "}]\n");
}

/// m5 = pitch + roll / 2, m6 = pitch - roll / 2.
const std::string kDifferential =
    "joints: [pitch, roll], axes: [m5, m6], matrix: [[0.5, 0.5], [1, -1]], "
    "pitch: {limits: {lower: -1, upper: 1, velocity: 2, acceleration: 8}}, "
    "roll: {type: continuous, limits: {velocity: 2, acceleration: 8}}";
const std::string kGantry = "joints: [x], axes: [m5, m6], skew: {window: 0.01, homing: 0.05}";

TEST(LoadCouplings, ADifferentialHasJointsWithLimitsOfTheirOwn) {
  const LoadedRobot loaded = coupled(kDifferential);
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.warnings, IsEmpty());
  EXPECT_THAT(namesOf(loaded.robot.joints()), ElementsAre("base", "pitch", "roll"));
  ASSERT_THAT(loaded.robot.couplings, SizeIs(1));
  const CouplingConfig& coupling = loaded.robot.couplings[0];
  EXPECT_EQ(coupling.joints[0].limits.upper, 1.0);
  EXPECT_EQ(coupling.joints[0].limits.velocity, 2.0);
  EXPECT_FALSE(coupling.joints[0].limits.continuous);
  EXPECT_TRUE(coupling.joints[1].limits.continuous);
  EXPECT_NEAR(coupling.matrix->shareOfAxis(1, 1), -0.5, 1e-12);
  EXPECT_THAT(loaded.robot.groups.at(0).joints, ElementsAre("base", "pitch", "roll"));
}

TEST(LoadCouplings, AGantryHasTheLimitsOfItsSidesLessWhatSquaringTakes) {
  const LoadedRobot loaded = coupled(kGantry, "", "groups: {portal: {joints: [x]}}\n");
  EXPECT_EQ(loaded.problems, "");
  const CouplingConfig& coupling = loaded.robot.couplings.at(0);
  ASSERT_TRUE(coupling.gantry);
  EXPECT_EQ(coupling.gantry->skew_window, 0.01);
  EXPECT_EQ(coupling.gantry->homing_window, 0.05);
  EXPECT_EQ(coupling.gantry->squaring_velocity, 0.01);  // the window in a second
  EXPECT_NEAR(coupling.gantry->squaring_acceleration, 0.6, 1e-12);
  EXPECT_NEAR(*coupling.joints.at(0).limits.velocity, 2.85, 1e-12);
  EXPECT_NEAR(*coupling.joints.at(0).limits.acceleration, 11.4, 1e-12);
  EXPECT_EQ(coupled("joints: [x], axes: [m5, m6], skew: {window: 0.02}")
                .robot.couplings.at(0)
                .gantry->homing_window,
            0.02);
}

TEST(LoadCouplings, AMatrixThatCannotBeUsedIsRefusedWithItsConditionNumber) {
  const auto problems = [](const std::string& matrix) {
    return coupled("joints: [p, r], axes: [m5, m6], matrix: " + matrix).problems;
  };
  EXPECT_THAT(problems("[[1, 2], [2, 4]]"),
              HasSubstr("couplings[0]/matrix: is refused: coupling of joints p, r with axes m5, "
                        "m6: the matrix [[1, 2], [2, 4]] is singular (condition number inf"));
  EXPECT_THAT(problems("[[1, 1], [1, 1.001]]"),
              HasSubstr("is badly conditioned (condition number 4e+03, at most 1000)"));
  EXPECT_THAT(problems("[[0, 0], [1, 2]]"), HasSubstr("is singular"));
  EXPECT_THAT(problems("[[1, 2]]"), HasSubstr("matrix: must have a row for each joint: 2, not 1"));
  EXPECT_THAT(problems("[[1, 2], [3]]"), HasSubstr("couplings[0]/matrix"));
  EXPECT_THAT(problems("[[1, 2], [3, .nan]]"), HasSubstr("couplings[0]/matrix"));
}

TEST(LoadCouplings, WithoutAnyAxisThatAloneIsTheProblem) {
  for (const std::string& coupling : {kDifferential, kGantry}) {
    const LoadedRobot loaded =
        loadText("bus: {interface: can0}\ncouplings: [{" + coupling + "}]\n");
    EXPECT_THAT(loaded.problems, HasSubstr("axes: is missing: name at least one axis"));
  }
}

TEST(LoadCouplings, JointsThatCouldAskMoreOfAnAxisThanItMayAreRefused) {
  // Both at 2: 2 + 2 / 2 = 3 rad/s of the axis, just what it may; 2.2: 2.2 + 1.
  const auto with = [](const std::string& from, const std::string& to, const std::string& m5 = {}) {
    std::string text = kDifferential;
    return coupled(text.replace(text.find(from), from.size(), to), m5).problems;
  };
  EXPECT_EQ(with("velocity: 2", "velocity: 2.0"), "");
  EXPECT_THAT(with("velocity: 2", "velocity: 2.2"),
              HasSubstr("couplings[0]: at the velocity limits of all its joints `m5` would need "
                        "3.2, and axes/m5/limits/velocity is 3: give the joints 0.938 of theirs, "
                        "or the axis more"));
  EXPECT_THAT(with("acceleration: 8", "acceleration: 9"),
              HasSubstr("acceleration limits of all its joints `m6` would need 13"));
  EXPECT_THAT(with("velocity: 2, ", ""),
              HasSubstr("couplings[0]: pitch/limits: no velocity, and axes/m5/limits has"));
  const std::string bounded = ", limits: {lower: -5, upper: 5}";
  EXPECT_THAT(with("type: continuous, limits: {", "limits: {lower: -8, upper: 8, ", bounded), "");
  EXPECT_THAT(with("type: continuous, limits: {", "limits: {lower: -8.2, upper: 8, ", bounded),
              HasSubstr("within the limits of its joints `m5` goes from -5.1 to 5, beyond "
                        "axes/m5/limits/lower -5"));
  EXPECT_THAT(with("roll", "roll", bounded),
              HasSubstr("couplings[0]: roll/limits: no lower and upper, and axes/m5/limits has"));
}

TEST(LoadCouplings, KeysOfAnAxisThatSpeakOfAJointOfItsOwnAreRefused) {
  EXPECT_THAT(coupled(kDifferential, ", joint: wrist").problems,
              HasSubstr("couplings[0]: axes/m5/joint: `wrist` has no meaning, as the axis is "
                        "coupled: `joints` names what it moves; take it out"));
  EXPECT_THAT(coupled(kDifferential, ", frame: {parent: a, child: b}").problems,
              HasSubstr("couplings[0]: axes/m5/frame: the axis is coupled"));
  EXPECT_THAT(coupled(kDifferential + ", colour: red").problems,
              HasSubstr("couplings[0]/colour: unknown key"));
  EXPECT_THAT(coupled("joints: [axes, r], axes: [m5, m6], matrix: [[0.5, 0.5], [1, -1]]").problems,
              HasSubstr("a joint cannot be called `axes`, which is a key here"));
  std::string effort = kDifferential;
  effort.replace(effort.find("velocity: 2"), 11, "effort: 1, velocity: 2");
  EXPECT_THAT(coupled(effort).problems,
              HasSubstr("couplings[0]/pitch/limits: a coupled joint has neither jerk nor effort"));
}

TEST(LoadCouplings, ACoupledJointMovesAFrame) {
  std::string text = kDifferential;
  text.replace(text.find("pitch: {"), 8, "pitch: {frame: {parent: arm, child: hand}, ");
  const LoadedRobot loaded = coupled(text);
  EXPECT_EQ(loaded.problems, "");
  ASSERT_THAT(loaded.robot.frames, SizeIs(1));
  EXPECT_EQ(loaded.robot.frames[0].joint, "pitch");
  EXPECT_TRUE(loaded.robot.publish_tf);
}

TEST(LoadCouplings, JointsOfACouplingAreInAGroupTogether) {
  EXPECT_THAT(coupled(kDifferential, "", "groups: {arm: {joints: [roll, base]}}\n").problems,
              HasSubstr("groups/arm/joints: lacks `pitch`, which the same axes move (m5, m6): "
                        "joints of a coupling are in a group together"));
  EXPECT_EQ(coupled(kDifferential, "", "groups: {arm: {joints: [base]}}\n").problems, "");
}

TEST(LoadCouplings, TheSidesOfAGantryAreAlike) {
  EXPECT_THAT(coupled(kGantry, ", type: prismatic, lead: 0.01").problems,
              HasSubstr("axes/m5/type and axes/m6/type differ"));
  EXPECT_THAT(coupled(kGantry, ", limits: {velocity: 2.9}").problems,
              HasSubstr("axes/m5/limits and axes/m6/limits differ: both sides of a gantry move and "
                        "stop by the same limits"));
  EXPECT_THAT(coupled(kGantry, ", homing: {method: 17}").problems,
              HasSubstr("axes/m5/homing and axes/m6/homing differ"));
  EXPECT_THAT(
      loadText("bus: {interface: can0}\ndefaults: {drive: generic_cia402, "
               "counts_per_turn: 4000, homing: {method: 17}}\n"
               "axes:\n  m5: {node_id: 1}\n  m6: {node_id: 2}\ncouplings: [{" +
               kGantry + "}]\n")
          .problems,
      HasSubstr("couplings[0]: axes/m6/limits: no velocity: a side of a gantry that homes"));
  EXPECT_THAT(coupled(kGantry, ", optional: true").problems,
              HasSubstr("axes/m5/optional: a gantry does not move without one of its sides"));
}

TEST(LoadCouplings, AGantryNeedsAWindowAndNoMatrix) {
  EXPECT_THAT(coupled("joints: [x], axes: [m5, m6]").problems,
              HasSubstr("couplings[0]: `skew` is missing: a gantry needs {window: ...}"));
  EXPECT_THAT(coupled("joints: [x], axes: [m5, m6], skew: {}").problems,
              HasSubstr("couplings[0]/skew: `window` is missing"));
  EXPECT_THAT(coupled("joints: [x], axes: [m5, m6], skew: {window: 0}").problems,
              HasSubstr("couplings[0]/skew/window: must be greater than 0"));
  EXPECT_THAT(coupled("joints: [x], axes: [m5, m6], skew: {window: 0.1, homing: 0.05}").problems,
              HasSubstr("couplings[0]/skew/homing: must be at least `window` (0.1)"));
  EXPECT_THAT(coupled(kGantry + ", matrix: [[0.5, 0.5]]").problems,
              HasSubstr("couplings[0]/matrix: is that of a gantry"));
  EXPECT_THAT(
      coupled("joints: [x], axes: [m5, m6, base], skew: {window: 1}").problems,
      HasSubstr("couplings[0]: has 1 joints and 3 axes; it needs as many joints as axes, or "
                "one joint and the two axes of a gantry"));
  EXPECT_THAT(coupled(kDifferential + ", skew: {window: 1}").problems,
              HasSubstr("couplings[0]/skew: unknown key"));
}

TEST(LoadCouplings, JointsWithoutLimitsAreWarnedOf) {
  const LoadedRobot loaded = loadText(
      "bus: {interface: can0}\ndefaults: {drive: generic_cia402, counts_per_turn: 4000}\naxes:\n"
      "  a: {node_id: 1}\n  b: {node_id: 2}\n"
      "couplings: [{joints: [p, r], axes: [a, b], matrix: [[0.5, 0.5], [1, -1]]}]\n");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.warnings,
              Contains("couplings[0]/r/limits: no velocity limit: the joint follows trajectories "
                       "however fast they are"));
}

}  // namespace
}  // namespace cia402::config
