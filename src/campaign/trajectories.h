// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/session.h"

namespace cia402::campaign {

/// Trajectories of groups, what they permit, and whether a goal that the driver calls reached is.
class Trajectories {
 public:
  explicit Trajectories(Session& session) : session_(session) {}

  /// @return false if the words are none of trajectories.
  bool act(const Words& words);
  /// Stops those of all groups.
  void stopAll();
  /// What the driver tells: has a group reached its goal, have its motors?
  void hear(const std::string& text);

  // Actions; a group that a smaller robot has not, or no driver: nothing happens.
  void move(const Words& words);  ///< move G SECONDS FRACTION...: within reach
  void goal(const Words& words);  ///< goal G SECONDS POSITION...: whatever it is
  void path(const Words& words);  ///< path G START COUNT SECONDS FRACTION...: there and back
  void stop(const Words& words);  ///< stop G

 private:
  using Points = std::vector<motion::TrajectoryPoint>;
  /// How far a trajectory is to take a motor, and from where.
  struct Goal {
    std::size_t axis = 0;
    double from = 0.0, way = 0.0, slack = 0.0;
  };
  /// A trajectory that waits until the one before has had its time.
  struct Waiting {
    Time since{}, begin{};
    std::vector<Goal> goals;
  };
  /// A trajectory on its way to the driver.
  struct Sent {
    std::string group;
    std::vector<std::size_t> axes;
    std::vector<Goal> goals;
    Time base{};      ///< from which its points count, at the earliest
    Duration last{};  ///< time of the last point
    bool stop = false, has_start = false;
  };

  const config::GroupConfig* running(const std::string& name) const;
  std::size_t axisOf(const std::string& joint) const;
  std::vector<double> shown(const config::GroupConfig& group) const;
  std::vector<double> reachable(const config::GroupConfig& group, const std::vector<double>& from,
                                const Words& words, std::size_t first, double seconds) const;
  void send(const config::GroupConfig& group, Points points,
            std::optional<Duration> start = std::nullopt);
  std::vector<Goal> goalsOf(const std::vector<std::size_t>& axes, const Points& points) const;
  void accepted(const Sent& sent);
  void reached(const config::GroupConfig& group);

  Session& session_;
  std::map<std::size_t, std::string> follows_;      ///< the group that moved an axis last
  std::map<std::string, std::vector<Goal>> goals_;  ///< of the groups' trajectories under way
  std::map<std::string, Waiting> waiting_;          ///< and of those behind them
};

}  // namespace cia402::campaign
