// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/start_up.h"

#include <utility>

namespace cia402::bus {
namespace {

constexpr std::size_t kMostDeferred = 64;  // calls that come before the drives are started

}  // namespace

bool StartUp::begin(Time now) {
  listener_.start(now);
  if (listening()) cycle_.sayStep("listening for another master");
  return listening();
}

void StartUp::receive(const can::Frame& frame, Time now) {
  const bool was_alone = !listener_.heard();
  if (!listener_.receive(frame, now)) return;
  problem_.assign(listener_.text());
  if (!was_alone || cycle_.shutdown().begun()) return;
  cycle_.sayStep("waiting until there is no other master on the bus");
  tell(events_, Event::Severity::error,
       listener_.text() +
           ". A drive that makes SYNC itself (1005h, bit 30) needs `bus: {sync: external}`; "
           "`bus: {listen: 0}` starts without listening",
       now);
  for (Command& command : takeDeferred()) refuseForOtherMaster(command);
}

bool StartUp::tick(bool bus_lost, Time now) {
  if (bus_lost) listener_.start(now);
  if (now < listener_.deadline()) return false;
  if (listener_.heard()) {
    tell(events_, Event::Severity::info,
         "there is no other master on the bus any more: the drives are started", now);
  }
  listener_.finish();
  problem_.assign("");
  return true;
}

void StartUp::refuseDeferred(const std::string& why) {
  for (Command& command : takeDeferred()) command.refuse("refused: " + why);
}

void StartUp::take(Command command) {
  if (listener_.heard()) return refuseForOtherMaster(command);
  if (!command.streams() && deferred_.size() < kMostDeferred) {
    deferred_.push_back(std::move(command));
  } else {
    command.refuse("refused: the bus is still listened to for another master; try again");
  }
}

std::vector<Command> StartUp::takeDeferred() { return std::exchange(deferred_, {}); }

void StartUp::refuseForOtherMaster(Command& command) const {
  command.refuse("refused: " + listener_.text());
}

}  // namespace cia402::bus
