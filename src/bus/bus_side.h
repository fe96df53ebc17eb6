// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

struct AxisUnit;

/// What the cycle of the axes asks of the bus that they are on. Seldom: nothing of it is asked for
/// in a cycle in which nothing happens.
class BusSide {
 public:
  /// Why no axis may be enabled now; empty if it may.
  virtual std::string enableProblem() const = 0;
  /// What is done with the device of an axis before it can boot, e.g. "LSS: inquiring its node-ID";
  /// empty if nothing is. @param axis index in the configuration
  virtual std::string preparationOf(std::size_t axis) const = 0;
  /// Axes are to recover: begins what their devices need before they can boot. @return true if that
  /// takes its time; JobList::release() is called at its end
  virtual bool prepareRecovery(const std::vector<AxisUnit*>& units) = 0;
  /// All axes are disabled at the end of the program: takes the devices out of operation.
  virtual void releaseDevices(Time now) = 0;

 protected:
  ~BusSide() = default;
};

}  // namespace cia402::bus
