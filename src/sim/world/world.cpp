// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/world.h"

#include <algorithm>

namespace cia402::sim {

/// A drive behind its port. Its next event is kept, for it is asked for far more often than it
/// changes.
class World::DriveNode final : public Listener {
 public:
  DriveNode(Bus& bus, std::string name, std::shared_ptr<const DriveDefinition> definition,
            canopen::NodeId node, const AxisMechanics& mechanics, const DriveIdentity& identity,
            const std::vector<AxisMechanics>& further)
      : bus_(bus),
        port_(bus.attach(*this, std::move(name))),
        drive_(std::move(definition), node, port_, mechanics, identity, further) {
    drive_.hangOn(static_cast<std::uint32_t>(bus.bitrate()));
  }

  void onFrame(const can::Frame& frame, Time now) override {
    drive_.receive(frame, now);
    if (drive_.device().jamsUntil() > now) bus_.jam(drive_.device().jamsUntil());
    refresh();
  }
  void onStateChange(can::BusState state, Time now) override {
    const bool was_off = off_;
    off_ = state == can::BusState::bus_off;
    if (off_ == was_off) return;
    Device& device = drive_.device();
    restart_at_ = kNever;
    if (off_ && device.behaviour().restart_after_bus_off > Duration::zero()) {
      restart_at_ = now + device.behaviour().restart_after_bus_off;
    }
    drive_.tick(now);
    off_ ? device.onBusOff(now) : device.onBusRecovered(now);
    refresh();
  }
  void tick(Time now) {
    if (restart_at_ <= now) {
      restart_at_ = kNever;
      port_.requestRecovery();
    }
    const bool had_power = drive_.device().powered();
    drive_.tick(now);
    if (off_ && !had_power && drive_.device().powered()) restartController();
    refresh();
  }
  void refresh() { next_event_ = std::min(drive_.nextEvent(), restart_at_); }
  Time nextEvent() const { return next_event_; }
  Port& port() { return port_; }
  Drive& drive() { return drive_; }

 private:
  // Power that comes back starts the controller anew.
  void restartController() {
    off_ = false;
    restart_at_ = kNever;
    port_.setPowered(false);
    port_.setPowered(true);
  }

  Bus& bus_;
  Port& port_;
  Drive drive_;
  Time next_event_ = kNever;
  Time restart_at_ = kNever;
  bool off_ = false;
};

class World::ParticipantNode final : public Listener {
 public:
  ParticipantNode(Bus& bus, std::string name, Participant& participant)
      : port_(bus.attach(*this, std::move(name))), participant_(participant) {}

  void onFrame(const can::Frame& frame, Time now) override { participant_.receive(frame, now); }
  Port& port() { return port_; }

 private:
  Port& port_;
  Participant& participant_;
};

World::World(double bitrate, std::uint64_t seed) : bus_(bitrate, seed) {}
World::~World() = default;

Drive& World::addDrive(const std::string& name, std::shared_ptr<const DriveDefinition> definition,
                       canopen::NodeId node, const AxisMechanics& mechanics,
                       const DriveIdentity& identity, const std::vector<AxisMechanics>& further) {
  drives_.push_back(std::make_unique<DriveNode>(bus_, name, std::move(definition), node, mechanics,
                                                identity, further));
  return drives_.back()->drive();
}

Port& World::addParticipant(const std::string& name, Participant& participant) {
  participants_.push_back(std::make_unique<ParticipantNode>(bus_, name, participant));
  add(participant);
  return participants_.back()->port();
}

void World::powerOn() {
  bus_.setTime(now_);
  for (auto& node : drives_) {
    node->drive().powerOn(now_);
    node->refresh();
  }
}

Time World::nextEvent() const {
  Time next = bus_.nextEvent();
  for (const auto& node : drives_) next = std::min(next, node->nextEvent());
  for (const Timed* timed : timed_) next = std::min(next, timed->nextDeadline());
  return next;
}

void World::advance(Time until) {
  // Somebody outside may have switched or poked at a drive since.
  for (auto& node : drives_) node->refresh();
  for (Time next = nextEvent(); next <= until; next = nextEvent()) {
    now_ = std::max(now_, next);
    bus_.setTime(now_);
    bus_.advance(now_);
    for (auto& node : drives_) {
      if (node->nextEvent() <= now_) node->tick(now_);
    }
    for (Timed* timed : timed_) {
      if (timed->nextDeadline() <= now_) timed->tick(now_);
    }
  }
  now_ = std::max(now_, until);
  bus_.advance(now_);
}

Drive& World::drive(std::size_t index) { return drives_[index]->drive(); }

Drive* World::find(const std::string& name) {
  for (auto& node : drives_) {
    if (node->port().name() == name) return &node->drive();
  }
  return nullptr;
}

Port& World::port(std::size_t index) { return drives_[index]->port(); }

}  // namespace cia402::sim
