// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/trajectory.h"

#include <cmath>

#include "motion/trajectory_fixture.h"

namespace cia402::motion {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Code = TrajectoryErrorCode;
constexpr double kPi = 3.14159265358979323846;

class TrajectorySampling : public TrajectoryFixture {};

TEST_F(TrajectorySampling, PositionsOnlyGiveStraightLines) {
  const auto trajectory = create({point(1, {1, -2}), point(3, {2, -2})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, at(0.5)).position, 0.5, 1e-12);
  EXPECT_NEAR(trajectory->sample(1, at(0.5)).velocity, -2, 1e-12);
  EXPECT_NEAR(trajectory->sample(0, at(2)).position, 1.5, 1e-12);
  EXPECT_NEAR(trajectory->sample(0, at(2)).velocity, 0.5, 1e-12);
}

TEST_F(TrajectorySampling, ExactlyAtAPointTheNextSegmentCounts) {
  const auto trajectory = create({point(1, {1, 0}), point(3, {2, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, at(1)).position, 1, 1e-12);
  EXPECT_NEAR(trajectory->sample(0, at(1)).velocity, 0.5, 1e-12);
}

TEST_F(TrajectorySampling, VelocitiesGiveCubics) {
  const auto trajectory = create({point(1, {1, 2}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, at(0.5)).velocity, 1.5, 1e-12);
  EXPECT_NEAR(trajectory->sample(1, at(0.5)).velocity, 3, 1e-12);
}

TEST_F(TrajectorySampling, AccelerationsGiveQuintics) {
  const auto trajectory = create({point(1, {1, 2}, {0, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, at(0.5)).velocity, 1.875, 1e-12);
}

TEST_F(TrajectorySampling, PassesAPointAsItIsGiven) {
  const auto trajectory =
      create({point(1, {1, -2}, {0.5, 0.25}, {2, -3}), point(2, {2, -2}, {0, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  const MotionState given[] = {{1, 0.5, 2}, {-2, 0.25, -3}};
  for (const Time time : {at(1) - Duration(1), at(1)}) {
    for (std::size_t j = 0; j < 2; ++j) {
      const MotionState state = trajectory->sample(j, time);
      EXPECT_NEAR(state.position, given[j].position, 1e-8) << j;
      EXPECT_NEAR(state.velocity, given[j].velocity, 1e-8) << j;
      EXPECT_NEAR(state.acceleration, given[j].acceleration, 1e-6) << j;
    }
  }
}

TEST_F(TrajectorySampling, ASegmentHasOnlyTheOrderThatBothItsEndsCarry) {
  const auto trajectory = create({point(1, {1, 0}, {0, 0}, {0, 0}), point(2, {2, 0}, {0, 0}),
                                  point(3, {3, 0}), point(4, {4, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, at(0.5)).velocity, 1.875, 1e-12);
  EXPECT_NEAR(trajectory->sample(0, at(1.5)).velocity, 1.5, 1e-12);
  EXPECT_NEAR(trajectory->sample(0, at(2.5)).velocity, 1, 1e-12);
  EXPECT_NEAR(trajectory->sample(0, at(3.5)).velocity, 1, 1e-12);
}

TEST_F(TrajectorySampling, LeavesFromThePresentMovingState) {
  commanded[0] = {0.2, 1, -3};
  const auto trajectory = create({point(1, {1, 0}, {0, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  const MotionState first = trajectory->sample(0, at(0));
  EXPECT_NEAR(first.position, 0.2, 1e-12);
  EXPECT_NEAR(first.velocity, 1, 1e-12);
  EXPECT_NEAR(first.acceleration, -3, 1e-12);
}

TEST_F(TrajectorySampling, PreemptionHalfwayKeepsPositionVelocityAndAcceleration) {
  const auto first = create({point(1, {1, 0}, {0, 0}, {0, 0})});
  ASSERT_TRUE(first.ok());
  std::vector<MotionState> state(2);
  first->sample(at(0.25), state);
  const auto second = Trajectory::create(joints, state, {point(1, {-1, 0}, {0, 0}, {0, 0})},
                                         {at(0.25), std::nullopt, false});
  ASSERT_TRUE(second.ok());
  const MotionState before = first->sample(0, at(0.25)), after = second->sample(0, at(0.25));
  EXPECT_NEAR(before.position, 0.103515625, 1e-12);
  EXPECT_NEAR(after.position, before.position, 1e-12);
  EXPECT_NEAR(after.velocity, before.velocity, 1e-12);
  EXPECT_NEAR(after.acceleration, before.acceleration, 1e-12);
  EXPECT_NEAR(second->sample(0, at(1.25)).position, -1, 1e-12);
}

TEST_F(TrajectorySampling, HoldsTheLastPositionAtRestAfterTheEnd) {
  const auto trajectory = create({point(1, {1, 2})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_FALSE(trajectory->finished(at(1) - Duration(1)));
  EXPECT_TRUE(trajectory->finished(at(1)));
  EXPECT_EQ(trajectory->endTime(), at(1));
  for (const double seconds : {1.0, 50.0}) {
    const MotionState state = trajectory->sample(1, at(seconds));
    EXPECT_EQ(state.position, 2);
    EXPECT_EQ(state.velocity, 0);
    EXPECT_EQ(state.acceleration, 0);
  }
}

TEST_F(TrajectorySampling, AllJointsAtOnceGiveWhatOneAtATimeGives) {
  const auto trajectory = create({point(1, {1, 2}, {1, 1}), point(2, {3, 1}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  std::vector<MotionState> states(2);
  for (const double seconds : {-1.0, 0.0, 0.3, 1.0, 1.7, 2.0, 9.0}) {
    trajectory->sample(at(seconds), states);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_EQ(states[j].position, trajectory->sample(j, at(seconds)).position);
      EXPECT_EQ(states[j].velocity, trajectory->sample(j, at(seconds)).velocity);
    }
  }
}

TEST_F(TrajectorySampling, PositionsAloneAreThoseOfTheStatesToTheLastBit) {
  commanded[0] = {0.2, 1, -3};
  const auto trajectory =
      create({point(1, {1, 0.3}, {0.1, 0}, {0, 0}), point(2.5, {2, 0.7}, {0, 0}),
              point(3, {3, 0.1}), point(4.7, {4, -1}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  std::vector<MotionState> states(2);
  std::vector<double> positions(2);
  for (double time = -0.1; time < 5.0; time += 0.013) {
    trajectory->sample(at(time), states);
    trajectory->samplePositions(at(time), positions);
    EXPECT_EQ(positions, (std::vector<double>{states[0].position, states[1].position})) << time;
  }
}

TEST_F(TrajectorySampling, NeverWritesBeyondTheRoomItIsGiven) {
  const auto trajectory = create({point(1, {1, 2})});
  std::vector<MotionState> one(1), three(3, {9, 9, 9});
  trajectory->sample(at(1), one);
  trajectory->sample(at(1), three);
  EXPECT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].position, 1);
  EXPECT_EQ(three[1].position, 2);
  EXPECT_EQ(three[2].position, 9);
}

TEST_F(TrajectorySampling, WaitsAtThePresentPositionForAStartInTheFuture) {
  commanded[0].position = 0.5;
  start.start_time = at(2);
  const auto trajectory = create({point(1, {1.5, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_EQ(trajectory->startTime(), at(2));
  EXPECT_EQ(trajectory->sample(0, at(1)).position, 0.5);
  EXPECT_EQ(trajectory->sample(0, at(1)).velocity, 0);
  EXPECT_NEAR(trajectory->sample(0, at(2.5)).position, 1, 1e-12);
  EXPECT_EQ(trajectory->endTime(), at(3));
}

TEST_F(TrajectorySampling, DropsPointsThatHavePassedAndJoinsTheRest) {
  start.start_time = at(-1.5);
  const auto trajectory =
      create({point(0.5, {7, 7}), point(1.5, {8, 8}), point(2.5, {1, 0}), point(3.5, {2, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_EQ(trajectory->startTime(), kNow);
  EXPECT_NEAR(trajectory->sample(0, at(0.5)).position, 0.5, 1e-12);
  EXPECT_EQ(trajectory->endTime(), at(2));
}

TEST_F(TrajectorySampling, AFirstPointAtTimeZeroIsThePresentState) {
  const auto trajectory = create({point(0, {0, 0}, {0, 0}), point(1, {1, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, at(0.5)).velocity, 1.5, 1e-12);
}

TEST_F(TrajectorySampling, NoPointsAskForAStop) {
  commanded[0] = {0.5, 1, 0};
  const auto trajectory = create({});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_TRUE(trajectory->finished(kNow));
  EXPECT_EQ(trajectory->sample(0, at(1)).position, 0.5);
}

TEST_F(TrajectorySampling, ContinuousJointTakesTheShortestWayWhereAsked) {
  joints[0].limits.continuous = true;
  commanded[0].position = 3;
  const std::vector<TrajectoryPoint> points{point(1, {-3, 0}), point(2, {-2, 0})};
  EXPECT_NEAR(create(points)->sample(0, at(1)).position, -3, 1e-12);
  start.shortest_way = true;
  const auto wrapped = create(points);
  EXPECT_NEAR(wrapped->sample(0, at(1)).position, 2 * kPi - 3, 1e-12);
  EXPECT_NEAR(wrapped->sample(0, at(2)).position, 2 * kPi - 2, 1e-12);
  EXPECT_NEAR(wrapped->goal()[0], 2 * kPi - 2, 1e-12);
}

// ros_controllers' wraparoundJointOffset: within 1e-9 of half a turn the asked direction is kept.
TEST_F(TrajectorySampling, HalfATurnKeepsTheAskedDirection) {
  joints[0].limits.continuous = true;
  start.shortest_way = true;
  const struct {
    double from, first, goal;
  } cases[] = {
      {0.0, kPi, kPi},
      {0.0, -kPi, -kPi},
      {kPi, 0.0, 0.0},
      {-kPi, 0.0, 0.0},
      {-kPi / 2, kPi / 2, kPi / 2},
      {kPi / 2, -kPi / 2, -kPi / 2},
      {0.0, 3 * kPi, kPi},
      {0.0, -3 * kPi, -kPi},
      {0.0, kPi + 0.5e-9, kPi},
      {0.0, -kPi - 0.5e-9, -kPi},
      {1.0, 1.0 + 5 * kPi, 1.0 + kPi},
      {0.0, kPi + 1e-6, -kPi + 1e-6},  // the other way is shorter
      {0.0, -kPi - 1e-6, kPi - 1e-6},
  };
  for (const auto& way : cases) {
    commanded[0].position = way.from;
    EXPECT_NEAR(create({point(4, {way.first, 0})})->goal()[0], way.goal, 1e-8)
        << way.from << " to " << way.first;
  }
}

TEST_F(TrajectorySampling, OrdinaryJointNeverTakesAShorterWayRound) {
  start.shortest_way = true;
  commanded[0].position = 3;
  EXPECT_NEAR(create({point(1, {-3, 0})})->sample(0, at(1)).position, -3, 1e-12);
}

TEST_F(TrajectorySampling, TimesStayExactLateInTheLifeOfTheClock) {
  start.now = Time{std::chrono::hours(24 * 365 * 100)};
  const auto trajectory = create({point(1, {1, 0}, {0, 0})});
  ASSERT_TRUE(trajectory.ok());
  EXPECT_NEAR(trajectory->sample(0, start.now + fromSeconds(0.5)).velocity, 1.5, 1e-12);
}

std::string text(const std::vector<JointPlace>& places) {
  std::string all;
  for (const JointPlace& place : places) {
    all += std::to_string(place.joint) + " at " + std::to_string(place.place) + ", ";
  }
  return all;
}

TEST(MatchJoints, FindsThePlaceOfEachJoint) {
  const auto order = matchJoints({{"a", {}, {}}, {"b", {}, {}}, {"c", {}, {}}}, {"c", "a", "b"});
  ASSERT_TRUE(order);
  EXPECT_EQ(text(*order), "0 at 1, 1 at 2, 2 at 0, ");
}

TEST(MatchJoints, LeavesJointsOutWhereThatIsAllowed) {
  const std::vector<Joint> joints{{"a", {}, {}}, {"b", {}, {}}, {"c", {}, {}}};
  const auto some = matchJoints(joints, {"c", "b"}, true);
  ASSERT_TRUE(some);
  EXPECT_EQ(text(*some), "1 at 1, 2 at 0, ");
  EXPECT_FALSE(matchJoints(joints, {"c", "b"}));
  EXPECT_FALSE(matchJoints(joints, {}, true)) << "but not all";
  EXPECT_FALSE(matchJoints(joints, {"c", "c"}, true));
  EXPECT_FALSE(matchJoints(joints, {"c", "x"}, true));
}

TEST(MatchJoints, NamesUnknownMissingAndRepeatedJointsAllAtOnce) {
  const auto order = matchJoints({{"a", {}, {}}, {"b", {}, {}}}, {"a", "x", "a"});
  ASSERT_FALSE(order);
  EXPECT_EQ(order.error().message,
            "the group has no joint 'x'; the trajectory lacks joint 'b'; the trajectory names more "
            "than once 'a'; the group's joints are 'a', 'b'");
}

}  // namespace
}  // namespace cia402::motion
