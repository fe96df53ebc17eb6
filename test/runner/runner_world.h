// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "bus/robot_world.h"
#include "bus/runner.h"

namespace cia402::bus::test {

/// What the test sees and sets of an interface that the runner owns.
struct RunnerWire {
  std::atomic<can::BusState> state{can::BusState::error_active};
  std::atomic<int> frames{0};
  std::atomic<std::uint64_t> bus_off_events{0};
  std::atomic<long> rounds{0};  ///< of the bus thread
  std::promise<void> first_frame, shut_down;
  std::function<void()> while_flushing;  ///< called once, after the last frame was sent
  std::atomic<int> emergencies{0};       ///< that the shoulder has still to send
  std::atomic<bool> flood{false};        ///< always another frame
  std::promise<std::array<std::uint8_t, 8>> first_time;  ///< message of the service TIME
};

/// An interface with the drives shoulder and elbow behind it; used by the bus thread only.
class RunnerInterface : public can::Interface {
 public:
  explicit RunnerInterface(std::shared_ptr<RunnerWire> wire) : wire_(std::move(wire)) {}

  bool send(const can::Frame& frame) override {
    if (wire_->frames++ == 0) wire_->first_frame.set_value();
    if (frame == can::Frame(0x000, {0x80, 0x00})) {
      wire_->shut_down.set_value();
      rounds_left_ = 3;
    }
    if (frame.id == 0x100 && times_++ == 0) wire_->first_time.set_value(frame.data);
    for (FakeDrive& drive : drives_) drive.receive(frame, now_);
    return true;
  }
  std::optional<can::ReceivedFrame> receive(Time now) override {
    now_ = now;
    if (wire_->flood) return can::ReceivedFrame{can::Frame(0x7A0, {}), now};
    if (wire_->emergencies > 0) {
      --wire_->emergencies;
      return can::ReceivedFrame{can::Frame(0x081, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}), now};
    }
    for (FakeDrive& drive : drives_) {
      drive.tick(now);
      if (drive.out.empty()) continue;
      const can::ReceivedFrame received{drive.out.front(), now};
      drive.out.pop_front();
      ++counters_.frames_received;
      return received;
    }
    return std::nullopt;
  }
  void maintain(Time) override {
    ++wire_->rounds;
    counters_.bus_off_events = wire_->bus_off_events;
    if (rounds_left_ > 0 && --rounds_left_ == 0 && wire_->while_flushing) wire_->while_flushing();
  }
  Time nextDeadline() const override {
    Time next = kNever;
    for (const FakeDrive& drive : drives_) {
      next = std::min(next, drive.out.empty() ? drive.nextDeadline() : Time{});
    }
    return next;
  }
  int fd() const override { return -1; }
  can::BusState state() const override { return wire_->state; }
  const can::BusCounters& counters() const override { return counters_; }
  std::string describe() const override {
    return std::string("can0 is ") + can::toString(wire_->state);
  }
  std::size_t pending() const override { return 3; }
  std::optional<ErrorCounters> errorCounters() const override { return ErrorCounters{12, 34}; }

 private:
  std::shared_ptr<RunnerWire> wire_;
  std::array<FakeDrive, 2> drives_{FakeDrive(1), FakeDrive(2)};
  can::BusCounters counters_;
  Time now_{};
  int rounds_left_ = 0, times_ = 0;
};

/// A runner of shoulder and elbow on that interface.
struct BusRunnerTest : testing::Test {
  BusRunnerTest() {
    config::RobotConfig robot = testRobot();
    robot.bus.sync_period = std::chrono::milliseconds(10);  // sanitizers are slow
    for (drive::AxisConfig& axis : robot.axes) axis.homing = homingOfOrder(0);
    runner = std::make_unique<BusRunner>(robot, masterOf(robot),
                                         std::make_unique<RunnerInterface>(wire), options());
  }
  static BusRunner::Options options() {
    BusRunner::Options options;
    options.priority = 0;
    return options;
  }
  template <typename Request>
  std::future<typename Request::Answer> post(Request request) {
    using AnswerType = typename Request::Answer;
    auto promise = std::make_shared<std::promise<AnswerType>>();
    auto future = promise->get_future();
    posted = runner->post(Command(
        std::move(request), [promise](const AnswerType& answer) { promise->set_value(answer); }));
    return future;
  }
  std::future<Answer> post(drive::ProcedureKind kind) {
    ProcedureCommand command;
    command.request.kind = kind;
    return post(command);
  }
  /// Returns when the bus thread has come round.
  void meet() {
    CallCommand call;
    call.function = [](Time) { return Answer(); };
    post(call).wait();
  }
  void waitFor(const std::function<bool()>& condition) {
    while (!condition()) meet();
  }
  bool seen(const std::string& words) {
    Event event;
    while (runner->nextEvent(event)) events += event.text.str() + "\n";
    return events.find(words) != std::string::npos;
  }
  bool ready() {
    const NetworkSnapshot snapshot = runner->snapshot();
    return std::all_of(snapshot.axes.begin(), snapshot.axes.end(), [](const AxisSnapshot& axis) {
      return axis.state.health == fieldbus::Health::ready && axis.state.feedback_valid;
    });
  }

  std::shared_ptr<RunnerWire> wire = std::make_shared<RunnerWire>();
  std::unique_ptr<BusRunner> runner;
  std::string events;
  bool posted = false;
};

}  // namespace cia402::bus::test
