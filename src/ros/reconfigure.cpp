// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/reconfigure.h"

#include <algorithm>

#include "ros/parameters.h"

namespace cia402::ros_node {
namespace {

using config::Tunable;
using dynamic_reconfigure::Config;

constexpr char kLastChange[] = "last_change";

/// "axes/shoulder" of "axes/shoulder/command_timeout"; "Default" of what is of no axis or group.
std::string groupOf(const std::string& key) {
  const bool owned = key.compare(0, 5, "axes/") == 0 || key.compare(0, 7, "groups/") == 0;
  return owned ? key.substr(0, key.find('/', key.find('/') + 1)) : "Default";
}

/// In the order in which they come first; a group's id is its place.
std::vector<std::string> groupsOf(const std::vector<Tunable>& tunables) {
  std::vector<std::string> groups = {"Default"};
  for (const Tunable& tunable : tunables) {
    const std::string group = groupOf(tunable.key);
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  return groups;
}

void addNumber(const std::string& key, double value, Config& config) {
  dynamic_reconfigure::DoubleParameter parameter;
  parameter.name = key;
  parameter.value = value;
  config.doubles.push_back(parameter);
}

void addFlag(const std::string& key, bool value, Config& config) {
  dynamic_reconfigure::BoolParameter parameter;
  parameter.name = key;
  parameter.value = value;
  config.bools.push_back(parameter);
}

void add(const Tunable& tunable, double value, Config& config) {
  if (tunable.is_flag) return addFlag(tunable.key, value != 0.0, config);
  addNumber(tunable.key, value, config);
}

void addText(const std::string& text, Config& config) {
  dynamic_reconfigure::StrParameter parameter;
  parameter.name = kLastChange;
  parameter.value = text;
  config.strs.push_back(parameter);
}

dynamic_reconfigure::ParamDescription descriptionOf(const std::string& key, const char* type,
                                                    const std::string& meaning) {
  dynamic_reconfigure::ParamDescription description;
  description.name = key;
  description.type = type;
  description.description = meaning;
  return description;
}

/// Takes one value of a call.
void take(const std::string& key, bool is_flag, const XmlRpc::XmlRpcValue& value, double number,
          const std::vector<Tunable>& tunables, std::map<std::string, std::string>& values,
          Problems& problems) {
  const auto tunable = std::find_if(tunables.begin(), tunables.end(),
                                    [&](const Tunable& known) { return known.key == key; });
  if (tunable == tunables.end()) {
    return problems.add(key, "is nothing that can be changed here; rosparam and ~reload may");
  }
  if (tunable->is_flag != is_flag) {
    return problems.add(key, tunable->is_flag ? "must be true or false" : "must be a number");
  }
  if (tunable->value == number) return;
  values[key] = toYaml(value, key, problems).Scalar();
}

}  // namespace

std::map<std::string, std::string> valuesOf(const Config& config,
                                            const std::vector<Tunable>& tunables,
                                            Problems& problems) {
  std::map<std::string, std::string> values;
  for (const auto& given : config.bools) {
    const bool value = given.value != 0;
    take(given.name, true, XmlRpc::XmlRpcValue(value), value ? 1.0 : 0.0, tunables, values,
         problems);
  }
  for (const auto& given : config.doubles) {
    take(given.name, false, XmlRpc::XmlRpcValue(given.value), given.value, tunables, values,
         problems);
  }
  for (const auto& given : config.ints) {
    take(given.name, false, XmlRpc::XmlRpcValue(given.value), given.value, tunables, values,
         problems);
  }
  for (const auto& given : config.strs) {
    if (given.name != kLastChange) problems.add(given.name, "must be a number, or true or false");
  }
  return values;
}

dynamic_reconfigure::ConfigDescription descriptionOf(const std::vector<Tunable>& tunables) {
  dynamic_reconfigure::ConfigDescription all;
  const std::vector<std::string> groups = groupsOf(tunables);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    dynamic_reconfigure::Group group;
    group.name = groups[i];
    group.id = static_cast<std::int32_t>(i);
    for (const Tunable& tunable : tunables) {
      if (groupOf(tunable.key) != groups[i]) continue;
      group.parameters.push_back(
          descriptionOf(tunable.key, tunable.is_flag ? "bool" : "double", tunable.meaning));
    }
    all.groups.push_back(group);
  }
  all.groups[0].parameters.push_back(
      descriptionOf(kLastChange, "str", "what became of the last change; only told"));
  for (const Tunable& tunable : tunables) {
    add(tunable, tunable.low, all.min);
    add(tunable, tunable.high, all.max);
    add(tunable, tunable.value, all.dflt);
  }
  for (Config* config : {&all.min, &all.max, &all.dflt}) addText("", *config);
  return all;
}

Config configOf(const std::vector<Tunable>& tunables, const std::string& last_change) {
  Config config;
  for (const Tunable& tunable : tunables) add(tunable, tunable.value, config);
  addText(last_change, config);
  const std::vector<std::string> groups = groupsOf(tunables);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    dynamic_reconfigure::GroupState state;
    state.name = groups[i];
    state.state = true;
    state.id = static_cast<std::int32_t>(i);
    config.groups.push_back(state);
  }
  return config;
}

Reconfigure::Reconfigure(ros::NodeHandle& service_node, ros::NodeHandle& private_node,
                         Reloader& reloader, const std::vector<config::GroupConfig>& groups)
    : node_(private_node), reloader_(reloader), groups_(groups) {
  descriptions_ =
      node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = node_.advertise<Config>("parameter_updates", 1, true);
  const std::vector<Tunable> tunables = reloader_.tunables();
  descriptions_.publish(descriptionOf(tunables));
  updates_.publish(configOf(tunables, last_change_));
  service_ = service_node.advertiseService("set_parameters", &Reconfigure::set, this);
}

void Reconfigure::update() {
  const unsigned changes = reloader_.changes();
  if (changes == told_) return;
  told_ = changes;
  const std::lock_guard<std::mutex> lock(mutex_);
  updates_.publish(configOf(reloader_.tunables(), last_change_));
}

/// On the parameter server, so that a reload does not take it back. A group that is there without
/// being given is given then.
void Reconfigure::keep(const Tunable& tunable) const {
  const bool of_group = tunable.key.compare(0, 7, "groups/") == 0;
  if (of_group && !node_.hasParam("groups")) {
    for (const config::GroupConfig& group : groups_) {
      node_.setParam("groups/" + group.name + "/joints", group.joints);
    }
  }
  if (tunable.is_flag) return node_.setParam(tunable.key, tunable.value != 0.0);
  node_.setParam(tunable.key, tunable.value);
}

/// A refusal is no failure of the call: the answer has the values that count, and why.
bool Reconfigure::set(dynamic_reconfigure::Reconfigure::Request& request,
                      dynamic_reconfigure::Reconfigure::Response& response) {
  Problems problems;
  const auto values = valuesOf(request.config, reloader_.tunables(), problems);
  const bus::Answer answer = problems.empty()
                                 ? reloader_.set(values)
                                 : bus::answerOf(false, "nothing was changed: " + problems.text());
  const std::lock_guard<std::mutex> lock(mutex_);
  last_change_ = answer.message;
  const std::vector<Tunable> now = reloader_.tunables();
  for (const Tunable& tunable : now) {
    if (answer.success && values.count(tunable.key) != 0) keep(tunable);
  }
  response.config = configOf(now, last_change_);
  updates_.publish(response.config);
  return true;
}

}  // namespace cia402::ros_node
