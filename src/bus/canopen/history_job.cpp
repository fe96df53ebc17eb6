// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/history_job.h"

#include <memory>
#include <utility>

#include "bus/axis_cycle.h"
#include "bus/canopen/history_command.h"
#include "common/text.h"
#include "drive/axis/fault_details.h"
#include "drive/profile/fault_text.h"

namespace cia402::bus {

void ErrorHistoryCommand::begin(AxisCycle& cycle, const Reply<HistoryAnswer>& reply, Time) const {
  const auto unit = cycle.findToAsk(axis, "its error history (1003h)");
  if (!unit) return refuse(reply, unit.error().message);
  const drive::AxisConfig& config = (*unit)->axis.config();
  cycle.jobs().add(std::make_unique<HistoryJob>(
      (*unit)->axis, canopen::ErrorHistoryReader::kAll,
      [&config, reply](const canopen::ErrorHistory& history) {
        HistoryAnswer answer;
        answer.success = history.readable;
        answer.message = drive::whoIs(config) + ": " + historyTitle(*config.profile) + ": " +
                         historyText(*config.profile, history);
        answer.history = history;
        give(reply, answer);
      }));
}

HistoryJob::HistoryJob(drive::Axis& axis, unsigned most, Done done)
    : Job(Turn::history, Ends::with_motion), axis_(&axis), reader_(most), done_(std::move(done)) {
  if (axis.config().profile->alarm_memory.entries > 0) alarms_.emplace(axis, most);
  if (!axis.config().profile->fault_memory.faults.empty()) faults_.emplace(axis, most);
}

bool HistoryJob::step(Time) {
  if (alarms_) {
    if (!alarms_->step()) return false;
    done_(alarms_->history());
    return true;
  }
  if (faults_) {
    if (!faults_->step()) return false;
    done_(faults_->history());
    return true;
  }
  if (!reader_.step(axis_->device().objects())) return false;
  done_(reader_.history());
  return true;
}

void HistoryJob::abandon(const std::string& why) {
  canopen::ErrorHistory history = alarms_   ? alarms_->history()
                                  : faults_ ? faults_->history()
                                            : reader_.history();
  history.remark = why;
  done_(history);
}

namespace {

std::string historyName(const drive::DriveProfile& profile, std::uint16_t code) {
  return profile.alarm_memory.entries > 0
             ? drive::detailName(profile.error_details, code)
             : hexText(code, 4) + " " + drive::errorName(profile, code);
}

}  // namespace

std::string historyTitle(const drive::DriveProfile& profile) {
  const drive::AlarmMemory& memory = profile.alarm_memory;
  if (!profile.fault_memory.faults.empty()) {
    const std::string& newest = profile.fault_memory.faults.front().code;
    return "past faults (" + newest + " (" + fieldbus::toString(profile.find(newest)->id) + "))";
  }
  if (memory.entries == 0) return "error history (1003h)";
  return "alarms (" + memory.code + " (" + fieldbus::toString(profile.find(memory.code)->id) + "))";
}

std::string historyCodeText(const drive::DriveProfile& profile, std::uint16_t code) {
  return profile.alarm_memory.entries > 0 ? drive::detailName(profile.error_details, code)
                                          : drive::errorCodeText(profile, code);
}

std::string historyText(const drive::DriveProfile& profile, const canopen::ErrorHistory& history) {
  std::string text;
  for (const canopen::ErrorHistoryEntry& entry : history.entries) {
    append(text, historyName(profile, entry.code), ", ");
    if (entry.info != 0) text += " (info " + hexText(entry.info, 4) + ")";
    if (entry.time) text += " at " + numberText(*entry.time) + " s";
    if (!entry.with.empty()) text += " (" + entry.with + ")";
  }
  if (history.readable && history.recorded == 0) text = "empty";
  const std::size_t more = history.recorded - history.entries.size();
  if (!history.entries.empty() && history.remark.empty() && more > 0) {
    text += " and " + std::to_string(more) + " older";
  }
  if (!history.remark.empty()) append(text, history.remark);
  return text;
}

}  // namespace cia402::bus
