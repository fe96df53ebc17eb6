// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/trajectories.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "campaign/verbs.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

constexpr double kShownAge = 0.03;     // s, of what the driver shows
constexpr Duration kShownTime = 30ms;  // likewise
// After a stall the time of trajectories goes on from rest, as the joints do.
constexpr Duration kUpToSpeed = 500ms;
constexpr Duration kRampEnds = 150ms;  // as in AxisFacts::stopTime
constexpr double kRounded = 1e-6;      // s, of what the driver tells in digits
constexpr double kArrived = 0.01;      // rad or m: how near the driver calls reached by itself

const Verbs<Trajectories> kTrajectoryVerbs{
    {"move", &Trajectories::move}, {"part", &Trajectories::part},
    {"goal", &Trajectories::goal}, {"path", &Trajectories::path},
    {"stop", &Trajectories::stop}, {"cancel", &Trajectories::cancel}};

std::vector<double> rest(std::size_t joints) { return std::vector<double>(joints, 0.0); }

}  // namespace

bool Trajectories::act(const Words& words) { return actBy(kTrajectoryVerbs, *this, words); }

void Trajectories::move(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to != nullptr) moveThere(*to, jointsOf(*to), words, 2);
}

void Trajectories::part(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  const Joints joints = among(jointsOf(*to), words.at(2));
  if (!joints.empty()) moveThere(*to, joints, words, 3);
}

/// @param seconds where among the words; what the joints are to go to follows
void Trajectories::moveThere(const config::GroupConfig& group, const Joints& joints,
                             const Words& words, std::size_t seconds) {
  const double length = toNumber(words.at(seconds));
  const std::vector<double> goal = reachable(joints, shown(joints), words, seconds + 1, length);
  send(group, joints, {{goal, rest(goal.size()), {}, fromSeconds(length)}});
}

void Trajectories::goal(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  std::vector<double> goal;
  for (std::size_t i = 3; i < words.size(); ++i) goal.push_back(toNumber(words[i]));
  send(*to, jointsOf(*to), {{goal, rest(goal.size()), {}, toDuration(words.at(2))}});
}

void Trajectories::path(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  const double seconds = toNumber(words.at(4));
  const Joints joints = jointsOf(*to);
  std::vector<double> at = shown(joints);
  Points points;
  for (int i = 1; i <= static_cast<int>(toNumber(words.at(3))); ++i) {
    Words turned = words;
    if (i % 2 == 0) std::reverse(turned.begin() + 5, turned.end());
    at = reachable(joints, at, turned, 5, seconds);
    points.push_back({at, rest(at.size()), {}, fromSeconds(seconds * i)});
  }
  send(*to, joints, std::move(points), toDuration(words.at(2)));
}

void Trajectories::stop(const Words& words) {
  const config::GroupConfig* const to = running(words.at(1));
  if (to == nullptr) return;
  const Joints all = jointsOf(*to);
  const Joints joints = words.size() > 2 ? among(all, words[2]) : all;
  if (!joints.empty()) send(*to, joints, {});
}

void Trajectories::cancel(const Words& words) {
  if (running(words.at(1)) == nullptr) return;
  const std::uint64_t id = last_of_[words[1]];
  session_.stage.host().post(bus::Command(
      bus::CancelCommand{words[1], id}, [this, id, group = words[1]](const auto& said) {
        session_.say("< cancel of " + group + ": " + said.message);
        cancelled(id);
      }));
}

void Trajectories::stopAll() {
  for (const config::GroupConfig& group : session_.stage.loaded().robot.groups) {
    send(group, jointsOf(group), {});
  }
}

void Trajectories::nudge(const config::GroupConfig& group, const Nudge& nudge, double seconds,
                         const std::function<void(const std::string& why)>& refused) {
  const Joints joints = jointsOf(group);
  std::vector<double> goal = shown(joints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i] == nudge.joint) goal[i] += nudge.way;
  }
  send(group, joints, {{goal, rest(goal.size()), {}, fromSeconds(seconds)}}, std::nullopt, refused);
}

const config::GroupConfig* Trajectories::running(const std::string& name) const {
  return session_.stage.host().running() ? session_.stage.group(name) : nullptr;
}

Trajectories::Joints Trajectories::jointsOf(const config::GroupConfig& group) const {
  Joints joints;
  for (const std::string& name : group.joints) {
    for (std::size_t i = 0; i < session_.stage.joints().size(); ++i) {
      if (jointAt(i).name == name) joints.push_back(i);
    }
  }
  return joints;
}

Trajectories::Joints Trajectories::among(const Joints& joints, const std::string& names) const {
  Joints found;
  for (const std::string& name : listed(names)) {
    for (std::size_t joint : joints) {
      if (jointAt(joint).name == name) found.push_back(joint);
    }
  }
  return found;
}

std::vector<std::size_t> Trajectories::axesOf(const Joints& joints) const {
  std::vector<std::size_t> axes;
  for (std::size_t joint : joints) {
    for (std::size_t axis : jointAt(joint).axes) {
      if (std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
    }
  }
  return axes;
}

std::vector<double> Trajectories::shown(const Joints& joints) const {
  std::vector<double> positions;
  for (std::size_t joint : joints) positions.push_back(session_.shown(jointAt(joint)));
  return positions;
}

/// Goals as shares of each joint's range, or as near to that as its limits allow in so many
/// seconds.
std::vector<double> Trajectories::reachable(const Joints& joints, const std::vector<double>& from,
                                            const Words& words, std::size_t first,
                                            double seconds) const {
  std::vector<double> goal;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointFacts& facts = jointAt(joints[i]);
    const motion::JointLimits& limits = facts.limits;
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
std::vector<Trajectories::Goal> Trajectories::goalsOf(const Joints& joints,
                                                      const Points& points) const {
  std::vector<Goal> goals;
  for (std::size_t i = 0; i < joints.size() && !points.empty(); ++i) {
    if (i >= points.back().positions.size()) return {};
    const JointFacts& facts = jointAt(joints[i]);
    goals.push_back({facts.position(session_.truths),
                     points.back().positions[i] - session_.shown(facts),
                     facts.speed(session_.truths) * kShownAge});
  }
  return goals;
}

void Trajectories::send(const config::GroupConfig& group, Joints joints, Points points,
                        std::optional<Duration> start,
                        const std::function<void(const std::string& why)>& refused) {
  const std::uint64_t id = ++last_id_;
  Sent sent;
  sent.id = id;
  sent.group = &group;
  sent.axes = axesOf(joints);
  sent.joints = std::move(joints);
  sent.at = session_.now();
  sent.stalled = session_.conditions.stalled;
  sent.base = sent.at + start.value_or(Duration());
  sent.goals = goalsOf(sent.joints, points);
  sent.has_start = start.has_value();
  sent.stop = points.empty();
  if (!points.empty()) sent.last = points.back().time_from_start;
  bus::TrajectoryCommand body;
  body.id = id;
  body.group = group.name;
  for (std::size_t joint : sent.joints) body.joints.push_back(jointAt(joint).name);
  body.points = std::move(points);
  if (start) body.start_time = sent.base;
  body.ended = [this, id](const bus::TrajectoryOutcome& outcome) { ended(id, outcome); };
  sent_[id] = sent;
  const auto reply = [this, sent, refused](const bus::Answer& answer) {
    session_.say("< trajectory of " + sent.group->name + (answer.success ? ": " : " refused: ") +
                 answer.message);
    if (answer.success) return accepted(sent, laterBy(sent, answer.message));
    sent_.erase(sent.id);
    if (refused) refused(answer.message);
  };
  session_.stage.host().post(bus::Command(std::move(body), reply));
}

/// By how much later than asked it ends, as the driver says, which may be no more than is
/// documented.
Duration Trajectories::laterBy(const Sent& sent, const std::string& answer) const {
  static const std::string kWords = "it ends ";
  const std::size_t at = answer.find(kWords);
  if (at == std::string::npos) return {};
  const double told = std::strtod(answer.c_str() + at + kWords.size(), nullptr);
  // Without tolerances of its own.
  const double most = sent.group->goal_time + sent.group->lengthening * toSeconds(sent.last);
  if (!(told >= 0.0 && told <= most + kRounded)) {
    session_.report("untrue_answer", "",
                    "a trajectory may take " + number(most) + " s longer: " + answer);
    return {};
  }
  return fromSeconds(told);
}

void Trajectories::accepted(const Sent& sent, Duration later) {
  const Time now = session_.now();
  session_.stage.look(session_.truths);
  const bool seen = std::all_of(sent.axes.begin(), sent.axes.end(),
                                [&](std::size_t i) { return session_.conditions.quiet(i, now); });
  const auto runs = sent_.find(sent.id);  // one that only stops may have ended already
  if (!seen && runs != sent_.end()) runs->second.goals.clear();
  if (!sent.stop) last_of_[sent.group->name] = sent.id;
  for (std::size_t i : sent.axes) {
    if (runs != sent_.end()) {
      runs->second.before[i] = {follows_[i], session_.permits.until(i, Source::trajectory)};
    }
    const config::GroupConfig*& leader = led_by_[i];
    const bool of_another = leader != nullptr && leader != sent.group;
    if (sent.stop && of_another) continue;  // that group moves it
    follows_[i] = sent.id;
    leader = sent.group;
    if (sent.stop) {
      stopped(sent, i);
      continue;
    }
    const Time begin = sent.has_start ? sent.base : std::max(sent.base, now);
    const Time end = begin + sent.last + later + session_.lateFor() + 250ms;
    session_.permits.cut(i, Source::trajectory, end);
    session_.permits.allow(i, Source::trajectory, end);
  }
}

/// When an axis of it that moves stands, if it is brought to rest from now on.
Time Trajectories::restAfter(const Sent& sent, std::size_t axis) const {
  const Duration hard = session_.stage.axes()[axis].stopTime(session_.truths[axis].velocity);
  return session_.now() +
         std::max(hard, fromSeconds(sent.group->stop_trajectory_duration) + kRampEnds);
}

/// A gentle stop may last longer than what it ends.
void Trajectories::stopped(const Sent& sent, std::size_t axis) {
  const Time rest = restAfter(sent, axis);
  session_.permits.cut(axis, Source::trajectory, rest);
  session_.permits.prolong(axis, Source::trajectory, rest);
}

/// It has not begun yet, or not surely.
bool Trajectories::waits(const Sent& sent) const {
  const Duration stood = session_.conditions.stalled - sent.stalled;
  const Duration late = stood > Duration() ? stood + kUpToSpeed : Duration();
  return sent.has_start && sent.base + late + session_.lateFor() + kShownTime > session_.now();
}

/// One that waits leaves those that are before it to what they do.
void Trajectories::cancelled(std::uint64_t id) {
  const auto found = sent_.find(id);
  if (found == sent_.end()) return;
  const Sent& sent = found->second;
  if (waits(sent)) return;
  session_.stage.look(session_.truths);
  for (std::size_t i : sent.axes) {
    if (follows_[i] == id) stopped(sent, i);
  }
}

void Trajectories::ended(std::uint64_t id, const bus::TrajectoryOutcome& outcome) {
  const auto found = sent_.find(id);
  if (found == sent_.end()) {
    return session_.report("answered_twice", "",
                           "a trajectory has ended twice: " + outcome.message);
  }
  const Sent sent = std::move(found->second);
  sent_.erase(found);
  session_.say("< trajectory of " + sent.group->name + " has ended: " + outcome.message);
  for (std::size_t i : sent.axes) {  // of one that was replaced some axes may go on
    const bool over = outcome.end != bus::TrajectoryEnd::replaced;
    if (over && follows_[i] == id) led_by_[i] = nullptr;
  }
  if (waits(sent)) neverBegan(sent);
  session_.stage.look(session_.truths);
  if (outcome.end == bus::TrajectoryEnd::reached) judgeReached(sent, outcome);
  const bool stopped = outcome.end == bus::TrajectoryEnd::stopped && !waits(sent);
  const bool restless = outcome.message.find("still moves") != std::string::npos;
  if (stopped && !restless) judgeStopped(sent, outcome.message);
}

/// What it was to take over goes on.
void Trajectories::neverBegan(const Sent& sent) {
  for (const auto& [axis, before] : sent.before) {
    if (follows_[axis] != sent.id) continue;
    follows_[axis] = before.follows;
    session_.permits.allow(axis, Source::trajectory, before.until);
  }
}

bool Trajectories::judged(const Sent& sent, std::size_t axis) const {
  const auto follows = follows_.find(axis);
  // A trajectory that was taken is given after it has left.
  const bool led = (sent.stop && session_.permits.given(axis) > sent.at) ||
                   session_.permits.given(axis, Source::homing) > sent.at;
  return follows != follows_.end() && follows->second == sent.id && !led &&
         session_.conditions.quiet(axis, session_.now());
}

void Trajectories::judgeReached(const Sent& sent, const bus::TrajectoryOutcome& outcome) const {
  // Without a tolerance it is over wherever its joints are; the answer names the farthest.
  const double said = std::isfinite(outcome.off) ? outcome.off : 0.0;
  for (std::size_t i = 0; i < sent.goals.size(); ++i) {
    const JointFacts& facts = jointAt(sent.joints[i]);
    const auto tolerance = sent.group->tolerances.find(facts.name);
    const bool told = tolerance != sent.group->tolerances.end() && tolerance->second.goal > 0.0;
    double missing = facts.position(session_.truths) - sent.goals[i].from - sent.goals[i].way;
    // The way to the first point is the shorter one, whole turns off.
    if (facts.limits.continuous) missing = std::remainder(missing, kTwoPi);
    double counts = 0.0;
    for (std::size_t k = 0; k < facts.axes.size(); ++k) {
      counts += std::fabs(facts.shares[k] * session_.stage.axes()[facts.axes[k]].units_per_count);
    }
    const double bound = (told ? tolerance->second.goal : kArrived + said) + sent.goals[i].slack +
                         facts.speed(session_.truths) * kShownAge + 2.0 * counts;
    if (std::fabs(missing) <= bound) continue;
    session_.report("untrue_answer", session_.stage.axes()[facts.axes.front()].name,
                    sent.group->name + " has reached its goal, is said, and " + facts.name +
                        " is, by its motors, " + number(missing) + " away from it");
  }
}

/// What was stopped is told of once its joints stand, unless something else moves them since.
void Trajectories::judgeStopped(const Sent& sent, const std::string& words) const {
  for (std::size_t i : sent.axes) {
    const AxisFacts& facts = session_.stage.axes()[i];
    const AxisTruth& truth = session_.truths[i];
    const double bound =
        std::max(facts.creep(), 1.2 * facts.joint_share * sent.group->stopped_velocity_tolerance);
    const bool stands = !truth.power || std::fabs(truth.velocity) <= bound;
    if (stands || !judged(sent, i)) continue;
    session_.report("untrue_answer", facts.name,
                    "a trajectory has come to its end (" + words + ") while the motor turns at " +
                        number(truth.velocity) + " per s");
  }
}

}  // namespace cia402::campaign
