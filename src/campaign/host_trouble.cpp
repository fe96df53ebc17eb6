// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/host_trouble.h"

#include <algorithm>

#include "campaign/verbs.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

constexpr Duration kBootTime = 6s;          // of drives that take no notice of the reset, too
constexpr Duration kShutdownTime = 2500ms;  // until a driver that was asked to end is gone

const Verbs<HostTrouble> kHostVerbs{{"stall", &HostTrouble::stall},
                                    {"late", &HostTrouble::late},
                                    {"kill", &HostTrouble::kill},
                                    {"shutdown", &HostTrouble::shutDown}};

}  // namespace

bool HostTrouble::act(const Words& words) { return actBy(kHostVerbs, *this, words); }

void HostTrouble::calm() { session_.stage.host().setLateness({}); }

void HostTrouble::stall(const Words& words) {
  const Duration length = toDuration(words.at(1));
  const Time now = session_.now();
  session_.stage.host().stall(length);
  session_.conditions.stalled += length;
  Conditions::extend(session_.conditions.host_late, now + length + 100ms);
  session_.permits.delay(length, now);
  for (std::size_t i = 0; i < session_.truths.size(); ++i) {
    const AxisFacts& facts = session_.stage.axes()[i];
    if (length <= facts.master_timeout) continue;
    session_.permits.cut(i, now + facts.master_timeout + facts.stopTime(facts.velocity) + 100ms);
  }
}

void HostTrouble::late(const Words& words) {
  const double most = toNumber(words.at(1));
  const Time now = session_.now();
  const Time end = now + toDuration(words.at(2));
  Conditions::extend(session_.conditions.host_late, end + 100ms);
  // What leads to a place waits at each late cycle and starts anew from rest.
  session_.permits.delay(Source::trajectory, end - now, now);
  session_.permits.delay(Source::target, end - now, now);
  for (std::size_t i = 0; i < session_.truths.size(); ++i) session_.permits.hinder(i, end);
  session_.late_until = std::max(session_.late_until, end);
  session_.stage.host().setLateness([this, most, end] {
    const Time time = session_.now();
    if (time >= end) return Duration();
    // Most wake-ups are in time, few are very late.
    const double share = session_.random.uniform();
    const Duration delay = fromSeconds(most * share * share * share * share);
    session_.permits.delay(delay, time);
    return delay;
  });
}

void HostTrouble::kill(const Words& words) {
  if (!session_.stage.host().running()) return;
  const Duration gone = toDuration(words.at(1));
  const Time now = session_.now();
  Conditions& conditions = session_.conditions;
  session_.stage.host().kill();
  calls_.drop();
  conditions.stalled += gone;
  Conditions::extend(conditions.host_late, now + gone + 100ms);
  for (std::size_t i = 0; i < session_.truths.size(); ++i) {
    const bool watched = session_.stage.axes()[i].watches_master;
    session_.breakLink(i, watched ? 1h : gone);
  }
  for (auto& axis : conditions.axes) {
    axis.cut_off = std::min(axis.cut_off, now + gone + 500ms);
    axis.unheard = now + gone;
  }
  session_.later(gone, [this] { start(); });
}

void HostTrouble::shutDown(const Words& words) {
  const Time now = session_.now();
  if (!session_.stage.host().running() || now < ends_at_) return;
  const Duration gone = kShutdownTime + toDuration(words.at(1));
  ends_at_ = now + gone;
  session_.onCall(
      {"shutdown", "all", "", session_.stage.named("all"), now, session_.conditions.stalled});
  session_.stage.host().stop();
  for (std::size_t i = 0; i < session_.truths.size(); ++i) session_.permits.cut(i, now + 2300ms);
  const Time due = now + kShutdownTime;
  session_.later(kShutdownTime, [this, due, stalled = session_.conditions.stalled] {
    // Earlier only where the history ends sooner.
    if (session_.now() < due || !session_.stage.host().running()) return;
    if (session_.conditions.stalled != stalled) return;
    session_.report("late_shutdown", "", "the driver has not ended 2.5 s after it was asked to");
  });
  session_.later(gone, [this] {
    session_.stage.host().kill();
    calls_.drop();
    start();
  });
  Conditions::extend(session_.conditions.ended, now + gone);
}

void HostTrouble::start() {
  if (session_.stage.host().running()) return;
  session_.say("  a new driver starts");
  const Time now = session_.now();
  for (auto& axis : session_.conditions.axes) Conditions::extend(axis.unheard, now + kBootTime);
  // It has to find a drive that moves, and stops it before all else.
  for (std::size_t i = 0; i < session_.truths.size(); ++i) {
    const AxisFacts& facts = session_.stage.axes()[i];
    if (!session_.permits.allowed(i, now)) continue;
    session_.permits.allow(i, Source::stream,
                           now + facts.retaken() + facts.stopTime(facts.velocity));
  }
  session_.stage.host().start();
}

}  // namespace cia402::campaign
