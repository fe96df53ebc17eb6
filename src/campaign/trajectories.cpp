// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/trajectories.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "campaign/verbs.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

constexpr double kShownAge = 0.03;  // s, of what the driver shows
constexpr double kArrived = 0.01;   // rad or m: how near the driver calls reached by itself

const Verbs<Trajectories> kTrajectoryVerbs{{"move", &Trajectories::move},
                                           {"goal", &Trajectories::goal},
                                           {"path", &Trajectories::path},
                                           {"stop", &Trajectories::stop}};

std::vector<double> rest(std::size_t joints) { return std::vector<double>(joints, 0.0); }

}  // namespace

bool Trajectories::act(const Words& words) { return actBy(kTrajectoryVerbs, *this, words); }

void Trajectories::move(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  const double seconds = toNumber(words.at(2));
  const std::vector<double> goal = reachable(*to, shown(*to), words, 3, seconds);
  send(*to, {{goal, rest(goal.size()), {}, fromSeconds(seconds)}});
}

void Trajectories::goal(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  std::vector<double> goal;
  for (std::size_t i = 3; i < words.size(); ++i) goal.push_back(toNumber(words[i]));
  send(*to, {{goal, rest(goal.size()), {}, toDuration(words.at(2))}});
}

void Trajectories::path(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  const double seconds = toNumber(words.at(4));
  std::vector<double> at = shown(*to);
  Points points;
  for (int i = 1; i <= static_cast<int>(toNumber(words.at(3))); ++i) {
    Words turned = words;
    if (i % 2 == 0) std::reverse(turned.begin() + 5, turned.end());
    at = reachable(*to, at, turned, 5, seconds);
    points.push_back({at, rest(at.size()), {}, fromSeconds(seconds * i)});
  }
  send(*to, std::move(points), toDuration(words.at(2)));
}

void Trajectories::stop(const Words& words) {
  if (const config::GroupConfig* const to = running(words.at(1))) send(*to, {});
}

void Trajectories::stopAll() {
  for (const config::GroupConfig& group : session_.stage.loaded().robot.groups) send(group, {});
}

const config::GroupConfig* Trajectories::running(const std::string& name) const {
  if (!session_.stage.host().running()) return nullptr;
  for (const config::GroupConfig& config : session_.stage.loaded().robot.groups) {
    if (config.name == name) return &config;
  }
  return nullptr;
}

std::size_t Trajectories::axisOf(const std::string& joint) const {
  for (const AxisFacts& facts : session_.stage.axes()) {
    if (facts.config->joint == joint) return facts.index;
  }
  throw std::invalid_argument("no joint " + joint);
}

std::vector<double> Trajectories::shown(const config::GroupConfig& group) const {
  std::vector<double> positions;
  for (const std::string& joint : group.joints) {
    positions.push_back(session_.shown(axisOf(joint)));
  }
  return positions;
}

/// Goals as shares of each joint's range, or as near to that as its limits allow in so many
/// seconds.
std::vector<double> Trajectories::reachable(const config::GroupConfig& group,
                                            const std::vector<double>& from, const Words& words,
                                            std::size_t first, double seconds) const {
  std::vector<double> goal;
  for (std::size_t i = 0; i < group.joints.size(); ++i) {
    const AxisFacts& facts = session_.stage.axes()[axisOf(group.joints[i])];
    const motion::JointLimits& limits = facts.config->limits;
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

/// As the driver shows the axes now, which is as old as its feedback.
std::vector<Trajectories::Goal> Trajectories::goalsOf(const std::vector<std::size_t>& axes,
                                                      const Points& points) const {
  std::vector<Goal> goals;
  for (std::size_t i = 0; i < axes.size() && !points.empty(); ++i) {
    if (i >= points.back().positions.size()) break;
    const AxisTruth& truth = session_.truths[axes[i]];
    goals.push_back({axes[i], truth.position, points.back().positions[i] - session_.shown(axes[i]),
                     std::fabs(truth.velocity) * kShownAge});
  }
  return goals;
}

void Trajectories::send(const config::GroupConfig& group, Points points,
                        std::optional<Duration> start) {
  Sent sent;
  sent.group = group.name;
  for (const std::string& joint : group.joints) sent.axes.push_back(axisOf(joint));
  sent.goals = goalsOf(sent.axes, points);
  sent.base = session_.now() + start.value_or(Duration());
  sent.has_start = start.has_value();
  sent.stop = points.empty();
  if (!points.empty()) sent.last = points.back().time_from_start;
  bus::TrajectoryCommand body;
  body.group = group.name;
  body.joints = group.joints;
  body.points = std::move(points);
  if (start) body.start_time = sent.base;
  const auto reply = [this, sent](const bus::Answer& answer) {
    session_.say("< trajectory of " + sent.group + (answer.success ? ": " : " refused: ") +
                 answer.message);
    if (answer.success) accepted(sent);
  };
  session_.stage.host().post(bus::Command(std::move(body), reply));
}

void Trajectories::accepted(const Sent& sent) {
  const Time now = session_.now();
  session_.stage.look(session_.truths);
  const bool seen = std::all_of(sent.axes.begin(), sent.axes.end(),
                                [&](std::size_t i) { return session_.conditions.quiet(i, now); });
  const std::vector<Goal> goals = seen ? sent.goals : std::vector<Goal>();
  waiting_.erase(sent.group);
  if (sent.has_start && sent.base > now) {
    waiting_[sent.group] = {now, sent.base, goals};
  } else {
    goals_[sent.group] = goals;
  }
  for (std::size_t i : sent.axes) {
    if (sent.stop && follows_[i] != sent.group) continue;  // another group moves it
    follows_[i] = sent.group;
    const Duration stop = session_.stage.axes()[i].stopTime(session_.truths[i].velocity);
    const Time begin = std::max(sent.base, sent.has_start ? sent.base : now);
    const Time end = sent.stop ? now + stop : begin + sent.last + session_.lateFor() + 250ms;
    session_.permits.cut(i, Source::trajectory, end);
    if (!sent.stop) session_.permits.allow(i, Source::trajectory, end);
  }
}

void Trajectories::hear(const std::string& text) {
  for (const config::GroupConfig& group : session_.stage.loaded().robot.groups) {
    if (text != group.name + ": goal reached") continue;
    const auto next = waiting_.find(group.name);
    if (next != waiting_.end() && session_.now() >= next->second.begin) {
      // Where cycles were late the driver's clock is, too: this may be the end of the one before.
      const bool late = session_.late_until > next->second.since;
      goals_[group.name] = late ? std::vector<Goal>() : next->second.goals;
      waiting_.erase(next);
    }
    reached(group);
  }
}

void Trajectories::reached(const config::GroupConfig& group) {
  session_.stage.look(session_.truths);
  for (const Goal& goal : goals_[group.name]) {
    const AxisFacts& facts = session_.stage.axes()[goal.axis];
    const AxisTruth& truth = session_.truths[goal.axis];
    const auto tolerance = group.tolerances.find(facts.config->joint);
    const bool told = tolerance != group.tolerances.end() && tolerance->second.goal > 0.0;
    double missing = truth.position - goal.from - goal.way;
    // The way to the first point is the shorter one, whole turns off.
    const bool turns = facts.config->geometry.type == drive::AxisGeometry::Type::continuous;
    if (turns) missing = std::remainder(missing, kTwoPi);
    const double bound = (told ? tolerance->second.goal : kArrived) + goal.slack +
                         std::fabs(truth.velocity) * kShownAge +
                         2.0 * std::fabs(facts.units_per_count);
    if (std::fabs(missing) <= bound) continue;
    session_.report("untrue_answer", facts.name,
                    group.name + " has reached its goal, is said, and the motor is " +
                        number(missing) + " away from it");
  }
}

}  // namespace cia402::campaign
