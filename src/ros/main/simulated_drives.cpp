// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <ros/ros.h>

#include <algorithm>
#include <mutex>

#include "cia402_driver/bus/real_clock.h"
#include "cia402_driver/bus/realtime.h"
#include "cia402_driver/can/socketcan.h"
#include "cia402_driver/ros/fault_service.h"
#include "cia402_driver/ros/process_signals.h"
#include "cia402_driver/ros/robot_loader.h"
#include "cia402_driver/sim/drive_host.h"

namespace {

using namespace cia402;  // NOLINT: a main file

constexpr Duration kLongestWait = std::chrono::milliseconds(20);

void waitForFrames(const can::Interface& interface, Time deadline) {
  const Time now = bus::realNow();
  const Duration left = std::clamp(deadline - now, Duration::zero(), kLongestWait);
  const timespec timeout{0, static_cast<long>(left.count())};
  pollfd source{interface.fd(), POLLIN, 0};
  ppoll(&source, source.fd >= 0 ? 1 : 0, &timeout, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  ros_node::catchSignals();
  ros::init(argc, argv, "simulated_drives", ros::init_options::NoSigintHandler);
  ros::NodeHandle private_node("~");
  const auto loaded = ros_node::loadRobot(private_node);
  if (!loaded) return 1;
  const auto axes = ros_node::loadSimulation(loaded->robot);
  if (!axes) return 1;

  can::SocketCan::Options options;
  options.error_frames = false;
  can::SocketCan interface(loaded->robot.bus.interface, options);
  sim::DriveHost host(*axes, interface, bus::realNow());
  std::mutex host_mutex;
  ros_node::FaultService faults(
      private_node, [&](const std::string& axis, const std::string& fault) {
        const std::lock_guard<std::mutex> lock(host_mutex);
        return ros_node::injectFault(host.find(axis), axis, fault, bus::realNow());
      });
  ros::AsyncSpinner spinner(1);
  spinner.start();
  ROS_INFO_STREAM(axes->size() << " simulated drives on " << interface.describe());
  const int priority = loaded->options.realtime_priority;
  if (priority > 0 && !bus::makeRealtime(priority).complete()) {
    ROS_INFO("the simulated drives do not run in real time and may answer late under load");
  }
  while (!ros_node::endRequested()) {
    Time deadline;
    {
      const std::lock_guard<std::mutex> lock(host_mutex);
      host.step(bus::realNow());
      deadline = host.nextDeadline();
    }
    waitForFrames(interface, deadline);
  }
  spinner.stop();
  ros::shutdown();
  return 0;
}
