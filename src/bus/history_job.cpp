// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/history_job.h"

#include <utility>

#include "cia402_driver/drive/fault_text.h"

namespace cia402::bus {

HistoryJob::HistoryJob(drive::Axis& axis, unsigned most, Done done)
    : axis_(&axis), reader_(most), done_(std::move(done)) {}

bool HistoryJob::step() {
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
    if (!text.empty()) text += ", ";
    text += drive::hexWord(entry.code) + " " + drive::errorName(profile, entry.code);
    if (entry.info != 0) text += " (info " + drive::hexWord(entry.info) + ")";
  }
  if (history.readable && history.recorded == 0) text = "empty";
  const std::size_t more = history.recorded - history.entries.size();
  if (!history.entries.empty() && history.remark.empty() && more > 0) {
    text += " and " + std::to_string(more) + " older";
  }
  if (!history.remark.empty()) text += (text.empty() ? "" : "; ") + history.remark;
  return text;
}

}  // namespace cia402::bus
