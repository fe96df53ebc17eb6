// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "can/bus.h"
#include "sim/drive/drive.h"
#include "sim/world/robot_drives.h"

namespace cia402::sim {

/// Simulated drives on a CAN interface that exists, in the time of whoever calls step(). The drives
/// hear each other as they would on the wire.
class DriveHost {
 public:
  /// @param interface must outlive the host. The drives are powered on at `now`.
  DriveHost(const std::vector<SimulatedDrive>& drives, can::Interface& interface, Time now);
  ~DriveHost();
  DriveHost(const DriveHost&) = delete;
  DriveHost& operator=(const DriveHost&) = delete;

  /// Takes what was received, each frame at the time of its stamp, and does what is due. Called
  /// late, the drives answer late, but miss nothing that was on the wire in time.
  void step(Time now);
  /// When step() is due if nothing is received.
  Time nextDeadline() const;
  /// The axis of that name in one of the drives.
  AxisOfDrive find(const std::string& axis);

 private:
  class Tap;
  struct Member {
    std::unique_ptr<Tap> tap;
    std::unique_ptr<Drive> drive;
  };

  void hearEachOther();

  can::Interface& interface_;
  Time at_;  ///< how far the drives have come
  std::vector<SimulatedDrive> described_;
  std::vector<Member> drives_;  ///< in the same order
};

}  // namespace cia402::sim
