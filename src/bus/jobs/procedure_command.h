// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/reply.h"
#include "cia402_driver/common/time.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

class AxisCycle;

/// A procedure on one axis, or on all that are concerned where `axis` is empty.
struct ProcedureCommand {
  using Answer = bus::Answer;
  std::string axis;
  drive::ProcedureRequest request;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
