// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/coupling.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace cia402::motion {
namespace {

using testing::HasSubstr;

Eigen::MatrixXd matrix2(double a, double b, double c, double d) {
  Eigen::MatrixXd matrix(2, 2);
  matrix << a, b, c, d;
  return matrix;
}

Result<Coupling> wrist(const Eigen::MatrixXd& matrix) {
  return Coupling::create({"wrist_pitch", "wrist_roll"}, {"m5", "m6"}, matrix);
}

Coupling differential() { return wrist(matrix2(0.5, 0.5, 1.0, -1.0)).value(); }

TEST(Coupling, DifferentialWristTurnsAxisPositionsIntoJointPositions) {
  Eigen::VectorXd joints(2);
  differential().toJoints(Eigen::Vector2d(0.4, 0.2), joints);
  EXPECT_NEAR(joints(0), 0.3, 1e-15);
  EXPECT_NEAR(joints(1), 0.2, 1e-15);
}

TEST(Coupling, DifferentialWristTurnsJointPositionsIntoAxisPositions) {
  Eigen::VectorXd axes(2);
  differential().toAxes(Eigen::Vector2d(0.3, 0.2), axes);
  EXPECT_NEAR(axes(0), 0.4, 1e-15);
  EXPECT_NEAR(axes(1), 0.2, 1e-15);
}

TEST(Coupling, EffortGoesThroughTheTranspose) {
  Eigen::VectorXd axes(2), joints(2);
  differential().effortToAxes(Eigen::Vector2d(4, 1), axes);  // 0.5*4 + 1*1, 0.5*4 - 1*1
  EXPECT_NEAR(axes(0), 3, 1e-15);
  EXPECT_NEAR(axes(1), 1, 1e-15);
  differential().effortToJoints(axes, joints);
  EXPECT_NEAR(joints(0), 4, 1e-15);
  EXPECT_NEAR(joints(1), 1, 1e-15);
}

TEST(Coupling, ThereAndBackIsTheSameAndPowerIsKept) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> random(-2, 2);
  const auto fill = [&](auto& values) {
    for (Eigen::Index k = 0; k < values.size(); ++k) values.data()[k] = random(engine);
  };
  for (int i = 0; i < 200; ++i) {
    Eigen::MatrixXd matrix(3, 3);
    fill(matrix);
    matrix += 3 * Eigen::MatrixXd::Identity(3, 3);
    const auto coupling = Coupling::create({"a", "b", "c"}, {"1", "2", "3"}, matrix);
    if (!coupling) continue;
    Eigen::VectorXd joints(3), axes(3), back(3), effort(3), axis_effort(3);
    fill(joints);
    fill(effort);
    coupling->toAxes(joints, axes);
    coupling->toJoints(axes, back);
    EXPECT_NEAR((back - joints).norm(), 0, 1e-9);
    coupling->effortToAxes(effort, axis_effort);
    EXPECT_NEAR(axis_effort.dot(axes), effort.dot(joints), 1e-9 * (1 + axes.norm()));
  }
}

TEST(Coupling, SingularMatrixIsRefusedInWords) {
  const auto result = wrist(matrix2(0.5, 0.5, 1, 1));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message,
              HasSubstr("coupling of joints wrist_pitch, wrist_roll with axes m5, m6: the matrix "
                        "[[0.5, 0.5], [1, 1]] is singular"));
  EXPECT_FALSE(wrist(matrix2(0, 0, 0, 0)));
  EXPECT_FALSE(wrist(matrix2(1, 0, 2, 0)));
}

TEST(Coupling, IsRefusedWhereTheConditionNumberIsBeyondAThousand) {
  // 2 and d / 2 are the singular values of these: condition numbers 4 / d
  const auto refused = wrist(matrix2(1, 1, 1, 1 + 3.9e-3));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr("is badly conditioned (condition number 1.03e+03, at most 1000)"));
  EXPECT_TRUE(wrist(matrix2(1, 1, 1, 1 + 4.1e-3)));
  EXPECT_THAT(wrist(matrix2(1, 1, 1, 1)).error().message,
              HasSubstr("is singular (condition number inf"));
}

TEST(Coupling, AnUnknownAxisLeavesThoseJointsKnownThatDoNotNeedIt) {
  const Coupling coupling = wrist(matrix2(2, 0, 1, 1)).value();
  const Eigen::Vector2d axes(0.5, std::nan(""));
  EXPECT_EQ(coupling.toJoint(0, axes), 1.0);
  EXPECT_TRUE(std::isnan(coupling.toJoint(1, axes)));
}

TEST(Coupling, SaysWhatAnAxisGetsFromAllJointsAtOnce) {
  // pitch = (a + b) / 2, roll = a - b: a = pitch + roll / 2
  EXPECT_NEAR(differential().mostOfAxis(0, Eigen::Vector2d(2, 3)), 3.5, 1e-12);
  EXPECT_NEAR(differential().mostOfAxis(1, Eigen::Vector2d(2, 3)), 3.5, 1e-12);
  EXPECT_NEAR(differential().shareOfAxis(1, 1), -0.5, 1e-12);
}

TEST(Coupling, UnequalScalesAreNotMistakenForSingularity) {
  EXPECT_TRUE(wrist(matrix2(1e-6, 0, 0, 1e6)));
  EXPECT_TRUE(wrist(matrix2(1e-7, 1e-7, 1e5, -1e5)));
  EXPECT_TRUE(wrist(matrix2(1, 1e12, 1, -1e12))) << "one axis has a large gear ratio";
}

TEST(Coupling, WrongSizesAreRefusedInWords) {
  const auto shape = wrist(Eigen::MatrixXd::Identity(2, 3));
  ASSERT_FALSE(shape);
  EXPECT_THAT(shape.error().message, HasSubstr("2 rows and 3 columns; it needs 2 of each"));
  const auto names = Coupling::create({"a"}, {"1", "2"}, Eigen::MatrixXd::Identity(1, 2));
  ASSERT_FALSE(names);
  EXPECT_THAT(names.error().message, HasSubstr("1 joints and 2 axes"));
  EXPECT_FALSE(Coupling::create({}, {}, Eigen::MatrixXd()));
}

TEST(Coupling, MatrixWithNanIsRefused) {
  const auto result = wrist(matrix2(1, 0, 0, std::nan("")));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("not a number"));
}

}  // namespace
}  // namespace cia402::motion
