// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/robot.h"

namespace cia402::bus {
void Robot::execute(Command command, Time now) {
  now_ = now;
  if (shutdown_ != Shutdown::no) {
    refuse(command.reply, "refused: the driver is shutting down");
    return;
  }
  if (!started_ && !std::holds_alternative<CallCommand>(command.body)) {
    refuse(command.reply,
           "refused: the bus interface " + config_.bus.interface + " is not there yet");
    return;
  }
  if (listener_.listening() && !std::holds_alternative<CallCommand>(command.body)) {
    executeLater(std::move(command));
    return;
  }
  if (lss_starting_ && !std::holds_alternative<CallCommand>(command.body)) {
    refuse(command.reply,
           "refused: the drives are being given their node-IDs (" + lss_.step() + ")");
    return;
  }
  if (!bus_lost_.empty() && !std::holds_alternative<CallCommand>(command.body)) {
    refuse(command.reply, "refused: " + bus_lost_ +
                              ", nothing reaches the drives; those that watch the master's "
                              "heartbeat stop by themselves");
    return;
  }
  std::visit([&](auto& body) { run(body, std::move(command.reply), now); }, command.body);
}

void Robot::run(ProcedureCommand& command, Reply reply, Time now) {
  const bool homing = command.request.kind == drive::ProcedureKind::home;
  const std::string problem = enables(command.request.kind) ? enableProblem() : std::string();
  if (!problem.empty()) {
    refuse(reply, std::string(drive::toString(command.request.kind)) + " is refused: " + problem);
    return;
  }
  std::vector<ProcedureJob::Item> items;
  std::string left_out;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const drive::AxisConfig& axis = axes_[i].config();
    const bool named = axis.name == command.axis;
    const bool concerned = command.axis.empty() && (!homing || axis.homing);
    if (concerned && axes_[i].device().excused()) {
      left_out += "; " + drive::jointName(axis) + " is optional and not there, it was left out";
      continue;
    }
    if (!named && !concerned) continue;
    items.push_back({i, homing && axis.homing ? axis.homing->order : 0});
    if (!stops(command.request.kind)) continue;
    for (ProcedureJob& job : procedures_) job.withdraw(i, command.request.kind, axes_);
  }
  if (items.empty()) {
    refuse(reply, !command.axis.empty() ? noSuchAxis(command.axis)
                  : left_out.empty()    ? "nothing to do: no axis has a `homing` section"
                                        : "nothing to do" + left_out);
    return;
  }
  const bool by_lss = command.request.kind == drive::ProcedureKind::recover && recoverByLss(items);
  procedures_.emplace_back(command.request, std::move(items), std::move(reply));
  procedures_.back().remark(std::move(left_out));
  if (by_lss) procedures_.back().hold();  // until stepLss() has no more to do
  if (procedures_.back().step(axes_, now)) procedures_.pop_back();
}

void Robot::run(SetpointCommand& command, const Reply& reply, Time now) {
  if (command.axis >= axes_.size()) return;
  const Result<void> taken =
      motions_[command.axis].command(axes_[command.axis], command.value, now);
  if (taken) return;
  refuse(reply, taken.error().message);
}

void Robot::run(TrajectoryCommand& command, const Reply& reply, Time now) {
  for (Group& group : groups_) {
    if (group.config().name != command.group) continue;
    const TrajectoryOutcome outcome =
        group.start(command.joints, command.points, command.start_time, axes_, motions_, now);
    const bool accepted = outcome.code == motion::TrajectoryErrorCode::successful;
    give(reply, answerOf(accepted, outcome.message));
    return;
  }
  refuse(reply, "there is no group \"" + command.group + "\"");
}

void Robot::run(ReadObjectCommand& command, const Reply& reply, Time) {
  drive::Axis* axis = axisNamed(command.axis, reply);
  if (axis == nullptr) return;
  Result<ObjectJob> job = ObjectJob::read(*axis, command.object, reply);
  if (job) {
    objects_.push_back(std::move(job).value());
  } else {
    refuse(reply, job.error().message);
  }
}

void Robot::run(WriteObjectCommand& command, const Reply& reply, Time) {
  drive::Axis* axis = axisNamed(command.axis, reply);
  if (axis == nullptr) return;
  Result<ObjectJob> job = ObjectJob::write(*axis, command.object, command.value, reply);
  if (job) {
    objects_.push_back(std::move(job).value());
  } else {
    refuse(reply, job.error().message);
  }
}

void Robot::run(NmtServiceCommand& command, const Reply& reply, Time now) {
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (command.axis.empty() || axes_[i].config().name == command.axis) which.push_back(i);
  }
  if (which.empty()) {
    refuse(reply, noSuchAxis(command.axis));
    return;
  }
  Result<NmtJob> job = NmtJob::start(command.command, which, command.axis.empty(), axes_, nodes_,
                                     master_, reply, now);
  if (!job) {
    refuse(reply, job.error().message);
    return;
  }
  const std::string whom = command.axis.empty() ? "all nodes" : command.axis;
  tell(Event::Severity::info, "nmt " + command.command + " to " + whom + " was asked for", now);
  nmt_.push_back(std::move(job).value());
}

void Robot::run(ErrorHistoryCommand& command, const Reply& reply, Time) {
  drive::Axis* axis = axisToAsk(command.axis, "its error history (1003h)", reply);
  if (axis == nullptr) return;
  const std::string who = drive::whoIs(axis->config()) + ": error history (1003h): ";
  histories_.emplace_back(*axis, canopen::ErrorHistoryReader::kAll,
                          [axis, who, reply](const canopen::ErrorHistory& history) {
                            Answer answer;
                            answer.success = history.readable;
                            answer.message = who + historyText(*axis->config().profile, history);
                            answer.history = history;
                            give(reply, answer);
                          });
}

void Robot::run(SaveDcfCommand& command, const Reply& reply, Time) {
  drive::Axis* axis = axisToAsk(command.axis, "its objects for a DCF", reply);
  if (axis == nullptr) return;
  dcfs_.emplace_back(*axis, command, config_.bus.bitrate, reply);
}

void Robot::run(CallCommand& command, const Reply& reply, Time now) {
  give(reply, command.function(now));
}

}  // namespace cia402::bus
