// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/ros/process_signals.h"

#include <ros/duration.h>
#include <ros/init.h>

#include <csignal>

namespace cia402::ros_node {
namespace {

volatile std::sig_atomic_t signal_seen = 0;

void onSignal(int) { signal_seen = 1; }

}  // namespace

void catchSignals() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
}

bool endRequested() { return signal_seen != 0 || ros::isShuttingDown(); }

void waitForEnd() {
  while (!endRequested()) ros::WallDuration(0.02).sleep();
}

}  // namespace cia402::ros_node
