// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <ros/ros.h>

#include <algorithm>
#include <mutex>

#include "bus/real_clock.h"
#include "bus/realtime.h"
#include "can/socketcan.h"
#include "ros/command_line.h"
#include "ros/fault_service.h"
#include "ros/process_signals.h"
#include "ros/robot_loader.h"
#include "sim/world/drive_host.h"

namespace {

using namespace cia402;  // NOLINT: a main file

constexpr char kHelp[] = R"(Usage: simulated_drives [name:=value...]

The simulated drives of a robot on a real CAN interface, for a bus_node in another process. It takes
the robot's file from its private parameters, so it is started by roslaunch:

  roslaunch cia402_driver sim.launch config:=/path/to/robot.yaml can:=vcan0

or by hand:

  rosparam load /path/to/robot.yaml /simulated_drives
  rosrun cia402_driver simulated_drives _interface:=vcan0

  _interface:=NAME          CAN interface instead of the file's
  _profile_path:=FOLDER     a folder with further drive profiles
  _realtime_priority:=80    SCHED_FIFO priority of the thread that plays the drives; 0: no real time

It waits for the ROS master and for the interface. SIGINT and SIGTERM end it.
)";

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
  if (const auto status = ros_node::readCommandLine(argc, argv, kHelp)) return *status;
  ros::init(argc, argv, "simulated_drives", ros::init_options::NoSigintHandler);
  ros::NodeHandle private_node("~");  // waits for the ROS master
  ros_node::catchSignals();
  const auto loaded = ros_node::loadRobot(private_node);
  if (!loaded) return 1;
  const auto drives = ros_node::loadSimulation(loaded->robot);
  if (!drives) return 1;

  can::SocketCan::Options options;
  options.error_frames = false;
  can::SocketCan interface(loaded->robot.bus.interface, options);
  sim::DriveHost host(*drives, interface, bus::realNow());
  std::mutex host_mutex;
  ros_node::FaultService faults(
      private_node, [&](const std::string& axis, const std::string& fault) {
        const std::lock_guard<std::mutex> lock(host_mutex);
        return ros_node::injectFault(host.find(axis), axis, fault, bus::realNow());
      });
  ros::AsyncSpinner spinner(1);
  spinner.start();
  ROS_INFO_STREAM(drives->size() << " simulated drives on " << interface.describe());
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
