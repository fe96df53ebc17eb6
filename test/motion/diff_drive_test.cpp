// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/diff_drive.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace cia402::motion {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr DiffDriveGeometry kBase{0.4, 0.1};
// 1 m/s are 10 rad/s of a wheel.
constexpr PlanarLimits kLimits{0.5, 1.0, 1.0, 2.0, 6.0};

TEST(DiffDrive, TurnsWheelsAlikeStraightAheadAndAgainstEachOtherOnTheSpot) {
  const WheelSpeeds ahead = wheelSpeeds(kBase, {0.5, 0.0});
  EXPECT_DOUBLE_EQ(ahead.left, 5.0);
  EXPECT_DOUBLE_EQ(ahead.right, 5.0);
  const WheelSpeeds left = wheelSpeeds(kBase, {0.0, 1.0});  // 0.2 m/s at each track
  EXPECT_DOUBLE_EQ(left.left, -2.0);
  EXPECT_DOUBLE_EQ(left.right, 2.0);
  const WheelSpeeds arc = wheelSpeeds(kBase, {-0.3, 0.5});
  EXPECT_DOUBLE_EQ(arc.left, -4.0);
  EXPECT_DOUBLE_EQ(arc.right, -2.0);
}

TEST(DiffDrive, MovesAsItsWheelsTurn) {
  const PlanarTwist twist = twistOf(kBase, {-4.0, -2.0});
  EXPECT_DOUBLE_EQ(twist.linear, -0.3);
  EXPECT_DOUBLE_EQ(twist.angular, 0.5);
}

TEST(TwistLimiter, KeepsTheCurveOfWhatIsTooFast) {
  const TwistLimiter limiter(kLimits, kBase);
  const PlanarTwist fast = limiter.within({2.0, 1.0});
  EXPECT_DOUBLE_EQ(fast.linear, 0.5);
  EXPECT_DOUBLE_EQ(fast.angular, 0.25);
  const PlanarTwist turning = limiter.within({-0.1, -4.0});
  EXPECT_DOUBLE_EQ(turning.linear, -0.025);
  EXPECT_DOUBLE_EQ(turning.angular, -1.0);
  const PlanarTwist both = limiter.within({0.5, 1.0});  // the outer wheel would need 7 rad/s
  EXPECT_NEAR(wheelSpeeds(kBase, both).right, 6.0, 1e-12);
  EXPECT_NEAR(both.linear / both.angular, 0.5, 1e-12);
  EXPECT_NEAR(wheelSpeeds(kBase, limiter.within({0.5, -1.0})).left, 6.0, 1e-12);
  const PlanarTwist slow = limiter.within({0.1, -0.2});
  EXPECT_DOUBLE_EQ(slow.linear, 0.1);
  EXPECT_DOUBLE_EQ(slow.angular, -0.2);
}

TEST(TwistLimiter, GetsThereWithItsAccelerationAndBothPartsAtOnce) {
  TwistLimiter limiter(kLimits, kBase);
  for (int i = 1; i <= 10; ++i) {  // 0.4 m/s take 0.4 s, 0.5 rad/s would take 0.25 s
    const PlanarTwist& twist = limiter.step({0.4, 0.5}, 0.02);
    EXPECT_NEAR(twist.linear, 0.02 * i, 1e-12);
    EXPECT_NEAR(twist.angular, 0.025 * i, 1e-12);
  }
  for (int i = 0; i < 10; ++i) limiter.step({0.4, 0.5}, 0.02);
  EXPECT_NEAR(limiter.twist().linear, 0.4, 1e-9);
  limiter.step({0.4, 0.5}, 0.02);
  EXPECT_EQ(limiter.twist().linear, 0.4);
  EXPECT_EQ(limiter.twist().angular, 0.5);
}

TEST(TwistLimiter, GoesAheadNoFasterThanItsTurnAllows) {
  TwistLimiter limiter(kLimits, kBase);
  for (int i = 1; i <= 10; ++i) {  // 0.8 rad/s take 0.4 s
    const PlanarTwist& twist = limiter.step({0.1, -0.8}, 0.02);
    EXPECT_NEAR(twist.linear, 0.005 * i, 1e-12);
    EXPECT_NEAR(twist.angular, -0.04 * i, 1e-12);
  }
}

TEST(TwistLimiter, ReversesThroughRest) {
  TwistLimiter limiter(kLimits, kBase);
  for (int i = 0; i < 60; ++i) limiter.step({0.5, 0.0}, 0.01);
  double before = limiter.twist().linear;
  ASSERT_EQ(before, 0.5);
  for (int i = 0; i < 100; ++i) {
    const double now = limiter.step({-0.5, 0.0}, 0.01).linear;
    EXPECT_LE(before - now, 0.01 + 1e-12);
    before = now;
  }
  EXPECT_NEAR(before, -0.5, 1e-9);
}

TEST(TwistLimiter, StandsStillWhereNoTimePasses) {
  TwistLimiter limiter(kLimits, kBase);
  EXPECT_TRUE(atRest(limiter.step({0.5, 1.0}, 0.0)));
}

TEST(WheelOdometry, TheFirstPositionsMoveNothing) {
  WheelOdometry odometry(kBase);
  odometry.update(1234.5, -99.0);
  EXPECT_EQ(odometry.pose().position, Eigen::Vector2d::Zero());
  EXPECT_EQ(odometry.pose().heading, 0.0);
}

TEST(WheelOdometry, GoesStraightAndBack) {
  WheelOdometry odometry(kBase);
  odometry.update(100.0, 7.0);
  odometry.update(120.0, 27.0);
  EXPECT_NEAR(odometry.pose().position.x(), 2.0, 1e-12);
  EXPECT_EQ(odometry.pose().position.y(), 0.0);
  odometry.update(95.0, 2.0);
  EXPECT_NEAR(odometry.pose().position.x(), -0.5, 1e-12);
  EXPECT_EQ(odometry.pose().heading, 0.0);
}

TEST(WheelOdometry, TurnsOnTheSpotOverManyTurns) {
  WheelOdometry odometry(kBase);
  odometry.update(0.0, 0.0);
  for (int i = 1; i <= 100; ++i) odometry.update(-i * kHalfTurn / 5.0, i * kHalfTurn / 5.0);
  EXPECT_NEAR(odometry.pose().position.norm(), 0.0, 1e-12);
  EXPECT_NEAR(odometry.pose().heading, 100 * kHalfTurn / 10.0, 1e-9);  // 0.1 m * pi/5 / 0.2 m
}

/// A quarter of a circle of 1 m: the tracks are 0.8 and 1.2 m off its centre.
TEST(WheelOdometry, AnArcInOneStepIsExact) {
  WheelOdometry odometry(kBase);
  odometry.update(0.0, 0.0);
  odometry.update(0.8 * kHalfTurn / 2.0 / 0.1, 1.2 * kHalfTurn / 2.0 / 0.1);
  EXPECT_NEAR(odometry.pose().position.x(), 1.0, 1e-12);
  EXPECT_NEAR(odometry.pose().position.y(), 1.0, 1e-12);
  EXPECT_NEAR(odometry.pose().heading, kHalfTurn / 2.0, 1e-12);
}

TEST(WheelOdometry, ACircleClosesHoweverItIsCut) {
  for (const int pieces : {1, 2, 7, 1000}) {
    WheelOdometry odometry(kBase);
    odometry.update(0.0, 0.0);
    for (int i = 1; i <= pieces; ++i) {
      odometry.update(0.8 * 2.0 * kHalfTurn / 0.1 * i / pieces,
                      1.2 * 2.0 * kHalfTurn / 0.1 * i / pieces);
    }
    EXPECT_NEAR(odometry.pose().position.norm(), 0.0, 1e-9) << pieces;
    EXPECT_NEAR(odometry.pose().heading, 2.0 * kHalfTurn, 1e-9) << pieces;
  }
}

/// Against a chain of rigid motions, each an arc written as a rotation about its centre.
TEST(WheelOdometry, IsTheProductOfRotationsAboutTheCentresOfItsArcs) {
  WheelOdometry odometry(kBase);
  Eigen::Isometry2d pose = Eigen::Isometry2d::Identity();
  double left = 3.0, right = -5.0;
  odometry.update(left, right);
  for (int i = 0; i < 50; ++i) {
    const double way = 0.07 * std::sin(0.9 * i), angle = 0.3 + 0.25 * std::cos(0.4 * i);
    left += (way - angle * 0.2) / 0.1;
    right += (way + angle * 0.2) / 0.1;
    odometry.update(left, right);
    const Eigen::Translation2d centre(0.0, way / angle);
    pose = pose * centre * Eigen::Rotation2Dd(angle) * centre.inverse();
  }
  EXPECT_LT((odometry.pose().position - pose.translation()).norm(), 1e-9);
  EXPECT_NEAR(std::remainder(odometry.pose().heading - Eigen::Rotation2Dd(pose.rotation()).angle(),
                             2.0 * kHalfTurn),
              0.0, 1e-9);
}

TEST(WheelOdometry, WhatWasLostMovesNothing) {
  WheelOdometry odometry(kBase);
  odometry.update(0.0, 0.0);
  odometry.update(10.0, 10.0);
  odometry.lose();
  EXPECT_FALSE(odometry.following());
  odometry.update(-700.0, 300.0);
  EXPECT_DOUBLE_EQ(odometry.pose().position.x(), 1.0);
  odometry.update(-690.0, 310.0);
  EXPECT_DOUBLE_EQ(odometry.pose().position.x(), 2.0);
  EXPECT_EQ(odometry.pose().heading, 0.0);
}

}  // namespace
}  // namespace cia402::motion
