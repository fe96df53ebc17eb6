// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "config/described_limits.h"
#include "config/robot.h"
#include "yaml/reader.h"

// The parts of a robot configuration, each read by a function of its own.
namespace cia402::config {

/// What the profile of a drive says; both nullptr where it has problems.
struct SharedFamily {
  std::shared_ptr<const drive::DriveProfile> drive;
  std::shared_ptr<const canopen::DeviceProfile> device;
};

/// An axis, and the device that it sits in, while they are read.
struct AxisDraft {
  drive::AxisConfig axis;
  canopen::DeviceConfig device;
  bool first = true;  ///< of those in the device, which reads what is the device's

  canopen::PdoSet& pdos() { return device.axes[axis.device_axis]; }
  const canopen::PdoSet& pdos() const { return device.axes[axis.device_axis]; }
};

/// An EDS or DCF that was read.
struct SharedEds {
  std::shared_ptr<const fieldbus::DeviceDescription> description;
  std::shared_ptr<const canopen::EdsInfo> info;
};

/// Reads drive profiles, each file once.
class ProfileCache {
 public:
  ProfileCache(const ProfileLookup& lookup, Problems& problems)
      : lookup_(lookup), problems_(problems) {}
  /// Empty (and problems) if there is no valid profile of that name.
  SharedFamily get(const yaml::Value& name);

 private:
  const ProfileLookup& lookup_;
  Problems& problems_;
  std::map<std::string, SharedFamily> profiles_;
};

/// Reads EDS and DCF files; what is wrong in one becomes warnings, once a file.
class EdsFiles {
 public:
  explicit EdsFiles(const ProfileLookup& lookup) : lookup_(lookup) {}
  /// Empty (and problems) if there is none of that name.
  SharedEds get(const yaml::Value& name, canopen::NodeId node_id, RobotConfig& robot);

 private:
  const ProfileLookup& lookup_;
  std::set<std::string> told_;
};

/// What the axes of a robot share while they are read.
struct AxisReading {
  ProfileCache profiles;
  EdsFiles eds;
  std::map<canopen::NodeId, unsigned> axes_of;  ///< how many the file has of a node
  DescribedLimits described;
  std::set<std::string> coupled;  ///< axes in a coupling
  /// Of each device (index) what its first axis says of it: key to YAML.
  std::map<std::size_t, std::map<std::string, std::string>> device_keys;
};

/// `axis` with everything that only `defaults` has added under it, mappings key by key.
YAML::Node mergeDefaults(const YAML::Node& defaults, const YAML::Node& axis);
/// Problems of what an axis took from `defaults` get the path "defaults/..." and are told once.
void nameDefaults(const YAML::Node& tree, const Problems& from, Problems& to);

void readBus(const yaml::Value& value, BusConfig& bus, bool& counter_given);
void readRecorder(const yaml::Value& value, RecorderConfig& recorder);
/// Reads one axis with its frame and simulation into `robot`.
void readAxis(const std::string& name, const yaml::Value& value, AxisReading& reading,
              RobotConfig& robot);

/// Reads `node_id` and `device_axis`, and finds the device that the axis sits in: a new one, or
/// that of an axis before.
void readPlace(yaml::Section& section, AxisDraft& draft, const RobotConfig& robot);
/// The keys that say something of the device, which its first axis has; where a further one has
/// such a key, too, it must say the same. All of them count as read then.
void checkDeviceKeys(yaml::Section& section, const AxisDraft& draft, AxisReading& reading);

/// Reads `eds`, or takes that of the device's first axis, and widens the axis' profile by its
/// objects; checkEds() compares both.
void readEds(yaml::Section& section, AxisDraft& draft, EdsFiles& files, RobotConfig& robot);
void checkEds(yaml::Section& section, const AxisDraft& draft, RobotConfig& robot);

motion::JointLimits readLimits(const yaml::Value& value, drive::AxisGeometry::Type type);
/// @param profile of the drive, for the words of its methods; nullptr: it is not known
drive::HomingOptions readHoming(const yaml::Value& value, const drive::DriveProfile* profile);
/// `error_control`, `sdo`, `optional`, `boot` and the like.
void readNodeOptions(yaml::Section& section, canopen::DeviceConfig& device);
/// `trusted`: objects that may be written though the profile calls them doubtful.
void readTrusted(const yaml::Value& list, drive::AxisConfig& axis);
/// Refuses doubtful objects in `write`, and warns of those in PDOs that the user gave.
void checkDoubts(yaml::Section& section, const AxisDraft& draft, RobotConfig& robot);
/// `half_floats`: how floats of 16 bits are encoded. @pre the drive's profile was read
void readHalfFloatKey(yaml::Section& section, AxisDraft& draft);
/// The floats of the axis that its node may have in 16 bits.
void addHalfFloats(const drive::AxisConfig& axis, const canopen::DeviceConfig& device,
                   canopen::NodeConfig& node);
/// What `error_control` means together with profile and bus; `section` is the axis.
void checkErrorControl(yaml::Section& section, const AxisDraft& draft, const RobotConfig& robot);
/// How master and drive notice each other's loss; zero: not at all.
struct ErrorControlPlan {
  canopen::ErrorControl kind = canopen::ErrorControl::none;
  Duration period{0}, timeout{0}, master_timeout{0};
};
ErrorControlPlan planErrorControl(const BusConfig& bus, const canopen::DeviceConfig& device);
/// COB-IDs of `sdo` that somebody else has become problems.
void checkSdoChannels(const canopen::MasterConfig& master, Problems& problems);
void readIdentity(const yaml::Value& value, canopen::DeviceConfig& device);
/// `true`, or a mapping; the numbers that it leaves out are those of `identity`, which gets those
/// that it lacks: what LSS selects is also what the boot expects.
void readLss(const yaml::Value& value, canopen::DeviceConfig& device, const RobotConfig& robot);
void readParameters(const yaml::Value& value, drive::AxisConfig& axis);
/// `feed_forward` of an axis, before its PDOs are planned; and its check once they are.
void readFeedForward(yaml::Section& axis_section, drive::AxisConfig& axis);
void checkFeedForward(yaml::Section& axis_section, const drive::AxisConfig& axis);
/// The axis' `position_loop`, or the profile's, for the modes that it can be in.
void tunePositionLoop(yaml::Section& section, drive::AxisConfig& axis);
/// The axis' `set_point_stream`, or the profile's. @pre its PDOs are chosen
void tuneSetPointStream(yaml::Section& section, drive::AxisConfig& axis);
/// The `frame` of an axis. A second parent of a frame, or a ring of frames, is refused.
void readFrame(const yaml::Value& value, const std::string& joint, RobotConfig& robot);
/// `static_frames` and `publish_tf`. @pre the axes were read
void readTf(yaml::Section& root, RobotConfig& robot);
SimulationConfig readSimulation(const yaml::Value& value);

/// Chooses the PDO mapping: the axis' `pdos`, the profile's, or one made for its modes.
/// @return false if there is none; the problem is told.
/// @param axes how many axes the device has that it sits in
bool choosePdos(yaml::Section& section, AxisDraft& draft, RobotConfig& robot, unsigned axes);

/// Plans what was planned once more, for another cycle; the same objects find room then, but for
/// what travels only because there was room.
void planAgain(RobotConfig& robot, Duration cycle);
/// Plans anew without what travels only because there was room.
void leaveRiders(RobotConfig& robot);

/// What the axis' keys mean together with its profile, which it has; `section` is the axis.
void checkAxis(yaml::Section& section, const AxisDraft& draft, RobotConfig& robot);

/// The names in the list `key`, each once. @param known those that there are; empty: any.
/// @param what they are, for messages
std::vector<std::string> readNames(yaml::Section& section, const std::string& key,
                                   const std::vector<std::string>& known, const char* what);
/// `couplings`, with the frames of their joints. @pre the axes were read
void readCouplings(const yaml::Value& value, const DescribedLimits& described, RobotConfig& robot);
void readGroups(const yaml::Value& value, RobotConfig& robot);
/// The group `joints` of all joints that can follow a stream of positions.
void addDefaultGroup(RobotConfig& robot);
/// Names of all joints: of axes without a coupling, and of the couplings.
std::vector<std::string> jointNames(const RobotConfig& robot);

/// Chooses the SYNC counter and checks the period against what the drives take.
void checkSync(const yaml::Value& bus_section, bool counter_given, RobotConfig& robot);
void checkBusLoad(const yaml::Value& bus_section, RobotConfig& robot, Problems& problems);

/// True for names that can stand in a topic: a letter, then letters, digits and underscores.
bool isGraphName(const std::string& name);

}  // namespace cia402::config
