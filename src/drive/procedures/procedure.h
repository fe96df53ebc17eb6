// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "drive/axis/words.h"

namespace cia402::drive {

/// What one call of a procedure, or of a step in it, came to.
struct Outcome {
  enum class Kind { running, done, failed };
  Kind kind = Kind::running;
  std::string message;
  bool remark = false;  ///< done, but the message says more than that; told in a summary, too

  static Outcome running() { return {}; }
  static Outcome done(std::string text = {}) { return {Kind::done, std::move(text), false}; }
  static Outcome remarked(std::string text) { return {Kind::done, std::move(text), true}; }
  static Outcome failed(std::string text) { return {Kind::failed, std::move(text), false}; }
  bool isRunning() const { return kind == Kind::running; }
  bool isDone() const { return kind == Kind::done; }
  bool isFailed() const { return kind == Kind::failed; }
};

/// What a step works with in one call.
struct Context {
  AxisCore& axis;
  ProcedureStatus& status;
  Time now;

  /// Tells where the procedure is; to be called when a step begins, not in every cycle.
  void show(std::string step, std::string waiting_for) const {
    status.step = std::move(step);
    status.waiting_for = std::move(waiting_for);
  }
};

/// A long operation on an axis. step() is called in every cycle until it is not running.
class Procedure {
 public:
  virtual ~Procedure() = default;
  /// Does what is due. Where the deadline of the whole (ProcedureStatus) is over it leaves the axis
  /// safe and fails, whatever its steps wait for.
  Outcome step(const Context& context);
  /// Somebody wants it to end. @return true if it may simply be dropped; else it goes on running
  /// until the axis is safe and then fails with `reason`.
  virtual bool cancel(const std::string& /*reason*/, const Context&) { return true; }
  /// Nothing has to be done: it ends as soon as it is asked for, and whoever moves the axis goes
  /// on.
  virtual bool leavesAlone(const Context&) const { return false; }
  /// It waits for the device to come back by itself.
  virtual bool survivesDeviceLoss() const { return false; }
  /// Set-points are taken and followed while it runs.
  virtual bool letsMotionGoOn() const { return false; }

 protected:
  virtual Outcome advance(const Context& context) = 0;

 private:
  Outcome giveUp(const Context& context) const;

  State seen_ = State::unknown;
  unsigned changes_ = 0;  ///< of the drive's state since it began
  bool watched_ = false;
};

/// Makes the procedure that was asked for, or says why the axis cannot do it now.
Result<std::unique_ptr<Procedure>> makeProcedure(const ProcedureRequest& request, AxisCore& axis);

// One factory for each, in <kind>.cpp.
Result<std::unique_ptr<Procedure>> makeEnable(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeDisable(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeHome(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeClearFaults(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeRecover(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeQuickStop(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeHalt(AxisCore& axis);
Result<std::unique_ptr<Procedure>> makeSetMode(AxisCore& axis, const std::string& mode);
Result<std::unique_ptr<Procedure>> makeSetPosition(AxisCore& axis, double position);
Result<std::unique_ptr<Procedure>> makeSaveParameters(AxisCore& axis);  // parameters.cpp
Result<std::unique_ptr<Procedure>> makeRestoreParameters(AxisCore& axis,
                                                         bool confirmed);  // the same

/// A check before something that needs standstill: running while it is not known yet (a window of
/// Standstill is not full), failed in motion. @param since when the waiting began
Outcome awaitStandstill(const Context& context, Time since, const std::string& what);

/// Shows that the device is being booted, and is waited for.
void showBoot(const Context& context);

/// Error for a procedure that needs the device; empty if it is ready.
std::string deviceRefusal(AxisCore& axis, const char* what);

}  // namespace cia402::drive
