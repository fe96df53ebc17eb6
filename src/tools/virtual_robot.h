// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/flight_recorder.h"
#include "bus/jobs/procedure_command.h"
#include "bus/network.h"
#include "sim/world/robot_drives.h"
#include "sim/world/world.h"

namespace cia402::tools {

/// A whole robot in virtual time and one thread: driver, bus and simulated drives. Hours of robot
/// life in seconds, and with one seed always the same.
///
/// The network itself, not bus::BusLoop on an interface, as in a VirtualHost: a frame is taken in
/// at its end, and the network is ticked when it says so. BusLoop ticks after each frame, too, so
/// that an axis asks its next question with the answer, and its frames lie elsewhere.
class VirtualRobot final : private sim::Participant, private bus::EventSink {
 public:
  /// @param drives on the bus, not necessarily those that `robot` expects.
  /// @param seed of faults injected into the bus.
  VirtualRobot(const config::RobotConfig& robot, const canopen::MasterConfig& master,
               const std::vector<sim::SimulatedDrive>& drives, std::uint64_t seed = 1)
      : world_(robot.bus.bitrate, seed),
        port_(world_.addParticipant("master", *this)),
        recorder_(robot, port_),
        network_(robot, master, recorder_, *this) {
    recorder_.watch(network_);
    sim::addTo(world_, drives);
  }

  /// Powers the drives on and starts the driver.
  void start() {
    world_.powerOn();
    network_.start(world_.now());
  }
  void run(Duration duration) { world_.advance(world_.now() + duration); }
  /// Runs in steps of a millisecond until `condition` holds. @return false after `limit`.
  bool runUntil(const std::function<bool()>& condition, Duration limit) {
    const Time end = world_.now() + limit;
    while (!condition()) {
      if (world_.now() >= end) return false;
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
    network_.execute(bus::Command(std::move(request), take), world_.now());
    runUntil([&answer] { return answer.has_value(); }, limit);
    return answer;
  }
  /// A procedure on one axis, or on all (`axis` empty).
  std::optional<bus::Answer> procedure(drive::ProcedureKind kind, const std::string& axis = {}) {
    drive::ProcedureRequest request;
    request.kind = kind;
    return call(bus::ProcedureCommand{axis, request});
  }

  bus::Network& network() { return network_; }
  sim::World& world() { return world_; }
  bus::FlightRecorder& recorder() { return recorder_; }
  /// The driver does not run for so long, as on a host that sleeps; frames are kept for it.
  void freeze(Duration duration) { frozen_until_ = world_.now() + duration; }
  /// The driver's controller, to pull its cable or let it die.
  sim::Port& port() { return port_; }
  Time now() const { return world_.now(); }
  /// What was told so far, oldest first.
  const std::vector<bus::Event>& events() const { return events_; }
  /// Every emergency so far, oldest first.
  const std::vector<bus::EmergencyEvent>& emergencies() const { return emergencies_; }

 private:
  /// As bus::BusWatch does with a real interface.
  void watchPort(Time now) {
    const bool lost = port_.state() == can::BusState::bus_off;
    if (lost == port_lost_) return;
    port_lost_ = lost;
    recorder_.onInterface(port_.state(), now);
    if (lost) {
      network_.busLost("the bus is off", now);
    } else {
      network_.busBack(true, now);
    }
  }
  void receive(const can::Frame& frame, Time now) override {
    if (now < frozen_until_) {
      kept_.emplace_back(frame, now);
    } else {
      take(frame, now, now);
    }
  }
  /// In the order of bus::BusLoop.
  void tick(Time now) override {
    network_.produceSync(now);
    for (const auto& [frame, stamp] : kept_) take(frame, stamp, now);
    kept_.clear();
    watchPort(now);
    network_.tick(now);
    recorder_.observe();
  }
  void take(const can::Frame& frame, Time stamp, Time now) {
    recorder_.received(frame, stamp);
    network_.receive(frame, stamp, now);
  }
  Time nextDeadline() const override { return std::max(network_.nextDeadline(), frozen_until_); }
  void onEvent(const bus::Event& event) override {
    recorder_.onEvent(event);
    events_.push_back(event);
  }
  void onEmergency(const bus::EmergencyEvent& event) override {
    recorder_.onEmergency(event);
    emergencies_.push_back(event);
  }

  sim::World world_;
  sim::Port& port_;
  std::vector<bus::Event> events_;
  std::vector<bus::EmergencyEvent> emergencies_;
  std::vector<std::pair<can::Frame, Time>> kept_;
  Time frozen_until_{};
  bus::FlightRecorder recorder_;
  bool port_lost_ = false;
  bus::Network network_;
};

}  // namespace cia402::tools
