// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "canopen/config.h"
#include "canopen/device_config.h"
#include "common/problems.h"
#include "drive/axis/config.h"
#include "motion/joint.h"

namespace cia402::motion {
class Coupling;
}

namespace cia402::config {

/// The bus of a robot and how the master behaves on it (`bus:`).
struct BusConfig {
  std::string interface;  ///< "can0", or "sim"
  double bitrate = 1e6;   ///< bit/s
  Duration sync_period{std::chrono::milliseconds(4)};
  canopen::NodeId node_id = 127;
  Duration heartbeat{std::chrono::milliseconds(100)};
  std::uint8_t sync_counter = 0;  ///< chosen from the profiles unless given
  bool external_sync = false;     ///< another device produces SYNC, the node follows it
  Duration listen{std::chrono::milliseconds(150)};  ///< for another master at start; zero: not
  bool reset_all = false;  ///< starts with one NMT reset to all nodes, also those of others
  std::optional<Duration> sync_window;  ///< 1007h of the drives; none: not written
  Duration time_interval{0};            ///< of TIME messages; zero: none
  /// Frames that nothing in the configuration needs are received, too, and recorded.
  bool receive_all = false;
  bool stop_all_on_loss = false;  ///< where a drive is lost all axes get a quick stop
};

/// Goal and path tolerances of one joint in a group; 0: none.
struct JointTolerance {
  double trajectory = 0.0, goal = 0.0;
};

/// Joints that follow trajectories together (`groups:`).
struct GroupConfig {
  std::string name;
  std::vector<std::string> joints;
  bool stop_group_on_fault = true;
  bool allow_partial_joints_goal = false;    ///< a trajectory may name some of the joints only
  double goal_time = 0.4;                    ///< s
  double stopped_velocity_tolerance = 0.01;  ///< rad/s or m/s; 0: none
  double stop_trajectory_duration = 0.0;     ///< s that a stop takes at least; 0: as hard as may be
  bool strict = false;  ///< what is beyond a limit on its way is refused, not slowed down
  double acceleration_margin = 0.0;  ///< share by which limits of acceleration may be exceeded
  double lengthening = 0.1;  ///< share by which a trajectory may take longer, beside goal_time
  std::map<std::string, JointTolerance> tolerances;
};

/// The two sides of a gantry move one joint, side by side.
struct GantryConfig {
  double skew_window = 0.0;    ///< rad or m, > 0, that one side may be ahead of the other
  double homing_window = 0.0;  ///< the same while they are not homed, counted from where they stood
  /// How fast what is left of it is taken back while the joint moves, per s and s².
  double squaring_velocity = 0.0, squaring_acceleration = 0.0;
};

/// Joints that several axes move together (`couplings:`).
struct CouplingConfig {
  std::vector<motion::Joint> joints;
  std::vector<std::string> axes;
  /// Joint space = matrix * axis space. That of a gantry has a second row: side 2 minus side 1.
  std::shared_ptr<const motion::Coupling> matrix;
  std::optional<GantryConfig> gantry;

  bool has(const std::string& axis) const {
    return std::find(axes.begin(), axes.end(), axis) != axes.end();
  }
  bool moves(const std::string& joint) const {
    return std::any_of(joints.begin(), joints.end(),
                       [&](const motion::Joint& any) { return any.name == joint; });
  }
};

/// A tf frame that a joint moves, or one that stands still, as URDF defines joints.
struct FrameConfig {
  std::string joint;           ///< that moves it; empty: it stands still
  std::string parent, child;   ///< names in tf, the frame's own is `child`
  double xyz[3] = {0, 0, 0};   ///< m, of its origin in the parent
  double rpy[3] = {0, 0, 0};   ///< rad, its turn there about the parent's x, then y, then z
  double axis[3] = {0, 0, 1};  ///< of length 1, in the turned frame: the joint turns it about that
                               ///< or shifts it along
};

/// The `simulation:` section of an axis: what stands around the simulated drive, in the joint's own
/// true coordinates (rad or m).
struct SimulationConfig {
  std::string drive;  ///< definition of the simulated drive; default: the profile's name
  YAML::Node with;    ///< keys of such a definition that count for this axis instead
  double initial_position = 0.0;  ///< where the joint stands at power-on
  std::optional<double> lower_limit_switch, upper_limit_switch;  ///< active beyond
  std::optional<double> lower_stop, upper_stop;                  ///< it cannot move beyond
  std::optional<std::pair<double, double>> home_switch;          ///< active from .. to
  std::optional<double> index_offset;   ///< turns; the index pulse is at k + index_offset
  std::optional<double> time_constant;  ///< s, lag of the position loop
  double brake_delay = 0.0;             ///< s
  bool unconfigured = false;            ///< has no node-ID until LSS gives it one
  std::optional<std::uint32_t> vendor, product, revision, serial;  ///< instead of the drive's 1018h
};

/// The `recorder:` section: what the flight recorder keeps, and where recordings go.
struct RecorderConfig {
  Duration duration{std::chrono::seconds(10)};            ///< kept before the end of a recording
  Duration post_trigger{std::chrono::milliseconds(500)};  ///< recorded after a fault
  std::string directory;  ///< empty: `recordings` in $ROS_HOME or ~/.ros
  unsigned keep = 20;     ///< recordings of this bus; the oldest go. 0: none is written on faults
};

/// Everything that the file of a robot says, checked, with its drives' profiles read.
struct RobotConfig {
  BusConfig bus;
  RecorderConfig recorder;
  std::vector<drive::AxisConfig> axes;
  std::vector<canopen::DeviceConfig> devices;  ///< that the axes sit in: AxisConfig::device
  const canopen::DeviceConfig& deviceOf(const drive::AxisConfig& axis) const {
    return devices[axis.device];
  }
  canopen::DeviceConfig& deviceOf(const drive::AxisConfig& axis) { return devices[axis.device]; }
  const canopen::PdoSet& pdosOf(const drive::AxisConfig& axis) const {
    return devices[axis.device].axes[axis.device_axis];
  }
  canopen::PdoSet& pdosOf(const drive::AxisConfig& axis) {
    return devices[axis.device].axes[axis.device_axis];
  }
  std::vector<CouplingConfig> couplings;
  /// That which the axis is in; nullptr: it moves its own joint.
  const CouplingConfig* couplingOf(const std::string& axis) const {
    const auto found = std::find_if(couplings.begin(), couplings.end(),
                                    [&](const CouplingConfig& any) { return any.has(axis); });
    return found != couplings.end() ? &*found : nullptr;
  }
  /// The joints of a bus: of the axes that are in no coupling, then of the couplings.
  std::vector<motion::Joint> joints() const;
  /// Whether the axis moves that joint, alone or with others.
  bool turns(const drive::AxisConfig& axis, const std::string& joint) const {
    const CouplingConfig* coupling = couplingOf(axis.name);
    return coupling != nullptr ? coupling->moves(joint) : axis.joint == joint;
  }
  std::vector<GroupConfig> groups;
  std::vector<FrameConfig> frames;         ///< that joints move; with `static_frames` trees
  std::vector<FrameConfig> static_frames;  ///< that stand still
  bool publish_tf = false;                 ///< the node tells tf of them
  double joint_state_rate = 50.0;          ///< Hz
  /// joint_states leave out joints whose position is not known; else they are NaN there.
  bool omit_unknown_joints = false;
  std::map<std::string, SimulationConfig> simulated;  ///< axis name -> its `simulation:` section
  std::vector<std::string> warnings;                  ///< worth a look, but no reason to refuse
  std::vector<std::string> notes;                     ///< good to know
};

/// Finds the file of a drive profile, an EDS or a DCF: a name ("generic_cia402", "motor.eds") in
/// the search folders, or a path.
/// @return empty if there is none.
using ProfileLookup = std::function<std::string(const std::string& drive)>;
ProfileLookup profilesIn(std::vector<std::string> folders);

/// Turns a parameter tree (docs/configuration.md) into a typed configuration. Every problem
/// is reported at once with its path; the result is only valid if none was added.
RobotConfig loadRobot(const YAML::Node& tree, const ProfileLookup& profiles, Problems& problems);

/// What the CANopen master needs: PDO COB-IDs, mappings, start-up writes as bytes. A pure function
/// of a valid configuration; problems that only show here (a value that does not fit) are added.
canopen::MasterConfig makeMasterConfig(const RobotConfig& robot, Problems& problems);

/// Bus load that the configuration causes, as shares of the bit rate (1.0: full).
struct BusLoad {
  double nominal = 0.0, worst = 0.0;  ///< without stuff bits; with the most there can be
  double feasible_rate = 0.0;         ///< Hz of SYNC at which the worst case is 80 %
};
/// Of the bus; what is left is for SDO and emergencies.
inline constexpr double kComfortableLoad = 0.8;
BusLoad busLoad(const canopen::MasterConfig& master, double bitrate);
/// The part of one PDO in it, the remote frames that ask for it included; zero if it is disabled.
/// Nominal: an RPDO that is sent on change is sent at its refresh rate only.
BusLoad pdoLoad(const canopen::PdoConfig& pdo, Duration sync_period, double bitrate);

/// The PDO plan as a table for people, with the bus load that each PDO causes.
std::string pdoTable(const canopen::MasterConfig& master, double bitrate);

/// Reads a robot's YAML file into a tree for loadRobot(); adds a problem if it is no YAML.
YAML::Node readRobotFile(const std::string& path, Problems& problems);

}  // namespace cia402::config
