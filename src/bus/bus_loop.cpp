// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_loop.h"

#include <algorithm>
#include <utility>

namespace cia402::bus {
namespace {

constexpr int kFramesPerRound = 256;  // then SYNC may be due again
// A flood that comes faster than it is read must not keep the network from its cycle: so much is
// more than the kernel holds for a socket.
constexpr int kRoundsBehind = 16;

}  // namespace

BusLoop::BusLoop(config::RobotConfig robot, canopen::MasterConfig master, can::Interface& interface,
                 EventSink& events)
    : interface_(interface),
      meter_(interface, robot.bus.bitrate),
      recorder_(robot, meter_),
      network_(std::move(robot), std::move(master), recorder_, events),
      watch_(events) {
  recorder_.watch(network_);
}

void BusLoop::step(Time now) {
  if (const auto unseen = watch_.update(interface_, network_, now)) {
    recorder_.onInterface(*unseen, now);
  }
  recorder_.onInterface(interface_.state(), now);
  network_.produceSync(now);
  if (takeIn(now) || ++rounds_behind_ == kRoundsBehind) {
    rounds_behind_ = 0;
    network_.tick(now);
  }
  interface_.maintain(now);
  meter_.update(now);
  recorder_.observe();
}

Time BusLoop::nextDeadline() const {
  if (more_waits_) return Time::min();
  return std::min(network_.nextDeadline(), interface_.nextDeadline());
}

/// @return true if nothing is left that came before `now`.
bool BusLoop::takeIn(Time now) {
  bool caught_up = false;
  for (int i = 0; i < kFramesPerRound; ++i) {
    const auto received = interface_.receive(now);
    more_waits_ = received.has_value();
    if (!more_waits_) return true;
    meter_.count(received->frame);
    recorder_.received(received->frame, received->stamp);
    network_.receive(received->frame, received->stamp, now);
    caught_up = received->stamp > now;
  }
  return caught_up;
}

}  // namespace cia402::bus
