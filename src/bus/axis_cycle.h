// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bus/axis_unit.h"
#include "bus/bus_side.h"
#include "bus/event.h"
#include "bus/group.h"
#include "bus/jobs/job_list.h"
#include "bus/jobs/object_claims.h"
#include "bus/shutdown.h"
#include "bus/snapshot.h"
#include "cia402_driver/common/result.h"
#include "config/robot.h"

namespace cia402::bus {

/// All axes of a bus and what they do in a cycle, whatever bus it is: that calls, once in each of
/// its cycles and in this order, move(), then sends the outputs, stepJobs(), stepShutdown(),
/// watch(). One thread.
class AxisCycle {
 public:
  /// @param robot valid configuration. @param places of its axes, in its order.
  /// @param bus, @param events must outlive this.
  AxisCycle(const config::RobotConfig& robot, const std::vector<AxisUnit::Place>& places,
            BusSide& bus, EventSink& events);
  AxisCycle(const AxisCycle&) = delete;  // the groups know where the units are
  AxisCycle& operator=(const AxisCycle&) = delete;

  // Of a cycle:
  /// Decodes the feedback, computes motion and encodes the outputs.
  void move(Time now);
  void stepJobs(Time now);
  /// Goes on with the orderly end of the program, if it has begun.
  void stepShutdown(Time now);
  /// Tells what is new of each axis. @param tell_of_device (AxisUnit&): the bus' own part of it,
  /// before that of the axis.
  template <typename TellOfDevice>
  void watch(Time now, TellOfDevice&& tell_of_device) {
    for (AxisUnit& unit : units_) {
      unit.reporter.tick(now);
      tell_of_device(unit);
      unit.news.watch(unit.axis, unit.reporter, bus_, now);
    }
  }

  // Between two cycles:
  /// The device of an axis has answered beside the cycle.
  void noteAnswer(AxisUnit& unit) { unit.answered = any_answered_ = true; }
  /// One has, since hurry() was called.
  bool answered() const { return any_answered_; }
  /// Whose device has answered need not wait for the next cycle, nor who called for the answer: the
  /// next cycle may be late, and the answer no longer true. To be called once all frames that came
  /// before are taken in, for behind the answer there may be frames that tell what has become of
  /// the device since.
  void hurry(Time now) {
    if (any_answered_) hurryProcedures(now);
  }
  /// Brings all axes to rest, for the reason `why`.
  void stopMotion(const std::string& why);
  /// All axes that may move get a quick stop, for the reason `why`.
  void quickStop(const std::string& why, Time now);
  /// Set-points do not reach the drives as they should: all that moves is stopped by what does.
  void stopBesideCycle(const std::string& why);
  /// Nothing reaches the drives any more: motion ends, nothing enables an axis.
  void loseBus(const std::string& why);
  /// The orderly end of the program is asked for. @param started false: there is nothing to stop
  void beginShutdown(bool started, Time now) { shutdown_.begin(started, now); }
  /// Then, once the bus has ended what it does by itself: begins to bring the axes to rest.
  void endMotion(Time now);
  const Shutdown& shutdown() const { return shutdown_; }
  void finishShutdown() { shutdown_.finish(); }

  /// The axes have got other limits. @pre they are disabled
  void adoptLimits();

  /// Why nothing that delays other things may be begun: something is in motion, or may be. Empty if
  /// it may.
  std::string motionProblem() const;
  /// In their order in the configuration.
  std::vector<AxisUnit>& units() { return units_; }
  const std::vector<AxisUnit>& units() const { return units_; }
  Joints& joints() { return joints_; }
  const Joints& joints() const { return joints_; }
  std::vector<Group>& groups() { return groups_; }
  const std::vector<Group>& groups() const { return groups_; }
  /// By the name of its axis; nullptr if there is none.
  AxisUnit* find(const std::string& axis);
  /// The same, to ask its device for `what` beside the cycle; or why there is nobody to ask, e.g.
  /// as the device is stopped (NMT).
  Result<AxisUnit*> findToAsk(const std::string& axis, const std::string& what);
  /// Somebody is about to look at the axes: see drive::Axis::look().
  void look() {
    for (AxisUnit& unit : units_) unit.signals.look(unit.axis, now_);
  }
  JobList& jobs() { return jobs_; }
  ObjectClaims& claims() { return claims_; }
  /// Why no axis may be enabled now; empty if it may.
  std::string enableProblem() const { return bus_.enableProblem(); }
  /// See BusSide.
  bool prepareRecovery(const std::vector<AxisUnit*>& units) { return bus_.prepareRecovery(units); }
  /// Shows `step` of the start of the program on all axes.
  void sayStep(const std::string& step);

  /// The time that it was given last.
  Time now() const { return now_; }
  void setTime(Time now) { now_ = now; }
  /// When the last cycle began.
  Time lastCycle() const { return last_cycle_; }

 private:
  void hurryProcedures(Time now);

  BusSide& bus_;
  EventSink& events_;
  std::vector<AxisUnit> units_;
  Joints joints_;  ///< that they turn, with their couplings
  std::vector<Group> groups_;
  ObjectClaims claims_;
  JobList jobs_;
  Shutdown shutdown_;
  Time now_{}, last_cycle_{};
  bool any_answered_ = false;
};

}  // namespace cia402::bus
