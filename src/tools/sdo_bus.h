// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "can/pacer.h"
#include "canopen/sdo/client.h"
#include "sim/bus/bus.h"
#include "sim/device/device.h"

namespace cia402::tools {

/// One SDO client and one simulated device, node 1, on a bus in virtual time. The client's port
/// sends in the order of the kernel's queue, first in, first out.
class SdoBus final : private sim::Listener, private sim::Device::Application {
 public:
  explicit SdoBus(canopen::SdoOptions options = {}, std::uint64_t seed = 1, double bitrate = 1e6)
      : bus_(bitrate, seed),
        port_(bus_.attach(*this, "client")),
        pacer_(port_, bitrate),
        client_(kNode, pacer_, options, {}, &pacer_),
        device_port_(bus_.attach(device_listener_, "device")),
        device_(kNode, device_port_, dictionary_, {}, *this) {
    port_.setFirstInFirstOut(true);
    addNumber({0x1000, 0}, 0x00020192);
    addNumber({0x1018, 0}, 4);
  }
  SdoBus(const SdoBus&) = delete;
  SdoBus& operator=(const SdoBus&) = delete;

  void addNumber(fieldbus::ObjectId id, std::uint64_t value) {
    sim::Entry entry;
    entry.id = id;
    entry.number = value;
    dictionary_.add(entry);
  }
  void addDomain(fieldbus::ObjectId id, std::vector<std::uint8_t> bytes) {
    sim::Entry entry;
    entry.id = id;
    entry.type = sim::DataType::domain;
    entry.bytes = std::move(bytes);
    dictionary_.add(entry);
  }
  /// Powers the device on and waits for it. To be called after the dictionary is complete.
  void start() {
    device_.powerOn(now_);
    run(std::chrono::seconds(1));
  }
  /// Lets everything happen for so long.
  void run(Duration duration) {
    const Time end = now_ + duration;
    while (step(end)) {
    }
  }
  /// Runs until the transfer is done. @return how long that took.
  Duration finish(const canopen::SdoTicket& ticket, Duration limit = std::chrono::seconds(1000)) {
    const Time begin = now_, end = now_ + limit;
    while (!ticket->done() && step(end)) {
    }
    return now_ - begin;
  }

  canopen::SdoClient& client() { return client_; }
  can::Pacer& pacer() { return pacer_; }
  sim::Bus& bus() { return bus_; }
  sim::Port& port() { return port_; }
  sim::Device& device() { return device_; }
  sim::ObjectDictionary& dictionary() { return dictionary_; }
  Time now() const { return now_; }

 private:
  static constexpr canopen::NodeId kNode = 1;

  struct DeviceListener final : sim::Listener {
    explicit DeviceListener(SdoBus& bus) : owner(bus) {}
    void onFrame(const can::Frame& frame, Time now) override { owner.device_.receive(frame, now); }
    SdoBus& owner;
  };

  /// The next event, if it is not after `end`.
  bool step(Time end) {
    const Time next = std::min({bus_.nextEvent(), client_.nextDeadline(), device_.nextEvent()});
    if (next > end) {
      now_ = end;
      bus_.advance(now_);
      return false;
    }
    now_ = std::max(now_, next);
    bus_.setTime(now_);
    bus_.advance(now_);
    pacer_.setTime(now_);
    if (client_.nextDeadline() <= now_) client_.tick(now_);
    device_.tick(now_);
    return true;
  }
  void onFrame(const can::Frame& frame, Time now) override {
    pacer_.setTime(now);
    pacer_.heard(frame, now);
    if (frame.id == client_.answerId()) client_.receive(frame, now);
  }

  Time now_{};
  sim::Bus bus_;
  DeviceListener device_listener_{*this};
  sim::Port& port_;
  can::Pacer pacer_;
  canopen::SdoClient client_;
  sim::ObjectDictionary dictionary_;
  sim::Port& device_port_;
  sim::Device device_;
};

}  // namespace cia402::tools
