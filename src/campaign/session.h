// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "campaign/oracle.h"
#include "campaign/random.h"
#include "campaign/runner.h"

namespace cia402::campaign {

/// The words of an action.
using Words = std::vector<std::string>;

/// One run of a scene, as all that plays a part in it sees it: the stage, what is true, permitted
/// and wrong, the oracles and their findings, and what is to happen later.
class Session {
 public:
  /// All must outlive it.
  Session(Stage& on, std::uint64_t seed, const RunOptions& options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  Time now() const { return stage.now(); }
  View view() const { return {stage, truths, permits, conditions, now()}; }

  /// Looks at all drives, and lets the permits see it.
  void look();
  /// Lets the oracles look, too.
  void lookAsOracles();
  void onFrame(const can::Frame& frame, Time now);
  void onCall(const Call& call);
  /// All oracles look anew and judge the answer.
  void onAnswer(const Call& call, const bus::Answer& answer);

  /// Does something so much later.
  void later(Duration delay, std::function<void()> what);
  /// When something is to be done next; kNever if nothing is.
  Time nextLater() const;
  /// Does what is due.
  void doLater(Time due);
  /// What still lasts ends now.
  void endLater();

  /// Tells whoever traces the run.
  void say(const std::string& line) const;
  void report(const char* oracle, const std::string& axis, const std::string& text);
  std::vector<Finding>& findings() { return findings_; }
  /// Whether the run is to end because of a finding.
  bool failed() const { return options_.stop_at_first && !findings_.empty(); }

  /// Neither hears the driver the drive of an axis nor that drive the driver for so long.
  void breakLink(std::size_t axis, Duration duration);
  /// The driver may not hear that drive for so long.
  void mayBeUnheard(std::size_t axis, Duration duration);
  /// A drive that nothing reaches goes on with what it has until it misses the master, all its
  /// axes.
  void loseCommands(std::size_t axis, Duration duration);
  /// The power of one axis may go by itself now; that of all axes in its drive.
  void mayCoast(std::size_t axis);
  void mayCoastInDriveOf(std::size_t axis);
  /// How long the host is going to be late, now and then.
  Duration lateFor() const { return std::max(late_until - now(), Duration()); }
  /// Where the driver shows an axis, rad or m; 0 where no driver runs.
  double shown(std::size_t axis) const;
  double shown(const JointFacts& joint) const;

  Stage& stage;
  Random random;
  Permits permits;
  Conditions conditions;
  std::vector<AxisTruth> truths;  ///< of all axes, as last looked at; empty before the first look
  std::vector<Time> limited_at;   ///< when a limit was last active (statusword bit 11)
  Time late_until{};              ///< the host, now and then

 private:
  void loseCommandsOfOne(std::size_t axis, Duration duration);
  bool heldByVelocity(std::size_t axis) const;
  struct Later {
    Time at{};
    std::function<void()> what;
  };
  bool ignored(const std::string& oracle) const;

  const RunOptions& options_;
  std::vector<std::unique_ptr<Oracle>> oracles_;
  std::vector<Finding> findings_, ignored_;
  std::vector<Later> later_;
};

/// The words of a list, "a1,a3".
Words listed(const std::string& word);
/// A number of a line; throws std::invalid_argument with the line's words.
double toNumber(const std::string& word);
/// Seconds of a line, likewise.
Duration toDuration(const std::string& word);

}  // namespace cia402::campaign
