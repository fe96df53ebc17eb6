// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::drive {

/// How the host leads a drive along positions by set-points of its profile position mode, where the
/// drive has no mode of operation that follows a stream of positions: each set-point is the place
/// where the stream would come to rest, and travels with the speed at which the drive is to go
/// there.
struct SetPointStream {
  std::string speed;  ///< name of the object that holds that speed; it travels in an RPDO
  /// Likewise of the deceleration of its ramp; empty: it is fixed, and the motor has to keep a
  /// greater distance to the stream.
  std::string deceleration;
  double interval =
      0.01;  ///< from one set-point to the next, s >= 0; the handshake may need longer
  /// Of the distance to where the motor should be, what one set-point makes good; 0 to
  /// kLargestShare
  double catch_up = 0.3;

  bool sends(const std::string& object) const { return object == speed || object == deceleration; }

  /// A set-point shows in the feedback when the next one is on its way already; beyond this the
  /// motor would swing.
  static constexpr double kLargestShare = 0.5;
};

}  // namespace cia402::drive
