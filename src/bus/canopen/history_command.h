// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/reply.h"
#include "canopen/emcy/error_history.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

class AxisCycle;

/// What a drive keeps of its past errors.
struct HistoryAnswer : Answer {
  canopen::ErrorHistory history;
};

/// Reads the error history (1003h) of an axis' drive.
struct ErrorHistoryCommand {
  using Answer = HistoryAnswer;
  std::string axis;

  void begin(AxisCycle& cycle, const Reply<HistoryAnswer>& reply, Time now) const;
};

}  // namespace cia402::bus
