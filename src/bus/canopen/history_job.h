// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "bus/jobs/job.h"
#include "canopen/emcy/error_history.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Reads the error history (1003h) of one axis beside the cycle.
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
  Done done_;
};

/// "0x8611 following error (info 0x1234), 0x2310 over current": the newest first.
std::string historyText(const drive::DriveProfile& profile, const canopen::ErrorHistory& history);

}  // namespace cia402::bus
