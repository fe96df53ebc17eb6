// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bus/bus_loop.h"
#include "sim/bus/interface.h"
#include "system/robot_fixture.h"

namespace cia402 {

/// A whole robot on a CAN interface in virtual time, with a controller that may fall off the bus
/// and has to be restarted, and a thread that may be held up.
class InterfaceScene : private bus::EventSink {
 public:
  InterfaceScene(LoadedRobot loaded, const sim::BusInterface::Options& options)
      : loaded_(std::move(loaded)),
        world_(loaded_.robot.bus.bitrate),
        interface_(world_.bus(), "can0", options),
        loop_(loaded_.robot, loaded_.master, interface_, *this) {
    sim::addTo(world_, loaded_.drives);
    interface_.setAdvance([this](Time time) { world_.advance(time); });
    world_.powerOn();
  }

  bus::Network& network() { return loop_.network(); }
  sim::World& world() { return world_; }
  sim::BusInterface& interface() { return interface_; }
  sim::Port& port() { return interface_.port(); }
  const bus::BusWatch& watch() const { return loop_.watch(); }
  Time now() const { return now_; }
  std::string told() const {
    std::string text;
    for (const bus::Event& event : events_) text += event.text.str() + "\n";
    return text;
  }
  void forgetTold() { events_.clear(); }
  const drive::AxisState& state(std::size_t i) { return network().axis(i).state(); }
  sim::DriveTruth truth(std::size_t i) { return world_.drive(i).truth(now_); }
  bool allReady() {
    for (const bus::AxisUnit& unit : network().cycle().units()) {
      const drive::AxisState& state = unit.axis.state();
      if (state.health != fieldbus::Health::ready || !state.feedback_valid) return false;
    }
    return true;
  }

  void run(Duration duration) {
    for (const Time end = now_ + duration; now_ < end;) step();
  }
  template <typename Condition>
  bool runUntil(Condition&& condition, Duration limit) {
    for (const Time end = now_ + limit; !condition();) {
      if (now_ >= end) return false;
      step();
    }
    return true;
  }
  /// The driver's thread does not run for so long; the bus and the kernel do.
  void stall(Duration duration) {
    now_ += duration;
    world_.advance(now_);
  }
  template <typename Request>
  bus::Answer call(Request request) {
    std::optional<bus::Answer> answer;
    const auto take = [&answer](const bus::Answer& given) { answer = given; };
    network().execute(bus::Command(std::move(request), take), now_);
    runUntil([&answer] { return answer.has_value(); }, std::chrono::seconds(60));
    return answer.value_or(bus::Answer());
  }
  bus::Answer procedure(drive::ProcedureKind kind, const std::string& axis = {}) {
    drive::ProcedureRequest request;
    request.kind = kind;
    return call(bus::ProcedureCommand{axis, request});
  }
  bus::Answer move(std::vector<double> goal, Duration duration) {
    bus::TrajectoryCommand trajectory;
    trajectory.group = loaded_.robot.groups[0].name;
    trajectory.joints = loaded_.robot.groups[0].joints;
    std::vector<double> rest(goal.size(), 0.0);
    trajectory.points = {{std::move(goal), std::move(rest), {}, duration}};
    return call(trajectory);
  }

 private:
  void onEvent(const bus::Event& event) override { events_.push_back(event); }
  void step() {
    now_ += std::chrono::microseconds(500);
    loop_.step(now_);
  }

  LoadedRobot loaded_;
  sim::World world_;
  sim::BusInterface interface_;
  std::vector<bus::Event> events_;
  bus::BusLoop loop_;
  Time now_{};
};

}  // namespace cia402
