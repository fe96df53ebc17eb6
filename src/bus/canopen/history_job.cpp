// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/history_job.h"

#include <memory>
#include <utility>

#include "bus/axis_cycle.h"
#include "bus/canopen/history_command.h"
#include "common/text.h"
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
        answer.message = drive::whoIs(config) +
                         ": error history (1003h): " + historyText(*config.profile, history);
        answer.history = history;
        give(reply, answer);
      }));
}

HistoryJob::HistoryJob(drive::Axis& axis, unsigned most, Done done)
    : Job(Turn::history, Ends::with_motion), axis_(&axis), reader_(most), done_(std::move(done)) {}

bool HistoryJob::step(Time) {
  if (!reader_.step(axis_->device().objects())) return false;
  done_(reader_.history());
  return true;
}

void HistoryJob::abandon(const std::string& why) {
  canopen::ErrorHistory history = reader_.history();
  history.remark = why;
  done_(history);
}

std::string historyText(const drive::DriveProfile& profile, const canopen::ErrorHistory& history) {
  std::string text;
  for (const canopen::ErrorHistoryEntry& entry : history.entries) {
    append(text, hexText(entry.code, 4) + " " + drive::errorName(profile, entry.code), ", ");
    if (entry.info != 0) text += " (info " + hexText(entry.info, 4) + ")";
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
