// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "can/frame.h"
#include "sim/definition/monitors.h"
#include "sim/drive/core.h"

namespace cia402::sim {

/// The maker's objects that show how the axis is: numbers that stay as they are, or that are
/// brought up to date when somebody reads them, and counters of what was heard wrongly.
class Monitors {
 public:
  /// All must outlive it, and stay where they are.
  Monitors(const MonitorsDefinition& definition, ObjectDictionary& dictionary, DriveCore& core);
  Monitors(const Monitors&) = delete;
  Monitors& operator=(const Monitors&) = delete;

  /// Power or reset. @param power_on it had none
  void start(bool power_on, Time now);
  /// It is `now`; often.
  void look(Time now) { now_ = now; }
  /// The device has got this frame.
  void heard(const can::Frame& frame);

 private:
  double value(const MonitorDefinition& monitor) const;
  std::uint64_t number(const MonitorDefinition& monitor, const Entry& entry) const;
  std::uint64_t numberOf(const std::optional<fieldbus::ObjectId>& object) const;
  void count(const std::optional<fieldbus::ObjectId>& counter);

  const MonitorsDefinition& definition_;
  ObjectDictionary& dictionary_;
  DriveCore& core_;
  Time now_{}, since_{};
  Duration before_{};  ///< with power, until it went last
};

}  // namespace cia402::sim
