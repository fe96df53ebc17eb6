// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/permits.h"

#include <algorithm>
#include <cmath>

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStandingLong = 400ms;  // longer than any brake of a robot takes to open

}  // namespace

Permits::Permits(const Stage& stage) : stage_(stage), axes_(stage.axes().size()) {}

void Permits::allow(std::size_t axis, Source source, Time until) {
  Time& present = at(axis, source);
  present = std::max(present, until);
  axes_[axis].given[static_cast<std::size_t>(source)] = stage_.now();
  if (source == Source::target) hinder(axis, stage_.now());
  if (source == Source::homing) axes_[axis].homing_called = stage_.now();
}

void Permits::cut(std::size_t axis, Source source, Time until) {
  at(axis, source) = std::min(at(axis, source), until);
}

void Permits::cut(std::size_t axis, Time until) {
  for (Time& time : axes_[axis].until) time = std::min(time, until);
}

void Permits::prolong(std::size_t axis, Source source, Time until) {
  Time& present = at(axis, source);
  if (present > stage_.now()) present = std::max(present, until);
}

void Permits::end(std::size_t axis, Time called, Time now) {
  for (const Source source : {Source::stream, Source::target, Source::trajectory}) {
    // What came in the cycle in which the call ended is commanded after it.
    const bool after =
        axes_[axis].given[static_cast<std::size_t>(source)] + stage_.axes()[axis].config->cycle >=
        now;
    if (!after) cut(axis, source, now);
  }
  if (axes_[axis].homing_called <= called) cut(axis, Source::homing, now);
}

void Permits::delay(Duration duration, Time now) {
  for (const Source source : {Source::stream, Source::target, Source::trajectory, Source::homing}) {
    delay(source, duration, now);
  }
  for (Axis& axis : axes_) axis.moved += duration;
}

void Permits::delay(Source source, Duration duration, Time now) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Time& time = at(i, source);
    if (time > now && time != kNever) time += duration;
  }
}

void Permits::hinder(std::size_t axis, Time until) {
  axes_[axis].moved = std::max(axes_[axis].moved, until);
}

void Permits::stretch(std::size_t axis, Duration duration, Time until) {
  axes_[axis].stretched = duration;
  axes_[axis].stretched_until = std::max(axes_[axis].stretched_until, until);
}

Time Permits::given(std::size_t axis) const {
  const auto& given = axes_[axis].given;
  return *std::max_element(given.begin(), given.end());
}

Time Permits::until(std::size_t axis) const {
  const Axis& state = axes_[axis];
  const Time latest = *std::max_element(state.until.begin(), state.until.end());
  if (latest == kNever || stage_.now() >= state.stretched_until) return latest;
  return latest + state.stretched;
}

void Permits::watch(const std::vector<AxisTruth>& truths, Time now) {
  for (std::size_t i = 0; i < axes_.size(); ++i) watch(axes_[i], stage_.axes()[i], truths[i], now);
}

void Permits::watch(Axis& axis, const AxisFacts& facts, const AxisTruth& truth, Time now) {
  Time& target = axis.until[static_cast<std::size_t>(Source::target)];
  Time& homing = axis.until[static_cast<std::size_t>(Source::homing)];
  if (std::fabs(truth.velocity) > facts.creep()) axis.moved = std::max(axis.moved, now);
  if (now - axis.moved > kStandingLong) target = std::min(target, now);
  // Without power, or in a fault, what was commanded before is void; a homing enables first.
  const bool lost_power = axis.power && !truth.power;
  const bool got_fault = !axis.faulted && truth.faulted();
  if (lost_power || got_fault) {
    const Time end = now + (truth.power ? facts.stopTime(truth.velocity) : Duration(0));
    for (Time& time : axis.until) {
      if (&time != &homing) time = std::min(time, end);
    }
  }
  axis.power = truth.power;
  axis.faulted = truth.faulted();
}

}  // namespace cia402::campaign
