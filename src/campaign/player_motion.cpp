// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Streams of set-points and trajectories.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "campaign/player.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

constexpr double kShownAge = 0.03;  // s, of what the driver shows
constexpr double kArrived = 0.01;   // rad or m: how near the driver calls reached by itself

}  // namespace

bool Player::actMotion(const Words& words) {
  const std::string& verb = words[0];
  if (verb == "stream") {  // stream A VALUE SECONDS RATE
    for (std::size_t i : stage_.named(words.at(1))) {
      const double value = toNumber(words.at(2));
      stream(
          i, [value](Duration) { return value; }, toNumber(words.at(3)), toNumber(words.at(4)));
    }
  } else if (verb == "sine") {  // sine A CENTRE AMPLITUDE PERIOD SECONDS RATE
    const double centre = toNumber(words.at(2)), amplitude = toNumber(words.at(3));
    const double turns = kTwoPi / toNumber(words.at(4));
    for (std::size_t i : stage_.named(words.at(1))) {
      stream(
          i, [=](Duration time) { return centre + amplitude * std::sin(turns * toSeconds(time)); },
          toNumber(words.at(5)), toNumber(words.at(6)));
    }
  } else if (verb == "nudge") {  // nudge A DISTANCE SECONDS RATE: from where it is shown
    for (std::size_t i : stage_.named(words.at(1))) {
      const double value = shown(i) + toNumber(words.at(2));
      stream(
          i, [value](Duration) { return value; }, toNumber(words.at(3)), toNumber(words.at(4)));
    }
  } else if (verb == "point") {
    for (std::size_t i : stage_.named(words.at(1))) point(i, toNumber(words.at(2)));
  } else if (verb == "dry") {
    for (std::size_t i : stage_.named(words.at(1))) {
      streams_.erase(std::remove_if(streams_.begin(), streams_.end(),
                                    [i](const Stream& s) { return s.axis == i; }),
                     streams_.end());
    }
  } else if (verb == "move" || verb == "goal" || verb == "path" || verb == "stop") {
    const config::GroupConfig* const to = group(words.at(1));
    if (to == nullptr || !stage_.host().running()) return true;  // a smaller robot has it not
    const std::size_t joints = to->joints.size();
    std::vector<double> from;
    for (const std::string& joint : to->joints) from.push_back(shown(axisOf(joint)));
    const std::vector<double> rest(joints, 0.0);
    std::vector<motion::TrajectoryPoint> points;
    Duration start{};
    if (verb == "move") {  // move G SECONDS FRACTION...: within reach
      const double seconds = toNumber(words.at(2));
      points.push_back({reachable(*to, from, words, 3, seconds), rest, {}, fromSeconds(seconds)});
    } else if (verb == "goal") {  // goal G SECONDS POSITION...: whatever it is
      std::vector<double> goal;
      for (std::size_t i = 3; i < words.size(); ++i) goal.push_back(toNumber(words[i]));
      points.push_back(
          {goal, std::vector<double>(goal.size(), 0.0), {}, fromSeconds(toNumber(words.at(2)))});
    } else if (verb == "path") {  // path G START COUNT SECONDS FRACTION...
      start = fromSeconds(toNumber(words.at(2)));
      const double seconds = toNumber(words.at(4));
      for (int i = 1; i <= static_cast<int>(toNumber(words.at(3))); ++i) {
        Words turned = words;
        if (i % 2 == 0) std::reverse(turned.begin() + 5, turned.end());
        from = reachable(*to, from, turned, 5, seconds);
        points.push_back({from, rest, {}, fromSeconds(seconds * i)});
      }
    }
    trajectory(*to, std::move(points), start, verb == "path");
  } else {
    return false;
  }
  return true;
}

double Player::shown(std::size_t axis) {
  return stage_.host().running() ? stage_.host().robot().axes()[axis].state().position : 0.0;
}

const config::GroupConfig* Player::group(const std::string& name) const {
  for (const config::GroupConfig& config : stage_.loaded().robot.groups) {
    if (config.name == name) return &config;
  }
  return nullptr;
}

std::size_t Player::axisOf(const std::string& joint) const {
  for (const AxisFacts& facts : stage_.axes()) {
    if (facts.config->joint == joint) return facts.index;
  }
  throw std::invalid_argument("no joint " + joint);
}

/// Goals as shares of each joint's range, or as near to that as its limits allow in so many
/// seconds.
std::vector<double> Player::reachable(const config::GroupConfig& to,
                                      const std::vector<double>& from, const Words& words,
                                      std::size_t first, double seconds) const {
  std::vector<double> goal;
  for (std::size_t i = 0; i < to.joints.size(); ++i) {
    const AxisFacts& facts = stage_.axes()[axisOf(to.joints[i])];
    const drive::AxisLimits& limits = facts.config->limits;
    const double share = first + i < words.size() ? toNumber(words[first + i]) : 0.5;
    const double wish = limits.lower && limits.upper
                            ? *limits.lower + share * (*limits.upper - *limits.lower)
                            : from[i] + (share - 0.5) * 4.0;
    // A cubic from rest to rest: speed 1.5 d/T, acceleration 6 d/T^2.
    const double reach = 0.95 * std::min(facts.velocity * seconds / 1.5,
                                         facts.acceleration * seconds * seconds / 6.0);
    goal.push_back(from[i] + std::clamp(wish - from[i], -reach, reach));
  }
  return goal;
}

void Player::trajectory(const config::GroupConfig& to, std::vector<motion::TrajectoryPoint> points,
                        Duration start, bool has_start) {
  const Duration last = points.empty() ? Duration() : points.back().time_from_start;
  std::vector<std::size_t> axes;
  for (const std::string& joint : to.joints) axes.push_back(axisOf(joint));
  // As the driver shows it now, which is as old as its feedback.
  std::vector<Goal> goals;
  for (std::size_t i = 0; i < axes.size() && !points.empty(); ++i) {
    if (i >= points.back().positions.size()) break;
    const AxisTruth& truth = truths_[axes[i]];
    goals.push_back({axes[i], truth.position, points.back().positions[i] - shown(axes[i]),
                     std::fabs(truth.velocity) * kShownAge});
  }
  bus::TrajectoryCommand body;
  body.group = to.name;
  body.joints = to.joints;
  const bool stop = points.empty();
  body.points = std::move(points);
  if (has_start) body.start_time = stage_.now() + start;
  const Time base = stage_.now() + (has_start ? start : Duration());
  bus::Command command;
  command.body = std::move(body);
  command.reply = [=](const bus::Answer& answer) {
    say("< trajectory of " + to.name + (answer.success ? ": " : " refused: ") + answer.message);
    if (!answer.success) return;
    const Time now = stage_.now();
    stage_.look(truths_);
    const bool seen = std::all_of(axes.begin(), axes.end(),
                                  [&](std::size_t i) { return conditions_.quiet(i, now); });
    goals_[to.name] = seen ? goals : std::vector<Goal>();
    for (std::size_t i : axes) {
      if (stop && follows_[i] != to.name) continue;  // another group moves it
      follows_[i] = to.name;
      const double speed = truths_[i].velocity;
      const Time end = stop ? now + stage_.axes()[i].stopTime(speed)
                            : std::max(base, has_start ? base : now) + last + lateFor() + 250ms;
      permits_.cut(i, Source::trajectory, end);
      if (!stop) permits_.allow(i, Source::trajectory, end);
    }
  };
  stage_.host().post(std::move(command));
}

void Player::goalReached(const config::GroupConfig& to) {
  stage_.look(truths_);
  for (const Goal& goal : goals_[to.name]) {
    const AxisFacts& facts = stage_.axes()[goal.axis];
    const AxisTruth& truth = truths_[goal.axis];
    const auto tolerance = to.tolerances.find(facts.config->joint);
    const bool told = tolerance != to.tolerances.end() && tolerance->second.goal > 0.0;
    double missing = truth.position - goal.from - goal.way;
    // The way to the first point is the shorter one, whole turns off.
    const bool turns = facts.config->geometry.type == drive::AxisGeometry::Type::continuous;
    if (turns) missing = std::remainder(missing, kTwoPi);
    const double bound = (told ? tolerance->second.goal : kArrived) + goal.slack +
                         std::fabs(truth.velocity) * kShownAge +
                         2.0 * std::fabs(facts.units_per_count);
    if (std::fabs(missing) <= bound) continue;
    report("untrue_answer", facts.name,
           to.name + " has reached its goal, is said, and the motor is " + number(missing) +
               " away from it");
  }
}

void Player::stream(std::size_t axis, std::function<double(Duration)> value, double seconds,
                    double rate) {
  streams_.erase(std::remove_if(streams_.begin(), streams_.end(),
                                [axis](const Stream& s) { return s.axis == axis; }),
                 streams_.end());
  const Time now = stage_.now();
  streams_.push_back(
      {axis, std::move(value), now, now, now + fromSeconds(seconds), fromSeconds(1.0 / rate)});
}

void Player::stepStreams() {
  const Time now = stage_.now();
  for (Stream& item : streams_) {
    if (item.next > now) continue;
    point(item.axis, item.value(now - item.began));
    item.next += item.period;
  }
  streams_.erase(std::remove_if(streams_.begin(), streams_.end(),
                                [](const Stream& s) { return s.next >= s.end; }),
                 streams_.end());
}

void Player::point(std::size_t axis, double value) {
  const auto refused = std::make_shared<bool>(false);
  bus::Command command;
  command.body = bus::SetpointCommand{axis, value};
  command.reply = [this, refused, axis](const bus::Answer& answer) {
    *refused = true;
    say("< set-point of " + stage_.axes()[axis].name + ": " + answer.message);
  };
  stage_.host().post(std::move(command));
  // A set-point that is taken has no answer: look right after it.
  bus::Command look;
  look.body = bus::CallCommand{[this, refused, axis, value](Time) {
    if (!*refused) accepted(axis, value);
    return bus::Answer();
  }};
  stage_.host().post(std::move(look));
}

void Player::accepted(std::size_t axis, double value) {
  if (truths_.empty()) return;
  const AxisFacts& facts = stage_.axes()[axis];
  const drive::DriveProfile& profile = *facts.config->profile;
  const Time now = stage_.now();
  const auto mode =
      std::find_if(profile.modes.begin(), profile.modes.end(),
                   [&](const drive::ModeSpec& m) { return m.value == truths_[axis].mode; });
  const bool position = mode == profile.modes.end() || mode->kind == drive::ControlKind::position;
  if (position) {
    const drive::AxisLimits& limits = facts.config->limits;
    const double way = std::min(std::fabs(value - shown(axis)), 3600.0 * facts.velocity);
    const double range =
        limits.lower && limits.upper ? std::max(*limits.upper - *limits.lower, way) : way;
    permits_.allow(
        axis, Source::target,
        now + lateFor() +
            fromSeconds(range / facts.velocity + facts.velocity / facts.acceleration * 3 + 1.0));
    return;
  }
  double speed = std::max(std::fabs(truths_[axis].velocity),
                          mode->kind == drive::ControlKind::velocity ? std::fabs(value) : 0.0);
  speed = std::min(speed, facts.velocity);
  if (mode->kind == drive::ControlKind::torque) speed = facts.velocity;
  permits_.allow(
      axis, Source::stream,
      now + facts.config->command_timeout + 4 * facts.config->sync_period + facts.stopTime(speed));
}

}  // namespace cia402::campaign
