// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/canopen/lss_commands.h"
#include "bus/canopen/lss_desk.h"
#include "bus/canopen/node_unit.h"

namespace cia402::bus {

/// Sets the bit timing of drives by LSS and has all devices switch to it at once (CiA 305, 5.4.5).
/// From the command until the switch is over no axis may be enabled.
class BitTimingSwitch {
 public:
  /// All must outlive this.
  BitTimingSwitch(LssDesk& desk, NodeUnits& nodes, AxisCycle& cycle)
      : desk_(desk), nodes_(nodes), cycle_(cycle) {}

  void begin(const LssBitTimingCommand& command, const Reply<>& reply);
  /// Why no axis may be enabled now; empty if it may.
  std::string enableProblem() const;

 private:
  struct Drive {
    const AxisUnit* unit = nullptr;
    canopen::lss::Identity identity;
  };
  /// Of one command, shared by the tasks that carry it out.
  struct Progress {
    LssBitTimingCommand command;
    Reply<> reply;
    std::string text;      ///< what came of each drive
    std::size_t left = 0;  ///< drives
    bool success = true;   ///< of all so far
  };

  std::string refusal(const LssBitTimingCommand& command, std::vector<Drive>& drives) const;
  std::string refusalOf(const AxisUnit& unit, canopen::lss::Identity& identity) const;
  std::string activationRefusal(bool stored) const;
  void set(const Drive& drive, const std::shared_ptr<Progress>& progress);
  void onAllSet(const std::shared_ptr<Progress>& progress);
  void activate(const std::shared_ptr<Progress>& progress);
  void onActivated(const Progress& progress, const std::string& failure, Time now);

  LssDesk& desk_;
  NodeUnits& nodes_;
  AxisCycle& cycle_;
  unsigned activations_ = 0;  ///< commands that end with an activation, queued or running
  Time switched_{};           ///< all devices have taken their new bit timing by then
};

}  // namespace cia402::bus
