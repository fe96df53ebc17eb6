// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <set>
#include <string>

#include "bus/bus_condition.h"
#include "bus/runner.h"
#include "config/robot.h"
#include "ros/link_watch.h"

namespace cia402::ros_node {

/// /diagnostics after REP-107: one status for the bus, each node and each axis. The hardware id of
/// a node and its axis is the serial number.
class Diagnostics {
 public:
  Diagnostics(ros::NodeHandle& node, ros::NodeHandle& private_node, bus::BusRunner& runner,
              LinkWatch& link, const config::RobotConfig& robot);

  /// Publishes once a second, and has LinkWatch look; call it ten times as often.
  void update();

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  void reportBus(Status& status);
  void reportLink(Status& status);
  void reportNode(std::size_t index, Status& status);
  void reportAxis(std::size_t index, Status& status);

  bus::BusRunner& runner_;
  const config::RobotConfig& robot_;
  bus::NetworkSnapshot snapshot_;
  bus::SkippedCycles skipped_;
  LinkWatch& link_;
  std::set<std::string> findings_told_;
  diagnostic_updater::Updater updater_;
  ros::Publisher topic_;  ///< of the updater, which does not tell who listens
};

}  // namespace cia402::ros_node
