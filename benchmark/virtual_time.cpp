// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How fast virtual time runs, and that it runs the same way twice.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "figures.h"
#include "fingerprint.h"
#include "robots.h"
#include "tools/virtual_robot.h"

namespace cia402::benchmark {
namespace {

constexpr double kHour = 3600.0;     // s
constexpr double kTolerance = 0.05;  // rad between the sine and the drives

bool allReady(tools::VirtualRobot& robot) {
  for (const bus::AxisUnit& unit : robot.network().cycle().units()) {
    if (unit.axis.state().health != fieldbus::Health::ready) return false;
  }
  return true;
}

void enable(tools::VirtualRobot& robot) {
  robot.start();
  if (!robot.runUntil([&] { return allReady(robot); }, std::chrono::seconds(10))) {
    throw std::runtime_error("the simulated drives did not boot");
  }
  const auto answer = robot.procedure(drive::ProcedureKind::enable);
  if (!answer || !answer->success) {
    throw std::runtime_error("enable failed: " + (answer ? answer->message : "no answer"));
  }
}

/// Every joint must be on its sine: what stands still costs little and shows nothing.
void checkMotion(tools::VirtualRobot& robot, double time_s) {
  const auto& units = robot.network().cycle().units();
  for (std::size_t i = 0; i < units.size(); ++i) {
    const double error = units[i].axis.state().position - swingPosition(i, time_s);
    if (std::abs(error) <= kTolerance) continue;
    std::string told;
    for (const bus::Event& event : robot.events()) told += "\n  " + event.text.str();
    throw std::runtime_error(units[i].axis.config().name + " is " + std::to_string(error) +
                             " rad off its path after " + std::to_string(time_s) + " s:" + told);
  }
}

/// Moves all joints for an hour of bus time, looking every ten seconds at where they are.
void moveForAnHour(tools::VirtualRobot& robot, const config::RobotConfig& config) {
  const auto answer = robot.call(swing(config, kHour + 1.0, 0.1));
  if (!answer || !answer->success) {
    throw std::runtime_error("the trajectory was refused: " + (answer ? answer->message : ""));
  }
  for (int i = 1; i * 10 <= static_cast<int>(kHour); ++i) {
    robot.run(std::chrono::seconds(10));
    checkMotion(robot, i * 10.0);
  }
}

/// Everything that was on the bus in an hour with faults, as one number.
std::uint64_t hourWithFaults(std::uint64_t seed) {
  const TestRobot robot = genericRobot(3, 0.004, Layout::profile);
  tools::VirtualRobot world(robot.robot, robot.master, robot.drives, seed);
  Fingerprint fingerprint;
  world.world().bus().setMonitor(
      [&](const can::Frame& frame, Time time) { fingerprint.add(frame, time); });
  enable(world);
  sim::FaultRates rates;
  rates.loss = 1e-4;
  rates.corrupt = 1e-4;
  world.world().bus().faults().setRates(rates);
  moveForAnHour(world, robot.robot);
  for (const bus::AxisUnit& unit : world.network().cycle().units()) {
    fingerprint.add(unit.axis.state().position);
  }
  return fingerprint.value();
}

}  // namespace

int virtualTimeSpeed() {
  using Clock = std::chrono::steady_clock;
  const TestRobot robot = genericRobot(3, 0.004, Layout::profile);
  tools::VirtualRobot world(robot.robot, robot.master, robot.drives);
  enable(world);
  const Clock::time_point begin = Clock::now();
  moveForAnHour(world, robot.robot);
  const std::chrono::duration<double> took = Clock::now() - begin;
  print("virtual_time_speed_3_axes", kHour / took.count(), "x");
  return 0;
}

int virtualTimeRepeatable() {
  const std::uint64_t first = hourWithFaults(1), again = hourWithFaults(1),
                      other = hourWithFaults(2);
  const bool repeatable = first == again && first != other;
  print("virtual_time_repeatable", repeatable ? 1.0 : 0.0, "identical");
  if (first != again) std::fprintf(stderr, "two hours with one seed differ\n");
  if (first == other) std::fprintf(stderr, "the seed makes no difference\n");
  return repeatable ? 0 : 1;
}

}  // namespace cia402::benchmark
