// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <ros/ros.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "bus/real_clock.h"
#include "bus/realtime.h"
#include "bus/runner.h"
#include "driver/open_socket.h"
#include "ros/call_desk.h"
#include "ros/command_call.h"
#include "ros/command_line.h"
#include "ros/command_topics.h"
#include "ros/diagnostics.h"
#include "ros/event_log.h"
#include "ros/event_loop.h"
#include "ros/fault_service.h"
#include "ros/frames.h"
#include "ros/home_action.h"
#include "ros/link_watch.h"
#include "ros/process_signals.h"
#include "ros/publishers.h"
#include "ros/reconfigure.h"
#include "ros/reloader.h"
#include "ros/robot_loader.h"
#include "ros/service_pool.h"
#include "ros/services.h"
#include "ros/trajectory_actions.h"
#include "sim/world/simulated_interface.h"

namespace {

using cia402::ros_node::LoadedRobot;
using namespace cia402;  // NOLINT: a main file

constexpr char kHelp[] = R"(Usage: bus_node [name:=value...]

The driver of one CAN bus. It takes the robot's file from its private parameters, so it is started
by roslaunch:

  roslaunch cia402_driver bus.launch config:=/path/to/robot.yaml
  roslaunch cia402_driver bus.launch config:=/path/to/robot.yaml sim:=true    simulated drives
  roslaunch cia402_driver bus.launch config:=/path/to/robot.yaml can:=can1    another interface

or by hand:

  rosparam load /path/to/robot.yaml /bus
  rosrun cia402_driver bus_node __name:=bus _interface:=sim

  _interface:=NAME          CAN interface instead of the file's; sim: simulated drives in the node
  _limits_from_parameters:=true  whether limits of robot_description and joint_limits count
  _profile_path:=FOLDER     a folder with further drive profiles
  _realtime_priority:=80    SCHED_FIFO priority of the bus thread, 1 to 99; 0: no real time

It waits for the ROS master and for the interface. SIGINT and SIGTERM stop and disable the drives.
)";

constexpr unsigned kWaitingCalls = 4;  // of services that keep a thread while they wait
constexpr Duration kLongestTick = std::chrono::milliseconds(20);  // for states and the log
constexpr Duration kFeedbackTick = std::chrono::milliseconds(50);
constexpr Duration kHomingTick = std::chrono::milliseconds(100);
constexpr Duration kStatusTick = std::chrono::seconds(1);
constexpr Duration kDiagnosticsTick = std::chrono::milliseconds(100);

/// A whole part of the period of joint_states, so that states and log need no waking of their own.
Duration tickOf(Duration joint_states) {
  const auto parts = (joint_states + kLongestTick - Duration(1)) / kLongestTick;
  return joint_states / parts;
}

/// The interface that the configuration names: one of these two.
struct OpenInterface {
  std::unique_ptr<can::Interface> interface;  ///< null: the problem has been told
  can::SocketCan* socket = nullptr;           ///< the same, where it is one of the kernel
  sim::SimulatedInterface* simulation = nullptr;
};

OpenInterface openInterface(const LoadedRobot& loaded) {
  const config::BusConfig& bus = loaded.robot.bus;
  OpenInterface open;
  if (bus.interface != "sim") {
    auto socket = openSocket(bus, loaded.master);
    open.socket = socket.get();
    open.interface = std::move(socket);
    return open;
  }
  const auto drives = ros_node::loadSimulation(loaded.robot);
  if (!drives) return open;
  auto interface = std::make_unique<sim::SimulatedInterface>(*drives, bus.bitrate, bus::realNow());
  open.simulation = interface.get();
  open.interface = std::move(interface);
  return open;
}

/// Injects into a drive that lives in the bus thread.
ros_node::FaultService::Inject injectThrough(bus::BusRunner& runner,
                                             sim::SimulatedInterface& simulation) {
  return [&](const std::string& axis, const std::string& fault) {
    const auto inject = [&simulation, axis, fault](Time now) {
      if (axis == "bus" && fault == "bus_off") {
        simulation.port().forceBusOff();
        return bus::answerOf(true, "the driver's controller is bus-off");
      }
      return ros_node::injectFault(simulation.find(axis), axis, fault, now);
    };
    return ros_node::call(runner, bus::CallCommand{inject});
  };
}

/// What joint_states and tf tell together comes from one cycle.
void publishMeasured(bus::BusRunner& runner, ros_node::Publishers& publishers,
                     ros_node::Frames& frames) {
  const bus::NetworkSnapshot snapshot = runner.snapshot();
  publishers.publishJointStates(snapshot);
  frames.publish(snapshot.joints);
}

/// Clients of the actions hear what becomes of their goals.
void tellOfGoals(ros_node::EventLoop& loop, ros_node::TrajectoryActions& trajectories,
                 ros_node::HomeAction& home) {
  loop.always([&] {
    trajectories.update();
    home.update();
  });
  loop.every(
      kFeedbackTick, [&] { trajectories.publishFeedback(); }, [&] { return trajectories.busy(); });
  loop.every(
      kHomingTick, [&] { home.publishFeedback(); }, [&] { return home.busy(); });
  loop.every(kStatusTick, [&] {
    trajectories.publishStatus();
    home.publishStatus();
  });
}

/// The tasks at the rate of joint_states, which may change.
void addStateTasks(ros_node::EventLoop& loop, const ros_node::Reloader& reloader,
                   const std::function<void()>& states, const std::function<void()>& measured) {
  const Duration period = reloader.jointStatePeriod();
  const std::size_t first = loop.every(tickOf(period), states);
  const std::size_t second = loop.every(period, measured);
  loop.always([&loop, &reloader, first, second] {
    loop.retime(first, tickOf(reloader.jointStatePeriod()));
    loop.retime(second, reloader.jointStatePeriod());
  });
}

/// Until the program is to end, and until the drives are stopped then.
void untilStopped(ros_node::EventLoop& loop, bus::BusRunner& runner) {
  ros_node::wakeOnSignals(loop.wakeFd());
  while (!ros_node::endRequested()) loop.step();
  ROS_INFO("stopping the drives");
  runner.requestShutdown();
  while (runner.running()) loop.step();
  runner.join();
}

/// Runs the driver until the node is asked to end.
void serve(ros::NodeHandle& node, ros::NodeHandle& private_node, const LoadedRobot& loaded,
           OpenInterface open) {
  sim::SimulatedInterface* const simulation = open.simulation;
  ros_node::EventLoop loop;
  const auto wake = [&loop] { loop.wake(); };
  ros_node::CallDesk desk(wake);
  ros_node::ServicePool pool(kWaitingCalls);
  node.setCallbackQueue(loop.queue());
  private_node.setCallbackQueue(loop.queue());

  bus::BusRunner::Options options;
  options.priority = loaded.options.realtime_priority;
  if (simulation != nullptr) options.time = bus::BusTime::Kind::simulated;
  bus::ReplyLog replies(loaded.robot.axes.size(), loaded.robot.groups.size());
  bus::BusRunner runner(loaded.robot, loaded.master, std::move(open.interface), options);
  ROS_INFO_STREAM(runner.recordings().describe());
  ros_node::EventLog events(private_node, runner, replies, loaded.robot);
  ros_node::LinkWatch link(loaded.robot.bus, open.socket);
  ros_node::Publishers publishers(node, private_node, runner, link, loaded.robot);
  ros_node::Diagnostics diagnostics(node, private_node, runner, link, loaded.robot);
  ros_node::Frames frames(runner.time(), loaded.robot);
  ros_node::CommandTopics topics(private_node, runner, replies, wake, loaded.robot);
  ros_node::TrajectoryActions actions(private_node, runner, wake, loaded.robot);
  ros_node::HomeAction home(private_node, runner, wake, loaded.robot);
  runner.start();

  ros::NodeHandle service_node("~");
  service_node.setCallbackQueue(pool.queue());
  ros_node::Reloader reloader(private_node, runner, loaded, [&loop] { loop.wake(); });
  ros_node::Services services(service_node, desk, runner, reloader, loaded.robot);
  ros_node::Reconfigure reconfigure(service_node, private_node, reloader, loaded.robot.groups);
  std::optional<ros_node::FaultService> faults;
  if (simulation != nullptr) faults.emplace(service_node, injectThrough(runner, *simulation));

  loop.always([&] {
    desk.answer();
    topics.update();
    reconfigure.update();
  });
  tellOfGoals(loop, actions, home);
  addStateTasks(
      loop, reloader,
      [&] {
        events.drain();
        publishers.publishStates();
      },
      [&] { publishMeasured(runner, publishers, frames); });
  loop.every(kDiagnosticsTick, [&] { diagnostics.update(); });
  untilStopped(loop, runner);
  events.drain();
  desk.answer();
  actions.update();
  home.update();
  topics.update();
  pool.stop();
  ROS_INFO("stopped");
  ros::shutdown();
}

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = ros_node::readCommandLine(argc, argv, kHelp)) return *status;
  bus::keepMemory();
  ros::init(argc, argv, "bus_node", ros::init_options::NoSigintHandler);
  ros::NodeHandle node;  // waits for the ROS master
  ros::NodeHandle private_node("~");
  ros_node::catchSignals();

  const auto loaded = ros_node::loadRobot(private_node);
  if (!loaded) return 1;
  OpenInterface open = openInterface(*loaded);
  if (!open.interface) return 1;
  ROS_INFO_STREAM("PDO plan:\n" << config::pdoTable(loaded->master, loaded->robot.bus.bitrate));
  serve(node, private_node, *loaded, std::move(open));
  return 0;
}
