// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/bus_loop.h"
#include "bus/jobs/procedure_command.h"
#include "sim/bus/interface.h"
#include "sim/world/robot_drives.h"
#include "sim/world/world.h"

namespace cia402::tools {

/// A whole robot in virtual time and one thread: driver, bus and simulated drives. Hours of robot
/// life in seconds, and with one seed always the same. The driver is bus::BusLoop on a simulated
/// interface, and goes round at once with each frame and at each deadline; where the computer that
/// it runs on matters, a VirtualHost does it.
class VirtualRobot final : private sim::Timed, private bus::EventSink {
 public:
  /// @param drives on the bus, not necessarily those that `robot` expects.
  /// @param seed of faults injected into the bus.
  VirtualRobot(const config::RobotConfig& robot, const canopen::MasterConfig& master,
               const std::vector<sim::SimulatedDrive>& drives, std::uint64_t seed = 1)
      : world_(robot.bus.bitrate, seed),
        interface_(world_.bus(), "master", unhelped()),
        loop_(robot, master, interface_, static_cast<bus::EventSink&>(*this)) {
    interface_.setAdvance([](Time) {});  // the world goes on by itself
    world_.add(*this);
    sim::addTo(world_, drives);
  }

  /// Powers the drives on and starts the driver.
  void start() {
    world_.powerOn();
    startDriver();
  }
  /// Starts the driver on drives that may be there for long; it hears nothing of what was before.
  void startDriver() {
    while (interface_.receive(now())) {
    }
    started_ = true;
    loop_.step(now());
  }
  void run(Duration duration) { world_.advance(now() + duration); }
  /// Runs in steps of a millisecond until `condition` holds. @return false after `limit`.
  bool runUntil(const std::function<bool()>& condition, Duration limit) {
    const Time end = now() + limit;
    while (!condition()) {
      if (now() >= end) return false;
      run(std::chrono::milliseconds(1));
    }
    return true;
  }
  /// Gives a command and runs until it is answered; nothing after `limit`.
  template <typename Request>
  std::optional<typename Request::Answer> call(Request request,
                                               Duration limit = std::chrono::seconds(120)) {
    std::optional<typename Request::Answer> answer;
    const auto take = [&answer](const typename Request::Answer& given) { answer = given; };
    network().execute(bus::Command(std::move(request), take), now());
    runUntil([&answer] { return answer.has_value(); }, limit);
    return answer;
  }
  /// A procedure on one axis, or on all (`axis` empty).
  std::optional<bus::Answer> procedure(drive::ProcedureKind kind, const std::string& axis = {}) {
    drive::ProcedureRequest request;
    request.kind = kind;
    return call(bus::ProcedureCommand{axis, request});
  }

  bus::Network& network() { return loop_.network(); }
  sim::World& world() { return world_; }
  bus::FlightRecorder& recorder() { return loop_.recorder(); }
  /// The driver does not run for so long, as on a host that sleeps; frames are kept for it.
  void freeze(Duration duration) { frozen_until_ = now() + duration; }
  /// The driver's controller, to pull its cable or let it die.
  sim::Port& port() { return interface_.port(); }
  Time now() const { return world_.now(); }
  /// What was told so far, oldest first.
  const std::vector<bus::Event>& events() const { return events_; }
  /// Every emergency so far, oldest first.
  const std::vector<bus::EmergencyEvent>& emergencies() const { return emergencies_; }

 private:
  /// A controller that is bus-off stays so until port() is asked to recover.
  static sim::BusInterface::Options unhelped() {
    sim::BusInterface::Options options;
    options.may_restart = false;
    return options;
  }
  void tick(Time now) override { loop_.step(now); }
  Time nextDeadline() const override {
    if (!started_) return kNever;
    return std::max(interface_.waiting() > 0 ? now() : loop_.nextDeadline(), frozen_until_);
  }
  void onEvent(const bus::Event& event) override {
    loop_.recorder().onEvent(event);
    events_.push_back(event);
  }
  void onEmergency(const bus::EmergencyEvent& event) override {
    loop_.recorder().onEmergency(event);
    emergencies_.push_back(event);
  }

  sim::World world_;
  sim::BusInterface interface_;
  std::vector<bus::Event> events_;
  std::vector<bus::EmergencyEvent> emergencies_;
  bool started_ = false;
  Time frozen_until_{};
  bus::BusLoop loop_;
};

}  // namespace cia402::tools
