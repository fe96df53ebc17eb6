// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/diff_drive_parameters.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "common/text.h"

namespace cia402::ros_node {
namespace {

/// Reads parameters of a node and keeps what is wrong with them.
class Reader {
 public:
  Reader(const ros::NodeHandle& node, Problems& problems) : node_(node), problems_(problems) {}

  /// @param unit for the message. @param needed it has no default
  void positive(const std::string& name, const std::string& unit, double& value, bool needed) {
    known_.insert(name);
    if (!node_.hasParam(name)) {
      if (needed) problems_.add("~" + name, "is missing: " + unit + ", greater than 0");
      return;
    }
    double number = 0.0;
    const bool read = node_.getParam(name, number);
    if (read && std::isfinite(number) && number > 0.0) {
      value = number;
    } else {
      problems_.add("~" + name, "must be a number of " + unit + ", greater than 0");
    }
  }
  void seconds(const std::string& name, Duration& value) {
    double number = toSeconds(value);
    positive(name, "s", number, false);
    if (number > 60.0) {
      problems_.add("~" + name, "must be at most 60 s, and is " + numberText(number));
    } else {
      value = fromSeconds(number);
    }
  }
  void joints(const std::string& name, std::vector<std::string>& value) {
    known_.insert(name);
    if (!node_.getParam(name, value) || value.empty()) {
      problems_.add("~" + name, "must be a list of the joints of that side's wheels: [left_wheel]");
    }
  }
  template <typename Value>
  void any(const std::string& name, const std::string& kind, Value& value) {
    known_.insert(name);
    if (node_.hasParam(name) && !node_.getParam(name, value)) {
      problems_.add("~" + name, "must be " + kind);
    }
  }
  void diagonal(const std::string& name, std::array<double, 6>& value) {
    known_.insert(name);
    if (!node_.hasParam(name)) return;
    std::vector<double> numbers;
    const bool valid = node_.getParam(name, numbers) && numbers.size() == value.size() &&
                       std::all_of(numbers.begin(), numbers.end(),
                                   [](double n) { return std::isfinite(n) && n >= 0.0; });
    if (valid) {
      std::copy(numbers.begin(), numbers.end(), value.begin());
    } else {
      problems_.add("~" + name, "must be six numbers, 0 or more: x, y, z, roll, pitch, yaw");
    }
  }
  /// What nobody has asked for is misspelt.
  void finish() {
    std::vector<std::string> all;
    (void)node_.getParamNames(all);
    const std::string prefix = node_.getNamespace() + "/";
    for (const std::string& full : all) {
      if (full.compare(0, prefix.size(), prefix) != 0) continue;
      const std::string name =
          full.substr(prefix.size(), full.find('/', prefix.size()) - prefix.size());
      if (known_.insert(name).second) problems_.add("~" + name, "is not a parameter of this node");
    }
  }

 private:
  const ros::NodeHandle& node_;
  Problems& problems_;
  std::set<std::string> known_;
};

void checkNames(const DiffDriveOptions& base, Problems& problems) {
  std::set<std::string> names;
  for (const auto* side : {&base.left, &base.right}) {
    for (const std::string& name : *side) {
      if (!names.insert(name).second) {
        problems.add("~right_wheels", "\"" + name + "\" is named twice among the wheels");
      }
    }
  }
}

}  // namespace

DiffDriveParameters readDiffDrive(const ros::NodeHandle& private_node, Problems& problems) {
  DiffDriveParameters parameters;
  DiffDriveOptions& base = parameters.base;
  Reader reader(private_node, problems);
  reader.joints("left_wheels", base.left);
  reader.joints("right_wheels", base.right);
  checkNames(base, problems);
  reader.positive("wheel_separation", "m", base.geometry.separation, true);
  reader.positive("wheel_radius", "m", base.geometry.radius, true);
  reader.positive("max_linear_velocity", "m/s", base.limits.linear_velocity, true);
  reader.positive("max_angular_velocity", "rad/s", base.limits.angular_velocity, true);
  reader.positive("max_linear_acceleration", "m/s^2", base.limits.linear_acceleration, true);
  reader.positive("max_angular_acceleration", "rad/s^2", base.limits.angular_acceleration, true);
  reader.positive("max_wheel_velocity", "rad/s", base.limits.wheel_velocity, true);
  reader.seconds("cmd_vel_timeout", base.command_timeout);
  reader.seconds("joint_states_timeout", base.joints_timeout);
  reader.positive("rate", "Hz", parameters.rate, false);
  reader.any("group", "the name of the driver's group: /bus/wheels", parameters.group);
  reader.any("odom_frame", "a name", parameters.odom_frame);
  reader.any("base_frame", "a name", parameters.base_frame);
  reader.any("publish_tf", "true or false", parameters.publish_tf);
  reader.diagonal("pose_covariance_diagonal", parameters.pose_covariance);
  reader.diagonal("twist_covariance_diagonal", parameters.twist_covariance);
  reader.finish();
  return parameters;
}

}  // namespace cia402::ros_node
