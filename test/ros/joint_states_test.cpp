// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/joint_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace cia402::ros_node {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsNan;
using testing::Optional;

constexpr double kUnknown = drive::kUnknown;

bus::JointState at(double position, double velocity, double effort,
                   Time stamp = Time(Duration(1))) {
  bus::JointState state;
  state.known = !std::isnan(position);
  state.stamp = stamp;
  state.position = position;
  state.velocity = velocity;
  state.effort = effort;
  return state;
}

const std::vector<motion::Joint>& threeJoints() {
  static const std::vector<motion::Joint> kJoints = [] {
    std::vector<motion::Joint> joints(3);
    joints[0].name = "hip";
    joints[1].name = "knee";
    joints[2].name = "ankle";
    return joints;
  }();
  return kJoints;
}

TEST(JointStates, HaveAllJointsInTheirOrder) {
  for (const bool omit : {false, true}) {
    const auto message = jointStates(threeJoints(), {at(1, 2, 3), at(4, 5, 6), at(7, 8, 9)}, omit);
    EXPECT_THAT(message.name, ElementsAre("hip", "knee", "ankle"));
    EXPECT_THAT(message.position, ElementsAre(1, 4, 7));
    EXPECT_THAT(message.velocity, ElementsAre(2, 5, 8));
    EXPECT_THAT(message.effort, ElementsAre(3, 6, 9));
  }
}

TEST(JointStates, HaveNanForWhatIsNotKnown) {
  const auto message = jointStates(
      threeJoints(), {at(1, 2, kUnknown), at(kUnknown, kUnknown, kUnknown), at(7, 8, 9)}, false);
  EXPECT_THAT(message.name, ElementsAre("hip", "knee", "ankle"));
  EXPECT_THAT(message.position, ElementsAre(1, IsNan(), 7));
  EXPECT_THAT(message.velocity, ElementsAre(2, IsNan(), 8));
  EXPECT_THAT(message.effort, ElementsAre(IsNan(), IsNan(), 9));
}

TEST(JointStates, LeaveOutUnknownJointsWhereAskedFor) {
  const auto message = jointStates(
      threeJoints(), {at(1, 2, 3), at(kUnknown, kUnknown, kUnknown), at(7, 8, 9)}, true);
  EXPECT_THAT(message.name, ElementsAre("hip", "ankle"));
  EXPECT_THAT(message.position, ElementsAre(1, 7));
  EXPECT_THAT(message.velocity, ElementsAre(2, 8)) << "the unknown one went with its joint";
  EXPECT_THAT(message.effort, ElementsAre(3, 9));
}

TEST(JointStates, LeaveOutAListWithAGapWhereAskedFor) {
  const auto no_effort =
      jointStates(threeJoints(), {at(1, 2, 3), at(4, 5, kUnknown), at(7, 8, 9)}, true);
  EXPECT_THAT(no_effort.position, ElementsAre(1, 4, 7));
  EXPECT_THAT(no_effort.velocity, ElementsAre(2, 5, 8));
  EXPECT_THAT(no_effort.effort, IsEmpty());
  const auto no_velocity =
      jointStates(threeJoints(), {at(1, kUnknown, 3), at(4, 5, 6), at(7, 8, 9)}, true);
  EXPECT_THAT(no_velocity.position, ElementsAre(1, 4, 7));
  EXPECT_THAT(no_velocity.velocity, IsEmpty());
  EXPECT_THAT(no_velocity.effort, ElementsAre(3, 6, 9));
}

TEST(JointStates, AreEmptyWhereNothingIsKnownAndThatIsLeftOut) {
  const bus::JointState unknown = at(kUnknown, kUnknown, kUnknown);
  const auto message = jointStates(threeJoints(), {unknown, unknown, unknown}, true);
  EXPECT_THAT(message.name, IsEmpty());
  EXPECT_THAT(message.position, IsEmpty());
  EXPECT_THAT(message.velocity, IsEmpty());
  EXPECT_THAT(message.effort, IsEmpty());
}

TEST(NewestFeedback, IsThatOfKnownPositionsOnly) {
  EXPECT_EQ(newestFeedback({at(1, 2, 3, Time(Duration(50))), at(1, 2, 3, Time(Duration(70))),
                            at(1, 2, 3, Time(Duration(60)))}),
            Time(Duration(70)));
  EXPECT_EQ(
      newestFeedback({at(1, 2, 3, Time(Duration(50))), at(kUnknown, 2, 3, Time(Duration(70)))}),
      Time(Duration(50)));
  EXPECT_EQ(newestFeedback({at(kUnknown, 2, 3, Time(Duration(70)))}), Time());
  EXPECT_EQ(newestFeedback({}), Time());
}

/// Two joints, and a clock that is 0.1 s ahead of the feedback.
struct StampsOfJointStates : testing::Test {
  std::optional<ros::Time> next(bool first, bool second, double newest) {
    return next(first, second, newest, newest + 0.1);
  }
  std::optional<ros::Time> next(bool first, bool second, double newest, double now) {
    const std::vector<bus::JointState> states{at(first ? 0 : kUnknown, 0, 0),
                                              at(second ? 0 : kUnknown, 0, 0)};
    return stamps.next(states, ros::Time(newest), ros::Time(now));
  }
  JointStateStamps stamps;
};

TEST_F(StampsOfJointStates, AreTheNewestFeedbackOnce) {
  EXPECT_THAT(next(true, true, 10.0), Optional(ros::Time(10.0)));
  EXPECT_EQ(next(true, true, 10.0), std::nullopt);
  EXPECT_THAT(next(true, true, 10.02), Optional(ros::Time(10.02)));
}

TEST_F(StampsOfJointStates, GoOnWithTheJointsThatAreLeft) {
  EXPECT_THAT(next(true, true, 10.0), Optional(ros::Time(10.0)));
  EXPECT_THAT(next(true, false, 10.02), Optional(ros::Time(10.02)));
  EXPECT_THAT(next(true, true, 10.04), Optional(ros::Time(10.04)));
}

TEST_F(StampsOfJointStates, AreNotTheClocksWhileALossMayBeFollowedByOthers) {
  EXPECT_THAT(next(true, true, 10.0, 10.1), Optional(ros::Time(10.0)));
  EXPECT_EQ(next(true, false, 9.9, 10.12), std::nullopt) << "the other one is as old";
  EXPECT_EQ(next(true, false, 9.9, 11.89), std::nullopt);
  EXPECT_THAT(next(false, false, 9.9, 11.9), Optional(ros::Time(11.9)));
}

TEST_F(StampsOfJointStates, AreTheClocksWhereALossIsAllTheNewsForTwoSeconds) {
  EXPECT_THAT(next(true, true, 10.0, 10.1), Optional(ros::Time(10.0)));
  EXPECT_THAT(next(true, false, 9.9, 12.0), Optional(ros::Time(12.0)));
  EXPECT_EQ(next(true, false, 9.9, 12.1), std::nullopt) << "that was told";
  EXPECT_EQ(next(true, true, 11.95, 12.2), std::nullopt) << "from before the last message";
  EXPECT_EQ(next(true, false, 9.9, 12.3), std::nullopt) << "nobody was told that it was back";
  EXPECT_THAT(next(true, true, 12.35, 12.4), Optional(ros::Time(12.35)));
  EXPECT_EQ(next(true, false, 9.9, 12.35), std::nullopt) << "lost once more, but the clock stands";
  EXPECT_THAT(next(true, false, 9.9, 12.45), Optional(ros::Time(12.45)));
}

TEST_F(StampsOfJointStates, AreTheClocksWhileNothingIsKnown) {
  EXPECT_THAT(next(false, false, 10.0), Optional(ros::Time(10.1)));
  EXPECT_EQ(next(false, false, 10.0), std::nullopt) << "the clock stands";
  EXPECT_THAT(next(false, false, 10.02), Optional(ros::Time(10.12)));
  EXPECT_THAT(next(true, false, 10.2), Optional(ros::Time(10.2)));
}

}  // namespace
}  // namespace cia402::ros_node
