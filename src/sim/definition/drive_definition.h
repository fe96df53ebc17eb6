// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/definition/absolute_encoder.h"
#include "sim/definition/makers_own.h"
#include "sim/definition/memory.h"
#include "sim/definition/quirks.h"
#include "sim/definition/terminals.h"
#include "sim/device/device.h"
#include "sim/dictionary/template.h"
#include "sim/drive/drive.h"
#include "sim/drive/homing_route.h"
#include "sim/drive/motor.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// What a value of 6060h makes the drive do.
enum class ModeBehaviour : std::uint8_t {
  hold,  ///< no mode assigned: stands still
  profile_position,
  velocity,  ///< with 6042h ("vl")
  profile_velocity,
  profile_torque,
  homing,
  interpolated_position,
  cyclic_position,
  cyclic_velocity,
  cyclic_torque,
};

/// What statusword bit 12 means in a mode.
enum class Bit12 : std::uint8_t {
  none,
  acknowledge,
  started,  ///< as acknowledge, but it stays from the first set-point on
  zero_speed,
  follows,
  homing_attained,
  always,  ///< set whatever the axis does
};
/// What statusword bit 13 means in a mode.
enum class Bit13 : std::uint8_t { none, following_error, homing_error };

/// What a maker's statusword shows in a mode otherwise than CiA 402-2.
struct MakerBits {
  bool stopped = false;          ///< bit 8: halted, in a quick stop, or at a limit switch
  std::vector<Role> not_0;       ///< bit 14: one of these objects is 0
  bool waits_for_start = false;  ///< until a set-point or a search has begun bits 8, 10 to 15 are:
  std::uint16_t before_start = 0;
};

/// In which stops a torque mode only lets the torque go, by 6087h, and brakes nothing.
enum class StopsFade : std::uint8_t {
  never,
  ramps,   ///< halt and quick stop by a ramp; once the motor stands it is held
  always,  ///< halt, quick stop and disabling
};

/// A value of 6060h.
struct ModeDefinition {
  std::int64_t number = 0;
  ModeBehaviour behaviour = ModeBehaviour::hold;
  bool handshake = true;  ///< profile_position: new set-points by a rising controlword bit:
  unsigned set_point_bit = 4;
  Bit12 bit_12 = Bit12::none;
  Bit13 bit_13 = Bit13::none;
  bool target_reached = true;    ///< statusword bit 10 is used
  std::optional<Role> velocity;  ///< speed (limit) of the mode, none: only the maxima
  std::optional<Role> torque;    ///< torque limit of the mode
  StopsFade stops_fade = StopsFade::never;
  bool delayed = false;             ///< interpolated_position: a set-point begins one SYNC later
  std::int64_t queue = 1;           ///< profile_position: set-points that may wait for those before
  bool stop_empties_queue = false;  ///< whatever stops the motor takes those away
  bool replaces_queue = false;      ///< bit 5 counts where no more may wait, too
  MakerBits maker;
};

/// When position limits (607Dh) count, by the value of an object of the maker's own.
enum class LimitUse : std::uint8_t { off, on, homed };

/// Which of 607Bh and 607Dh limits positions.
enum class RangeUse : std::uint8_t {
  none,     ///< 607Dh alone
  farther,  ///< on each side the one that is farther from 0
  greater,  ///< on each side the greater number
};

/// How motion ends.
enum class Ramp : std::uint8_t {
  coast,          ///< power off at once
  dynamic_brake,  ///< the same, and the windings of the motor are shorted
  slow_down,      ///< 6084h
  quick_stop,     ///< 6085h
  limit,          ///< as hard as the torque limit allows
};

/// What a value of an option code does.
struct StopOption {
  Ramp ramp = Ramp::coast;
  bool hold = false;  ///< afterwards stay, position held
};

/// The values of an option code object (605Ah to 605Eh) and what they do.
struct OptionTable {
  std::int64_t fallback = 0;  ///< where the object does not exist
  std::map<std::int64_t, StopOption> options;
};

/// When what a touch probe has stored is no longer shown as such.
enum class ProbeForgets : std::uint8_t {
  disarmed,  ///< at once (CiA 402-2)
  armed,     ///< when it is armed anew
  never,     ///< only power or a reset takes it away
};

/// What the drive does with the loss of its master (6007h).
enum class ConnectionLoss : std::uint8_t { none, fault, disable_voltage, quick_stop };

/// An error that the drive can have.
struct FaultDefinition {
  std::string name;
  std::uint16_t code = 0;           ///< 603Fh and EMCY
  std::uint8_t error_register = 1;  ///< 1001h
  std::array<std::uint8_t, 5> vendor{};
  bool resettable = true;                      ///< false: only a power cycle helps, ...
  std::optional<fieldbus::ObjectId> reset_by;  ///< ... or a reset while this object is not 0
  bool warning = false;                        ///< statusword bit 7 instead of a fault
  bool holds = false;                          ///< a warning: the motor is halted until it is over
  Duration persists{0};          ///< the cause stays so long; a reset before is refused
  bool ends_by_itself = false;   ///< the drive resets it as soon as its cause is gone
  std::optional<Ramp> reaction;  ///< instead of 605Eh, e.g. coast where the stage is broken
  /// That by the number of an object; a number that is not listed leaves it to 605Eh.
  struct ReactionBy {
    fieldbus::ObjectId object;
    std::map<std::int64_t, Ramp> ramps;
  };
  std::optional<ReactionBy> reaction_by;
  bool voltage_lost = false;  ///< statusword bit 4 goes while the cause lasts
  std::int64_t details = 0;   ///< in the object of the role error_details
  /// Object whose number says what becomes of it: reaction (bits 24 to 31), resets itself (16 to
  /// 23), code. See AlarmWords.
  std::optional<fieldbus::ObjectId> word;
  bool tells = true;    ///< false: nothing happens but that the drive may remember it
  bool records = true;  ///< in 1003h
};

/// Where one of the past faults stands: the low byte of its code, and what was so when it came.
struct FaultRecordObjects {
  fieldbus::ObjectId code;
  std::map<fieldbus::ObjectId, fieldbus::ObjectId> copies;  ///< from the first into the second
};

/// What keeps the drive from being switched on, or lets the power go where it is, without a fault:
/// the main power is missing, a safety input is open. Injected by name.
struct ObstacleDefinition {
  std::string name;
  bool voltage = true;       ///< statusword bit 4 stays
  bool remote = true;        ///< statusword bit 9 stays
  std::int64_t reason = 0;   ///< in the object of the role not_ready_reason
  std::uint32_t inputs = 0;  ///< bits of the role digital_inputs that are 1 meanwhile
};

/// What homing mode does.
struct DriveHomingDefinition {
  std::vector<std::int64_t> methods;
  std::vector<std::int64_t> inert;             ///< taken, but their start does nothing
  std::map<std::int64_t, HomingRoute> routes;  ///< instead of those of the standard
  bool home_offset_is_zero_shift = false;      ///< 6064h at home = -607Ch instead of +607Ch
  bool returns = false;                        ///< moves back onto the home position
  bool stops_quickly_at_limits = false;        ///< by 6085h instead of by 609Ah
  bool stops_by_torque = false;        ///< what pushes is at a hard stop, whether it moves or not
  bool stop_torque_bounds = false;     ///< in a search for a hard stop nothing pushes harder
  bool offset_counts_at_once = false;  ///< 607Ch, once it has homed since its power came
  /// What the object of a terminal says where a switch is connected to it; a method whose switches
  /// are not at one terminal each is the fault `terminal_setup`. Empty: nobody looks.
  std::map<HomingInput, std::int64_t> terminal_functions;

  /// Of a method, by the maker or by the standard; nullptr where neither has it.
  const HomingRoute* route(std::int64_t method) const;
};

/// How the numbers of a quantity stand in their objects.
struct UnitScale {
  /// What of a turn the factor is multiplied with.
  enum class Per : std::uint8_t {
    unit,     ///< nothing
    count,    ///< AxisMechanics::counts_per_turn
    encoder,  ///< the object of the role encoder_resolution
    gear,     ///< the same, times gear_denominator over gear_numerator
  };
  Per per = Per::unit;
  double factor = 1.0;  ///< device units per internal unit
};

/// Numbers that an object of floats does not take.
struct FloatTraps {
  bool non_finite = false;  ///< NaN and infinity: fault "not_a_number"
  bool negative_zero = false;
};

/// What makes the corners of profiles round.
struct SCurveDefinition {
  std::int64_t number = 3;  ///< of 6086h
  double time = 0.0;        ///< s; 0: that of an acceleration by 60A4h
};

/// Its digital outputs.
struct OutputsDefinition {
  /// What the objects of the roles output_n_function say where 60FEh is shown, and where the axis
  /// tells something by an output.
  std::int64_t commanded = 0;
  std::map<std::int64_t, OutputFunction> functions;
  unsigned first = 16;  ///< bit of the first output in the role digital_outputs
};

/// See docs/simulated_drives.md for the file format.
struct DriveDefinition {
  std::string name;
  DictionaryTemplate dictionary;
  DeviceBehaviour communication;
  std::array<UnitScale, kQuantityCount> units;
  std::map<Role, UnitScale> units_of;  ///< of single objects, instead of their quantity's
  Encoding encoding = Encoding::integer;
  std::map<fieldbus::ObjectId, Encoding> encodings;
  std::map<Role, fieldbus::ObjectId> objects;  ///< instead of the standard's
  /// Bits of 607Eh that turn the sign of targets of that quantity.
  std::array<std::int64_t, kQuantityCount> polarity{};
  std::vector<MotorParameters> motors{MotorParameters()};  ///< one for each axis
  std::vector<ModeDefinition> modes;

  bool absolute_encoder = true;
  bool positions_wrap = true;      ///< else a target beyond the wrap is a whole range away
  bool enable_in_one_step = true;  ///< 0x0F in Ready to switch on: transitions 3 and 4 at once
  bool direct_enable = false;      ///< 0x07 and 0x0F work in Switch on disabled, too
  bool mode_change_while_enabled = true;
  bool stores_while_enabled = false;  ///< takes 1010h and 1011h then, too (else 0x08000022)
  bool resume_quick_stop_while_moving = true;
  bool halt = true;
  bool internal_limit_bit = true;
  bool warning_stops = false;         ///< a warning leads to the fault reaction
  bool follows_sync_period = false;   ///< csp interpolates over the SYNC period, not over 60C2h
  bool edges_while_enabling = false;  ///< those that come with 0x0F count
  bool brake_loses_commands = false;  ///< edges of the controlword while the brake opens are lost
  bool ramps_of_mode = false;         ///< in homing "slow down" goes by 609Ah
  /// In velocity mode controlword bit 5 = 0 locks the ramps of quick stop and disabling, too.
  bool locked_ramp_holds_stops = false;
  std::optional<std::uint16_t> homed_bit;  ///< mask in the statusword: home was found
  /// By the value of the object of the role sync_tolerance: the share of its period by which SYNC
  /// may be off in interpolated position before the fault `sync_error`; 0: anything.
  std::vector<double> sync_tolerances;
  SCurveDefinition s_curve;
  RangeUse range_use = RangeUse::none;
  std::vector<LimitUse> limit_uses;  ///< by the value of the role position_limits_use; empty: on
  std::vector<fieldbus::ObjectId> locked_while_enabled;
  DriveQuirks quirks;
  Duration initialisation{0};  ///< in Not ready to switch on

  OptionTable quick_stop, shutdown, disable_operation, halt_option, fault_reaction;

  DriveHomingDefinition homing;
  TerminalsDefinition terminals;
  AbsoluteEncoderDefinition absolute;
  ProbeForgets probe_forgets = ProbeForgets::disarmed;

  double enables_below = 0.0;  ///< turns/s; faster it raises `turning_at_enable`. 0: always
  bool following_error_is_fault = true;
  bool limit_switch_is_fault = false;
  /// A cyclic position further from the one before than so many times what the motor can turn
  /// meanwhile is the fault `position_step`; 0: none is.
  double position_step = 0.0;
  ConnectionLoss master_lost = ConnectionLoss::fault;  ///< where 6007h does not exist
  bool stops_outside_operational = true;
  FloatTraps float_traps;
  MakersOwnDefinition own;
  MemoryDefinition memory;

  OutputsDefinition outputs;

  std::vector<FaultDefinition> faults;
  std::vector<FaultRecordObjects>
      fault_records;  ///< what the maker keeps of them, the newest first
  std::vector<ObstacleDefinition> obstacles;

  /// 1 to 8. All else here says what every axis is, by the objects of axis 0.
  unsigned axisCount() const { return static_cast<unsigned>(motors.size()); }
  /// Both nullptr if there is none of that name.
  const ObstacleDefinition* obstacle(const std::string& obstacle_name) const;
  const FaultDefinition* fault(const std::string& fault_name) const;
  /// nullptr if 6060h cannot be this.
  const ModeDefinition* mode(std::int64_t number) const;
};

/// As loadDriveDefinition(path), with a mapping of further keys of such a file on top of it.
Result<std::shared_ptr<const DriveDefinition>> loadDriveDefinition(const std::string& path,
                                                                   const YAML::Node& changes);

}  // namespace cia402::sim
