// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/parameters.h"

#include <sstream>

#include "ros/described_limits.h"

namespace cia402::ros_node {
namespace {

using XmlRpc::XmlRpcValue;

std::string doubleText(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  text << value;
  const std::string plain = text.str();
  if (plain == "nan") return ".nan";
  if (plain == "inf") return ".inf";
  if (plain == "-inf") return "-.inf";
  const bool looks_whole = plain.find_first_of(".e") == std::string::npos;
  return looks_whole ? plain + ".0" : plain;
}

void takeOption(YAML::Node& tree, const char* key, std::string& value, Problems& problems) {
  const YAML::Node node = tree[key];
  if (!node) return;
  if (node.IsScalar()) {
    value = node.Scalar();
  } else {
    problems.add(key, "must be a text");
  }
  tree.remove(key);
}

void takeFlag(YAML::Node& tree, const char* key, bool& value, Problems& problems) {
  const YAML::Node node = tree[key];
  if (!node) return;
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) {
    problems.add(key, "must be true or false");
  }
  tree.remove(key);
}

void takePriority(YAML::Node& tree, int& value, Problems& problems) {
  const char* const key = "realtime_priority";
  const YAML::Node node = tree[key];
  if (!node) return;
  int number = -1;
  if (!YAML::convert<int>::decode(node, number) || number < 0 || number > 99) {
    problems.add(key, "must be a whole number from 0 (no real-time scheduling) to 99");
  } else {
    value = number;
  }
  tree.remove(key);
}

}  // namespace

YAML::Node toYaml(XmlRpcValue value, const std::string& path, Problems& problems) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value) ? "true" : "false");
    case XmlRpcValue::TypeInt:
      return YAML::Node(std::to_string(static_cast<int>(value)));
    case XmlRpcValue::TypeDouble:
      return YAML::Node(doubleText(static_cast<double>(value)));
    case XmlRpcValue::TypeString:
      return YAML::Node(static_cast<std::string>(value));
    case XmlRpcValue::TypeArray: {
      YAML::Node list(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) {
        list.push_back(toYaml(value[i], path + "[" + std::to_string(i) + "]", problems));
      }
      return list;
    }
    case XmlRpcValue::TypeStruct: {
      YAML::Node map(YAML::NodeType::Map);
      for (auto& member : value) {
        map[member.first] = toYaml(
            member.second, path.empty() ? member.first : path + "/" + member.first, problems);
      }
      return map;
    }
    default:
      problems.add(path, "is of a type that has no meaning here (date or binary)");
      return YAML::Node();
  }
}

Parameters readParameters(const ros::NodeHandle& private_node, Problems& problems) {
  Parameters parameters;
  parameters.robot = YAML::Node(YAML::NodeType::Map);
  XmlRpcValue tree;
  if (private_node.getParam(private_node.getNamespace(), tree) &&
      tree.getType() == XmlRpcValue::TypeStruct) {
    parameters.robot = toYaml(tree, "", problems);
  }
  takeOption(parameters.robot, "interface", parameters.options.interface, problems);
  takeOption(parameters.robot, "profile_path", parameters.options.profile_path, problems);
  takePriority(parameters.robot, parameters.options.realtime_priority, problems);
  takeFlag(parameters.robot, "limits_from_parameters", parameters.options.limits_from_parameters,
           problems);
  if (parameters.options.limits_from_parameters) {
    addDescribedLimits(private_node, parameters.robot, problems);
  }
  if (!parameters.options.interface.empty()) {
    parameters.robot["bus"]["interface"] = parameters.options.interface;
  }
  return parameters;
}

}  // namespace cia402::ros_node
