// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/sync_supervisor.h"

#include <algorithm>

#include "common/text.h"

namespace cia402::bus {
namespace {

using State = canopen::SyncConsumer::State;

constexpr Duration kForeignHeard = std::chrono::seconds(1);  // one within this is a second producer
constexpr unsigned kForeignLooks = 3;  // in a row that found one: no stray frame, but a pace
constexpr Duration kPatience = std::chrono::seconds(1);  // with the first SYNC, before it is told
constexpr Duration kLasting = std::chrono::seconds(1);   // trouble that is away so long is over
constexpr int kMeasuredDigits = 3;
constexpr Duration kLateAfter = std::chrono::milliseconds(50);  // an EMCY may come late itself

}  // namespace

void SyncSupervisor::begin(Time now) {
  next_sync_ = now + bus_.sync_period;
  held_ = master_.config().sync_counter != 0;
}

/// A counter in SYNC is an error to drives that are not yet configured for it (EMCY 0x8240): the
/// first SYNC waits until a drive is ready or none is booting.
bool SyncSupervisor::mayProduce() {
  if (!held_) return true;
  const auto& nodes = master_.nodes();
  const auto booting = [](const canopen::Node& node) {
    return node.health() == fieldbus::Health::booting;
  };
  const auto started = [](const canopen::Node& node) { return node.started(); };
  held_ = std::none_of(nodes.begin(), nodes.end(), started) &&
          std::any_of(nodes.begin(), nodes.end(), booting);
  return !held_;
}

void SyncSupervisor::produce(Time now) {
  if (mayProduce()) master_.sendSync(now);
  const Duration late = now - next_sync_;
  statistics_.syncSent(late);
  const Duration period = bus_.sync_period;
  if (late >= period / 4) {
    lateness_ = late;
    late_since_ = now - late;
    late_until_ = now + kLateAfter;
  }
  const bool overtaken = next_cycle_ != kNever;
  if (overtaken) statistics_.cyclesSkipped(1);
  // Under load every SYNC might overtake the cycle before: then none would ever run.
  next_cycle_ = overtaken ? now : now + period / 2;
  next_sync_ += period;
  if (next_sync_ <= now) {  // never a burst of SYNCs: what was missed is left out, and counted
    const auto skipped = (now - next_sync_) / period + 1;
    next_sync_ += skipped * period;
    statistics_.cyclesSkipped(static_cast<std::uint64_t>(skipped));
  }
}

void SyncSupervisor::onForeignSync(const can::Frame& frame, Time stamp, Time now) {
  if (bus_.external_sync) return follow(frame, stamp, now);
  ++foreign_;
  last_foreign_ = now;
}

/// SYNC of another device leads the cycle.
void SyncSupervisor::follow(const can::Frame& frame, Time stamp, Time now) {
  const Duration period = bus_.sync_period;
  const canopen::SyncConsumer::Observation seen = external_.receive(frame, stamp);
  const Duration deviation = seen.deviation < Duration::zero() ? -seen.deviation : seen.deviation;
  statistics_.syncSent(seen.regular ? deviation : Duration::zero());
  statistics_.cyclesSkipped(seen.missed);
  master_.syncPassed(now);
  const bool overtaken = next_cycle_ != kNever;
  if (overtaken) statistics_.cyclesSkipped(1);
  next_cycle_ = overtaken ? now : stamp + period / 2;
  next_sync_ = external_.deadline();
}

/// That SYNC is due and does not come: the cycle goes on without it, motion does not.
void SyncSupervisor::lack(Time now) {
  if (external_.tick(now)) {
    const int periods = canopen::SyncConsumer::kLostAfter;
    cycle_.stopBesideCycle(
        "stopped: no SYNC (COB-ID 0x080) came from the other device for " +
        std::to_string(periods) + " periods (" + millisecondsText(periods * bus_.sync_period) +
        "); set-points do not reach the drives without it. Check the device that " +
        "produces SYNC, then enable again");
  }
  master_.syncPassed(now);
  next_cycle_ = now;
  next_sync_ = now + bus_.sync_period;
}

std::string SyncSupervisor::ownLateness(Time stamp) const {
  if (stamp < late_since_ || stamp > late_until_ || lateness_ == Duration::zero()) return {};
  return "this program sent SYNC " + millisecondsText(lateness_, kMeasuredDigits) +
         " late: the computer did not let it run in time (see `real time` in the diagnostics)";
}

SyncSupervisor::Trouble SyncSupervisor::trouble() const {
  if (!bus_.external_sync) {
    const bool heard = foreign_ != 0 && cycle_.now() <= last_foreign_ + kForeignHeard;
    return heard ? Trouble::second_producer : Trouble::none;
  }
  if (external_.state() != State::running) return Trouble::absent;
  if (external_.formWrong()) return Trouble::wrong_form;
  return external_.periodWrong() ? Trouble::wrong_period : Trouble::none;
}

std::string SyncSupervisor::textOf(Trouble trouble) const {
  const std::string expected = millisecondsText(bus_.sync_period);
  switch (trouble) {
    case Trouble::none:
      break;
    case Trouble::second_producer:
      return "another device produces SYNC (COB-ID 0x080), too: drives would move at both paces; "
             "look for 1005h with bit 30, or let the other one lead with `bus: {sync: external}`";
    case Trouble::absent:
      return "no SYNC (COB-ID 0x080) comes; another device must send it every " + expected +
             ", as `bus: {sync: external}` says";
    case Trouble::wrong_form:
      return std::string("SYNC comes ") +
             (bus_.sync_counter == 0 ? "with a counter, write its overflow value as"
                                     : "without the counter of") +
             " `bus: {sync_counter}`";
    case Trouble::wrong_period:
      return "SYNC comes every " + millisecondsText(external_.period(), kMeasuredDigits) +
             ", not every " + expected + " as `bus: {sync_period}` says: correct one of them";
  }
  return {};
}

std::string SyncSupervisor::enableProblem() const {
  const Trouble now = trouble();
  if (now != Trouble::none) return textOf(now);
  if (told_ == Trouble::none) return {};
  return problem_.str() + " (a moment ago; wait until SYNC has been well for a second)";
}

/// Drives that get SYNC at two paces do not move as they are told to.
void SyncSupervisor::watchSecondProducer() {
  const bool heard = foreign_ != foreign_seen_;
  foreign_seen_ = foreign_;
  foreign_looks_ = heard ? foreign_looks_ + 1 : 0;
  if (foreign_looks_ != kForeignLooks) return;
  cycle_.stopBesideCycle("stopped: " + textOf(Trouble::second_producer));
}

void SyncSupervisor::look(Time now) {
  const bool first = looked_ == Time();
  looked_ = first ? now + kPatience : now;
  if (first) return;
  if (!bus_.external_sync) {
    if (foreign_ == 0) return;
    watchSecondProducer();
  }
  const Trouble found = trouble();
  if (found != seen_) seen_since_ = now;
  seen_ = found;
  // At the edge of what is tolerated trouble comes and goes at every look: told once.
  const bool lasts = now >= seen_since_ + kLasting;
  if (found != told_ && told_ != Trouble::none && !lasts) return;
  const bool is_new = found != told_;
  told_ = found;
  problem_.assign(textOf(found));
  if (is_new) tellTrouble(found, now);
}

void SyncSupervisor::tellTrouble(Trouble trouble, Time now) {
  if (trouble == Trouble::none) {
    return tell(events_, Event::Severity::info, "SYNC is as it should be", now);
  }
  tell(events_, Event::Severity::error, problem_.view(), now);
  // Where it is lost, that has happened already.
  const bool comes = external_.state() == State::running;
  if (comes && bus_.external_sync) cycle_.stopBesideCycle("stopped: " + problem_.str());
}

}  // namespace cia402::bus
