// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "campaign/calls.h"
#include "campaign/session.h"
#include "campaign/streams.h"
#include "campaign/trajectories.h"

namespace cia402::campaign {

/// After the disturbances: the robot comes back, and a small move of each axis works.
class Proof {
 public:
  /// Lets everything happen until then, or until a finding ends the run.
  using RunTo = std::function<void(Time)>;

  Proof(Session& session, Calls& calls, Streams& streams, Trajectories& trajectories, RunTo run_to)
      : session_(session),
        calls_(calls),
        streams_(streams),
        trajectories_(trajectories),
        run_to_(std::move(run_to)) {}

  /// @pre the world is well again
  void run();

 private:
  bool recover();
  bool freeDrives();
  bool enableAll();
  bool enable(const AxisFacts& facts);
  /// A fault keeps it on its limit switch until it is moved by hand.
  bool heldByFault(std::size_t axis) const;
  bool leaveSwitches();
  bool homeAll();
  /// @return false if it is not answered in time, or a finding ends the run; else answer_ is its.
  bool call(const std::string& verb, const std::string& who, Duration limit);
  const drive::ModeSpec* modeOf(std::size_t axis);
  /// @param tried the direction in which a limit held it, -1 or 1.
  /// @param tried so often it was held by a limit switch @param last the way that was tried last, 1
  /// or -1
  void move(std::size_t axis, unsigned tried = 0, double last = 0.0);

  /// Joints that several axes move, which take trajectories alone.
  void moveJoints();
  void moveJoint(const config::GroupConfig& group, std::size_t joint);
  /// All axes of the group are in a mode for trajectories, free, and stand as square as they must;
  /// no joint is outside of its limits, into which a zero may have put it.
  bool takesTrajectories(const config::GroupConfig& group);
  bool outside(const JointFacts& joint) const;
  bool skewed(const AxisFacts& facts) const;
  /// What a small move of an axis is to come to.
  struct Step {
    double value = 0.0;     ///< of the set-points
    double expected = 0.0;  ///< way, rad or m; signed
    bool provable = true;   ///< enough way is left
  };
  Step stepOf(const AxisFacts& facts, const drive::ModeSpec& mode, double at, double sign) const;
  void runFor(Duration duration) { run_to_(session_.now() + duration); }
  void noRecovery(const std::string& axis, const std::string& text);

  Session& session_;
  Calls& calls_;
  Streams& streams_;
  Trajectories& trajectories_;
  RunTo run_to_;
  bus::Answer answer_;  ///< to the last call
};

}  // namespace cia402::campaign
