// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "ros/reloader.h"

namespace cia402::ros_node {

/// What of a robot can be changed at any time, as dynamic_reconfigure's clients (rqt_reconfigure,
/// dynparam) show and change it. The parameters are those of the robot's own axes and groups, so
/// that no .cfg could list them: the service and the topics are served as they are on the wire.
/// `last_change` tells what became of the last call.
class Reconfigure {
 public:
  /// @param service_node whose callback queue may wait. @param reloader, @param groups must outlive
  /// it
  Reconfigure(ros::NodeHandle& service_node, ros::NodeHandle& private_node, Reloader& reloader,
              const std::vector<config::GroupConfig>& groups);
  /// One thread: tells what else has changed, e.g. by a reload.
  void update();

 private:
  void keep(const config::Tunable& tunable) const;
  bool set(dynamic_reconfigure::Reconfigure::Request& request,
           dynamic_reconfigure::Reconfigure::Response& response);

  ros::NodeHandle node_;
  Reloader& reloader_;
  const std::vector<config::GroupConfig>& groups_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
  std::mutex mutex_;  // of what follows, and of what is told last
  std::string last_change_;
  unsigned told_ = 0;
};

/// The values of a call by their names; a name that is none of `tunables`, or of another kind, is a
/// problem. What is the same as it is now is left out.
std::map<std::string, std::string> valuesOf(const dynamic_reconfigure::Config& config,
                                            const std::vector<config::Tunable>& tunables,
                                            Problems& problems);
/// What clients are told of the parameters, and their values.
dynamic_reconfigure::ConfigDescription descriptionOf(const std::vector<config::Tunable>& tunables);
dynamic_reconfigure::Config configOf(const std::vector<config::Tunable>& tunables,
                                     const std::string& last_change);

}  // namespace cia402::ros_node
