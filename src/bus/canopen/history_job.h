// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "bus/canopen/alarm_reader.h"
#include "bus/canopen/fault_objects_reader.h"
#include "bus/jobs/job.h"
#include "canopen/emcy/error_history.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Reads the error history of one axis (1003h, or what its profile has instead) beside the cycle.
class HistoryJob final : public Job {
 public:
  using Done = std::function<void(const canopen::ErrorHistory&)>;

  /// @param axis must outlive the job. @param most entries to read, the newest ones. @param done
  /// is called once, with a remark if something went wrong.
  HistoryJob(drive::Axis& axis, unsigned most, Done done);

  bool step(Time now) override;
  void abandon(const std::string& why) override;

 private:
  drive::Axis* axis_;
  canopen::ErrorHistoryReader reader_;
  std::optional<AlarmReader> alarms_;         ///< instead
  std::optional<FaultObjectsReader> faults_;  ///< likewise
  Done done_;
};

/// Where it stands: "error history (1003h)".
std::string historyTitle(const drive::DriveProfile& profile);
/// A code of it in words, with cause and remedy.
std::string historyCodeText(const drive::DriveProfile& profile, std::uint16_t code);
/// "0x8611 following error (info 0x1234), 0x2310 over current": the newest first.
std::string historyText(const drive::DriveProfile& profile, const canopen::ErrorHistory& history);

}  // namespace cia402::bus
