// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cia402_driver/common/result.h"

namespace cia402::motion {

/// Ties the joints a person thinks in to the axes that motors move, as in a differential wrist:
/// joint = matrix * axis, for positions, velocities and accelerations alike. Effort goes the other
/// way round (the power is the same on both sides): axis effort = matrixᵀ * joint effort.
///
/// The conversions neither allocate nor fail. Input and output are contiguous (a vector, or an
/// Eigen::Map of one), have size() elements each and must not overlap.
class Coupling {
 public:
  using Input = Eigen::Ref<const Eigen::VectorXd>;
  using Output = Eigen::Ref<Eigen::VectorXd>;

  /// The worst condition number of a matrix, see create(): small errors of the axes become errors
  /// of the joints, and the other way round, that are larger by as much.
  static constexpr double kWorstCondition = 1000.0;

  /// One row a joint, one column an axis. @return why the matrix cannot be used: not square, of
  /// another size than the names, not finite, or singular or badly conditioned: some movement of
  /// the axes moves no joint, or next to none. The condition number is the largest over the
  /// smallest singular value after scaling rows and columns, so that metres beside radians or a
  /// large gear ratio do not count.
  static Result<Coupling> create(std::vector<std::string> joints, std::vector<std::string> axes,
                                 const Eigen::MatrixXd& matrix);

  /// Positions, velocities or accelerations of the joints from those of the axes.
  void toJoints(const Input& axes, Output joints) const { joints.noalias() = matrix_ * axes; }
  /// Positions, velocities or accelerations of the axes from those of the joints.
  void toAxes(const Input& joints, Output axes) const { axes.noalias() = inverse_ * joints; }
  /// Joint efforts (N·m or N) from axis efforts.
  void effortToJoints(const Input& axes, Output joints) const {
    joints.noalias() = inverse_transposed_ * axes;
  }
  /// Axis efforts (N·m or N) from joint efforts.
  void effortToAxes(const Input& joints, Output axes) const {
    axes.noalias() = transposed_ * joints;
  }

  /// One joint of toJoints(). Axes that it does not depend on may be NaN: unknown.
  double toJoint(std::size_t joint, const Input& axes) const { return dot(matrix_, joint, axes); }
  /// One joint of effortToJoints(), likewise.
  double effortToJoint(std::size_t joint, const Input& axes) const {
    return dot(inverse_transposed_, joint, axes);
  }

  /// The largest magnitude that `axis` can get from joints of these magnitudes, all at once.
  double mostOfAxis(std::size_t axis, const Input& joints) const {
    return inverse_.row(static_cast<Eigen::Index>(axis)).cwiseAbs().dot(joints);
  }
  /// How much of a joint's motion an axis makes, e.g. in radians a radian.
  double shareOfAxis(std::size_t axis, std::size_t joint) const {
    return inverse_(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(joint));
  }

  std::size_t size() const { return joints_.size(); }
  const std::vector<std::string>& joints() const { return joints_; }
  const std::vector<std::string>& axes() const { return axes_; }
  const Eigen::MatrixXd& matrix() const { return matrix_; }

 private:
  Coupling(std::vector<std::string> joints, std::vector<std::string> axes,
           const Eigen::MatrixXd& matrix);
  static double dot(const Eigen::MatrixXd& matrix, std::size_t row, const Input& values);

  std::vector<std::string> joints_, axes_;
  Eigen::MatrixXd matrix_, inverse_, transposed_, inverse_transposed_;
};

}  // namespace cia402::motion
