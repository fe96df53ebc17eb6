// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "drive/axis/axis.h"
#include "drive/axis/neighbours.h"
#include "drive/axis/notices.h"
#include "drive/axis/objects.h"

namespace cia402::drive {

/// What the parts of an axis share: what it is made for, the device that it sits in, and what is
/// known of it. Each value of `state` has one part that writes it.
struct AxisBasis {
  /// @throws std::invalid_argument if the configuration lacks what it was validated for.
  AxisBasis(AxisConfig axis_config, fieldbus::Device& its_device);
  AxisBasis(const AxisBasis&) = delete;
  AxisBasis& operator=(const AxisBasis&) = delete;

  const DriveProfile& profile() const { return *config.profile; }
  bool deviceReady() const { return device.health() == fieldbus::Health::ready; }
  /// No motion is possible by this drive: the power stage is off, as far as the statusword says.
  bool powerOff() const { return powerStageOff(state.state, state.statusword); }
  bool faulted() const { return isFault(state.state); }
  /// "shoulder (node 3)".
  std::string who() const { return whoIs(config); }

  AxisConfig config;
  fieldbus::Device& device;
  fieldbus::ProcessImage& image;
  AxisObjects objects;
  AxisState state;
  /// When what moves the axis, or could have, was seen or sent last: its set-points, or the drive
  /// by itself. What is measured tells of standstill only after that.
  Time moved_at = Time::min();
  /// Of a halt by set-points, or of a goal that is being ended, see ModeControl.
  bool ends_at_stop_point = false;
  Notices notices;
  Neighbours neighbours;
  std::set<ObjectId> written;  ///< by services, since the driver started or they were saved
};

}  // namespace cia402::drive
