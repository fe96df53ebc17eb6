// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/interface.h"

#include <algorithm>
#include <string>
#include <utility>

#include "can/error_frame.h"

namespace cia402::sim {
namespace {

// The error frame by which SocketCAN tells a new controller state (linux/can/error.h).
can::Frame stateFrame(can::BusState state, const Port& port) {
  const bool transmitter = port.transmitErrors() >= port.receiveErrors();
  can::Frame frame(0x204, {0, 0, 0, 0, 0, 0, 0, 0});  // controller status, with counters
  frame.error = true;
  switch (state) {
    case can::BusState::bus_off:
      frame.id = 0x40;
      return frame;
    case can::BusState::error_passive:
      frame.data[1] = transmitter ? 0x20 : 0x10;
      break;
    case can::BusState::error_warning:
      frame.data[1] = transmitter ? 0x08 : 0x04;
      break;
    default:
      frame.data[1] = 0x40;
      break;
  }
  frame.data[6] = static_cast<std::uint8_t>(port.transmitErrors());
  frame.data[7] = static_cast<std::uint8_t>(port.receiveErrors());
  return frame;
}

}  // namespace

BusInterface::BusInterface(Bus& bus, std::string name, const Options& options)
    : bus_(bus), options_(options), port_(bus.attach(*this, std::move(name))) {
  recovery_ = can::BusOffRecovery(options.recovery);
  ring_.resize(options.receive_capacity > 0 ? options.receive_capacity : 1);
}

bool BusInterface::send(const can::Frame& frame) {
  const bool taken = port_.send(frame);
  counters_.frames_dropped = port_.counters().dropped;
  return taken;
}

void BusInterface::advance(Time now) {
  if (advance_) {
    advance_(now);
  } else {
    bus_.advance(now);
  }
}

std::optional<can::ReceivedFrame> BusInterface::receive(Time now) {
  if (count_ == 0) advance(now);
  if (count_ == 0) return std::nullopt;
  const can::ReceivedFrame received = ring_[first_];
  first_ = (first_ + 1) % ring_.size();
  --count_;
  return received;
}

void BusInterface::maintain(Time now) {
  advance(now);
  counters_.frames_dropped = port_.counters().dropped;
  recovery_.update(port_.state(), now);
  recover(now);
}

void BusInterface::recover(Time now) {
  const bool kernel = options_.restart_after > Duration::zero();
  if (kernel && now >= restart_at_) {
    restart_at_ = kNever;
    recovery_note_ = port_.name() + " is bus-off: it is restarted by itself after each bus-off";
    port_.requestRecovery();
  }
  if (kernel || !recovery_.attempt(now)) return;
  ++counters_.restart_attempts;
  if (options_.may_restart) {
    recovery_note_ = port_.name() + " is bus-off: the driver has restarted it, attempt " +
                     std::to_string(recovery_.attempts());
    port_.requestRecovery();
  } else {
    recovery_note_ = port_.name() + " is bus-off, and the driver may not restart it";
  }
}

std::optional<can::Interface::ErrorCounters> BusInterface::errorCounters() const {
  ErrorCounters counters;
  counters.transmit = static_cast<std::uint8_t>(std::min(port_.transmitErrors(), 255U));
  counters.receive = static_cast<std::uint8_t>(std::min(port_.receiveErrors(), 255U));
  return counters;
}

can::BusState BusInterface::state() const { return port_.state(); }

void BusInterface::push(const can::Frame& frame, Time stamp) {
  if (count_ == ring_.size()) {
    ++counters_.receive_overflows;
    return;
  }
  ring_[(first_ + count_) % ring_.size()] = {frame, stamp};
  ++count_;
}

void BusInterface::onFrame(const can::Frame& frame, Time end_of_frame) {
  ++counters_.frames_received;
  push(frame, end_of_frame);
}

void BusInterface::onSent(const can::Frame&, Time) { ++counters_.frames_sent; }

void BusInterface::onStateChange(can::BusState state, Time now) {
  if (state == can::BusState::down) return;  // no power: not something a controller can report
  const can::Frame frame = stateFrame(state, port_);
  can::countErrorFrame(frame, counters_);
  push(frame, now);
  const bool off = state == can::BusState::bus_off;
  if (was_off_ && !off) {
    ++counters_.restarts;
    recovery_note_.clear();
  }
  was_off_ = off;
  if (!off) return;
  ++counters_.bus_off_events;
  if (options_.restart_after > Duration::zero()) restart_at_ = now + options_.restart_after;
}

std::string BusInterface::describe() const {
  const std::string name = port_.name() + " (simulated bus)";
  switch (state()) {
    case can::BusState::missing:
    case can::BusState::down:
      return name + " is down: the simulation has switched its power off";
    case can::BusState::error_active:
      return name + " is up";
    case can::BusState::bus_off:
      return name + " is bus-off: no frame is sent until the controller is restarted" +
             (options_.restart_after > Duration::zero() ? ", which happens by itself"
              : recovery_note_.empty()                  ? ""
                                                        : "; " + recovery_note_);
    default:
      return name + " is " + can::toString(port_.state()) + " (transmit errors " +
             std::to_string(port_.transmitErrors()) + ", receive errors " +
             std::to_string(port_.receiveErrors()) +
             "): the bus is disturbed or nobody acknowledges";
  }
}

}  // namespace cia402::sim
