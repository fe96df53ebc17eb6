// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/streams.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "campaign/verbs.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

const Verbs<Streams> kStreamVerbs{{"stream", &Streams::stream},
                                  {"sine", &Streams::sine},
                                  {"nudge", &Streams::nudge},
                                  {"point", &Streams::point},
                                  {"dry", &Streams::dry}};

/// How long a position may take the axis from `shown`.
Duration timeOfWay(const AxisFacts& facts, double value, double shown) {
  const motion::JointLimits& limits = facts.config->limits;
  const double way = std::min(std::fabs(value - shown), 3600.0 * facts.velocity);
  const double range =
      limits.lower && limits.upper ? std::max(*limits.upper - *limits.lower, way) : way;
  return fromSeconds(range / facts.velocity + facts.velocity / facts.acceleration * 3 + 1.0);
}

}  // namespace

bool Streams::act(const Words& words) { return actBy(kStreamVerbs, *this, words); }

void Streams::stream(const Words& words) {
  for (std::size_t i : session_.stage.named(words.at(1))) {
    const double value = toNumber(words.at(2));
    begin(
        i, [value](Duration) { return value; }, toNumber(words.at(3)), toNumber(words.at(4)));
  }
}

void Streams::sine(const Words& words) {
  const double centre = toNumber(words.at(2)), amplitude = toNumber(words.at(3));
  const double turns = kTwoPi / toNumber(words.at(4));
  for (std::size_t i : session_.stage.named(words.at(1))) {
    begin(
        i, [=](Duration time) { return centre + amplitude * std::sin(turns * toSeconds(time)); },
        toNumber(words.at(5)), toNumber(words.at(6)));
  }
}

void Streams::nudge(const Words& words) {
  for (std::size_t i : session_.stage.named(words.at(1))) {
    const double value = session_.shown(i) + toNumber(words.at(2));
    begin(
        i, [value](Duration) { return value; }, toNumber(words.at(3)), toNumber(words.at(4)));
  }
}

void Streams::point(const Words& words) {
  for (std::size_t i : session_.stage.named(words.at(1))) send(i, toNumber(words.at(2)));
}

void Streams::dry(const Words& words) {
  for (std::size_t i : session_.stage.named(words.at(1))) end(i);
}

void Streams::end(std::size_t axis) {
  streams_.erase(std::remove_if(streams_.begin(), streams_.end(),
                                [axis](const Stream& s) { return s.axis == axis; }),
                 streams_.end());
}

void Streams::begin(std::size_t axis, std::function<double(Duration)> value, double seconds,
                    double rate) {
  end(axis);
  const Time now = session_.now();
  streams_.push_back(
      {axis, std::move(value), now, now, now + fromSeconds(seconds), fromSeconds(1.0 / rate)});
}

Time Streams::next() const {
  Time next = kNever;
  for (const Stream& item : streams_) next = std::min(next, item.next);
  return next;
}

void Streams::step() {
  const Time now = session_.now();
  for (Stream& item : streams_) {
    if (item.next > now) continue;
    send(item.axis, item.value(now - item.began));
    item.next += item.period;
  }
  streams_.erase(std::remove_if(streams_.begin(), streams_.end(),
                                [](const Stream& s) { return s.next >= s.end; }),
                 streams_.end());
}

void Streams::send(std::size_t axis, double value) {
  const auto refused = std::make_shared<bool>(false);
  const auto refuse = [this, refused, axis](const bus::Answer& answer) {
    *refused = true;
    session_.say("< set-point of " + session_.stage.axes()[axis].name + ": " + answer.message);
  };
  session_.stage.host().post(bus::Command(bus::SetpointCommand{axis, value}, refuse));
  // A set-point that is taken has no answer: look right after it.
  const auto look = [this, refused, axis, value](Time) {
    if (!*refused) accepted(axis, value);
    return bus::Answer();
  };
  session_.stage.host().post(bus::Command(bus::CallCommand{look}));
}

void Streams::accepted(std::size_t axis, double value) {
  if (session_.truths.empty()) return;
  const AxisFacts& facts = session_.stage.axes()[axis];
  const AxisTruth& truth = session_.truths[axis];
  // What is sent to a bus that is cut off, before anybody can notice, leaves once that is back.
  const Time cut_off = session_.conditions.axes[axis].cut_off;
  if (session_.now() < cut_off) {
    session_.permits.allow(axis, Source::stream, cut_off + facts.stopTime(facts.velocity));
  }
  const drive::ModeSpec* const mode = session_.stage.modeOf(axis, truth.mode);
  if (mode == nullptr || mode->kind == drive::ControlKind::position) {
    const Duration way = timeOfWay(facts, value, session_.shown(axis));
    session_.permits.allow(axis, Source::target, session_.now() + session_.lateFor() + way);
    return;
  }
  double speed = std::max(std::fabs(truth.velocity),
                          mode->kind == drive::ControlKind::velocity ? std::fabs(value) : 0.0);
  speed = std::min(speed, facts.velocity);
  if (mode->kind == drive::ControlKind::torque) speed = facts.velocity;
  // The stream may end while the motor speeds up: with a jerk limit that is to be undone first.
  const auto& limits = facts.config->limits;
  const double undone = limits.jerk ? 2.0 * facts.acceleration / *limits.jerk : 0.0;
  session_.permits.allow(axis, Source::stream,
                         session_.now() + facts.config->command_timeout + 4 * facts.config->cycle +
                             facts.stopTime(speed) + fromSeconds(undone));
}

}  // namespace cia402::campaign
