// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canopen/device_config.h"
#include "drive/profile/profile.h"
#include "yaml/reader.h"

// The parts of a profile file, each read by a function of its own into the profile.
namespace cia402::config {

using drive::ControlKind;
using drive::CoordinateMark;
using drive::DriveProfile;
using drive::Encoding;
using drive::ErrorText;
using drive::Handover;
using drive::HomingSpec;
using drive::ModeChange;
using drive::ModeSpec;
using drive::NamedWrite;
using drive::ObjectSpec;
using drive::Quantity;
using drive::StopBy;
using drive::Units;
using drive::UnitSpec;
using fieldbus::DataType;
using fieldbus::ObjectId;

/// A unit such as "count/s" or "turn/min"; adds a problem if it does not suit the quantity.
std::optional<UnitSpec> readUnit(const yaml::Value& value, Quantity quantity);
void readUnits(const yaml::Value& value, DriveProfile& profile);
/// `unit_systems`. @pre units, objects and checks were read
void readUnitSystems(const yaml::Value& value, DriveProfile& profile);
/// `bit_fields`: what the bits of objects say.
void readBitFields(const yaml::Value& value, DriveProfile& profile);
/// @pre `bit_fields` were read
void readObjects(const yaml::Value& value, DriveProfile& profile);
void readEncodings(const yaml::Value& value, DriveProfile& profile);
void readCoordinates(const yaml::Value& value, DriveProfile& profile);
void readDoubtful(const yaml::Value& value, DriveProfile& profile);
/// `counts_after_power`: a list of ranges.
void readAfterPower(const yaml::Value& value, DriveProfile& profile);
void readModes(const yaml::Value& value, DriveProfile& profile);
void readHoming(const yaml::Value& value, DriveProfile& profile);
/// `reaction` of an entry of `errors`, and `fault_reaction`; nothing: it is not said.
std::optional<drive::ErrorText::Reaction> readFaultReaction(yaml::Section& section,
                                                            const char* key);
void readErrors(const yaml::Value& value, DriveProfile& profile);
/// @pre `statusword` was read
void readWarnings(const yaml::Value& value, DriveProfile& profile);
/// `error_details`. @pre objects were read
void readErrorDetails(const yaml::Value& value, DriveProfile& profile);
/// `alarm_memory`. @pre objects were read
void readAlarmMemory(const yaml::Value& value, DriveProfile& profile);
/// `parameters`: what saves and restores them. @pre objects were read
void readParameters(const yaml::Value& value, DriveProfile& profile);
/// `bus_settings`. @pre objects were read
void readBusSettings(const yaml::Value& value, const DriveProfile& profile,
                     canopen::BusSettings& settings);
/// `fault_memory`. @pre objects were read
void readFaultMemory(const yaml::Value& value, DriveProfile& profile);
/// `parameter_names`
void readParameterNames(const yaml::Value& value, DriveProfile& profile);
/// What numbers the parameters hold that `parameter_names` names: `whole`, `signed`, `steps`.
void readParameterNumbers(yaml::Section& section, DriveProfile& profile);
/// `checks`: what the drive must be set to, or say. @pre objects, modes and homing were read
void readChecks(const yaml::Value& list, DriveProfile& profile);
/// `disable_by`: one of the ways out of operation.
drive::Disabling readDisabling(const yaml::Value& value);

/// `statusword_needs`, `watches`, `fault_reads`. @pre objects were read
void readSupervision(yaml::Section& section, DriveProfile& profile);
/// The name of an object of the profile that holds a whole number and can be read; else a problem
/// and nullptr. @pre objects were read
const ObjectSpec* readSetting(const yaml::Value& value, const DriveProfile& profile);
/// A list of such names. @pre objects were read
std::vector<std::string> readSettings(const yaml::Value& list, const DriveProfile& profile);
/// `counts_rule`. @pre objects were read
void readCountsRule(const yaml::Value& value, DriveProfile& profile);
/// A key of `timing`: a number, or an object that holds it, and the most that it may say.
struct ToldTime {
  const char* key;
  Duration& time;
  std::string& object;
};
/// @pre objects were read
void readToldTime(yaml::Section& timing, const DriveProfile& profile, const ToldTime& told);

/// `{object: NAME, bit: N}` of a whole number that can be read and written. @pre objects were read
std::optional<drive::ObjectBit> readOutputBit(const yaml::Value& value,
                                              const DriveProfile& profile);
/// `outputs`, `inputs` and `touch_probe`. @pre objects were read
void readDigitalOutputs(const yaml::Value& value, DriveProfile& profile);
void readDigitalInputs(const yaml::Value& value, DriveProfile& profile);
void readTouchProbes(const yaml::Value& value, DriveProfile& profile);

/// A mapping of whole numbers to what they mean.
drive::NumberTexts readNumberTexts(const yaml::Value& value);
/// The words of `encoding`.
std::optional<Encoding> readEncodingWord(const yaml::Value& value);
/// "position"; the words of profiles.
std::optional<Quantity> readQuantity(const yaml::Value& value);

/// Smallest and largest whole number that an integer type holds (64 bits: as far as int64 goes).
std::int64_t lowestOf(DataType type);
std::int64_t highestOf(DataType type);

/// Where a list of writes stands; decides what its entries may do.
enum class WriteList : std::uint8_t {
  boot,     ///< fixed before the drive is asked anything: values, no copies of other objects
  running,  ///< done by the axis: may copy another object
};

/// `position_loop` of a mode or an axis. @param loop what holds where it does not say
drive::PositionLoop readPositionLoop(const yaml::Value& value, drive::PositionLoop loop);
/// `set_point_stream` of a mode or an axis. @param stream what holds where it does not say
/// @param profile of the mode, whose objects `speed` may name; nullptr: an axis does not say that
drive::SetPointStream readSetPointStream(const yaml::Value& value, drive::SetPointStream stream,
                                         const DriveProfile* profile);

/// Reads a list of writes (docs/drive_profiles.md, "Writes"); what is wrong adds problems. By index
/// (`object: "6065:00"`) a value is the drive's own whole number; by name it is in SI units.
std::vector<NamedWrite> readWrites(const yaml::Value& list, const DriveProfile& profile,
                                   WriteList kind);

/// May two PDOs of one direction carry the same object?
enum class Sharing : std::uint8_t { refused, allowed };

/// Reads a PDO layout (docs/drive_profiles.md, "PDOs") against the objects and limits of a family.
std::vector<canopen::PdoLayout> readPdos(const yaml::Value& value, const DriveProfile& profile,
                                         const canopen::DeviceProfile& device,
                                         Sharing sharing = Sharing::refused);

/// The words of `from` and `if_given` that name values of the axis' configuration.
const std::vector<std::string>& configurationSources();

/// Reads a list of sub-indices of 1010h or 1011h into `subindices`, which keeps what it has if the
/// key is missing or wrong.
void readSubindices(yaml::Section& section, const std::string& key,
                    std::vector<std::uint8_t>& subindices);

/// Reads a list of the profile's modes; canonical names.
std::vector<std::string> readModeNames(const yaml::Value& list, const DriveProfile& profile);
/// Reads a list of objects that can be in a TPDO; their profile names.
std::vector<std::string> readFeedbackNames(const yaml::Value& list, const DriveProfile& profile);

/// Reads how a device of the family behaves on the bus: `identity`, `pdo_rules`, `sync`,
/// `heartbeat`, `nmt_reset_node`, `half_floats`, `pdos`. @param timing the section of that name, of
/// which it reads `boot`, `sdo` and `sdo_retries`. @param profile whose objects its PDOs map
void readDevice(yaml::Section& section, yaml::Section& timing, const DriveProfile& profile,
                canopen::DeviceProfile& device);
/// `half_floats`. @pre objects were read
void readHalfFloats(const yaml::Value& value, const DriveProfile& profile,
                    canopen::DeviceProfile& device);
/// One of the encodings of floats in 16 bits.
std::optional<Encoding> readHalfEncoding(const yaml::Value& value);
/// A time in seconds.
void readDuration(yaml::Section& section, const std::string& key, yaml::Range range,
                  Duration& target);

/// `profile` with the objects of an EDS: those that it does not name get the EDS' names and types
/// and count in device units; those that it does can be called by the EDS' names, too.
DriveProfile withEds(DriveProfile profile, const fieldbus::DeviceDescription& eds);

/// Where a profile and an EDS contradict each other. Each sentence names both sources.
struct EdsContradictions {
  std::vector<std::string> problems;  ///< another length: nothing can be sent
  std::vector<std::string> warnings;  ///< another sign, maker or PDO mapping, objects missing
};
/// @param pdos layout that is to be mapped.
EdsContradictions compareWithEds(const DriveProfile& profile, const canopen::DeviceConfig& device,
                                 const canopen::PdoSet& pdos,
                                 const fieldbus::DeviceDescription& eds);

}  // namespace cia402::config
