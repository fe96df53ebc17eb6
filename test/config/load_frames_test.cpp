// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Frames for tf: what may be said of them, and what is refused in which words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"
#include "config/robot.h"

namespace cia402::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// The arm with frames. @param shoulder, elbow their `frame`, may be empty
LoadedRobot framed(const std::string& shoulder, const std::string& elbow,
                   const std::string& root = "") {
  const auto key = [](const std::string& frame) {
    return frame.empty() ? "" : ", frame: {" + frame + "}";
  };
  return loadText(
      "bus: {interface: can0}\n" + root +
      "\ndefaults: {drive: generic_cia402, counts_per_turn: 4000, limits: {velocity: 2.0, "
      "acceleration: 8.0}}\naxes:\n  shoulder: {node_id: 1" +
      key(shoulder) + "}\n  elbow: {node_id: 2, joint: ellbogen" + key(elbow) + "}\n");
}

TEST(LoadFrames, AFrameNeedsParentAndChildAlone) {
  const LoadedRobot loaded = framed("parent: base, child: arm", "");
  EXPECT_EQ(loaded.problems, "");
  ASSERT_THAT(loaded.robot.frames, SizeIs(1));
  const FrameConfig& frame = loaded.robot.frames[0];
  EXPECT_EQ(frame.joint, "shoulder");
  EXPECT_THAT(frame.xyz, ElementsAre(0.0, 0.0, 0.0));
  EXPECT_THAT(frame.rpy, ElementsAre(0.0, 0.0, 0.0));
  EXPECT_THAT(frame.axis, ElementsAre(0.0, 0.0, 1.0));
}

TEST(LoadFrames, AnAxisIsBroughtToLengthOne) {
  const auto axis = [](const std::string& numbers) {
    const LoadedRobot loaded = framed("parent: base, child: arm, axis: " + numbers, "");
    EXPECT_EQ(loaded.problems, "");
    return std::vector<double>(loaded.robot.frames.at(0).axis, loaded.robot.frames.at(0).axis + 3);
  };
  const auto near = [](double value) { return testing::DoubleNear(value, 1e-15); };
  EXPECT_THAT(axis("[0, -7, 0]"), ElementsAre(near(0), near(-1), near(0)));
  EXPECT_THAT(axis("[2, 3, 6]"), ElementsAre(near(2.0 / 7), near(3.0 / 7), near(6.0 / 7)));
  EXPECT_THAT(axis("[3e-8, 0, 4e-8]"), ElementsAre(near(0.6), near(0), near(0.8)));
}

TEST(LoadFrames, TfIsToldWhereThereIsSomethingToTell) {
  EXPECT_FALSE(framed("", "").robot.publish_tf);
  EXPECT_TRUE(framed("", "parent: base, child: arm").robot.publish_tf);
  EXPECT_TRUE(framed("", "", "static_frames: [{parent: a, child: b}]").robot.publish_tf);
  const LoadedRobot wanted = framed("parent: base, child: arm", "", "publish_tf: true");
  EXPECT_EQ(wanted.problems, "");
  EXPECT_TRUE(wanted.robot.publish_tf);
}

TEST(LoadFrames, OfARobotThatDoesNotTellTfAreCheckedAllTheSame) {
  const LoadedRobot silent = framed("parent: base, child: arm", "", "publish_tf: false");
  EXPECT_EQ(silent.problems, "");
  EXPECT_FALSE(silent.robot.publish_tf);
  EXPECT_THAT(silent.robot.frames, SizeIs(1));
  EXPECT_THAT(framed("parent: a, child: b, axis: [0, 0, 0]", "", "publish_tf: false").problems,
              HasSubstr("axes/shoulder/frame/axis: [0, 0, 0] has no direction"));
}

TEST(LoadFrames, OfJointsAndThoseThatStandStillMakeOneTree) {
  const LoadedRobot loaded =
      framed("parent: base, child: arm", "parent: plate, child: forearm",
             "static_frames: [{parent: arm, child: plate}, {parent: forearm, child: tip},\n"
             "                {parent: world, child: base, origin: {xyz: [0, 0, 1]}}]");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.frames, SizeIs(2));
  EXPECT_THAT(loaded.robot.static_frames, SizeIs(3));
}

TEST(LoadFrames, MistakesInOneAreToldWithWhatToDo) {
  struct Mistake {
    const char *shoulder, *elbow, *root, *problem;
  };
  const Mistake mistakes[] = {
      {"child: a", "", "",
       "axes/shoulder/frame: `parent` is missing: the tf frame that the joint is fixed to"},
      {"parent: a", "", "",
       "axes/shoulder/frame: `child` is missing: the tf frame that the joint moves"},
      {"", "parent: a, child: b, axis: [0, 0.0, 0]", "",
       "axes/elbow/frame/axis: [0, 0.0, 0] has no direction, and joint ellbogen needs one: the "
       "axis that it turns about or moves along, such as [0, 0, 1]"},
      {"parent: a, child: b, axis: [1e-10, 0, 0]", "", "",
       "axes/shoulder/frame/axis: [1e-10, 0, 0] has no direction"},
      {"parent: a, child: b, axis: [1e308, 1e308, 1e308]", "", "",
       "axes/shoulder/frame/axis: [1e308, 1e308, 1e308] has no direction"},
      {"parent: a, child: b, axis: [0, 1]", "", "",
       "axes/shoulder/frame/axis: must be a list of 3 numbers, not of 2"},
      {"parent: a, child: b, axis: [0, .nan, 1]", "", "", "axes/shoulder/frame/axis[1]: "},
      {"parent: a, child: b, origin: {xyz: [.inf, 0, 0]}", "", "",
       "axes/shoulder/frame/origin/xyz[0]: "},
      {"parent: a, child: b, origin: {xzy: [0, 0, 0]}", "", "",
       "axes/shoulder/frame/origin/xzy: unknown key, did you mean `xyz`?"},
      {"parent: a, child: /b", "", "",
       "axes/shoulder/frame/child: tf knows no names that begin with `/`, such as `/b`: leave it "
       "out"},
      {"parent: /a, child: b", "", "",
       "axes/shoulder/frame/parent: tf knows no names that begin with `/`, such as `/a`"},
      {"", "", "static_frames: [{parent: a, child: b}, {child: c}]",
       "static_frames[1]: `parent` is missing: the tf frame that it stands in"},
      {"", "", "static_frames: [{parent: a}]",
       "static_frames[0]: `child` is missing: its own name in tf"},
      {"", "", "static_frames: [{parent: a, child: b, axis: [0, 0, 1]}]",
       "static_frames[0]: a static frame does not move: a frame that a joint moves is the `frame` "
       "of its axis"},
      {"", "", "static_frames: [{parent: a, child: b, orign: {}}]",
       "static_frames[0]/orign: unknown key, did you mean `origin`?"},
      {"", "", "static_frames: {parent: a, child: b}", "static_frames: must be a list"},
      {"", "", "static_frame: [{parent: a, child: b}]",
       "static_frame: unknown key, did you mean `static_frames`?"},
      {"", "", "publish_tf: maybe", "publish_tf: must be true or false"},
      {"", "", "publish_tf: true",
       "publish_tf: is true, but there is nothing to tell tf: give an axis its `frame`, list "
       "`static_frames`, or leave publish_tf out"},
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_THAT(framed(mistake.shoulder, mistake.elbow, mistake.root).problems,
                HasSubstr(mistake.problem))
        << mistake.problem;
  }
}

TEST(LoadFrames, AFrameHasOneParent) {
  EXPECT_THAT(framed("parent: a, child: b", "parent: c, child: b").problems,
              HasSubstr("axes/elbow/frame/child: `b` has the parent `a` by joint shoulder already, "
                        "and a frame has one parent: give it another name"));
  EXPECT_THAT(
      framed("parent: a, child: b", "", "static_frames: [{parent: c, child: b}]").problems,
      HasSubstr("static_frames[0]/child: `b` has the parent `a` by joint shoulder already"));
  EXPECT_THAT(
      framed("", "", "static_frames: [{parent: a, child: b}, {parent: a, child: b}]").problems,
      HasSubstr("static_frames[1]/child: `b` has the parent `a` by static_frames already"));
}

TEST(LoadFrames, ThatMakeARingAreRefused) {
  EXPECT_THAT(
      framed("parent: a, child: a", "").problems,
      HasSubstr("axes/shoulder/frame/parent: `a` makes a ring, where tf has a tree: a in a; "
                "name the frame that it is fixed to"));
  EXPECT_THAT(
      framed("parent: a, child: b", "parent: b, child: c", "static_frames: [{parent: c, child: a}]")
          .problems,
      HasSubstr("static_frames[0]/parent: `c` makes a ring, where tf has a tree: a in c in "
                "b in a"));
}

}  // namespace
}  // namespace cia402::config
