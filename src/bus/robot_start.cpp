// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// From the first look at the bus to the first frame that is sent.
#include "cia402_driver/bus/robot.h"

namespace cia402::bus {
namespace {

constexpr std::size_t kMostDeferred = 64;  // calls that come before the drives are started

}  // namespace

void Robot::start(Time now) {
  if (started_) return;
  started_ = true;
  now_ = now;
  listener_.start(now);
  next_cycle_ = listener_.deadline();
  if (listener_.listening()) {
    sayStep("listening for another master");
  } else {
    beginSending(now);
  }
}

/// Two masters would command the same drives: as long as there is another one nothing is sent.
void Robot::listenTo(const can::Frame& frame, Time now) {
  const bool was_alone = !listener_.heard();
  const bool is_new = listener_.receive(frame, now);
  next_cycle_ = listener_.deadline();
  if (!is_new) return;
  sync_problem_.assign(listener_.text());
  if (!was_alone) return;
  sayStep("waiting until there is no other master on the bus");
  tell(Event::Severity::error,
       listener_.text() +
           ". A drive that makes SYNC itself (1005h, bit 30) needs `bus: {sync: external}`; "
           "`bus: {listen: 0}` starts without listening",
       now);
  for (Command& command : std::exchange(deferred_, {})) refuseForOtherMaster(command.reply);
}

void Robot::stepListening(Time now) {
  if (!bus_lost_.empty()) listener_.start(now);  // nothing can be heard
  next_cycle_ = listener_.deadline();
  if (now < next_cycle_) return;
  if (listener_.heard()) {
    tell(Event::Severity::info,
         "there is no other master on the bus any more: the drives are started", now);
  }
  listener_.finish();
  next_cycle_ = kNever;
  sync_problem_.assign("");
  beginSending(now);
  for (Command& command : std::exchange(deferred_, {})) execute(std::move(command), now);
}

void Robot::beginSending(Time now) {
  sayStep("");
  lss_starting_ = beginLss();
  if (!lss_starting_) begin(now);
}

void Robot::begin(Time now) {
  next_sync_ = now + config_.bus.sync_period;
  sync_held_ = master_.config().sync_counter != 0;
  master_.start(now);
}

/// Calls wait for the end of the short listening, as they would for the drives to boot; set-points
/// do not.
void Robot::executeLater(Command command) {
  if (listener_.heard()) return refuseForOtherMaster(command.reply);
  const bool waits = !std::holds_alternative<SetpointCommand>(command.body) &&
                     !std::holds_alternative<TrajectoryCommand>(command.body);
  if (waits && deferred_.size() < kMostDeferred) {
    deferred_.push_back(std::move(command));
  } else {
    refuse(command.reply, "refused: the bus is still listened to for another master; try again");
  }
}

void Robot::refuseForOtherMaster(const Reply& reply) const {
  refuse(reply, "refused: " + listener_.text());
}

void Robot::abandonStart(const std::string& why) {
  listener_.finish();
  for (Command& command : std::exchange(deferred_, {})) refuse(command.reply, "refused: " + why);
}

void Robot::sayStep(const std::string& step) {
  for (AxisNews& news : news_) news.words.say(&AxisWords::step, step);
}

}  // namespace cia402::bus
