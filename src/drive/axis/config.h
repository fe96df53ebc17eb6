// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drive/profile/conversion.h"
#include "drive/profile/disabling.h"
#include "drive/profile/profile.h"
#include "fieldbus/object_dictionary.h"
#include "motion/joint.h"

namespace cia402::drive {

struct HomingOptions {
  /// Method number of the drive; absent: declare zero (only where the profile says so).
  std::optional<int> method;
  double search_velocity = 0.0;  ///< rad/s or m/s, > 0
  double zero_velocity = 0.0;
  double acceleration = 0.0;     ///< rad/s^2 or m/s^2
  std::optional<double> offset;  ///< rad or m, see atHome()
  /// The drive reads minus its home offset (607Ch) at home, not the offset itself.
  bool offset_shifts_zero = false;
  Duration timeout{std::chrono::seconds(30)};
  bool required = true;  ///< no position motion before homing
  /// Where the drive says that it knows its home (DriveProfile::homed_bit) the axis is homed.
  bool kept_by_drive = false;
  int order = 0;  ///< axes of a lower order home first
  /// Joint position at the home point.
  double atHome() const { return offset.value_or(0.0); }
};

/// Typed configuration of one axis.
struct AxisConfig {
  std::string name;        ///< key in the YAML
  std::string joint;       ///< joint name
  std::size_t device = 0;  ///< that it sits in, index in config::RobotConfig::devices
  unsigned device_axis =
      0;              ///< which of the device's axes it is, 0 to 7; the profile is that axis'
  std::string place;  ///< on its bus, for messages: "node 3", "node 3, axis 1"
  std::shared_ptr<const DriveProfile> profile;  ///< with the objects of the EDS added
  /// What the device's maker says of its objects (EDS or DCF); nullptr: nothing.
  std::shared_ptr<const fieldbus::DeviceDescription> description;
  AxisGeometry geometry;
  /// Of the joint; jointOf() adds what the geometry says.
  motion::JointLimits limits;
  std::string mode;                           ///< canonical name; mode at start
  std::optional<PositionLoop> position_loop;  ///< instead of the profile's, in modes that have one
  std::optional<SetPointStream> set_point_stream;  ///< likewise
  FeedForward feed_forward;                        ///< in modes that have offsets
  std::optional<HomingOptions> homing;
  Duration cycle{std::chrono::milliseconds(4)};  ///< from one to the next
  Duration command_timeout{std::chrono::milliseconds(200)};
  bool brake_after_effort = true;  ///< when a stream of efforts ends; else the axis coasts
  /// Velocities and efforts are streamed to a drive that does not notice the driver's death, too.
  bool unwatched_streams = false;
  Disabling disabling;            ///< the profile's, where the axis does not say another one
  bool set_mode_stops = false;    ///< in motion it stops the axis first; else it is refused
  bool quick_stop_holds = false;  ///< ends in quick stop active, under power; else disabled
  /// A statusword that no state of CiA 402 shows is put up with for so long.
  Duration undecodable_timeout{std::chrono::milliseconds(100)};
  /// Below this the axis stands still (mode changes, homing, set_position), rad/s or m/s; a
  /// prismatic one gets 0.002.
  double standstill_velocity = 0.01;
  std::vector<std::string> modes;  ///< that can be served: the one at start and those to switch to
  std::vector<std::string> outputs;  ///< objects that travel to the drive in every cycle, by name
  std::vector<std::string> lacks;    ///< objects of the profile that this drive does not have
  std::vector<ObjectId> trusted;     ///< of DriveProfile::doubtful, what may be written
  std::vector<std::string> adjust;   ///< settings that may be written where they differ, by name
  std::vector<std::string> keeps;    ///< settings that are right in the drive, by name
  std::vector<NamedWrite> writes;    ///< the user's extra start-up writes
  std::vector<std::uint8_t> save, restore;  ///< sub-indices of 1010h, 1011h; empty: the profile's
  const std::vector<std::uint8_t>& saved() const {
    return save.empty() ? profile->parameters.save : save;
  }
  const std::vector<std::uint8_t>& restored() const {
    return restore.empty() ? profile->parameters.restore : restore;
  }
};

/// Takes over what an axis takes in motion: the time-out of its commands, its position loop.
void tune(AxisConfig& axis, const AxisConfig& next);
/// Takes over what it takes at rest, without power: its limits, and how home is searched for.
void adopt(AxisConfig& axis, const AxisConfig& next);

/// The limits of its joint, with what the geometry says of them.
motion::JointLimits limitsOf(const AxisConfig& axis);
/// The joint of an axis with its limits, as the motion module sees it.
motion::Joint jointOf(const AxisConfig& axis);

/// With which an axis is stopped by its set-points: its acceleration limit, or 5 rad/s² (0.5 m/s²)
/// where none is configured.
double stopDeceleration(const AxisConfig& axis);

/// For messages: "shoulder", or "shoulder (axis m3)" where joint and axis have different names.
std::string jointName(const AxisConfig& axis);
/// For messages: "shoulder (node 3)", or "shoulder (axis m3, node 3)".
std::string whoIs(const AxisConfig& axis);
/// The same with another word for where it sits, as there is little room: "shoulder (3)".
std::string whoIs(const AxisConfig& axis, const std::string& place);
/// Does `lacks` of the axis name the object, which is given by profile name or index?
bool saidToLack(const AxisConfig& axis, const std::string& object);
/// Why an object is not written though it could be: what the manual leaves open of it; empty: no
/// reason, or the axis trusts it.
std::string doubtOf(const AxisConfig& axis, ObjectId id);
/// Of those that the axis can be in, the one in which it follows trajectories; nullptr: none.
const ModeSpec* trajectoryMode(const AxisConfig& axis);

}  // namespace cia402::drive
