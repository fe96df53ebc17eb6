// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/reply.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

class AxisCycle;

/// Restores the factory's parameters of a drive, by 1011h or what its family has for that. While
/// that is not confirmed nothing is written, and the answer says what would be.
struct FactoryResetCommand {
  using Answer = bus::Answer;
  std::string axis;
  bool confirm = false;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
