// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SYNC of other devices: followed where that is configured, told of where it is not.
#include <cstdio>

#include "cia402_driver/bus/robot.h"

namespace cia402::bus {
namespace {

using State = canopen::SyncConsumer::State;

constexpr Duration kSyncNewsInterval = std::chrono::milliseconds(100);
constexpr Duration kForeignHeard = std::chrono::seconds(1);  // one within this is a second producer
constexpr unsigned kForeignLooks = 3;  // in a row that found one: no stray frame, but a pace
constexpr Duration kPatience = std::chrono::seconds(1);  // with the first SYNC, before it is told
constexpr Duration kLasting = std::chrono::seconds(1);   // trouble that is away so long is over
constexpr int kMeasuredDigits = 3;
constexpr Duration kLateAfter = std::chrono::milliseconds(50);  // an EMCY may come late itself

std::string milliseconds(Duration duration, int digits = 6) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g ms", digits, 1e3 * toSeconds(duration));
  return text;
}

}  // namespace

void Robot::onForeignSync(const can::Frame& frame, Time stamp, Time now) {
  if (!started_) return;
  if (config_.bus.external_sync) {
    followSync(frame, stamp, now);
  } else {
    noteSecondProducer(now);
  }
}

void Robot::followSync(const can::Frame& frame, Time stamp, Time now) {
  const Duration period = config_.bus.sync_period;
  const canopen::SyncConsumer::Observation seen = external_sync_.receive(frame, stamp);
  const Duration deviation = seen.deviation < Duration::zero() ? -seen.deviation : seen.deviation;
  statistics_.syncSent(seen.regular ? deviation : Duration::zero());
  statistics_.cyclesSkipped(seen.missed);
  master_.syncPassed(now);
  const bool overtaken = next_cycle_ != kNever;
  if (overtaken) statistics_.cyclesSkipped(1);
  next_cycle_ = overtaken ? now : stamp + period / 2;
  next_sync_ = external_sync_.deadline();
}

void Robot::lackSync(Time now) {
  if (external_sync_.tick(now)) {
    const int periods = canopen::SyncConsumer::kLostAfter;
    stopForSync("stopped: no SYNC (COB-ID 0x080) came from the other device for " +
                    std::to_string(periods) + " periods (" +
                    milliseconds(periods * config_.bus.sync_period) +
                    "); set-points do not reach the drives without it. Check the device that " +
                    "produces SYNC, then enable again",
                now);
  }
  master_.syncPassed(now);
  next_cycle_ = now;
  next_sync_ = now + config_.bus.sync_period;
}

void Robot::stopForSync(const std::string& why, Time now) {
  stopMotion(why);
  for (drive::Axis& axis : axes_) axis.stopBySdo(why, now);
}

void Robot::noteLateness(Duration late, Time now) {
  lateness_ = late;
  late_since_ = now - late;
  late_until_ = now + kLateAfter;
}

std::string Robot::ownLateness(Time stamp) const {
  if (stamp < late_since_ || stamp > late_until_ || lateness_ == Duration::zero()) return {};
  return "this program sent SYNC " + milliseconds(lateness_, kMeasuredDigits) +
         " late: the computer did not let it run in time (see `real time` in the diagnostics)";
}

void Robot::noteSecondProducer(Time now) {
  ++foreign_syncs_;
  last_foreign_sync_ = now;
}

Robot::SyncTrouble Robot::syncTrouble() const {
  if (!config_.bus.external_sync) {
    const bool heard = foreign_syncs_ != 0 && now_ <= last_foreign_sync_ + kForeignHeard;
    return heard ? SyncTrouble::second_producer : SyncTrouble::none;
  }
  if (external_sync_.state() != State::running) return SyncTrouble::absent;
  if (external_sync_.formWrong()) return SyncTrouble::wrong_form;
  return external_sync_.periodWrong() ? SyncTrouble::wrong_period : SyncTrouble::none;
}

std::string Robot::syncText(SyncTrouble trouble) const {
  const std::string expected = milliseconds(config_.bus.sync_period);
  switch (trouble) {
    case SyncTrouble::none:
      break;
    case SyncTrouble::second_producer:
      return "another device produces SYNC (COB-ID 0x080), too: drives would move at both paces; "
             "look for 1005h with bit 30, or let the other one lead with `bus: {sync: external}`";
    case SyncTrouble::absent:
      return "no SYNC (COB-ID 0x080) comes; another device must send it every " + expected +
             ", as `bus: {sync: external}` says";
    case SyncTrouble::wrong_form:
      return std::string("SYNC comes ") +
             (config_.bus.sync_counter == 0 ? "with a counter, write its overflow value as"
                                            : "without the counter of") +
             " `bus: {sync_counter}`";
    case SyncTrouble::wrong_period:
      return "SYNC comes every " + milliseconds(external_sync_.period(), kMeasuredDigits) +
             ", not every " + expected + " as `bus: {sync_period}` says: correct one of them";
  }
  return {};
}

std::string Robot::syncProblem() const {
  const SyncTrouble trouble = syncTrouble();
  if (trouble != SyncTrouble::none) return syncText(trouble);
  if (sync_trouble_ == SyncTrouble::none) return {};
  return sync_problem_.str() + " (a moment ago; wait until SYNC has been well for a second)";
}

/// Drives that get SYNC at two paces do not move as they are told to.
void Robot::watchSecondProducer(Time now) {
  const bool heard = foreign_syncs_ != foreign_seen_;
  foreign_seen_ = foreign_syncs_;
  foreign_looks_ = heard ? foreign_looks_ + 1 : 0;
  if (foreign_looks_ != kForeignLooks) return;
  stopForSync("stopped: " + syncText(SyncTrouble::second_producer), now);
}

void Robot::watchSync(Time now) {
  if (now < sync_checked_ + kSyncNewsInterval) return;
  const bool just_started = sync_checked_ == Time();
  sync_checked_ = just_started ? now + kPatience : now;
  if (just_started) return;
  if (!config_.bus.external_sync) {
    if (foreign_syncs_ == 0) return;
    watchSecondProducer(now);
  }
  const SyncTrouble trouble = syncTrouble();
  if (trouble != sync_seen_) sync_seen_since_ = now;
  sync_seen_ = trouble;
  const bool is_new = trouble != sync_trouble_;
  // At the edge of what is tolerated trouble comes and goes at every look: told once.
  const bool lasts = now >= sync_seen_since_ + kLasting;
  if (is_new && sync_trouble_ != SyncTrouble::none && !lasts) return;
  sync_trouble_ = trouble;
  sync_problem_.assign(syncText(trouble));
  if (!is_new) return;
  if (trouble == SyncTrouble::none) {
    tell(Event::Severity::info, "SYNC is as it should be", now);
    return;
  }
  tell(Event::Severity::error, sync_problem_.view(), now);
  // Where it is lost, that has happened already.
  const bool comes = external_sync_.state() == State::running;
  if (comes && config_.bus.external_sync) stopForSync("stopped: " + sync_problem_.str(), now);
}

}  // namespace cia402::bus
