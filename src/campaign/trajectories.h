// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/session.h"

namespace cia402::campaign {

/// Trajectories of groups, what they permit, and whether what the driver says of their ends is
/// true. Joints are numbered as the stage has them.
class Trajectories {
 public:
  explicit Trajectories(Session& session) : session_(session) {}

  /// @return false if the words are none of trajectories.
  bool act(const Words& words);
  /// Stops those of all groups.
  void stopAll();

  // Actions; a group that a smaller robot has not, or no driver: nothing happens.
  void move(const Words& words);    ///< move G SECONDS FRACTION...: within reach
  void part(const Words& words);    ///< part G JOINT,JOINT... SECONDS FRACTION...: of these only
  void goal(const Words& words);    ///< goal G SECONDS POSITION...: whatever it is
  void path(const Words& words);    ///< path G START COUNT SECONDS FRACTION...: there and back
  void stop(const Words& words);    ///< stop G, or stop G JOINT,JOINT...
  void cancel(const Words& words);  ///< cancel G: the last one

  /// How a joint may be proved to move.
  struct Nudge {
    std::size_t joint;
    double way;  ///< rad or m, as the driver has it now
  };
  /// Has a group move one of its joints so far, the others where they are.
  /// @param refused told why, if it is
  void nudge(const config::GroupConfig& group, const Nudge& nudge, double seconds,
             const std::function<void(const std::string& why)>& refused);

 private:
  using Points = std::vector<motion::TrajectoryPoint>;
  using Joints = std::vector<std::size_t>;
  /// How far a trajectory is to take a joint, by its motors, and from where.
  struct Goal {
    double from = 0.0, way = 0.0, slack = 0.0;
  };
  /// A trajectory, from when it left for the driver.
  struct Sent {
    std::uint64_t id = 0;
    const config::GroupConfig* group = nullptr;
    Joints joints;
    std::vector<std::size_t> axes;  ///< that move these joints
    std::vector<Goal> goals;        ///< of these joints
    Time at{};                      ///< when it left
    Duration stalled{};             ///< Conditions::stalled at that time
    Time base{};                    ///< from which its points count, at the earliest
    Duration last{};                ///< time of the last point
    bool stop = false, has_start = false;
    /// What moved its axes before, and until when: it goes on where this one never begins.
    struct Before {
      std::uint64_t follows = 0;
      Time until{};
    };
    std::map<std::size_t, Before> before;
  };

  const config::GroupConfig* running(const std::string& name) const;
  const JointFacts& jointAt(std::size_t joint) const { return session_.stage.joints()[joint]; }
  Joints jointsOf(const config::GroupConfig& group) const;
  /// Those of them that the word names, "a1,p2"; a smaller robot may have none.
  Joints among(const Joints& joints, const std::string& names) const;
  std::vector<std::size_t> axesOf(const Joints& joints) const;
  std::vector<double> shown(const Joints& joints) const;
  std::vector<double> reachable(const Joints& joints, const std::vector<double>& from,
                                const Words& words, std::size_t first, double seconds) const;
  void moveThere(const config::GroupConfig& group, const Joints& joints, const Words& words,
                 std::size_t seconds);
  void send(const config::GroupConfig& group, Joints joints, Points points,
            std::optional<Duration> start = std::nullopt,
            const std::function<void(const std::string& why)>& refused = nullptr);
  std::vector<Goal> goalsOf(const Joints& joints, const Points& points) const;
  Duration laterBy(const Sent& sent, const std::string& answer) const;
  /// @param later it takes longer than was asked
  void accepted(const Sent& sent, Duration later);
  void cancelled(std::uint64_t id);
  bool waits(const Sent& sent) const;
  void neverBegan(const Sent& sent);
  void ended(std::uint64_t id, const bus::TrajectoryOutcome& outcome);
  /// Whether the driver hears and reaches an axis, and it was moved by that trajectory last.
  bool judged(const Sent& sent, std::size_t axis) const;
  void judgeReached(const Sent& sent, const bus::TrajectoryOutcome& outcome) const;
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
