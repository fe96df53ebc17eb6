// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/common/time.h"
#include "drive/profile/bit_fields.h"
#include "drive/profile/disabling.h"
#include "drive/profile/error_texts.h"
#include "drive/profile/fault_reset.h"
#include "drive/profile/handover.h"
#include "drive/profile/io.h"
#include "drive/profile/number_texts.h"
#include "drive/profile/object_range.h"
#include "drive/profile/offsets.h"
#include "drive/profile/parameter_names.h"
#include "drive/profile/parameter_recipes.h"
#include "drive/profile/position_loop.h"
#include "drive/profile/set_point_stream.h"
#include "drive/profile/setting_check.h"
#include "drive/profile/supervision.h"
#include "drive/profile/timing.h"
#include "drive/profile/units.h"
#include "fieldbus/float_codec.h"
#include "fieldbus/object.h"

namespace cia402::drive {

using fieldbus::DataType;
using fieldbus::Encoding;
using fieldbus::ObjectId;

/// Why an object must not be written while the axis may move: it shifts the drive's coordinates, or
/// holds its calibration. Each word says what there is for people to do instead.
enum class CoordinateMark : std::uint8_t {
  none,                ///< an object like others
  set_position,        ///< the service of that name declares where the joint stands
  home,                ///< homing finds the zero; home offsets
  restore_parameters,  ///< the service of that name; what it restores may hold all of it
  configuration,       ///< factors, gears, polarity: `write` of the axis and its geometry
  calibration,         ///< of motor and encoder; nothing but the maker's own way
};

/// A named object of the drive family.
struct ObjectSpec {
  std::string name;  ///< "target_position"; the fixed names are listed in docs/drive_profiles.md
  ObjectId id;
  DataType type = DataType::uint32;
  Encoding encoding = Encoding::integer;
  Quantity quantity = Quantity::none;
  double factor = 1.0;  ///< further factor: device value = factor * value in the profile's unit
  std::optional<UnitSpec> unit;  ///< of this object alone; absent: the profile's for the quantity
  /// What the object takes of all numbers of its type, in the drive's own numbers.
  struct Range {
    double low = 0.0, high = 0.0;
    bool holds(double number) const { return number >= low && number <= high; }
  };
  std::optional<Range> range;
  NumberTexts words;           ///< what single numbers of it mean
  std::string fields;          ///< of DriveProfile::bit_fields, what its bits say; empty: nothing
  bool when_disabled = false;  ///< services write it only while the axis is disabled and stands
  /// The drive may hold it in up to so many bits, which it says itself; 0: in those of its type.
  unsigned widest = 0;
  std::string high;  ///< object with the upper 32 bits of it, which are read together; or empty
  bool readable = true;
  bool writable = true;
  bool rpdo = false;                         ///< may be mapped into an RPDO
  bool tpdo = false;                         ///< may be mapped into a TPDO
  std::optional<std::uint8_t> transmission;  ///< type that an RPDO with it must have; absent: any
  std::string doubt;                  ///< why it may not be mappable so, told to whoever maps it
  bool from_eds = false;              ///< the axis' EDS names it, the profile does not
  std::vector<std::string> eds_keys;  ///< further names, from the EDS (fieldbus::nameKey())

  /// Whether a number with these bits is within `range`; so is every one where there is none.
  bool takes(std::uint64_t raw) const;
  /// "0 to 120", of `range`.
  std::string rangeText() const;
};

/// What a mode controls, for everything above the drive that does not care for mode numbers. The
/// table of kinds is in drive/modes/mode_control.cpp.
enum class ControlKind : std::uint8_t { position, velocity, torque, homing };
/// Their words in a profile, in the order of ControlKind: "position".
std::vector<std::string> controlKindWords();
/// What the target of a mode of this kind measures; none: it has no target.
Quantity targetQuantity(ControlKind kind);

/// What brings an axis to rest while its drive stays in operation.
enum class StopBy : std::uint8_t {
  set_points,  ///< they are ramped to rest; where the drive plans, it gets the nearest place to
               ///< stand
  halt,        ///< controlword bit 8
  quick_stop,  ///< nothing else brakes in this mode: the drive's own ramp, after which it switches
               ///< off or holds as 605Ah says
  mode,        ///< another mode brakes, ModeSpec::stop_mode: it begins at the measured velocity,
               ///< which is ramped to 0, and holds that until the axis is enabled anew
};

/// A write by profile name: value in the object's unit system (SI after conversion) or raw.
/// drive/profile/named_write.h turns it into a number for one axis.
struct NamedWrite {
  std::string object;  ///< name in the profile, or "6065:00"
  /// In SI units of the joint if the object has a quantity; infinity: the most that it holds.
  std::optional<double> value;
  std::optional<std::int64_t> raw;  ///< as it is
  /// A value of the configuration instead: "limits.lower", "limits.upper" (the one that is the
  /// smaller or larger number in the drive), "limits.velocity", "limits.acceleration",
  /// "limits.jerk", "limits.effort", "sync_period.value", "sync_period.exponent", "sync_period.ms",
  /// "homing.method",
  /// "homing.search_velocity", "homing.zero_velocity", "homing.acceleration", "homing.offset",
  /// "quick_stop.hold" (the first of quick_stop_holds, where the axis is to hold); or the name of a
  /// readable object, which is read and copied as it is. Where the configuration
  /// does not name it, `value` or `raw` is taken; without these the write is skipped.
  std::string from;
  double times = 1.0;    ///< the configuration's value is multiplied by this
  std::string if_given;  ///< a value of the configuration, as `from`: without it nothing is written
  std::optional<DataType> type;  ///< of an object by index that the profile does not name
  /// A limit of the position that counts in the drive's coordinates: written while these are known
  /// to be the joint's, and open (the widest number) while they are not. See
  /// drive/axis/position_limits.
  bool when_homed = false;
  bool optional = false;     ///< an abort is noted, not an error
  bool before_pdos = false;  ///< at boot; else when the PDOs are set up
};

/// One mode of operation of the family.
struct ModeSpec {
  std::string name;  ///< canonical logical name ("cyclic_position") or vendor name
  int value = 0;     ///< for 6060h
  ControlKind kind = ControlKind::position;
  bool cyclic = false;         ///< follows a stream of set-points (trajectory groups may use it)
  std::string target;          ///< name of the target object; empty for homing
  Handover handover;           ///< of positions, where the drive plans its way
  std::optional<StopBy> stop;  ///< absent: by the kind of mode, see stopBy()
  std::string stop_mode;       ///< with StopBy::mode: a cyclic velocity mode's name
  std::uint16_t controlword_bits = 0;  ///< held while the mode is active in Operation enabled
  /// They are held until the drive has left Operation enabled and Quick stop active, too: without
  /// them it may not slow down.
  bool bits_while_stopping = false;
  std::optional<PositionLoop>
      position_loop;  ///< positions by velocities: `target` is one; cyclic positions only
  /// Positions by set-points of profile position mode; cyclic positions with a handover only.
  std::optional<SetPointStream> set_point_stream;
  OffsetObjects offsets;
  /// A drive that hears nothing more keeps moving, or pushing, as it was told last.
  bool runsOn() const { return kind != ControlKind::position || position_loop.has_value(); }
  unsigned stoppingBits() const { return bits_while_stopping ? controlword_bits : 0u; }
  std::optional<int> target_reached_bit, following_error_bit, set_point_acknowledge_bit,
      speed_zero_bit, homing_attained_bit, homing_error_bit, follows_command_bit;
  /// Before the mode is entered, beside the cycle. What is an output, too, must be held in the
  /// process image while the mode is active, or the next cycle would undo it (a velocity limit in
  /// the velocity target of a vendor's position mode).
  std::vector<NamedWrite> entry_writes;
  std::vector<std::string> mapped;  ///< objects of these that shall travel in an RPDO
};

/// How a family takes another mode of operation (6060h), and shows it (6061h).
struct ModeChange {
  /// 6060h, or what goes with a mode, is refused while the power stage is on: to switch the mode
  /// the axis is disabled and enabled again.
  bool needs_disabling = false;
  /// 6061h shows the mode in operation enabled only: before, it shows another one or 0.
  bool shown_when_enabled = false;
  /// What is commanded while disabled is forgotten, and is commanded once more when enabled.
  enum class Again : std::uint8_t {
    never,
    same,          ///< the mode once more
    through_zero,  ///< first mode 0: what does not change is not looked at
  };
  Again again = Again::never;
  bool while_halted = true;  ///< else the halt bit (controlword bit 8) is in its way
  /// A change that the drive does not stand while enabled.
  struct Detour {
    std::string from, to;  ///< canonical names
    std::string through;   ///< the mode that goes between them; empty: the axis is disabled for it
  };
  std::vector<Detour> detours;
  /// @return nullptr: there is none
  const Detour* detour(const std::string& from, const std::string& to) const;
};

/// One way in which a family finds its zero.
struct HomingMethod {
  std::string text;   ///< in words: "home switch from the positive side, index pulse on it"
  bool moves = true;  ///< false: the present position is home, so that it is over at once
  /// A rising edge of this bit makes the present position the drive's zero; nothing else is told to
  /// it, and it is done while the axis is disabled.
  std::optional<ObjectBit> edge;
};

/// Does a method of this number move the axis by CiA 402-2 (6098h)? 35 and 37 do not.
bool movesByStandard(int method);

/// How the family finds its zero.
struct HomingSpec {
  /// By number (6098h, CiA 402-2) those of the drive's own homing mode; without one: the present
  /// position is declared to be the offset, and nothing moves. Empty: the family knows no homing.
  std::map<std::optional<int>, HomingMethod> methods;
  bool needs_zero_attained_before_start = false;
  std::vector<NamedWrite> writes;  ///< homing parameters, `from` the axis' homing options
};

/// What a family calls the bits of its statusword that CiA 402-2 leaves open, or uses otherwise, by
/// their numbers; empty: as the standard has it.
using StatusWords = std::array<std::string, 16>;

/// Position counts of a motor turn by the drive's own settings: the product of some objects over
/// that of others, by their names. Empty: the drive has no such objects.
struct CountsRule {
  std::vector<std::string> times, over;
  /// times[0] is the encoder's; times[1] and over[0] can be set to fit it (`adjust`).
  bool adjustable = false;
};

/// A drive family as data: what it is as a drive, whatever bus it hangs on. With what it is as a
/// device on the bus it makes a config::DriveFamily, which is loaded from
/// config/drives/<name>.yaml; documented in docs/drive_profiles.md. No code anywhere asks for
/// `name`.
struct DriveProfile {
  std::string name, description;
  std::uint16_t offset =
      0;  ///< of the objects of its axis from those of axis 0, see ofDeviceAxis()
  Units units;
  UnitSystems unit_systems;
  bool output_shaft = false;  ///< units count at the joint's side of the gear
  std::vector<ObjectSpec> objects;
  std::map<std::string, BitFields> bit_fields;  ///< by the names that objects call them by
  /// How numbers sit in objects that have no name, or a name without an encoding of its own.
  ObjectRanges<Encoding> encodings;
  /// Objects that shift coordinates or hold calibration, besides those of the standard.
  ObjectRanges<CoordinateMark> coordinates;
  /// What the maker's manual leaves open of an object: it is written for those alone who trust it
  /// (AxisConfig::trusted).
  ObjectRanges<std::string> doubtful;
  ObjectRanges<bool> after_power;  ///< what is written there counts once the power was off and on
  std::vector<ModeSpec> modes;
  HomingSpec homing;
  bool halt_supported = true;
  Disabling disabling;
  ModeChange mode_change;
  FaultReset fault_reset;
  bool reads_back = false;  ///< what is written is read again and compared
  StatusWords status_words;
  bool has_warning_bit = true;  ///< statusword bit 7 is a warning
  bool warning_stops = false;   ///< a warning makes the drive stop like a fault
  std::optional<ErrorText::Reaction> fault_reaction;  ///< of faults that have none of their own
  std::vector<int> quick_stop_holds;      ///< values of 605Ah after which quick stop stays active
  std::vector<NamedWrite> startup;        ///< at every boot
  std::vector<NamedWrite> before_enable;  ///< each time before enabling
  std::vector<SettingCheck> checks;       ///< what the drive must be set to, or say
  bool absent_settings_pass = false;      ///< what it does not have is told, and refuses nothing
  Supervision supervision;
  std::vector<std::string> may_be_cut;  ///< objects that are compared with what was written
  CountsRule counts_rule;               ///< compared with counts_per_turn before enabling
  std::string rated_torque;             ///< object that holds that of the motor, in N m; or empty
  std::string not_ready_reason;  ///< object whose words say why it cannot be enabled; or empty
  std::optional<int> homed_bit;  ///< of the statusword: the drive knows its home
  std::vector<std::string> default_modes;  ///< an axis can switch to; empty: all
  std::vector<std::string> feedback;  ///< in the cycle where there is room, most important first
  std::vector<std::string> feedback_if_room;  ///< only with what travels for something else
  std::vector<std::string>
      signals;  ///< objects that are shown besides; asked for where they do not come in the cycle
  std::map<std::string, DigitalOutput> outputs;  ///< by what people call them
  std::map<std::string, DigitalInput> inputs;
  std::optional<TouchProbes> touch_probes;  ///< nothing: the family has none
  using Timing = DriveTiming;
  Timing timing;
  /// Which sub-indices of 1010h and 1011h save and restore parameters: 1 all, 2 communication, 3
  /// application, 4.. the maker's.
  struct Parameters {
    std::vector<std::uint8_t> save{1}, restore{1};
    Duration timeout{std::chrono::seconds(10)};  ///< for the drive to confirm one
    bool power_cycle_after_save = false;         ///< it takes no enabling before
    ParameterRecipes recipes;
  } parameters;
  std::map<std::uint16_t, ErrorText> errors;
  std::uint16_t error_bits = 0;  ///< each of these is a code, which may stand beside another one
  std::map<std::uint16_t, WarningText> warnings;  ///< where they are no errors, or other ones
  ErrorDetails error_details;
  AlarmMemory alarm_memory;
  FaultObjects fault_memory;
  ParameterNames parameter_names;
  std::string eds;  ///< file whose objects were added, for messages; empty: none

  /// By the profile's name, or by a name of the EDS without regard to case and blanks.
  const ObjectSpec* find(const std::string& object_name) const;
  const ObjectSpec* find(ObjectId id) const;
  /// Where the axis has the object that CiA 402-2 gives axis 0. @param id 6000h to 67FFh
  ObjectId own(ObjectId id) const {
    return {static_cast<std::uint16_t>(id.index + offset), id.subindex};
  }
  /// "6841:00": where the axis has what CiA 402-2 has at `index`, for messages.
  std::string address(std::uint16_t index) const { return fieldbus::toString(own({index, 0})); }
  /// "statusword (6041:00) and position (6064:00)", without which an axis is not commanded.
  std::string feedbackObjects() const;
  /// How a number of this type sits in the object: as its name says, else as its place says where
  /// the type is as wide as that encoding.
  Encoding encodingOf(ObjectId id, DataType type) const;
  /// An object that nothing names but whose place says that it holds a float; nothing where it does
  /// not, or not in so many bytes.
  std::optional<ObjectSpec> unnamedFloat(ObjectId id, std::size_t bytes) const;
  /// What the profile says of an object, else the standard (standardMark()).
  CoordinateMark coordinateMark(ObjectId id) const;
  /// By logical name; nullptr if the family has no such mode.
  const ModeSpec* mode(const std::string& mode_name) const;
};

/// Axes that can sit in one device (CiA 402-2): axis 0 has its objects at 6000h to 67FFh, each
/// further one 800h behind the one before.
inline constexpr unsigned kDeviceAxes = 8;
inline constexpr std::uint16_t kFirstAxis = 0x6000, kAxisSize = 0x800;
/// The axis of a device that CiA 402-2 gives the object to; nothing for all others.
std::optional<unsigned> axisOf(ObjectId id);
/// The family as one axis of a device with several has it: what lies at 6000h to 67FFh is moved to
/// where that axis has it, in objects, writes, encodings and marks of coordinates. The maker's
/// objects stay where they are. @param axis 0 to 7
DriveProfile ofDeviceAxis(DriveProfile profile, unsigned axis);

/// Those of the profile's inputs in this object that are active: "home switch, probe 1"; empty:
/// none is. @param raw the object's value
std::string activeInputs(const DriveProfile& profile, const ObjectSpec& object, std::uint64_t raw);

/// The object that a name, or what objectId() takes, means; nullptr if the profile has none.
const ObjectSpec* findObject(const DriveProfile& profile, const std::string& name);
/// The object of an index ("6041:00"), or of a name that the maker gives a parameter ("H0A.40").
std::optional<ObjectId> objectId(const DriveProfile& profile, const std::string& text);
/// The same, and of a name of the profile; nothing where it is none of them.
std::optional<ObjectId> addressOf(const DriveProfile& profile, const std::string& name);
/// The encoding of ObjectRanges at this place, where the type is as wide; real32 is a float
/// anywhere.
Encoding encodingAt(const DriveProfile& profile, ObjectId id, DataType type);
/// "profile generic_cia402", and the EDS that it was widened by.
std::string sourceOf(const DriveProfile& profile);
/// Names of all objects, for suggestions.
std::vector<std::string> objectNames(const DriveProfile& profile);

/// What an error code reports as missing: by the profile, else fieldbus::kOutputsLate.
ErrorText::Missing missingByCode(const DriveProfile& profile, std::uint16_t code);

/// Of the objects of CiA 301 and CiA 402-2, those that shift coordinates. A profile may say
/// otherwise.
CoordinateMark standardMark(ObjectId id);

/// What stops the axis in `mode`: what the profile says; else the set-points in cyclic modes, and
/// the halt bit where the drive plans the motion and has one. Torques cannot be ramped to rest, so
/// without halt bit the quick stop must do it.
StopBy stopBy(const ModeSpec& mode, const DriveProfile& profile);

/// "csp" -> "cyclic_position"; names that are no short form come back as they are.
std::string canonicalModeName(const std::string& name);

}  // namespace cia402::drive
