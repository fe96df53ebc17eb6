// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "system/hostile_scene.h"

namespace cia402::hostile {

constexpr double kFar = 1e3;  // times the limit

/// Gives commands, a cycle of a sequence at a time.
class Storm {
 public:
  Storm(Scene& scene, const Mode& mode, unsigned seed)
      : scene_(scene), mode_(mode), engine_(seed), sides_(kJoints.size(), 1.0) {}

  void beginSequence() {
    if (--until_turn_ <= 0) {
      until_turn_ = static_cast<int>(whole(20, 40));
      for (double& side : sides_) side = chance(0.5) ? 1.0 : -1.0;
      marches_ = ++turns_ % 2 == 0;
      if (marches_) sides_.assign(sides_.size(), turns_ % 4 == 0 ? 1.0 : -1.0);
    }
    for (auto& pattern : patterns_) pattern = static_cast<Pattern>(whole(0, kPatterns - 1));
    for (auto& pattern : patterns_) pattern = chance(0.4) ? Pattern::step : pattern;
  }
  /// A set-point for each joint by itself.
  void attackAxes(int cycle) {
    for (std::size_t i = 0; i < kJoints.size(); ++i) {
      if (patterns_[i] == Pattern::silence && cycle == 0) silent_[i] = 20;
      if (--silent_[i] > 0 || !chance(0.8)) continue;
      give(bus::SetpointCommand{i, value(i, cycle), stamp(i)});
    }
  }
  /// One for all.
  void attackGroup(int cycle) {
    if (patterns_[0] == Pattern::silence && cycle == 0) silent_[0] = 20;
    if (--silent_[0] > 0) return;
    bus::GroupSetpointsCommand command{0, {}, stamp(0)};
    const bool mild = chance(0.6);  // all that is beyond a limit is refused
    for (std::size_t i = 0; i < kJoints.size(); ++i) {
      const double wild = value(i, cycle);
      command.values.push_back(mild && !(wild >= placed(i, -1.0) && wild <= placed(i, 1.0))
                                   ? placed(i, wild > 0.0 ? 1.0 : -1.0)
                                   : wild);
    }
    if (chance(0.02)) command.values.resize(whole(0, 5), std::nan(""));
    give(std::move(command));
    if (chance(0.05)) give(bus::SetpointCommand{whole(0, 3), value(1, cycle), stamp(1)});
  }
  /// A way for all of them, or for those that are named.
  void attackByTrajectories(int cycle);

  std::uint64_t given = 0, refused = 0;

 private:
  enum class Pattern : std::uint8_t { step, wild, reverse, shake, silence, stale, shuffle, random };
  static constexpr unsigned kPatterns = 8;

  bool chance(double share) { return std::uniform_real_distribution<>()(engine_) < share; }
  double within(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(engine_);
  }
  std::size_t whole(unsigned low, unsigned high) {
    return std::uniform_int_distribution<unsigned>(low, high)(engine_);
  }
  template <typename Request>
  void give(Request request) {
    ++given;
    const auto count = [this](const typename Request::Answer& answer) {
      if (!answer.success) ++refused;
    };
    scene_.robot().network().execute(bus::Command(std::move(request), count), scene_.now());
  }
  double wild();
  double value(std::size_t joint, int cycle);
  double placed(std::size_t joint, double share) const;
  std::optional<Time> stamp(std::size_t joint);
  bus::TrajectoryCommand trajectory();
  motion::TrajectoryPoint point(const std::vector<std::size_t>& joints, double after_s);
  void spoil(bus::TrajectoryCommand& command);
  void spoilNumbers(motion::TrajectoryPoint& point);

  Scene& scene_;
  const Mode& mode_;
  std::mt19937 engine_;
  std::vector<double> sides_;  ///< to which steps lead
  int until_turn_ = 0;
  unsigned turns_ = 0;
  bool marches_ = false;  ///< all joints are led to the same side until the next turn
  std::array<Pattern, kJoints.size()> patterns_{};
  std::array<int, kJoints.size()> silent_{};
};

/// What is no number, and numbers at the ends of what there is.
inline double Storm::wild() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double kinds[] = {std::nan(""),
                          kInfinity,
                          1e300,
                          std::numeric_limits<double>::max(),
                          std::numeric_limits<double>::denorm_min(),
                          std::numeric_limits<double>::min(),
                          0.0,
                          1e9,
                          std::exp(within(-40.0, 40.0))};
  return (chance(0.5) ? 1.0 : -1.0) * kinds[whole(0, 8)];
}

/// From -1 to 1, the limits of the joint in the mode.
inline double Storm::placed(std::size_t index, double share) const {
  const Joint& joint = kJoints[index];
  if (mode_.object == kVelocity.object) return share * joint.velocity;
  if (mode_.object == kEffort.object) return share * joint.effort;
  return 0.5 * (joint.upper + joint.lower + share * (joint.upper - joint.lower));
}

inline double Storm::value(std::size_t i, int cycle) {
  const bool effort = mode_.object == kEffort.object;  // too much for the object is refused
  switch (patterns_[i]) {
    case Pattern::wild:
      return wild();
    case Pattern::reverse:
      return placed(i, cycle % 2 == 0 ? 2.0 : -2.0);
    case Pattern::shake:
      return placed(i, 0.9 * sides_[i] + within(-1e-6, 1e-6));
    case Pattern::shuffle:  // a stream at a speed that can be followed, out of order
      return placed(i, sides_[i] * 0.01 * static_cast<double>((cycle * 7) % 10));
    case Pattern::random:
      return placed(i, within(-3.0, 3.0));
    case Pattern::step:
    case Pattern::silence:
    case Pattern::stale:
      break;
  }
  return placed(i, sides_[i] * (effort ? 3.0 : kFar));
}

/// When a command says that it came.
inline std::optional<Time> Storm::stamp(std::size_t i) {
  if (patterns_[i] != Pattern::stale) return {};
  const double ago[] = {0.0, 0.9 * kTimeout, 1.1 * kTimeout, 10.0, 1e6, -0.1, -1e6};
  return scene_.now() - fromSeconds(ago[whole(0, 6)]);
}

inline motion::TrajectoryPoint Storm::point(const std::vector<std::size_t>& joints,
                                            double after_s) {
  motion::TrajectoryPoint point;
  point.time_from_start = fromSeconds(after_s);
  const std::size_t carries = marches_ ? 0 : whole(0, 3);
  for (const std::size_t i : joints) {
    const bool rests = chance(0.7), marches = marches_ || chance(0.5);
    point.positions.push_back(placed(i, marches ? sides_[i] * within(0.95, 1.0) : within(-1, 1)));
    const double share = rests ? 0.0 : within(-1.1, 1.1);
    if (carries > 0) point.velocities.push_back(share * kJoints[i].velocity);
    if (carries > 1) point.accelerations.push_back(share * kJoints[i].acceleration);
  }
  return point;
}

inline void Storm::spoilNumbers(motion::TrajectoryPoint& point) {
  std::vector<double>* const parts[] = {&point.positions, &point.velocities, &point.accelerations};
  std::vector<double>& part = *parts[whole(0, 2)];
  if (part.empty() || chance(0.3)) return part.resize(whole(0, 5), chance(0.5) ? 0.0 : wild());
  part[whole(0, static_cast<unsigned>(part.size()) - 1)] = wild();
}

inline void Storm::spoil(bus::TrajectoryCommand& command) {
  const double times[] = {0.0, -1.0, 1e-9, 0.3, 2147483647.0, -2147483648.0};
  motion::TrajectoryPoint& point =
      command.points[whole(0, static_cast<unsigned>(command.points.size()) - 1)];
  switch (whole(0, 6)) {
    case 0:
    case 1:
      return spoilNumbers(point);
    case 2:
      point.time_from_start = fromSeconds(times[whole(0, 5)]);
      return;
    case 3:
      command.start_time = scene_.now() + fromSeconds(0.5 * times[whole(0, 5)]);
      return;
    case 4:
      command.start_time = scene_.now() + fromSeconds(within(-0.3, 0.3));
      return;
    case 5:
      command.joints.back() = chance(0.5) ? "nobody" : "stiff";
      return;
    default:
      std::reverse(command.joints.begin(), command.joints.end());
  }
}

inline bus::TrajectoryCommand Storm::trajectory() {
  bus::TrajectoryCommand command;
  command.group = "all";
  command.streamed = marches_ || chance(0.5);
  command.id = whole(1, 4);
  std::vector<std::size_t> joints = {whole(0, 2)};
  if (!marches_ && chance(0.6)) joints = {0, 1, 2};
  for (const std::size_t i : joints) command.joints.emplace_back(kJoints[i].name);
  if (chance(0.3)) command.tolerances.goal_time = within(0.0, 2.0);
  double after_s = within(-0.01, 0.2);
  for (std::size_t left = marches_ ? 1 : whole(1, 4); left > 0; --left) {
    command.points.push_back(point(joints, after_s));
    after_s += within(0.02, 0.5);
  }
  return command;
}

inline void Storm::attackByTrajectories(int cycle) {
  if (patterns_[0] == Pattern::silence) return;
  if (!chance(patterns_[0] == Pattern::step ? 0.3 : 0.8)) return;
  bus::TrajectoryCommand command = trajectory();
  if (patterns_[0] == Pattern::wild || chance(0.3)) spoil(command);
  if (chance(0.03)) give(bus::CancelCommand{"all", whole(0, 4)});
  if (marches_) return give(std::move(command));
  if (chance(0.03)) command.points.clear();
  if (chance(0.02)) command.joints.clear();
  if (chance(0.02)) command.group = "none";
  if (chance(0.05)) give(bus::SetpointCommand{whole(0, 2), value(0, cycle), stamp(0)});
  give(std::move(command));
}

}  // namespace cia402::hostile
