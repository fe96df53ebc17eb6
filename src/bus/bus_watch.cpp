// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/bus_watch.h"

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

void BusWatch::update(const can::Interface& interface, Robot& robot, Time now) {
  if (!known_ || interface.state() != state_) onChange(interface, robot, now);
  if (now >= limit_.deadline()) {
    while (const auto summary = limit_.due(now)) {
      tell(Event::Severity::warning,
           robot.config().bus.interface + " became " +
               can::toString(static_cast<can::BusState>(summary->kind)) + " " +
               std::to_string(summary->count) + " times in the last 5 s, now it is " +
               can::toString(state_),
           now);
    }
  }
  if (state_ == can::BusState::error_active || now < refreshed_ + kRefresh) return;
  refreshed_ = now;
  text_.assign(interface.describe());
  const std::string remedy = interface.recovery();
  if (remedy_ == remedy) return;
  remedy_.assign(remedy);
  if (!remedy.empty()) tell(Event::Severity::warning, remedy, now);
}

void BusWatch::onChange(const can::Interface& interface, Robot& robot, Time now) {
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
      robot.busLost(robot.config().bus.interface + " is " + can::toString(state_), now);
  } else if (!robot.started()) {
    robot.start(now);
  } else if (was_lost) {
    robot.busBack(verdict != RepeatLimiter::Verdict::hold, now);
  }
}

void BusWatch::tell(Event::Severity severity, const std::string& text, Time now) {
  Event event;
  event.severity = severity;
  event.stamp = now;
  event.text.assign(text);
  events_.onEvent(event);
}

}  // namespace cia402::bus
