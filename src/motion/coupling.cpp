// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/coupling.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

#include "common/text.h"
#include "motion/joint.h"

namespace cia402::motion {

namespace {

constexpr double kSmallestRcond = 1e-9;

std::string printed(const Eigen::MatrixXd& matrix) {
  std::string text = "[";
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    text += row == 0 ? "[" : ", [";
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      text += (column == 0 ? "" : ", ") + formatNumber(matrix(row, column));
    }
    text += "]";
  }
  return text + "]";
}

/// Smallest over largest singular value, after scaling the rows (joints) and then the columns
/// (axes): metres beside radians or a large gear ratio do not make a coupling singular.
double reciprocalCondition(Eigen::MatrixXd matrix) {
  constexpr double kTiny = 1e-300;  // a row of zeros stays one
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    matrix.row(i) /= std::max(matrix.row(i).cwiseAbs().maxCoeff(), kTiny);
  }
  for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
    matrix.col(i) /= std::max(matrix.col(i).cwiseAbs().maxCoeff(), kTiny);
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix);
  const auto& values = svd.singularValues();
  return values(0) > 0 ? values(values.size() - 1) / values(0) : 0;
}

}  // namespace

Coupling::Coupling(std::vector<std::string> joints, std::vector<std::string> axes,
                   const Eigen::MatrixXd& matrix)
    : joints_(std::move(joints)),
      axes_(std::move(axes)),
      matrix_(matrix),
      inverse_(matrix.fullPivLu().inverse()),
      transposed_(matrix.transpose()),
      inverse_transposed_(inverse_.transpose()) {}

Result<Coupling> Coupling::create(std::vector<std::string> joints, std::vector<std::string> axes,
                                  const Eigen::MatrixXd& matrix) {
  const std::string who =
      "coupling of joints " + joined(joints, ", ") + " with axes " + joined(axes, ", ");
  const auto rows = static_cast<Eigen::Index>(joints.size());
  const auto columns = static_cast<Eigen::Index>(axes.size());
  if (rows == 0 || rows != columns) {
    return Error{who + ": " + std::to_string(rows) + " joints and " + std::to_string(columns) +
                 " axes; there must be as many of one as of the other, and at least one"};
  }
  if (matrix.rows() != rows || matrix.cols() != columns) {
    return Error{who + ": the matrix has " + std::to_string(matrix.rows()) + " rows and " +
                 std::to_string(matrix.cols()) + " columns; it needs " + std::to_string(rows) +
                 " of each"};
  }
  if (!matrix.allFinite()) {
    return Error{who + ": the matrix " + printed(matrix) + " has an element that is not a number"};
  }
  if (reciprocalCondition(matrix) < kSmallestRcond) {
    return Error{who + ": the matrix " + printed(matrix) +
                 " is singular: some movement of the axes would move no joint, so that axis "
                 "set-points cannot be computed; check for a row or column that is zero or a "
                 "multiple of another"};
  }
  return Coupling(std::move(joints), std::move(axes), matrix);
}

}  // namespace cia402::motion
