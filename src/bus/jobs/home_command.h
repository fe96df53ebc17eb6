// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/jobs/procedure_progress.h"
#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"

namespace cia402::config {
struct RobotConfig;
}

namespace cia402::bus {

class AxisCycle;

/// One axis of those that are to be homed.
struct HomingItem {
  std::size_t axis = 0;  ///< index in the configuration
  int order = 0;         ///< equal ones together, lower ones first
  bool named = false;    ///< itself; else it is left out where it is optional and not there
};

/// What is to be homed, in the order of the names, of a group in that of its joints, else in that
/// of the configuration.
/// @param names of axes, or of groups: those of their axes that have a `homing` section. Empty:
/// every axis that has one
/// @param order one for each name; empty: as configured
/// @return or why that makes no sense, in words
Result<std::vector<HomingItem>> homingPlan(const config::RobotConfig& robot,
                                           const std::vector<std::string>& names,
                                           const std::vector<int>& order);

/// Homes axes. Begins only where all of them may begin; answered when all have ended, or at once
/// where it is refused.
struct HomeCommand {
  using Answer = ProcedureReport;
  std::vector<HomingItem> plan;
  std::uint64_t id = 0;         ///< for CancelHomeCommand; 0: nobody cancels it
  std::function<void()> begun;  ///< called in the bus thread if it was not refused; may be empty
  std::shared_ptr<ProcedureProgress> progress;  ///< where it is shown; may be empty

  void begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const;
};

/// Stops what the HomeCommand of that id has begun, and begins no more of it; its answer comes once
/// that is done. Where there is none, it does nothing.
struct CancelHomeCommand {
  using Answer = bus::Answer;
  std::uint64_t id = 0;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
