// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Where frames are. The numbers were computed by hand; those of random frames by formulas that are
// written out below.
#include "ros/frame_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cia402::ros_node {
namespace {

using Eigen::Vector3d;
using motion::JointUnit;

constexpr double kPi = 3.14159265358979323846;

config::FrameConfig frameAt(const Vector3d& xyz, const Vector3d& rpy,
                            const Vector3d& axis = {0, 0, 1}) {
  config::FrameConfig frame;
  frame.parent = "base";
  frame.child = "arm";
  for (int i = 0; i < 3; ++i) {
    frame.xyz[i] = xyz[i];
    frame.rpy[i] = rpy[i];
    frame.axis[i] = axis[i];
  }
  return frame;
}

void expectNear(const Vector3d& a, const Vector3d& b, double tolerance = 1e-12) {
  EXPECT_NEAR((a - b).norm(), 0.0, tolerance) << a.transpose() << " is not " << b.transpose();
}

/// Where the frame's axes point, in the parent.
void expectAxes(const Eigen::Isometry3d& pose, const Vector3d& x, const Vector3d& y,
                const Vector3d& z) {
  expectNear(pose.linear() * Vector3d::UnitX(), x);
  expectNear(pose.linear() * Vector3d::UnitY(), y);
  expectNear(pose.linear() * Vector3d::UnitZ(), z);
}

TEST(Origin, IsAShiftThenATurn) {
  const Eigen::Isometry3d pose = originOf(frameAt({1, 2, 3}, {0, 0, kPi / 2}));
  expectNear(pose * Vector3d(0, 0, 0), {1, 2, 3});
  expectNear(pose * Vector3d(1, 0, 0), {1, 3, 3});
}

TEST(Origin, TurnsAboutTheFixedAxesXThenYThenZ) {
  expectAxes(originOf(frameAt({0, 0, 0}, {kPi / 2, 0, 0})), {1, 0, 0}, {0, 0, 1}, {0, -1, 0});
  expectAxes(originOf(frameAt({0, 0, 0}, {0, kPi / 2, 0})), {0, 0, -1}, {0, 1, 0}, {1, 0, 0});
  expectAxes(originOf(frameAt({0, 0, 0}, {kPi / 2, 0, kPi / 2})), {0, 1, 0}, {0, 0, 1}, {1, 0, 0});
  expectAxes(originOf(frameAt({0, 0, 0}, {0, kPi / 2, kPi / 2})), {0, 0, -1}, {-1, 0, 0},
             {0, 1, 0});
}

TEST(Pose, OfARevoluteJointTurnsAboutItsAxis) {
  const auto elbow = frameAt({0.4, 0, 0}, {0, 0, 0});
  const Eigen::Isometry3d pose = poseOf(elbow, JointUnit::radian, kPi / 6);
  expectNear(pose * Vector3d(0, 0, 0), {0.4, 0, 0});
  expectNear(pose * Vector3d(1, 0, 0), {0.4 + std::sqrt(3.0) / 2, 0.5, 0});
  // Half a turn about (0, 0.6, 0.8): v goes to 2 a (a v) - v.
  expectAxes(poseOf(frameAt({0, 0, 0}, {0, 0, 0}, {0, 0.6, 0.8}), JointUnit::radian, kPi),
             {-1, 0, 0}, {0, -0.28, 0.96}, {0, 0.96, 0.28});
}

TEST(Pose, TurnsAndShiftsInTheTurnedFrame) {
  // The frame's z points along the parent's -y, its x along x.
  const auto frame = frameAt({1, 2, 3}, {kPi / 2, 0, 0});
  expectNear(poseOf(frame, JointUnit::metre, 0.5).translation(), {1, 1.5, 3});
  expectAxes(poseOf(frame, JointUnit::metre, 0.5), {1, 0, 0}, {0, 0, 1}, {0, -1, 0});
  const Eigen::Isometry3d turned = poseOf(frame, JointUnit::radian, kPi / 2);
  expectNear(turned.translation(), {1, 2, 3});
  expectAxes(turned, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0});
}

TEST(Pose, OfAPrismaticJointShiftsAlongItsAxisByMetres) {
  expectNear(
      poseOf(frameAt({0, 0, 1}, {0, 0, 0}, {0, 0.6, 0.8}), JointUnit::metre, -0.5).translation(),
      {0, -0.3, 0.6});
}

TEST(Pose, DoesNotDependOnTheLengthOfTheAxis) {
  expectNear(poseOf(frameAt({0, 0, 0}, {0, 0, 0}, {0, 3, 4}), JointUnit::metre, 0.5).translation(),
             {0, 0.3, 0.4});
  expectAxes(poseOf(frameAt({0, 0, 0}, {0, 0, 0}, {0, 3, 4}), JointUnit::radian, kPi), {-1, 0, 0},
             {0, -0.28, 0.96}, {0, 0.96, 0.28});
}

TEST(Pose, OfAContinuousJointIsThatOfItsLastTurn) {
  const Eigen::Isometry3d pose =
      poseOf(frameAt({0, 0, 0}, {0, 0, 0}), JointUnit::radian, 2000 * kPi + kPi / 3);
  expectNear(pose * Vector3d(1, 0, 0), {0.5, std::sqrt(3.0) / 2, 0}, 1e-11);
}

TEST(Transform, HasNamesStampPlaceAndTurn) {
  const auto frame = frameAt({1, 2, 3}, {0, 0, 0}, {0, 1, 0});
  const auto message =
      toTransform(frame, poseOf(frame, JointUnit::radian, kPi / 2), ros::Time(12, 34));
  EXPECT_EQ(message.header.stamp, ros::Time(12, 34));
  EXPECT_EQ(message.header.frame_id, "base");
  EXPECT_EQ(message.child_frame_id, "arm");
  EXPECT_EQ(message.transform.translation.x, 1);
  EXPECT_EQ(message.transform.translation.y, 2);
  EXPECT_EQ(message.transform.translation.z, 3);
  EXPECT_NEAR(message.transform.rotation.x, 0, 1e-15);
  EXPECT_NEAR(message.transform.rotation.y, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(message.transform.rotation.z, 0, 1e-15);
  EXPECT_NEAR(message.transform.rotation.w, std::sqrt(0.5), 1e-15);
}

// What URDF says, without Eigen's angles.

/// v turned about an axis of length 1, as Rodrigues has it.
Vector3d turned(const Vector3d& v, const Vector3d& axis, double angle) {
  return v * std::cos(angle) + axis.cross(v) * std::sin(angle) +
         axis * axis.dot(v) * (1 - std::cos(angle));
}

/// Where a point of the joint's frame is in the parent.
Vector3d byHand(const Vector3d& point, const Vector3d& xyz, const Vector3d& rpy,
                const Vector3d& axis, JointUnit unit, double position) {
  const Vector3d unit_axis = axis / std::sqrt(axis.dot(axis));
  const bool turns = unit == JointUnit::radian;
  Vector3d v = turns ? turned(point, unit_axis, position) : Vector3d(point + unit_axis * position);
  v = turned(v, {1, 0, 0}, rpy[0]);
  v = turned(v, {0, 1, 0}, rpy[1]);
  v = turned(v, {0, 0, 1}, rpy[2]);
  return v + xyz;
}

Vector3d appliedTo(const Vector3d& point, const geometry_msgs::Transform& transform) {
  const Vector3d q(transform.rotation.x, transform.rotation.y, transform.rotation.z);
  const double w = transform.rotation.w;
  const Vector3d turn = point + 2 * w * q.cross(point) + 2 * q.cross(q.cross(point));
  return turn + Vector3d(transform.translation.x, transform.translation.y, transform.translation.z);
}

/// Frames of any place, turn and axis.
struct RandomFrames : testing::Test {
  Vector3d random(double most) {
    std::uniform_real_distribution<double> numbers(-most, most);
    const double x = numbers(engine), y = numbers(engine);
    return {x, y, numbers(engine)};
  }
  void next() {
    xyz = random(2);
    rpy = random(4);
    do axis = random(1);
    while (axis.norm() < 1e-3);
    position = random(10)[0];
    frame = frameAt(xyz, rpy, axis);
  }
  std::mt19937 engine{1};
  Vector3d xyz, rpy, axis;
  double position = 0;
  config::FrameConfig frame;
};

TEST_F(RandomFrames, AreWhereTheFormulasSay) {
  for (int i = 0; i < 2000; ++i) {
    next();
    for (const JointUnit unit : {JointUnit::radian, JointUnit::metre}) {
      const auto message = toTransform(frame, poseOf(frame, unit, position), ros::Time(1));
      const Vector3d point = random(1);
      expectNear(appliedTo(point, message.transform),
                 byHand(point, xyz, rpy, axis, unit, position));
      const auto& q = message.transform.rotation;
      EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1.0, 1e-14);
    }
    if (HasFailure()) return;
  }
}

TEST_F(RandomFrames, GiveAxisAndPositionBack) {
  for (int i = 0; i < 2000; ++i) {
    next();
    const Eigen::Isometry3d back = originOf(frame).inverse();
    const Eigen::AngleAxisd turn((back * poseOf(frame, JointUnit::radian, position)).linear());
    const double turns =
        std::remainder(turn.angle() * turn.axis().dot(axis.normalized()) - position, 2 * kPi);
    EXPECT_NEAR(turns, 0.0, 1e-7) << "rad, of " << position;
    const Eigen::Isometry3d shift = back * poseOf(frame, JointUnit::metre, position);
    expectNear(shift.translation(), axis.normalized() * position);
    EXPECT_NEAR((shift.linear() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-13);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace cia402::ros_node
