// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/session.h"

namespace cia402::campaign {

/// Trajectories of groups, what they permit, and whether what the driver says of their ends is
/// true.
class Trajectories {
 public:
  explicit Trajectories(Session& session) : session_(session) {}

  /// @return false if the words are none of trajectories.
  bool act(const Words& words);
  /// Stops those of all groups.
  void stopAll();

  // Actions; a group that a smaller robot has not, or no driver: nothing happens.
  void move(const Words& words);    ///< move G SECONDS FRACTION...: within reach
  void part(const Words& words);    ///< part G AXIS,AXIS... SECONDS FRACTION...: of these axes only
  void goal(const Words& words);    ///< goal G SECONDS POSITION...: whatever it is
  void path(const Words& words);    ///< path G START COUNT SECONDS FRACTION...: there and back
  void stop(const Words& words);    ///< stop G, or stop G AXIS,AXIS...
  void cancel(const Words& words);  ///< cancel G: the last one

 private:
  using Points = std::vector<motion::TrajectoryPoint>;
  /// How far a trajectory is to take a motor, and from where.
  struct Goal {
    double from = 0.0, way = 0.0, slack = 0.0;
  };
  /// A trajectory, from when it left for the driver.
  struct Sent {
    std::uint64_t id = 0;
    const config::GroupConfig* group = nullptr;
    std::vector<std::size_t> axes;
    std::vector<Goal> goals;  ///< of these axes
    Time at{};                ///< when it left
    Time base{};              ///< from which its points count, at the earliest
    Duration last{};          ///< time of the last point
    bool stop = false, has_start = false;
  };

  const config::GroupConfig* running(const std::string& name) const;
  std::vector<std::size_t> axesOf(const config::GroupConfig& group) const;
  /// Those of them that the word names, "a1,a3"; a smaller robot may have none.
  std::vector<std::size_t> among(const std::vector<std::size_t>& axes,
                                 const std::string& names) const;
  std::vector<double> shown(const std::vector<std::size_t>& axes) const;
  std::vector<double> reachable(const std::vector<std::size_t>& axes,
                                const std::vector<double>& from, const Words& words,
                                std::size_t first, double seconds) const;
  void moveThere(const config::GroupConfig& group, const std::vector<std::size_t>& axes,
                 const Words& words, std::size_t seconds);
  void send(const config::GroupConfig& group, std::vector<std::size_t> axes, Points points,
            std::optional<Duration> start = std::nullopt);
  std::vector<Goal> goalsOf(const std::vector<std::size_t>& axes, const Points& points) const;
  Duration laterBy(const Sent& sent, const std::string& answer) const;
  /// @param later it takes longer than was asked
  void accepted(const Sent& sent, Duration later);
  void cancelled(std::uint64_t id);
  bool waits(const Sent& sent) const;
  void ended(std::uint64_t id, const bus::TrajectoryOutcome& outcome);
  /// Whether the driver hears and reaches an axis, and it was moved by that trajectory last.
  bool judged(const Sent& sent, std::size_t axis) const;
  void judgeReached(const Sent& sent) const;
  void judgeStopped(const Sent& sent, const std::string& words) const;
  void stopped(const Sent& sent, std::size_t axis);
  Time restAfter(const Sent& sent, std::size_t axis) const;

  Session& session_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, Sent> sent_;            ///< that have not ended, or never will
  std::map<std::size_t, std::uint64_t> follows_;  ///< what moved an axis last
  std::map<std::size_t, const config::GroupConfig*> led_by_;  ///< nullptr: no group any more
  std::map<std::string, std::uint64_t> last_of_;              ///< trajectory of a group
};

}  // namespace cia402::campaign
