// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/reply.h"
#include "cia402_driver/common/time.h"
#include "drive/axis/axis.h"

namespace cia402::config {
struct GroupConfig;
}

namespace cia402::bus {

class AxisCycle;
struct AxisUnit;

/// A procedure on one axis, on those of a group, or on all that are concerned where neither is
/// named. On a group `enable` and `set_mode` are done on all axes or on none, and `home` begins
/// only where all of them may begin.
struct ProcedureCommand {
  using Answer = bus::Answer;
  std::string axis;
  drive::ProcedureRequest request;
  std::string group{};

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;

 private:
  bool concerns(const AxisUnit& unit, const config::GroupConfig* of) const;
};

}  // namespace cia402::bus
