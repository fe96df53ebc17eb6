// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "motion/coupling.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>

#include "common/text.h"
#include "motion/joint.h"

namespace cia402::motion {

namespace {

constexpr double kSingular = 1e12;  // beyond that a condition number is rounding

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

/// After scaling the rows (joints) and then the columns (axes).
double conditionOf(Eigen::MatrixXd matrix) {
  constexpr double kTiny = 1e-300;  // a row of zeros stays one
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    matrix.row(i) /= std::max(matrix.row(i).cwiseAbs().maxCoeff(), kTiny);
  }
  for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
    matrix.col(i) /= std::max(matrix.col(i).cwiseAbs().maxCoeff(), kTiny);
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix);
  const auto& values = svd.singularValues();
  const double smallest = values(values.size() - 1);
  const bool singular = !(values(0) < kSingular * smallest);
  return singular ? std::numeric_limits<double>::infinity() : values(0) / smallest;
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

double Coupling::dot(const Eigen::MatrixXd& matrix, std::size_t row, const Input& values) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double factor = matrix(static_cast<Eigen::Index>(row), i);
    if (factor != 0.0) sum += factor * values(i);
  }
  return sum;
}

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
  const double condition = conditionOf(matrix);
  if (condition > kWorstCondition) {
    const bool singular = condition > kSingular;
    return Error{who + ": the matrix " + printed(matrix) +
                 (singular ? " is singular" : " is badly conditioned") + " (condition number " +
                 numberText(condition, 3) + ", at most " + formatNumber(kWorstCondition) +
                 "): some movement of the axes would move " +
                 (singular ? "no joint" : "the joints next to not at all") +
                 "; check for a row or column that is zero, or nearly a multiple of another"};
  }
  return Coupling(std::move(joints), std::move(axes), matrix);
}

}  // namespace cia402::motion
