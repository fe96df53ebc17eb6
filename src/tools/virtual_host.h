// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "bus/bus_loop.h"
#include "sim/bus/interface.h"
#include "sim/world/world.h"

namespace cia402::tools {

/// The computer that runs the driver, in virtual time: bus::BusLoop on the CAN interface of a
/// simulated world, woken by frames, commands and deadlines as bus::BusRunner is. It can be held
/// up, wake late, die without a word and start again on drives that are still powered. Frames wait
/// in its kernel meanwhile.
class VirtualHost final : private sim::Timed, private bus::EventSink {
 public:
  /// How late the driver's thread wakes up, asked before each round.
  using Lateness = std::function<Duration()>;
  /// Takes what the driver tells people.
  using Ear = std::function<void(const bus::Event&)>;

  VirtualHost(sim::World& world, config::RobotConfig robot, canopen::MasterConfig master)
      : world_(world),
        robot_(std::move(robot)),
        master_(std::move(master)),
        interface_(world.bus(), "can0") {
    interface_.setAdvance([](Time) {});  // the world goes on by itself
    world_.add(*this);
    interface_.port().setFirstInFirstOut(true);
  }

  /// Begins a new process. @pre !running()
  void start() {
    while (interface_.receive(now())) {
    }
    stopping_ = false;
    loop_.emplace(robot_, master_, interface_, static_cast<bus::EventSink&>(*this));
    rounded_ = now();
    wake(now());
  }
  /// The process dies; what it has given to the kernel still leaves. Commands get no answer.
  void kill() {
    loop_.reset();
    mailbox_.clear();
  }
  /// Asks the process to end in good order; it is gone once running() is false.
  void stop() {
    stopping_ = true;
    wake(now());
  }
  bool running() const { return loop_.has_value(); }

  /// The process gets no processor for so long.
  void stall(Duration duration) { stalled_until_ = std::max(stalled_until_, now() + duration); }
  bool stalled() const { return now() < stalled_until_; }
  void setLateness(Lateness lateness) {
    lateness_ = std::move(lateness);
    late_ = {};
  }
  void listen(Ear ear) { ear_ = std::move(ear); }

  /// Gives a command from another thread; lost where no process runs.
  void post(bus::Command command) {
    if (!loop_) return;
    mailbox_.push_back(std::move(command));
    wake(now());
  }
  /// Lets everything happen up to and including `until`.
  void advance(Time until) { world_.advance(until); }

  Time now() const { return world_.now(); }
  sim::BusInterface& interface() { return interface_; }
  /// @pre running()
  bus::Network& network() { return loop_->network(); }
  const bus::Network& network() const { return loop_->network(); }
  bus::BusLoop& loop() { return *loop_; }

 private:
  static constexpr Duration kIdle = std::chrono::milliseconds(20);  // as bus::BusRunner

  void tick(Time now) override {
    if (wakeTime() <= now) {
      round();
    } else {
      wake(now);
    }
  }
  Time nextDeadline() const override { return frameCame() ? now() : wakeTime(); }
  /// A frame has come for a thread that sleeps.
  bool frameCame() const { return loop_ && woken_ == kNever && interface_.waiting() > 0; }
  void wake(Time time) {
    if (woken_ == kNever) woken_ = time;
  }
  Time wakeTime() const {
    if (!loop_) return kNever;
    const Time due = std::min({woken_, loop_->nextDeadline(), rounded_ + kIdle});
    return std::max({due == Time::min() ? now() : due + late_, stalled_until_, now()});
  }
  /// As bus::BusRunner::iterate().
  void round() {
    woken_ = kNever;
    rounded_ = now();
    if (lateness_) late_ = lateness_();
    if (stopping_) loop_->network().beginShutdown(now());
    loop_->step(now());
    std::vector<bus::Command> commands;
    commands.swap(mailbox_);
    for (bus::Command& command : commands) loop_->network().execute(std::move(command), now());
    if (loop_->network().shutDown()) {
      loop_.reset();
    } else if (interface_.waiting() > 0) {
      wake(now());
    }
  }
  void onEvent(const bus::Event& event) override {
    if (loop_) loop_->recorder().onEvent(event);
    if (ear_) ear_(event);
  }
  void onEmergency(const bus::EmergencyEvent& event) override {
    if (loop_) loop_->recorder().onEmergency(event);
  }

  sim::World& world_;
  config::RobotConfig robot_;
  canopen::MasterConfig master_;
  sim::BusInterface interface_;
  Lateness lateness_;
  Ear ear_;
  Time stalled_until_{}, rounded_{}, woken_ = kNever;
  Duration late_{0};
  bool stopping_ = false;
  std::vector<bus::Command> mailbox_;
  std::optional<bus::BusLoop> loop_;
};

}  // namespace cia402::tools
