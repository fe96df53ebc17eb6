// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/described_limits.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using motion::JointLimits;

struct Row {
  const char* key;
  std::optional<double> JointLimits::*limit;
  bool of_place, of_coupled;
};
constexpr Row kRows[] = {
    {"lower", &JointLimits::lower, true, true},
    {"upper", &JointLimits::upper, true, true},
    {"velocity", &JointLimits::velocity, false, true},
    {"acceleration", &JointLimits::acceleration, false, true},
    {"jerk", &JointLimits::jerk, false, false},
    {"effort", &JointLimits::effort, false, false},
};

/// What is said of a limit by one of several.
struct Claim {
  double value;
  std::string place;
};

constexpr double kEqual = 1e-6;  // digits that another file has not
constexpr int kDigits = 12;      // more than anybody writes: none is rounded up

bool equal(double a, double b) {
  return std::abs(a - b) <= kEqual * std::max({1e-3, std::abs(a), std::abs(b)});
}

Claim strictestOf(const std::vector<Claim>& claims, const Row& row) {
  const auto less = [](const Claim& a, const Claim& b) { return a.value < b.value; };
  return row.limit == &JointLimits::lower ? *std::max_element(claims.begin(), claims.end(), less)
                                          : *std::min_element(claims.begin(), claims.end(), less);
}

/// All that is said of one limit. Those of position have no meaning for a joint that turns without
/// end.
std::vector<Claim> claimsOf(const Row& row, const DescribedLimits::Owner& own,
                            const std::vector<DescribedLimits::Stated>& stated,
                            RobotConfig& robot) {
  std::vector<Claim> claims;
  const auto own_limit = own.joint.limits.*row.limit;
  if (own_limit) claims.push_back({*own_limit, own.place});
  if (own.coupled && !row.of_coupled) return claims;
  for (const DescribedLimits::Stated& other : stated) {
    const auto limit = other.limits.*row.limit;
    if (!limit) continue;
    if (row.of_place && own.joint.limits.continuous) {
      robot.warnings.push_back(
          own.joint.name + ": " + row.key + " " + motion::formatNumber(*limit) + " of " +
          other.source +
          " does not count, as the joint is `type: continuous`; if it does not "
          "turn without end, write `type: revolute`");
    } else {
      claims.push_back({*limit, other.source});
    }
  }
  return claims;
}

/// What is stated of a joint that several axes move, though only an axis can be kept to it: "effort
/// 3 of robot_description".
std::string uncountedOf(const std::vector<DescribedLimits::Stated>& stated) {
  std::string all;
  for (const Row& row : kRows) {
    for (const DescribedLimits::Stated& other : stated) {
      const auto limit = other.limits.*row.limit;
      if (row.of_coupled || !limit) continue;
      append(all, std::string(row.key) + " " + motion::formatNumber(*limit) + " of " + other.source,
             ", ");
    }
  }
  return all;
}

/// "velocity 1.5 of robot_description, not 2 of axes/m3/limits".
std::string difference(const char* key, const Claim& strictest, const std::vector<Claim>& claims) {
  std::string others;
  for (const Claim& claim : claims) {
    if (equal(claim.value, strictest.value)) continue;
    others +=
        (others.empty() ? "" : ", ") + motion::formatNumber(claim.value) + " of " + claim.place;
  }
  const std::string counts =
      std::string(key) + " " + motion::formatNumber(strictest.value) + " of " + strictest.place;
  return others.empty() ? counts : counts + ", not " + others;
}

}  // namespace

DescribedLimits::DescribedLimits(const yaml::Value& value) {
  yaml::Section sources(value);
  for (const auto& [source, joints] : sources.entries()) {
    yaml::Section section(joints);
    for (const auto& [joint, limits] : section.entries()) {
      stated_[joint].push_back(
          {source, readLimits(limits, drive::AxisGeometry::Type::revolute), limits});
    }
    section.finish();
  }
  sources.finish();
}

JointLimits DescribedLimits::strictest(const Owner& own, Problems& problems,
                                       RobotConfig& robot) const {
  const auto stated = stated_.find(own.joint.name);
  if (stated == stated_.end()) return own.joint.limits;
  const std::string& name = own.joint.name;
  JointLimits strictest = own.joint.limits;
  std::string different, taken;
  std::map<std::string, Claim> bounds;
  for (const Row& row : kRows) {
    const std::vector<Claim> claims = claimsOf(row, own, stated->second, robot);
    if (claims.empty()) continue;
    const bool is_own = (own.joint.limits.*row.limit).has_value();
    const Claim claim = strictestOf(claims, row);
    bounds.emplace(row.key, claim);
    const bool agreed = std::all_of(claims.begin(), claims.end(), [&](const Claim& any) {
      return equal(any.value, claim.value);
    });
    if (agreed && is_own) continue;
    strictest.*row.limit = claim.value;
    append(agreed ? taken : different, difference(row.key, claim, claims));
  }
  if (strictest.lower && strictest.upper && !(*strictest.lower < *strictest.upper)) {
    const Claim &lower = bounds.at("lower"), &upper = bounds.at("upper");
    problems.add(own.place, "joint " + name + " cannot move: its lower limit is " +
                                motion::formatNumber(lower.value) + " of " + lower.place +
                                ", its upper limit " + motion::formatNumber(upper.value) + " of " +
                                upper.place + "; make them agree");
    return own.joint.limits;
  }
  if (!different.empty()) {
    robot.warnings.push_back(name + ": its limits differ, the strictest count: " + different);
  }
  const std::string uncounted = own.coupled ? uncountedOf(stated->second) : std::string();
  if (!uncounted.empty()) {
    robot.warnings.push_back(name + ": " + uncounted +
                             " do not count, as several axes move the joint: limit these instead "
                             "(axes/<name>/limits)");
  }
  if (!taken.empty()) robot.notes.push_back(name + ": limits stated elsewhere: " + taken);
  return strictest;
}

void DescribedLimits::finish(const std::vector<std::string>& joints) const {
  for (const auto& [joint, stated] : stated_) {
    if (std::find(joints.begin(), joints.end(), joint) != joints.end()) continue;
    for (const Stated& each : stated) {
      each.value.problem("there is no joint `" + joint + "`" + yaml::suggestion(joint, joints));
    }
  }
}

std::set<std::string> coupledAxes(const YAML::Node& tree) {
  std::set<std::string> axes;
  const YAML::Node couplings = tree["couplings"];
  if (!couplings || !couplings.IsSequence()) return axes;
  for (const YAML::Node& coupling : couplings) {
    const YAML::Node names = coupling.IsMap() ? coupling["axes"] : YAML::Node();
    if (!names || !names.IsSequence()) continue;
    for (const YAML::Node& name : names) {
      if (name.IsScalar()) axes.insert(name.Scalar());
    }
  }
  return axes;
}

void settleLimits(YAML::Node& tree, const RobotConfig& robot) {
  if (!tree["limits_from"]) return;
  for (const drive::AxisConfig& axis : robot.axes) {
    if (robot.couplingOf(axis.name) != nullptr) continue;
    YAML::Node limits = tree["axes"][axis.name]["limits"];
    for (const Row& row : kRows) {
      const std::optional<double>& value = axis.limits.*row.limit;
      const YAML::Node given = limits[row.key];
      const auto number =
          given && given.IsScalar() ? yaml::parseNumber(given.Scalar()) : std::nullopt;
      if (value && number != value) limits[row.key] = numberText(*value, kDigits);
    }
    for (const auto& source : tree["limits_from"]) {
      YAML::Node joints = source.second;
      joints.remove(axis.joint);
    }
  }
}

}  // namespace cia402::config
