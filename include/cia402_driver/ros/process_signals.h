// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::ros_node {

/// Catches SIGINT and SIGTERM, so that a node can stop its drives before it ends. Call before
/// ros::init with NoSigintHandler.
void catchSignals();
/// True once one of them came or ROS asked the node to end.
bool endRequested();
/// Blocks until endRequested().
void waitForEnd();

}  // namespace cia402::ros_node
