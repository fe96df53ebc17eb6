// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_watch.h"

namespace cia402::bus {
namespace {

constexpr Duration kRefresh = std::chrono::milliseconds(200);

/// No frame leaves.
bool lost(can::BusState state) {
  return state == can::BusState::missing || state == can::BusState::down ||
         state == can::BusState::bus_off;
}

Event::Severity severityOf(can::BusState state) {
  if (lost(state)) return Event::Severity::error;
  return state == can::BusState::error_active ? Event::Severity::info : Event::Severity::warning;
}

}  // namespace

std::optional<can::BusState> BusWatch::update(const can::Interface& interface, Network& network,
                                              Time now) {
  const auto through = unseenLoss(interface);
  if (through) onUnseenLoss(*through, interface, network, now);
  if (!known_ || interface.state() != state_) onChange(interface, network, now);
  if (now >= limit_.deadline()) {
    while (const auto summary = limit_.due(now)) {
      tell(Event::Severity::warning,
           network.config().bus.interface + " became " +
               can::toString(static_cast<can::BusState>(summary->kind)) + " " +
               std::to_string(summary->count) + " times in the last 5 s, now it is " +
               can::toString(state_),
           now);
    }
  }
  if (state_ == can::BusState::error_active || now < refreshed_ + kRefresh) return through;
  refreshed_ = now;
  text_.assign(interface.describe());
  const std::string remedy = interface.recovery();
  if (remedy_ == remedy) return through;
  remedy_.assign(remedy);
  if (!remedy.empty()) tell(Event::Severity::warning, remedy, now);
  return through;
}

std::optional<can::BusState> BusWatch::unseenLoss(const can::Interface& interface) {
  const can::BusCounters& counters = interface.counters();
  const bool went = counters.interface_losses != interface_losses_;
  const bool off = counters.bus_off_events != bus_offs_;
  interface_losses_ = counters.interface_losses;
  bus_offs_ = counters.bus_off_events;
  // A loss that is still there, or was there at the last look, is seen by the state.
  if (!known_ || lost(state_) || lost(interface.state())) return std::nullopt;
  if (went) return can::BusState::down;
  if (off) return can::BusState::bus_off;
  return std::nullopt;
}

/// The set-points of the time in between reached nobody: motion must not go on as if they had.
void BusWatch::onUnseenLoss(can::BusState through, const can::Interface& interface,
                            Network& network, Time now) {
  const std::string what =
      network.config().bus.interface + " was " + can::toString(through) + " for a moment";
  const auto verdict = limit_.take(static_cast<std::uint32_t>(through), now);
  const bool is_news = verdict != RepeatLimiter::Verdict::hold;
  if (is_news) {
    tell(severityOf(through),
         what +
             (through == can::BusState::bus_off
                  ? ": check wiring, termination and bit rate"
                  : ": look who takes it down, or whether its adapter was unplugged") +
             "; now: " + interface.describe(),
         now);
  }
  network.busLost(what, now);
  network.busBack(is_news, now);
}

void BusWatch::onChange(const can::Interface& interface, Network& network, Time now) {
  const bool was_lost = !known_ || lost(state_);
  known_ = true;
  state_ = interface.state();
  refreshed_ = now;
  text_.assign(interface.describe());
  if (state_ == can::BusState::error_active) remedy_.assign("");
  const auto verdict = limit_.take(static_cast<std::uint32_t>(state_), now);
  if (verdict != RepeatLimiter::Verdict::hold) tell(severityOf(state_), text_.str(), now);
  if (lost(state_)) {
    if (!was_lost)
      network.busLost(network.config().bus.interface + " is " + can::toString(state_), now);
  } else if (!network.started()) {
    network.start(now);
  } else if (was_lost) {
    network.busBack(verdict != RepeatLimiter::Verdict::hold, now);
  }
}

void BusWatch::tell(Event::Severity severity, const std::string& text, Time now) {
  bus::tell(events_, severity, text, now);
}

}  // namespace cia402::bus
