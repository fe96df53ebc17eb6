// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/couplings.h"

#include <algorithm>
#include <cmath>

#include "campaign/robot_plan.h"

namespace cia402::campaign {
namespace {

using Matrix = std::array<std::array<double, 2>, 2>;

/// That of two joints, well enough conditioned.
Matrix drawMatrix(Random& random) {
  const auto draw = [&] {
    const double size = std::round(random.between(0.2, 1.5) * 100.0) / 100.0;
    return random.chance(0.5) ? size : -size;
  };
  for (;;) {
    const Matrix matrix{{{draw(), draw()}, {draw(), draw()}}};
    const double one = matrix[0][0] * matrix[1][1], other = matrix[0][1] * matrix[1][0];
    if (std::fabs(one - other) > 0.4 * (std::fabs(one) + std::fabs(other))) return matrix;
  }
}

Matrix inverseOf(const Matrix& matrix) {
  const double det = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
  return {{{matrix[1][1] / det, -matrix[0][1] / det}, {-matrix[1][0] / det, matrix[0][0] / det}}};
}

/// The most that both joints may have at once, so that no axis has more than its own.
double within(const Matrix& inverse, double first, double second) {
  constexpr double kMargin = 0.9;
  const auto& [to_first, to_second] = inverse;
  return kMargin * std::min(first / (std::fabs(to_first[0]) + std::fabs(to_first[1])),
                            second / (std::fabs(to_second[0]) + std::fabs(to_second[1])));
}

std::string written(const Matrix& matrix) {
  const auto row = [](const std::array<double, 2>& values) {
    return "[" + text(values[0]) + ", " + text(values[1]) + "]";
  };
  return "[" + row(matrix[0]) + ", " + row(matrix[1]) + "]";
}

std::string gantryYaml(Random& random, const AxisPlan& side) {
  const double window = side.velocity * random.between(0.04, 0.1) + 0.001;
  const double drawn = window * random.between(1.0, 4.0);
  // One side may find its index pulse at once, and the other a turn later.
  const double homing = side.homes_by_moving ? std::max(drawn, 1.1 * (side.turn + window)) : drawn;
  return "skew: {window: " + text(window) + ", homing: " + text(homing) + "}";
}

std::string differentialYaml(Random& random, const AxisPlan& first, const AxisPlan& second,
                             const std::vector<std::string>& joints) {
  const Matrix matrix = drawMatrix(random), inverse = inverseOf(matrix);
  const double velocity = within(inverse, first.velocity, second.velocity);
  const double acceleration = within(inverse, first.acceleration, second.acceleration);
  std::string yaml = "matrix: " + written(matrix);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double at = matrix[i][0] * first.at + matrix[i][1] * second.at;
    const double reach = velocity * random.between(0.5, 3.0);
    yaml += ", " + joints[i] + ": {limits: {lower: " + text(at - reach) +
            ", upper: " + text(at + reach) + ", velocity: " + text(velocity) +
            ", acceleration: " + text(acceleration) + "}}";
  }
  return yaml;
}

}  // namespace

CouplingPlan planCoupling(Random& random, const std::vector<AxisPlan>& axes,
                          const std::array<std::size_t, 2>& members, bool gantry) {
  CouplingPlan plan;
  plan.axes = members;
  plan.gantry = gantry;
  const AxisPlan &first = axes[members[0]], &second = axes[members[1]];
  const std::string number = first.name.substr(1);
  plan.joints = gantry ? std::vector<std::string>{"x" + number}
                       : std::vector<std::string>{"p" + number, "q" + number};
  std::string names;
  for (const std::string& joint : plan.joints) names += (names.empty() ? "" : ", ") + joint;
  plan.yaml =
      "{joints: [" + names + "], axes: [" + first.name + ", " + second.name + "], " +
      (gantry ? gantryYaml(random, first) : differentialYaml(random, first, second, plan.joints)) +
      "}";
  return plan;
}

}  // namespace cia402::campaign
