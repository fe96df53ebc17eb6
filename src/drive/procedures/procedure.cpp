// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/procedure.h"

#include "drive/sentence.h"

namespace cia402::drive {

const char* toString(ProcedureKind kind) {
  switch (kind) {
    case ProcedureKind::none:
      return "none";
    case ProcedureKind::enable:
      return "enable";
    case ProcedureKind::disable:
      return "disable";
    case ProcedureKind::home:
      return "home";
    case ProcedureKind::clear_faults:
      return "clear_faults";
    case ProcedureKind::recover:
      return "recover";
    case ProcedureKind::quick_stop:
      return "quick_stop";
    case ProcedureKind::halt:
      return "halt";
    case ProcedureKind::set_mode:
      return "set_mode";
    case ProcedureKind::set_position:
      return "set_position";
    case ProcedureKind::save_parameters:
      return "save_parameters";
    case ProcedureKind::restore_parameters:
      return "restore_parameters";
  }
  return "unknown";
}

Result<std::unique_ptr<Procedure>> makeProcedure(const ProcedureRequest& request, AxisCore& axis) {
  switch (request.kind) {
    case ProcedureKind::enable:
      return makeEnable(axis);
    case ProcedureKind::disable:
      return makeDisable(axis);
    case ProcedureKind::home:
      return makeHome(axis);
    case ProcedureKind::clear_faults:
      return makeClearFaults(axis);
    case ProcedureKind::recover:
      return makeRecover(axis);
    case ProcedureKind::quick_stop:
      return makeQuickStop(axis);
    case ProcedureKind::halt:
      return makeHalt(axis);
    case ProcedureKind::set_mode:
      return makeSetMode(axis, request.mode);
    case ProcedureKind::set_position:
      return makeSetPosition(axis, request.position);
    case ProcedureKind::save_parameters:
      return makeSaveParameters(axis);
    case ProcedureKind::restore_parameters:
      return makeRestoreParameters(axis, request.confirmed);
    case ProcedureKind::none:
      break;
  }
  return Error{axis.who() + ": no procedure was named"};
}

namespace {

/// The axis is not to move by what was given up. @return what was done, in words
std::string makeSafe(AxisCore& axis, ProcedureKind kind) {
  if (!axis.deviceReady()) return "nothing reaches the drive";
  const bool off = kind == ProcedureKind::disable && axis.feedback().atStandstill();
  if (!enables(kind) && !stops(kind)) return "nothing moves by it";
  if (axis.mode().spec().kind == ControlKind::homing) axis.selectMode(axis.mode().working());
  off ? axis.switchOff() : axis.setGoal(Goal::quick_stop);
  return off ? "disable voltage is commanded" : "quick stop is commanded";
}

}  // namespace

Outcome Procedure::step(const Context& context) {
  const State state = context.axis.state().state;
  if (!watched_) seen_ = state;
  watched_ = true;
  if (state != seen_) ++changes_;
  seen_ = state;
  Outcome outcome = advance(context);
  if (outcome.isRunning() && context.now >= context.status.deadline) return giveUp(context);
  return outcome;
}

Outcome Procedure::giveUp(const Context& context) const {
  AxisCore& axis = context.axis;
  const ProcedureStatus& status = context.status;
  std::string text = axis.who() + ": " + toString(status.kind) + " was given up after " +
                     seconds(context.now - status.started) + " while " + status.step;
  if (!status.waiting_for.empty()) text += ", waiting for " + status.waiting_for;
  text += "; the drive changed its state " + std::to_string(changes_) + " times meanwhile. ";
  const std::string shown = report(axis);
  return Outcome::failed(text + makeSafe(axis, status.kind) + "; " + shown);
}

Outcome awaitStandstill(const Context& context, Time since, const std::string& what) {
  AxisCore& axis = context.axis;
  const bool patient = context.now - since <= 4 * Standstill::kWindow;
  if (!axis.state().feedback_valid) {
    if (patient) return Outcome::running();  // ready, and its first feedback still to come
    return Outcome::failed(axis.who() + ": " + what + ": no fresh " +
                           axis.profile().feedbackObjects());
  }
  if (axis.feedback().atStandstill()) return Outcome::done();
  if (!axis.generator().moving() && patient) return Outcome::running();
  return Outcome::failed(axis.who() + ": " + what + " needs standstill (velocity " +
                         number(axis.state().velocity) + "); stop the axis first");
}

void showBoot(const Context& context) {
  const std::string device = context.axis.device().terms().device;
  context.show("booting the " + device,
               "the " + device + " to be identified, configured and started");
}

std::string deviceRefusal(AxisCore& axis, const char* what) {
  if (axis.deviceReady()) return {};
  std::string text = axis.who() + ": cannot " + what + ": the " + axis.device().terms().device +
                     " is " + fieldbus::toString(axis.device().health());
  if (!axis.device().problem().empty()) text += " (" + axis.device().problem() + ")";
  return text + "; recover boots it again";
}

}  // namespace cia402::drive
