// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/described_limits.h"

#include <ros/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/text.h"
#include "ros/parameters.h"
#include "yaml/reader.h"

namespace cia402::ros_node {
namespace {

constexpr int kDigits = 9;  // more than anybody writes

/// Collects the limits of one joint.
class JointLimitsNode {
 public:
  JointLimitsNode(std::string who, std::vector<std::string>& warnings)
      : who_(std::move(who)), warnings_(warnings) {}

  void magnitude(const char* key, double value) {
    if (std::isfinite(value) && value > 0.0) {
      node_[key] = numberText(value, kDigits);
    } else {
      warn(std::string(key) + " " + numberText(value) + " counts as not given: it must be above 0");
    }
  }
  void range(double lower, double upper) {
    if (std::isfinite(lower) && std::isfinite(upper) && lower < upper) {
      node_["lower"] = numberText(lower, kDigits);
      node_["upper"] = numberText(upper, kDigits);
    } else {
      warn("positions from " + numberText(lower) + " to " + numberText(upper) +
           " count as not given: the lower limit must be below the upper one");
    }
  }
  void warn(const std::string& text) { warnings_.push_back(who_ + ": " + text); }
  const YAML::Node& node() const { return node_; }

 private:
  std::string who_;
  std::vector<std::string>& warnings_;
  YAML::Node node_{YAML::NodeType::Map};
};

void keep(const std::string& joint, const JointLimitsNode& limits, YAML::Node& all) {
  if (limits.node().size() > 0) all[joint] = limits.node();
}

/// One joint of a `joint_limits`.
class Entry {
 public:
  Entry(const YAML::Node& node, std::string path, Problems& problems)
      : node_(node), path_(std::move(path)), problems_(problems) {}

  /// Whether limits of that kind are there; anything but true or false is a problem.
  bool has(const std::string& kind) {
    const std::string key = "has_" + kind + "_limits";
    const YAML::Node value = node_[key];
    if (!value) return false;
    bool is = false;
    if (!value.IsScalar() || !YAML::convert<bool>::decode(value, is)) {
      problems_.add(path_ + "/" + key, "must be true or false");
    }
    return is;
  }
  std::optional<double> number(const std::string& key) {
    const YAML::Node value = node_[key];
    if (!value) return std::nullopt;
    const auto number = value.IsScalar() ? yaml::parseNumber(value.Scalar()) : std::nullopt;
    if (!number) problems_.add(path_ + "/" + key, "must be a number");
    return number;
  }

 private:
  YAML::Node node_;
  std::string path_;
  Problems& problems_;
};

void readEntry(Entry& entry, JointLimitsNode& limits) {
  for (const char* kind : {"velocity", "acceleration", "jerk", "effort"}) {
    if (!entry.has(kind)) continue;
    const std::string key = std::string("max_") + kind;
    if (const auto value = entry.number(key)) {
      limits.magnitude(kind, *value);
    } else {
      limits.warn("has " + std::string(kind) + " limits, but no " + key + ": not limited by it");
    }
  }
  if (!entry.has("position")) return;
  const auto lower = entry.number("min_position"), upper = entry.number("max_position");
  if (lower && upper) {
    limits.range(*lower, *upper);
  } else {
    limits.warn(
        "has position limits, but not both of min_position and max_position: not limited "
        "by them");
  }
}

void addSource(const std::string& source, const YAML::Node& limits, YAML::Node& robot) {
  if (limits.size() > 0) robot["limits_from"][source] = limits;
}

}  // namespace

YAML::Node limitsOfUrdf(const std::string& urdf, const std::string& source,
                        const std::vector<std::string>& joints, Problems& problems,
                        std::vector<std::string>& warnings) {
  YAML::Node all(YAML::NodeType::Map);
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(urdf);
  if (model == nullptr) {
    problems.add(source,
                 "is no URDF that can be read, so the limits of the joints are not known; "
                 "check_urdf says where, `~limits_from_parameters: false` does without");
    return all;
  }
  for (const std::string& name : joints) {
    const auto joint = model->getJoint(name);
    if (!joint || !joint->limits) continue;
    JointLimitsNode limits(source + ": joint " + name, warnings);
    limits.magnitude("velocity", joint->limits->velocity);
    limits.magnitude("effort", joint->limits->effort);
    const bool bounded =
        joint->type == urdf::Joint::REVOLUTE || joint->type == urdf::Joint::PRISMATIC;
    if (bounded) limits.range(joint->limits->lower, joint->limits->upper);
    keep(name, limits, all);
  }
  return all;
}

YAML::Node limitsOfJointLimits(const YAML::Node& limits, const std::string& source,
                               const std::vector<std::string>& joints, Problems& problems,
                               std::vector<std::string>& warnings) {
  YAML::Node all(YAML::NodeType::Map);
  for (const std::string& name : joints) {
    const YAML::Node node = limits.IsMap() ? limits[name] : YAML::Node();
    if (!node || !node.IsMap()) continue;
    Entry entry(node, source + "/" + name, problems);
    JointLimitsNode found(source + ": joint " + name, warnings);
    readEntry(entry, found);
    keep(name, found, all);
  }
  return all;
}

std::vector<std::string> jointNamesIn(const YAML::Node& robot) {
  std::vector<std::string> names;
  const auto add = [&names](const YAML::Node& name) {
    if (name.IsScalar()) names.push_back(name.Scalar());
  };
  const YAML::Node axes = robot["axes"], couplings = robot["couplings"];
  if (axes && axes.IsMap()) {
    for (const auto& axis : axes) {
      const YAML::Node joint = axis.second.IsMap() ? axis.second["joint"] : YAML::Node();
      add(joint && joint.IsScalar() ? joint : axis.first);
    }
  }
  if (couplings && couplings.IsSequence()) {
    for (const YAML::Node& coupling : couplings) {
      const YAML::Node joints = coupling.IsMap() ? coupling["joints"] : YAML::Node();
      if (!joints || !joints.IsSequence()) continue;
      for (const YAML::Node& joint : joints) add(joint);
    }
  }
  return names;
}

void addDescribedLimits(const ros::NodeHandle& private_node, YAML::Node& robot,
                        Problems& problems) {
  const std::vector<std::string> joints = jointNamesIn(robot);
  std::vector<std::string> warnings;
  std::string name, text;
  if (private_node.searchParam("robot_description", name) && private_node.getParam(name, text)) {
    addSource("robot_description", limitsOfUrdf(text, name, joints, problems, warnings), robot);
  }
  const std::string planning = "robot_description_planning", plain = "joint_limits";
  for (const bool of_planning : {true, false}) {
    if (!private_node.searchParam(of_planning ? planning : plain, name)) continue;
    if (of_planning) name += "/" + plain;
    XmlRpc::XmlRpcValue value;
    if (!private_node.getParam(name, value)) continue;
    const YAML::Node limits =
        limitsOfJointLimits(toYaml(value, name, problems), name, joints, problems, warnings);
    addSource(of_planning ? planning : plain, limits, robot);
  }
  for (const std::string& warning : warnings) ROS_WARN_STREAM(warning);
}

}  // namespace cia402::ros_node
