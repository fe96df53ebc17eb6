// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "campaign/oracle.h"
#include "campaign/random.h"
#include "campaign/runner.h"

namespace cia402::campaign {

/// Plays a scene: gives the commands of its history, disturbs what it disturbs, and lets the
/// oracles look at everything.
class Player {
 public:
  Player(Stage& stage, const Scene& scene, const RunOptions& options);
  virtual ~Player() = default;

  /// @return the time that was simulated.
  void play();
  std::vector<Finding>& findings() { return findings_; }
  std::uint64_t fingerprint() const { return fingerprint_; }
  std::uint64_t frames() const { return frames_; }
  const Permits& permits() const { return permits_; }

 protected:
  /// Gives a call to the driver; where a test can come between the two.
  virtual void post(bus::Command command) { stage_.host().post(std::move(command)); }

 private:
  struct Pending {
    Call call;
    Time deadline{};
    std::shared_ptr<bool> answered = std::make_shared<bool>(false);
  };
  struct Stream {
    std::size_t axis = 0;
    std::function<double(Duration)> value;
    Time began{}, next{}, end{};
    Duration period{};
  };
  /// How far a trajectory is to take a motor, and from where.
  struct Goal {
    std::size_t axis = 0;
    double from = 0.0, way = 0.0, slack = 0.0;
  };
  struct Later {
    Time at{};
    std::function<void()> what;
  };
  using Words = std::vector<std::string>;

  // player.cpp
  void runTo(Time until);
  void stepTo(Time next);
  void look();
  void act(const Action& action);
  bool failed() const { return stop_at_first_ && !findings_.empty(); }
  void later(Duration delay, std::function<void()> what);
  void say(const std::string& line);
  bool ignored(const std::string& oracle) const;
  void report(const char* oracle, const std::string& axis, const std::string& text);
  void traceFrame(const can::Frame& frame);
  void onFrame(const can::Frame& frame, Time now);
  View view() { return {stage_, truths_, permits_, conditions_, stage_.now()}; }

  // player_calls.cpp
  bool actCall(const Words& words);
  void call(const Words& words, decltype(bus::Command::body) body, Duration bound);
  void answered(const Call& call, const bus::Answer& answer);
  void dropCalls();
  void watchDeadlines();

  // player_motion.cpp
  bool actMotion(const Words& words);
  void stream(std::size_t axis, std::function<double(Duration)> value, double seconds, double rate);
  void point(std::size_t axis, double value);
  void accepted(std::size_t axis, double value);
  void stepStreams();
  void trajectory(const config::GroupConfig& to, std::vector<motion::TrajectoryPoint> points,
                  Duration start, bool has_start);
  std::vector<double> reachable(const config::GroupConfig& to, const std::vector<double>& from,
                                const Words& words, std::size_t first, double seconds) const;
  /// The driver says that the trajectory of a group has reached its goal: have its motors?
  void goalReached(const config::GroupConfig& to);
  const config::GroupConfig* group(const std::string& name) const;
  std::size_t axisOf(const std::string& joint) const;
  double shown(std::size_t axis);
  /// How long the host is going to be late, now and then.
  Duration lateFor() const { return std::max(late_until_ - stage_.now(), Duration()); }

  // player_trouble.cpp
  bool actTrouble(const Words& words);
  bool actHost(const Words& words);
  bool actDrive(const Words& words);
  void breakLink(std::size_t axis, Duration duration);
  void loseCommands(std::size_t axis, Duration duration);
  void kill(Duration gone);
  void startHost();
  void calm();

  // player_proof.cpp
  void prove();
  bool proveCall(const std::string& verb, const std::string& who, Duration limit,
                 bus::Answer& answer);
  /// @param tried the direction in which a limit held it, -1 or 1.
  void proveMove(std::size_t axis, std::optional<double> tried = std::nullopt);

  Stage& stage_;
  const Scene& scene_;
  const RunOptions& options_;
  bool stop_at_first_;
  Random random_;
  Permits permits_;
  Conditions conditions_;
  std::vector<AxisTruth> truths_;
  std::vector<std::unique_ptr<Oracle>> oracles_;
  std::vector<Finding> findings_, ignored_;
  std::list<Pending> pending_;
  std::vector<Stream> streams_;
  std::vector<Later> later_;
  std::map<std::size_t, std::string> follows_;      ///< the group that moved an axis last
  std::map<std::string, std::vector<Goal>> goals_;  ///< of the groups' trajectories under way
  std::vector<Time> held_;      ///< when a limit was last active (statusword bit 11)
  std::vector<unsigned> cuts_;  ///< of a drive's power that have not ended
  std::vector<bool> dead_;      ///< drives with a fault that only the power switch ends
  class Deaf : public sim::Listener {
    void onFrame(const can::Frame&, Time) override {}
  } deaf_;
  sim::Port* foreign_ = nullptr;
  sim::FaultRates rates_;
  Time late_until_{};  // the host, now and then
  Time ends_at_{};     ///< the new driver after an orderly shutdown starts then
  std::uint64_t fingerprint_ = 1469598103934665603U, frames_ = 0;
  Time looked_{};
  Duration taken_{};
};

/// A number of a line; throws std::invalid_argument with the line's words.
double toNumber(const std::string& word);

}  // namespace cia402::campaign
