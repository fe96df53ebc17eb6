// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/drive_host.h"

#include <algorithm>
#include <utility>

namespace cia402::sim {
namespace {

constexpr int kRounds = 16;  // drives may answer each other's frames; more than this waits

}  // namespace

/// Where a drive sends: onto the interface, and to the other drives, for the interface does not
/// hand our own frames back.
class DriveHost::Tap final : public can::Sink {
 public:
  explicit Tap(can::Interface& interface) : interface_(interface) {}

  bool send(const can::Frame& frame) override {
    if (!interface_.send(frame)) return false;
    sent_.push_back(frame);
    return true;
  }
  std::vector<can::Frame> takeSent() { return std::exchange(sent_, {}); }

 private:
  can::Interface& interface_;
  std::vector<can::Frame> sent_;
};

DriveHost::DriveHost(const std::vector<SimulatedDrive>& drives, can::Interface& interface, Time now)
    : interface_(interface), at_(now), described_(drives) {
  for (const SimulatedDrive& described : drives) {
    auto tap = std::make_unique<Tap>(interface);
    auto drive =
        std::make_unique<Drive>(described.definition, described.node, *tap, described.mechanics[0],
                                described.identity, described.further());
    drives_.push_back({std::move(tap), std::move(drive)});
  }
  for (Member& member : drives_) member.drive->powerOn(now);
}

DriveHost::~DriveHost() = default;

void DriveHost::step(Time now) {
  while (const auto received = interface_.receive(now)) {
    if (received->frame.error) continue;
    at_ = std::clamp(received->stamp, at_, std::max(at_, now));
    for (Member& member : drives_) member.drive->receive(received->frame, at_);
    hearEachOther();
  }
  at_ = std::max(at_, now);
  for (Member& member : drives_) {
    if (member.drive->nextEvent() <= at_) member.drive->tick(at_);
  }
  hearEachOther();
  interface_.maintain(now);
}

void DriveHost::hearEachOther() {
  for (int round = 0; round < kRounds; ++round) {
    bool quiet = true;
    for (Member& sender : drives_) {
      for (const can::Frame& frame : sender.tap->takeSent()) {
        quiet = false;
        for (Member& member : drives_) {
          if (&member != &sender) member.drive->receive(frame, at_);
        }
      }
    }
    if (quiet) break;
  }
}

Time DriveHost::nextDeadline() const {
  Time next = interface_.nextDeadline();
  for (const Member& member : drives_) next = std::min(next, member.drive->nextEvent());
  return next;
}

AxisOfDrive DriveHost::find(const std::string& axis) {
  const std::optional<AxisPlace> place = findAxis(described_, axis);
  return place ? AxisOfDrive{drives_[place->drive].drive.get(), place->axis} : AxisOfDrive();
}

}  // namespace cia402::sim
