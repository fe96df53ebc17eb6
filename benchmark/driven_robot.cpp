// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "driven_robot.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "bus/jobs/procedure_command.h"

namespace cia402::benchmark {
namespace {

constexpr Duration kFrameTime = std::chrono::microseconds(120);  // of a TPDO at 1 Mbit/s
constexpr double kBitrate = 1e6;

bus::NetworkSnapshot sized(std::size_t axes) {
  bus::NetworkSnapshot snapshot;
  snapshot.axes.resize(axes);
  snapshot.groups.resize(1);
  return snapshot;
}

}  // namespace

template <typename Request>
void DrivenRobot::runUntilAnswered(Request request) {
  std::optional<bus::Answer> answer;
  const auto take = [&answer](const bus::Answer& given) { answer = given; };
  network_.execute(bus::Command(std::move(request), take), now_);
  while (!answer) step();
  if (!answer->success) throw std::runtime_error(answer->message);
}

DrivenRobot::DrivenRobot(int axes, double sync_period_s, int cycles)
    : config_(genericRobot(axes, sync_period_s, Layout::lean)),
      period_(config_.robot.bus.sync_period),
      holds_(cycles == 0),
      drives_(axes),
      meter_(*this, kBitrate),
      recorder_(config_.robot, meter_),
      network_(config_.robot, config_.master, recorder_, *this),
      snapshots_(sized(static_cast<std::size_t>(axes))) {
  recorder_.watch(network_);
  incoming_.reserve(256);
  outgoing_.reserve(256);
  network_.start(now_);
  const auto ready = [](const bus::AxisUnit& unit) {
    const drive::AxisState& state = unit.axis.state();
    return state.health == fieldbus::Health::ready && state.feedback_valid;
  };
  const auto& units = network_.cycle().units();
  while (!std::all_of(units.begin(), units.end(), ready)) step();
  bus::ProcedureCommand enable;
  enable.request.kind = drive::ProcedureKind::enable;
  runUntilAnswered(enable);
  const std::uint64_t sync = network_.statistics().cycles();
  while (network_.statistics().cycles() == sync) step();
  sync_ = now_ + period_;
  began_ = sync_ - period_ / 2;  // one period before the first cycle
  if (holds_) return;
  runUntilAnswered(swing(config_.robot, sync_period_s * (cycles + 1), 0.1));
}

bool DrivenRobot::send(const can::Frame& frame) {
  outgoing_.push_back(frame);
  return true;
}

void DrivenRobot::onEvent(const bus::Event& event) {
  recorder_.onEvent(event);
  events_.push_back(event);
}

/// One event of a bus on which frames take no time.
void DrivenRobot::step() {
  now_ = std::max(now_, std::min(network_.nextDeadline(), drives_.nextHeartbeat()));
  if (toSeconds(now_.time_since_epoch()) > 60.0) {
    std::string told;
    for (const bus::Event& event : events_) told += "\n" + event.text.str();
    throw std::runtime_error("the scripted drives were not enabled within a minute:" + told);
  }
  network_.tick(now_);
  drives_.tick(now_, incoming_);
  while (!outgoing_.empty() || !incoming_.empty()) {
    const std::vector<can::Frame> sent = std::exchange(outgoing_, {});
    for (const can::Frame& frame : sent) drives_.receive(frame, incoming_);
    const std::vector<can::Frame> received = std::exchange(incoming_, {});
    for (const can::Frame& frame : received) {
      recorder_.received(frame, now_);
      network_.receive(frame, now_, now_);
    }
  }
}

void DrivenRobot::prepare() {
  incoming_.clear();
  for (const can::Frame& frame : outgoing_) {
    if (frame.id != 0x080) drives_.receive(frame, incoming_);
  }
  drives_.receive(can::Frame(0x080, {}), incoming_);
  drives_.tick(sync_, incoming_);
  outgoing_.clear();
}

/// In the order of bus::BusLoop::step.
void DrivenRobot::cycle() {
  wake(sync_);
  Time now = sync_;
  for (const can::Frame& frame : incoming_) {
    now += kFrameTime;
    const can::Frame received = frame;
    network_.produceSync(now);
    meter_.count(received);
    recorder_.received(received, now);
    network_.receive(received, now, now);
    network_.tick(now);
    meter_.update(now);
    recorder_.observe();
    publish(now);
  }
  wake(sync_ + period_ / 2);
  sync_ += period_;
}

void DrivenRobot::wake(Time now) {
  network_.tick(now);
  meter_.update(now);
  recorder_.observe();
  publish(now);
}

/// As in BusRunner.
void DrivenRobot::publish(Time now) {
  now_ = std::min(now, network_.nextDeadline());  // what BusRunner would wait for
  const std::uint64_t cycle = network_.statistics().cycles();
  if (cycle == published_cycle_) return;
  published_cycle_ = cycle;
  network_.fill(snapshots_.back());
  snapshots_.publish();
}

void DrivenRobot::checkHeld() const {
  for (const bus::AxisUnit& unit : network_.cycle().units()) {
    const drive::AxisState& state = unit.axis.state();
    if (state.state != drive::State::operation_enabled || state.position != 0.0) {
      throw std::runtime_error(unit.axis.config().joint + " does not hold");
    }
  }
}

void DrivenRobot::check() const {
  if (holds_) return checkHeld();
  // The target was computed in the middle of the last period.
  const double time_s = toSeconds(sync_ - period_ / 2 - began_);
  const auto& commanded = network_.cycle().groups().front().commanded();
  for (std::size_t i = 0; i < commanded.size(); ++i) {
    if (network_.cycle().groups().front().executing() &&
        std::abs(commanded[i].position - swingPosition(i, time_s)) < 1e-3) {
      continue;
    }
    std::string told;
    for (const bus::Event& event : events_) told += "\n" + event.text.str();
    throw std::runtime_error("joint " + std::to_string(i + 1) +
                             " left its path: " + std::to_string(commanded[i].position) +
                             " instead of " + std::to_string(swingPosition(i, time_s)) +
                             " rad at " + std::to_string(time_s) + " s" + told);
  }
}

}  // namespace cia402::benchmark
