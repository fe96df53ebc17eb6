// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/canopen/config.h"
#include "cia402_driver/canopen/eds.h"
#include "cia402_driver/canopen/lss_protocol.h"
#include "cia402_driver/drive/conversion.h"
#include "cia402_driver/drive/profile.h"

namespace cia402::drive {

/// Limits of a joint in SI units (rad or m); absent: none.
struct AxisLimits {
  std::optional<double> lower, upper, velocity, acceleration, jerk, effort;
};

struct HomingOptions {
  /// Method number of the drive; absent: declare zero (only where the profile says so).
  std::optional<int> method;
  double search_velocity = 0.0;  ///< rad/s or m/s, > 0
  double zero_velocity = 0.0;
  double acceleration = 0.0;     ///< rad/s^2 or m/s^2
  std::optional<double> offset;  ///< rad or m, see atHome()
  Duration timeout{std::chrono::seconds(30)};
  bool required = true;  ///< no position motion before homing
  int order = 0;         ///< axes of a lower order home first
  /// Joint position at the home point.
  double atHome() const { return offset.value_or(0.0); }
};

/// The EDS or DCF of an axis' drive.
struct AxisEds {
  std::string file;  ///< without its folder, for messages
  canopen::EdsInfo info;
  canopen::ObjectDictionary dictionary;
};

/// A drive that gets its node-ID by LSS at start-up, see bus::Robot.
struct AxisLss {
  canopen::lss::Identity identity;
  bool store = false;  ///< in the drive, where it was another one
};

/// How the loss of the drive, and of the master, is noticed; what is not given is as profile and
/// bus have it.
struct ErrorControlOptions {
  std::optional<canopen::ErrorControl> kind;
  std::optional<Duration> period;          ///< of heartbeats, or guard time
  std::optional<Duration> timeout;         ///< until the drive is lost
  std::optional<Duration> master_timeout;  ///< until the drive takes the master for lost
};

/// Typed configuration of one axis.
struct AxisConfig {
  std::string name;   ///< key in the YAML
  std::string joint;  ///< joint name
  canopen::NodeId node_id = 0;
  std::shared_ptr<const DriveProfile> profile;  ///< with the objects of the EDS added
  std::shared_ptr<const AxisEds> eds;           ///< nullptr: none was given
  AxisGeometry geometry;
  AxisLimits limits;
  std::string mode;  ///< canonical name; mode at start
  std::optional<HomingOptions> homing;
  Duration sync_period{std::chrono::milliseconds(4)};  ///< of the bus
  Duration command_timeout{std::chrono::milliseconds(200)};
  bool brake_after_effort = true;  ///< when a stream of efforts ends; else the axis coasts
  bool quick_stop_holds = false;   ///< ends in quick stop active, under power; else disabled
  /// A TPDO that fails to come so many times in a row is stale; where it brings statusword or
  /// position, an enabled axis is quick-stopped then.
  std::uint16_t stale_after = 10;
  /// A statusword that no state of CiA 402 shows is put up with for so long.
  Duration undecodable_timeout{std::chrono::milliseconds(100)};
  /// Below this the axis stands still (mode changes, homing, set_position), rad/s or m/s; a
  /// prismatic one gets 0.002.
  double standstill_velocity = 0.01;
  std::vector<std::string> modes;  ///< that the PDOs serve: the one at start and those to switch to
  std::vector<PdoLayout> pdos;     ///< resolved layout (planned, the profile's or the user's)
  bool pdos_planned = false;       ///< for this cycle; another one may get another plan
  /// Of what is in `pdos`, the objects that only defaults ask for.
  std::vector<std::string> default_objects;
  /// Of these, the feedback that is there only because its PDOs had room for it.
  std::vector<std::string> riders;
  std::vector<std::string> lacks;  ///< objects of the profile that this drive does not have
  Duration rpdo_timeout{0};        ///< the drive reacts when none came for so long; zero: never
  std::vector<NamedWrite> writes;  ///< the user's extra start-up writes
  ErrorControlOptions error_control;
  canopen::SdoChannel sdo;  ///< COB-IDs other than the predefined ones
  canopen::BootPolicy boot;
  std::optional<std::uint32_t> vendor_id, product_code, revision, serial;  ///< expected identity
  std::optional<AxisLss> lss;
  std::vector<std::uint8_t> save, restore;  ///< sub-indices of 1010h, 1011h; empty: the profile's
  const std::vector<std::uint8_t>& saved() const {
    return save.empty() ? profile->parameters.save : save;
  }
  const std::vector<std::uint8_t>& restored() const {
    return restore.empty() ? profile->parameters.restore : restore;
  }
};

/// With which an axis is stopped by its set-points: its acceleration limit, or 5 rad/s² (0.5 m/s²)
/// where none is configured.
double stopDeceleration(const AxisConfig& axis);

/// For messages: "shoulder", or "shoulder (axis m3)" where joint and axis have different names.
std::string jointName(const AxisConfig& axis);
/// For messages: "shoulder (node 3)", or "shoulder (axis m3, node 3)".
/// @param before_node_id "" where there is little room: "shoulder (3)"
std::string whoIs(const AxisConfig& axis, const char* before_node_id = "node ");
/// Does `lacks` of the axis name the object, which is given by profile name or index?
bool saidToLack(const AxisConfig& axis, const std::string& object);
/// Of those that the axis can be in, the one in which it follows trajectories; nullptr: none.
const ModeSpec* trajectoryMode(const AxisConfig& axis);

}  // namespace cia402::drive
