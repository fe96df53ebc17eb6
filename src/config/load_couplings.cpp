// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "common/text.h"
#include "config/robot_parts.h"
#include "motion/coupling.h"

namespace cia402::config {
namespace {

using drive::AxisConfig;
using motion::JointLimits;

constexpr double kForSquaring = 0.05;  // of the limits of a gantry's axes, where its joint has none
constexpr double kRounding = 1.0 + 1e-9;

const AxisConfig& axisOf(const RobotConfig& robot, const std::string& name) {
  return *std::find_if(robot.axes.begin(), robot.axes.end(),
                       [&](const AxisConfig& axis) { return axis.name == name; });
}

/// A limit of magnitude.
struct Quantity {
  const char* name;
  std::optional<double> JointLimits::*limit;
};
constexpr Quantity kMagnitudes[] = {{"velocity", &JointLimits::velocity},
                                    {"acceleration", &JointLimits::acceleration}};

/// Reads one coupling of the list, and checks that its axes may do all that its joints may.
class CouplingReader {
 public:
  CouplingReader(const yaml::Value& entry, const DescribedLimits& described, RobotConfig& robot)
      : section_(entry), described_(described), robot_(robot) {}

  CouplingConfig read() {
    std::vector<std::string> known;
    for (const AxisConfig& axis : robot_.axes) known.push_back(axis.name);
    coupling_.axes = readNames(section_, "axes", known, "axis");
    names_ = readNames(section_, "joints", {}, "joint");
    const bool complete = !coupling_.axes.empty() && !names_.empty();
    const bool gantry = names_.size() == 1 && coupling_.axes.size() == 2;
    if (complete && gantry) {
      readGantry();
    } else if (complete && names_.size() == coupling_.axes.size()) {
      readMatrix();
    } else if (complete) {
      section_.problem("has " + std::to_string(names_.size()) + " joints and " +
                       std::to_string(coupling_.axes.size()) +
                       " axes; it needs as many joints as axes, or one joint and the two axes of a "
                       "gantry");
    }
    for (const std::string& name : names_) readJoint(name);
    section_.finish();
    checkAxisKeys();
    if (coupling_.matrix != nullptr) checkLimits();
    return std::move(coupling_);
  }
  yaml::Section& section() { return section_; }

 private:
  void readMatrix() {
    const auto value = section_.require("matrix", "joint space = matrix * axis space");
    if (!value) return;
    const std::size_t size = names_.size();
    const std::vector<yaml::Value> rows = value->list();
    if (rows.size() != size) {
      value->problem("must have a row for each joint: " + std::to_string(size) + ", not " +
                     std::to_string(rows.size()));
      return;
    }
    Eigen::MatrixXd matrix(size, size);
    for (std::size_t row = 0; row < size; ++row) {
      const auto numbers = rows[row].numbers(size);
      if (!numbers) return;
      for (std::size_t i = 0; i < size; ++i) {
        matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(i)) = (*numbers)[i];
      }
    }
    auto made = motion::Coupling::create(names_, coupling_.axes, matrix);
    if (!made) return value->problem("is refused: " + made.error().message);
    coupling_.matrix = std::make_shared<const motion::Coupling>(*made);
  }

  void readGantry() {
    if (const auto matrix = section_.get("matrix")) {
      matrix->problem(
          "is that of a gantry (one joint, two axes), which needs none: both sides move like the "
          "joint, which is where their middle is; leave it out");
    }
    const auto skew = section_.require(
        "skew", "a gantry needs {window: ...}, how far one side may be ahead of the other");
    if (!skew) return;
    GantryConfig gantry;
    yaml::Section section(*skew);
    section.require("window", "rad or m that one side may be ahead of the other");
    section.read("window", gantry.skew_window, yaml::kPositive);
    gantry.homing_window = gantry.skew_window;
    section.read("homing", gantry.homing_window, yaml::kPositive);
    section.finish();
    if (gantry.homing_window < gantry.skew_window) {
      section.get("homing")->problem("must be at least `window` (" +
                                     numberText(gantry.skew_window) + ")");
    }
    if (!alike() || gantry.skew_window <= 0.0) return;
    const JointLimits& side = axisOf(robot_, coupling_.axes[0]).limits;
    const double slow = gantry.skew_window;  // in a second
    gantry.squaring_velocity = std::min(slow, kForSquaring * side.velocity.value_or(1e300));
    gantry.squaring_acceleration =
        side.acceleration ? kForSquaring * *side.acceleration : 4.0 * slow;
    coupling_.gantry = gantry;
    Eigen::MatrixXd matrix(2, 2);
    matrix << 0.5, 0.5, -1.0, 1.0;
    coupling_.matrix = std::make_shared<const motion::Coupling>(
        motion::Coupling::create({names_[0], "skew of " + names_[0]}, coupling_.axes, matrix)
            .value());
  }

  /// What both sides of a gantry must have alike, so that they move and stop alike.
  bool alike() {
    const AxisConfig &a = axisOf(robot_, coupling_.axes[0]), &b = axisOf(robot_, coupling_.axes[1]);
    const auto different = [&](const char* key, const std::string& why) {
      section_.problem("axes/" + a.name + "/" + key + " and axes/" + b.name + "/" + key +
                       " differ: " + why);
    };
    const bool types = a.geometry.type == b.geometry.type;
    if (!types) different("type", "both sides of a gantry are of one type");
    bool limits = true;
    for (const auto limit : {&JointLimits::lower, &JointLimits::upper, &JointLimits::velocity,
                             &JointLimits::acceleration}) {
      limits = limits && a.limits.*limit == b.limits.*limit;
    }
    if (!limits) different("limits", "both sides of a gantry move and stop by the same limits");
    const bool homing = a.homing.has_value() == b.homing.has_value() &&
                        (!a.homing || a.homing->order == b.homing->order);
    if (!homing)
      different("homing", "both sides of a gantry home together: both or none, in one order");
    for (const AxisConfig* side : {&a, &b}) {
      if (side->homing && !side->limits.velocity) {
        section_.problem("axes/" + side->name +
                         "/limits: no velocity: a side of a gantry that homes needs it, as its "
                         "position is supervised by it meanwhile");
      }
      if (!robot_.deviceOf(*side).boot.optional) continue;
      section_.problem("axes/" + side->name +
                       "/optional: a gantry does not move without one of its sides; take it out");
    }
    return types && limits && homing;
  }

  void readJoint(const std::string& name) {
    motion::Joint joint;
    joint.name = name;
    using Type = drive::AxisGeometry::Type;
    Type type = Type::revolute;
    if (!coupling_.axes.empty()) {
      const AxisConfig& first = axisOf(robot_, coupling_.axes[0]);
      type = first.geometry.type;
      if (coupling_.gantry) joint.limits = ofGantry(first.limits, *coupling_.gantry);
    }
    for (const char* key : {"joints", "axes", "matrix", "skew"}) {
      if (name != key) continue;
      section_.problem("a joint cannot be called `" + name + "`, which is a key here");
      return;
    }
    if (const auto value = section_.get(name)) {
      yaml::Section section(*value);
      if (const auto given = section.get("type")) {
        const auto index = given->oneOf({"revolute", "prismatic", "continuous"});
        if (index) type = static_cast<Type>(*index);
      }
      if (const auto limits = section.get("limits")) {
        joint.limits = readLimits(*limits, type);
        if (joint.limits.effort || joint.limits.jerk) {
          limits->problem(
              "a coupled joint has neither jerk nor effort limit: give them to its axes");
        }
      }
      if (const auto frame = section.get("frame")) readFrame(*frame, name, robot_);
      section.finish();
    }
    joint.limits.continuous = type == Type::continuous;
    const yaml::Value& value = section_.value();
    joint.limits = described_.strictest({joint, value.path() + "/" + name + "/limits", true},
                                        value.problems(), robot_);
    joint.unit = type == Type::prismatic ? motion::JointUnit::metre : motion::JointUnit::radian;
    coupling_.joints.push_back(joint);
  }

  /// Those of its sides, less what squaring may take.
  static JointLimits ofGantry(const JointLimits& side, const GantryConfig& gantry) {
    JointLimits limits;
    limits.velocity = side.velocity;
    limits.acceleration = side.acceleration;
    if (limits.velocity) *limits.velocity *= 1.0 - kForSquaring;
    if (limits.acceleration) *limits.acceleration *= 1.0 - kForSquaring;
    if (side.lower) limits.lower = *side.lower + 0.5 * gantry.skew_window;
    if (side.upper) limits.upper = *side.upper - 0.5 * gantry.skew_window;
    return limits;
  }

  /// Keys of an axis that speak of a joint of its own.
  void checkAxisKeys() {
    for (const std::string& name : coupling_.axes) {
      const AxisConfig& axis = axisOf(robot_, name);
      if (axis.joint != axis.name) {
        section_.problem("axes/" + name + "/joint: `" + axis.joint +
                         "` has no meaning, as the axis is coupled: `joints` names what it moves; "
                         "take it out");
      }
      const bool framed = std::any_of(robot_.frames.begin(), robot_.frames.end(),
                                      [&](const FrameConfig& f) { return f.joint == axis.joint; });
      if (framed && !coupling_.moves(axis.joint)) {
        section_.problem("axes/" + name +
                         "/frame: the axis is coupled, and joints move frames: give `frame` to one "
                         "of `joints` here");
      }
    }
  }

  /// What moves beside the joints: the skew of a gantry that is being squared.
  JointLimits limitsOf(std::size_t row) const {
    if (row < coupling_.joints.size()) return coupling_.joints[row].limits;
    JointLimits skew;
    skew.lower = -coupling_.gantry->skew_window;
    skew.upper = coupling_.gantry->skew_window;
    skew.velocity = coupling_.gantry->squaring_velocity;
    skew.acceleration = coupling_.gantry->squaring_acceleration;
    return skew;
  }

  void checkLimits() {
    for (std::size_t i = 0; i < coupling_.axes.size(); ++i) {
      const AxisConfig& axis = axisOf(robot_, coupling_.axes[i]);
      for (const Quantity& quantity : kMagnitudes) checkMagnitude(i, axis, quantity);
      checkRange(i, axis);
    }
    for (const motion::Joint& joint : coupling_.joints) {
      for (const Quantity& quantity : kMagnitudes) {
        if (joint.limits.*quantity.limit) continue;
        robot_.warnings.push_back(section_.value().path() + "/" + joint.name + "/limits: no " +
                                  quantity.name +
                                  " limit: the joint follows trajectories however fast they are");
      }
    }
  }

  /// What all joints at their limits at once ask of an axis.
  void checkMagnitude(std::size_t i, const AxisConfig& axis, const Quantity& quantity) {
    const std::optional<double>& bound = axis.limits.*quantity.limit;
    if (!bound) return;
    double most = 0.0;
    for (std::size_t row = 0; row < coupling_.matrix->size(); ++row) {
      const double share = std::fabs(coupling_.matrix->shareOfAxis(i, row));
      const std::optional<double> limit = limitsOf(row).*quantity.limit;
      if (share > 0.0 && !limit) return lacks(row, quantity.name, axis);
      if (share > 0.0) most += share * *limit;
    }
    if (most <= *bound * kRounding) return;
    section_.problem("at the " + std::string(quantity.name) + " limits of all its joints `" +
                     axis.name + "` would need " + numberText(most) + ", and axes/" + axis.name +
                     "/limits/" + quantity.name + " is " + numberText(*bound) +
                     ": give the joints " + numberText(*bound / most, 3) +
                     " of theirs, or the axis more");
  }

  void checkRange(std::size_t i, const AxisConfig& axis) {
    const JointLimits& bound = axis.limits;
    if (!bound.lower && !bound.upper) return;
    double lowest = 0.0, highest = 0.0;
    for (std::size_t row = 0; row < coupling_.matrix->size(); ++row) {
      const double share = coupling_.matrix->shareOfAxis(i, row);
      if (share == 0.0) continue;
      const JointLimits limits = limitsOf(row);
      if (!limits.lower || !limits.upper) return lacks(row, "lower and upper", axis);
      lowest += share * (share > 0.0 ? *limits.lower : *limits.upper);
      highest += share * (share > 0.0 ? *limits.upper : *limits.lower);
    }
    const double little = 1e-9 * (1.0 + highest - lowest);
    const bool low = bound.lower && lowest < *bound.lower - little;
    const bool high = bound.upper && highest > *bound.upper + little;
    if (!low && !high) return;
    section_.problem("within the limits of its joints `" + axis.name + "` goes from " +
                     numberText(lowest) + " to " + numberText(highest) + ", beyond axes/" +
                     axis.name + "/limits/" + (low ? "lower" : "upper") + " " +
                     numberText(low ? *bound.lower : *bound.upper) +
                     ": narrow those of the joints, or widen that of the axis");
  }

  void lacks(std::size_t row, const std::string& what, const AxisConfig& axis) {
    const std::string& joint = coupling_.joints[row].name;
    section_.problem(joint + "/limits: no " + what + ", and axes/" + axis.name +
                     "/limits has: give the joint what keeps the axis within it, or take it from "
                     "the axis (also from `defaults`)");
  }

  yaml::Section section_;
  const DescribedLimits& described_;
  RobotConfig& robot_;
  std::vector<std::string> names_;
  CouplingConfig coupling_;
};

}  // namespace

void readCouplings(const yaml::Value& value, const DescribedLimits& described, RobotConfig& robot) {
  if (robot.axes.empty()) return;  // which is a problem of its own
  std::set<std::string> coupled, joints;
  for (const yaml::Value& entry : value.list()) {
    CouplingReader reader(entry, described, robot);
    CouplingConfig coupling = reader.read();
    for (const std::string& axis : coupling.axes) {
      if (!coupled.insert(axis).second) reader.section().problem("`" + axis + "` is coupled twice");
    }
    for (const motion::Joint& joint : coupling.joints) {
      if (joints.insert(joint.name).second) continue;
      reader.section().problem("joint `" + joint.name + "` is given twice");
    }
    robot.couplings.push_back(std::move(coupling));
  }
  for (const AxisConfig& axis : robot.axes) {
    if (coupled.count(axis.name) == 0 && joints.count(axis.joint) != 0) {
      value.problem("the joint `" + axis.joint + "` is that of an axis without coupling already");
    }
  }
}

std::vector<motion::Joint> RobotConfig::joints() const {
  std::vector<motion::Joint> all;
  for (const AxisConfig& axis : axes) {
    if (couplingOf(axis.name) == nullptr) all.push_back(drive::jointOf(axis));
  }
  for (const CouplingConfig& coupling : couplings) {
    all.insert(all.end(), coupling.joints.begin(), coupling.joints.end());
  }
  return all;
}

}  // namespace cia402::config
