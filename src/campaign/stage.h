// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/scene.h"
#include "sim/definition/drive_definition.h"
#include "sim/world/robot_drives.h"
#include "sim/world/sync_producer.h"
#include "tools/virtual_host.h"

namespace cia402::campaign {

/// A robot's YAML as the driver loads it, with the drives to simulate.
struct Loaded {
  config::RobotConfig robot;
  canopen::MasterConfig master;
  std::vector<sim::SimulatedDrive> drives;
};
/// @param config_folder with drives/ and simulated_drives/. @return an error with all problems.
Result<Loaded> loadRobot(const std::string& yaml, const std::string& config_folder);

/// What is true of one motor and its drive, in the joint's units but with the drive's own zero.
struct AxisTruth {
  double position = 0.0;  ///< rad or m
  double velocity = 0.0;
  double effort = 0.0;  ///< N m or N, 6077h
  bool power = false;
  std::uint16_t statusword = 0;
  int mode = 0;             ///< in which it is, whatever 6061h shows
  double told = 0.0;        ///< 6064h, before position_offset and what set_position declared
  unsigned bad_floats = 0;  ///< received by it since the start
  bool at_switch = false;   ///< on a limit switch, or right before it
  canopen::NmtState nmt = canopen::NmtState::unknown;

  bool faulted() const { return (statusword & 0x0008) != 0; }
  bool enabled() const { return (statusword & 0x006F) == 0x0027; }
};

/// What oracles must know of an axis besides its truth.
struct AxisFacts {
  std::string name;
  std::size_t index = 0;
  const drive::AxisConfig* config = nullptr;
  std::uint8_t node_id = 0;
  sim::AxisPlace place;           ///< the simulated drive in the world, and its axis
  double units_per_turn = 1.0;    ///< of the shaft that the simulated drive turns; signed
  double units_per_count = 0.0;   ///< of 607Ah and 6064h; 0: they are floats
  double effort_per_count = 0.0;  ///< of 6077h; 0: it is a float
  double velocity = 1.0, acceleration = 1.0;  ///< limits
  bool watches_master = true;                 ///< else the drive goes on without one
  Duration master_timeout{};  ///< after which the drive stops by itself; else very long
  /// Until a driver that starts, or finds its drive again, has stopped it: what watches no master
  /// turns on while it boots.
  Duration retaken() const { return std::chrono::seconds(watches_master ? 1 : 4); }
  bool loss_coasts = false;   ///< it lets the motor go where it misses its master or SYNC
  bool limit_coasts = false;  ///< likewise at a limit switch
  bool homes_by_moving = false;
  Duration homing_timeout{};
  /// With which it moves joints, itself among them. Of a gantry: its sides, to which what is asked
  /// of one is done.
  std::vector<std::size_t> coupled;
  bool gantry = false;
  double joint_share = 1.0;       ///< how fast it may turn for joints at speed 1, all at once
  Duration longest_joint_stop{};  ///< of the joints that it moves with others

  /// Longest time from `speed` to rest by the acceleration limit, or those of its joints.
  Duration stopTime(double speed) const;
  /// What the mode with that number of 6060h controls; other where the drive homes or has no mode.
  drive::ControlKind kind(int mode) const;
  /// Slower counts as standing.
  double creep() const { return std::max(0.02 * velocity + 0.002, config->standstill_velocity); }
};

/// What trajectories are given for: what one axis moves, or several together.
struct JointFacts {
  std::string name;
  motion::JointLimits limits;
  double velocity = 1.0, acceleration = 1.0;
  std::vector<std::size_t> axes;
  std::vector<double> shares;  ///< of these axes: where the joint is, is the sum of share * axis

  /// By its motors, whose zeros nobody knows.
  double position(const std::vector<AxisTruth>& truths) const;
  double speed(const std::vector<AxisTruth>& truths) const;  ///< at most, of all its axes
};

/// What oracles and troubles must know of a simulated drive.
struct DriveFacts {
  std::uint8_t node_id = 0;
  std::vector<std::size_t> axes;  ///< of the robot that sit in it, at least one
};

/// Where a PDO, as the driver lays it out, holds an object of an axis.
struct PdoPlace {
  std::uint32_t cob_id = 0;
  fieldbus::ObjectId object;  ///< as the drive has it: 687Ah where axis 0 has 607Ah
  std::size_t axis = 0;
  unsigned byte = 0;

  /// Whether a frame is of that PDO, with so many bytes of the object.
  bool isIn(const can::Frame& frame, unsigned bytes) const {
    return frame.id == cob_id && !frame.error && !frame.remote && frame.size >= byte + bytes;
  }
};

/// The world of a scene: drives, bus, and the computer with the driver.
class Stage {
 public:
  /// @param seed of what happens by chance on the bus.
  Stage(Loaded loaded, std::uint64_t seed);

  sim::World& world() { return world_; }
  tools::VirtualHost& host() { return host_; }
  /// What the driver shows; nullptr while no process runs.
  const bus::Network* driver() const { return host_.running() ? &host_.network() : nullptr; }
  const Loaded& loaded() const { return loaded_; }
  const std::vector<AxisFacts>& axes() const { return facts_; }
  const std::vector<JointFacts>& joints() const { return joints_; }
  /// In the order of the world.
  const std::vector<DriveFacts>& drives() const { return drives_; }
  /// All axes in the drive of this one, itself among them: what is done to the drive happens to
  /// all of them.
  const std::vector<std::size_t>& inDriveOf(std::size_t axis) const {
    return drives_[facts_[axis].place.drive].axes;
  }
  sim::Drive& driveOf(std::size_t axis) { return world_.drive(facts_[axis].place.drive); }
  /// All that the driver sends cyclically.
  const std::vector<PdoPlace>& rpdos() const { return rpdos_; }
  /// All that the drives send cyclically.
  const std::vector<PdoPlace>& tpdos() const { return tpdos_; }
  /// Where its drive tells the statusword of an axis; nullptr: in no TPDO.
  const PdoPlace* statusword(std::size_t axis) const { return statuswords_[axis]; }
  /// The mode with that number of 6060h: where there are several, the one that the driver is in.
  const drive::ModeSpec* modeOf(std::size_t axis, int number) const;
  /// What the drive does about a fault of that name; nullptr: it has none.
  const sim::FaultDefinition* fault(std::size_t axis, const std::string& name) const;
  /// Whether a fault takes the power away at once.
  bool coasts(std::size_t axis, const std::string& name);
  /// nullptr if there is none.
  const AxisFacts* find(const std::string& name) const;
  /// nullptr if there is none.
  const config::GroupConfig* group(const std::string& name) const;
  /// The axes that a call concerns: one by its name, those of a group, or "all".
  std::vector<std::size_t> named(const std::string& name) const;
  /// The same where what is asked of one side of a gantry is done to both.
  std::vector<std::size_t> namedAsOne(const std::string& name) const;
  /// The drives that these axes sit in, each once.
  std::vector<std::size_t> drivesNamed(const std::string& name) const;
  Time now() const { return world_.now(); }
  /// Looks at all drives.
  void look(std::vector<AxisTruth>& truths);

 private:
  Loaded loaded_;
  sim::SyncProducer sync_;  ///< of a robot whose driver follows another's SYNC; outlives the world
  sim::World world_;
  tools::VirtualHost host_;
  std::vector<AxisFacts> facts_;
  std::vector<JointFacts> joints_;
  std::vector<DriveFacts> drives_;
  std::vector<PdoPlace> rpdos_, tpdos_;
  std::vector<const PdoPlace*> statuswords_;  // of tpdos_
  struct Objects {
    const sim::Entry *position, *effort;
  };
  std::vector<Objects> objects_;
};

}  // namespace cia402::campaign
