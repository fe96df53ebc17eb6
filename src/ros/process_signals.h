// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::ros_node {

/// Catches SIGINT and SIGTERM from now on, so that a node can stop its drives before it ends. Call
/// it once the ROS master was reached (the first node handle exists), after ros::init with
/// NoSigintHandler: until then nothing is to be stopped, and a signal ends the process at once.
/// A signal also ends ROS, so that no call goes on waiting for a master that is gone.
void catchSignals();
/// From now on a signal leaves ROS alone and wakes who reads `eventfd`.
void wakeOnSignals(int eventfd);
/// True once one of them came or ROS asked the node to end.
bool endRequested();

}  // namespace cia402::ros_node
