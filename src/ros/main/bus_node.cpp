// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <memory>

#include "cia402_driver/bus/real_clock.h"
#include "cia402_driver/bus/runner.h"
#include "cia402_driver/can/socketcan.h"
#include "cia402_driver/canopen/cyclic_identifiers.h"
#include "cia402_driver/ros/command_call.h"
#include "cia402_driver/ros/command_topics.h"
#include "cia402_driver/ros/diagnostics.h"
#include "cia402_driver/ros/event_log.h"
#include "cia402_driver/ros/fault_service.h"
#include "cia402_driver/ros/frames.h"
#include "cia402_driver/ros/lss_services.h"
#include "cia402_driver/ros/process_signals.h"
#include "cia402_driver/ros/publishers.h"
#include "cia402_driver/ros/robot_loader.h"
#include "cia402_driver/ros/services.h"
#include "cia402_driver/sim/simulated_interface.h"

namespace {

using cia402::ros_node::LoadedRobot;
using namespace cia402;  // NOLINT: a main file

/// The interface the configuration names. `simulation` points into it where it is simulated.
std::unique_ptr<can::Interface> openInterface(const LoadedRobot& loaded,
                                              sim::SimulatedInterface*& simulation) {
  const config::BusConfig& bus = loaded.robot.bus;
  if (bus.interface != "sim") {
    can::SocketCan::Options options;
    options.bitrate = static_cast<unsigned>(bus.bitrate);
    options.cyclic_lifetime = 2 * bus.sync_period;
    for (const std::uint32_t id : canopen::cyclicIdentifiers(loaded.master)) options.cyclic.set(id);
    return std::make_unique<can::SocketCan>(bus.interface, options);
  }
  const auto axes = ros_node::loadSimulation(loaded.robot);
  if (!axes) return nullptr;
  auto interface = std::make_unique<sim::SimulatedInterface>(*axes, bus.bitrate, bus::realNow());
  simulation = interface.get();
  return interface;
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
      return ros_node::injectFault(simulation.world().find(axis), axis, fault, now);
    };
    return ros_node::call(runner, bus::CallCommand{inject});
  };
}

}  // namespace

int main(int argc, char** argv) {
  ros_node::catchSignals();
  ros::init(argc, argv, "bus_node", ros::init_options::NoSigintHandler);
  ros::NodeHandle node;
  ros::NodeHandle private_node("~");

  const auto loaded = ros_node::loadRobot(private_node);
  if (!loaded) return 1;
  sim::SimulatedInterface* simulation = nullptr;
  std::unique_ptr<can::Interface> interface = openInterface(*loaded, simulation);
  if (!interface) return 1;
  ROS_INFO_STREAM("PDO plan:\n" << config::pdoTable(loaded->master, loaded->robot.bus.bitrate));

  bus::BusRunner::Options options;
  options.priority = loaded->options.realtime_priority;
  if (simulation != nullptr) options.time = bus::BusTime::Kind::simulated;
  bus::ReplyLog replies(loaded->robot.axes.size());
  bus::BusRunner runner(loaded->robot, loaded->master, std::move(interface), options);
  ROS_INFO_STREAM(runner.recordings().describe());
  ros_node::EventLog events(private_node, runner, replies, loaded->robot);
  ros_node::Publishers publishers(node, private_node, runner, loaded->robot);
  ros_node::Diagnostics diagnostics(node, private_node, runner, loaded->robot);
  ros_node::Frames frames(node, runner, loaded->robot);
  ros_node::CommandTopics topics(private_node, runner, replies, loaded->robot);
  runner.start();

  ros::CallbackQueue service_queue;  // calls wait for their procedures: not in the way of topics
  ros::NodeHandle service_node("~");
  service_node.setCallbackQueue(&service_queue);
  ros_node::Services services(service_node, runner, loaded->robot);
  ros_node::LssServices lss_services(service_node, runner);
  std::unique_ptr<ros_node::FaultService> faults;
  if (simulation != nullptr) {
    faults =
        std::make_unique<ros_node::FaultService>(service_node, injectThrough(runner, *simulation));
  }
  ros::AsyncSpinner service_spinner(ros_node::Services::threads(loaded->robot), &service_queue);
  ros::AsyncSpinner spinner(1);
  service_spinner.start();
  spinner.start();

  ros_node::waitForEnd();
  ROS_INFO("stopping the drives");
  runner.requestShutdown();
  runner.join();
  spinner.stop();
  events.drain();
  ROS_INFO("stopped");
  ros::shutdown();
  return 0;
}
