// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/process_signals.h"

#include <ros/init.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>

namespace cia402::ros_node {
namespace {

volatile std::sig_atomic_t signal_seen = 0;
std::atomic<int> fd_to_wake{-1};  // lock-free: read by a signal handler

void onSignal(int) {
  const int error = errno;  // of what was interrupted
  signal_seen = 1;
  const std::uint64_t one = 1;
  if (fd_to_wake < 0) {
    ros::requestShutdown();  // sets a flag
  } else {
    (void)!write(fd_to_wake, &one, sizeof one);
  }
  errno = error;
}

}  // namespace

void catchSignals() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
}

void wakeOnSignals(int eventfd) { fd_to_wake = eventfd; }

bool endRequested() { return signal_seen != 0 || ros::isShuttingDown(); }

}  // namespace cia402::ros_node
