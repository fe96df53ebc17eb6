// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

struct DriveDefinition;

/// What an object means to the drive, whatever its index. The standard's index is the default.
enum class Role : std::uint8_t {
  abort_connection_option,
  error_code,
  error_code_copy,  ///< vendor object: the same code
  controlword,
  statusword,
  vl_target_velocity,
  vl_velocity_demand,
  vl_minimum,
  vl_maximum,
  vl_acceleration_speed,
  vl_acceleration_time,
  vl_deceleration_speed,
  vl_deceleration_time,
  vl_quick_stop_speed,
  vl_quick_stop_time,
  quick_stop_option,
  shutdown_option,
  disable_operation_option,
  halt_option,
  fault_reaction_option,
  mode,
  mode_display,
  position_demand,
  position_internal,
  position_actual,
  following_error_window,
  following_error_timeout,
  position_window,
  position_window_time,
  velocity_demand,
  velocity_actual,
  velocity_window,
  velocity_window_time,
  velocity_threshold,
  velocity_threshold_time,
  target_torque,
  max_torque,
  torque_actual,
  current_actual,
  target_position,
  home_offset,
  position_range_minimum,
  position_range_maximum,
  position_minimum,
  position_maximum,
  max_profile_velocity,
  max_motor_speed,
  profile_velocity,
  profile_acceleration,
  profile_deceleration,
  quick_stop_deceleration,
  motion_profile_type,
  polarity,
  torque_slope,
  homing_method,
  homing_search_speed,
  homing_zero_speed,
  homing_acceleration,
  profile_jerk_1,
  profile_jerk_2,
  interpolation_target,
  interpolation_time,
  interpolation_exponent,
  max_acceleration,
  max_deceleration,
  position_offset,
  velocity_offset,
  torque_offset,
  touch_probe_function,
  touch_probe_status,
  touch_probe_1_rising,
  touch_probe_1_falling,
  touch_probe_2_rising,
  touch_probe_2_falling,
  touch_probe_1_rising_count,
  touch_probe_1_falling_count,
  touch_probe_2_rising_count,
  touch_probe_2_falling_count,
  positioning_option,
  following_error_actual,
  position_demand_internal,
  digital_inputs,
  digital_outputs,
  digital_outputs_mask,
  target_velocity,
  clear_errors,          ///< vendor object: a write that is not 0 resets faults
  save_zero,             ///< vendor object: the present position becomes 0
  homing_start,          ///< vendor object: 1 begins homing instead of controlword bit 4
  software_reset,        ///< vendor object: 1 starts the drive anew
  reversed,              ///< vendor object: 1: forward is the other way round, from power-on on
  brake_delay,           ///< vendor object: from operation enabled until commands count
  encoder_resolution,    ///< vendor object: encoder counts of a turn
  gear_numerator,        ///< vendor object: so many encoder counts are ...
  encoder_revolutions,   ///< vendor object: ... in so many turns, 1 where there is none
  gear_denominator,      ///< vendor object: ... so many position units
  sync_tolerance,        ///< vendor object: index into DriveDefinition::sync_tolerances
  position_limits_use,   ///< vendor object: index into DriveDefinition::limit_uses
  homing_stop_torque,    ///< vendor object: so hard the motor pushes at a hard stop ...
  homing_stop_time,      ///< vendor object: ... and for so long
  targets_dropped,       ///< object of a test: while it is not 0 cyclic targets are not followed
  homing_time_limit,     ///< vendor object: a longer search is the fault `homing_time`
  forward_torque_limit,  ///< vendor object, or 60E0h where the drive minds it
  reverse_torque_limit,  ///< the same in the other direction, 60E1h
  output_1_function,     ///< vendor object: what the terminal of bit 16 of 60FEh shows ...
  output_2_function,
  output_3_function,
  output_4_function,
  output_5_function,
  output_1_logic,  ///< vendor object: 0: low while what its function tells is so, else high
  output_2_logic,
  output_1_used,  ///< vendor object: 0: the terminal is an input
  output_2_used,
  outputs_by_parameter,  ///< vendor object: bit n: output n + 1 shows bit n of the next
  output_levels,
  outputs_offline,   ///< vendor object: bit n: output n + 1 is off while not operational
  homing_time_unit,  ///< vendor object: that limit counts in 1, 10, 100 units
  error_details,     ///< vendor object: more about the last error; 0: there is none
  not_ready_reason,  ///< vendor object: why it cannot be switched on; 0: it can
  alarm_select,      ///< vendor object: which of the past errors is shown, 0 the newest
  alarm_code,        ///< vendor object: the low half of its error_details ...
  alarm_time,        ///< vendor object: ... and when it came, since power-on
  emergency_stop,    ///< vendor object: 1 stops as a quick stop does
  input_1_function,  ///< vendor object: what the terminal is for; see `terminals` of homing
  input_2_function,
  input_3_function,
  input_4_function,
  input_5_function,
  limit_switch_action,   ///< vendor object: 0: as `limit_switch` says, 1: `limit_warning`
  home_offset_mode,      ///< vendor object: what 607Ch is for; see HomingMode
  torque_reached_base,   ///< vendor object: in torque modes bit 10 is set where the torque ...
  torque_reached_on,     ///< ... is above that by so much, ...
  torque_reached_off,    ///< ... until it is so near
  torque_ramp,           ///< vendor object: of torques that stream; 0: none ...
  torque_ramp_to_zero,   ///< ... and of those that end
  position_error_range,  ///< vendor object: a following error that is a fault at once ...
  position_error_off,    ///< ... unless this is 1
  brake_fitted,          ///< vendor object: 1: there is one, which closes when it is disabled
  brake_close_speed,     ///< vendor object: below that speed ...
  brake_close_time,      ///< ... or so long after the stop began
  brake_power_time,      ///< vendor object: where it stood then the power stays for so long
  rpm_units,  ///< vendor object: 1: speeds count in 0.01 rpm, ramps are the ms from 0 to 1000 rpm
  acceleration_clamp,  ///< vendor object: no profile or ramp accelerates more
  velocity_filter,     ///< vendor object: so much later the actual velocity is shown
  stall_error,         ///< vendor objects; see MotorWatch
  stall_speed,
  stall_time,
  maker_mode,  ///< vendor objects of MakerModes: 0: the modes of CiA 402
  step_amount,
  step_speed,
  maker_speed_source,
  maker_speed,
  maker_acceleration_time,  ///< ms from 0 to 1000/min
  maker_deceleration_time,
  pulse_width,  ///< %, as it is seen
  count,
};
inline constexpr std::size_t kRoleCount = static_cast<std::size_t>(Role::count);

/// What a number measures. Internally: turns, turns/s, turns/s^2, rated torques, seconds.
enum class Quantity : std::uint8_t {
  none,
  position,
  velocity,
  acceleration,
  torque,
  current,
  time,
  motor_speed,
  count,
};
inline constexpr std::size_t kQuantityCount = static_cast<std::size_t>(Quantity::count);

/// How a number stands in its object.
enum class Encoding : std::uint8_t {
  integer,
  float32,          ///< IEEE 754 bits in a 32-bit integer
  bfloat16,         ///< upper half of the float's bits in a 16-bit integer
  scaled_unsigned,  ///< 16 bits, unsigned, times 65535 give the float's bits
  scaled_signed,    ///< the same, signed
};

/// Name, object and quantity of a role.
struct RoleInfo {
  Role role;
  const char* name;
  fieldbus::ObjectId object;
  Quantity quantity;
};
/// What the standard says of a role.
const RoleInfo& roleInfo(Role role);
/// The role of that name.
std::optional<Role> findRole(std::string_view name);
/// The role whose standard object this is.
std::optional<Role> findRole(fieldbus::ObjectId object);

/// Decodes as the drive's firmware does. @return quiet NaN where the bits say so.
double decodeNumber(const Entry& entry, Encoding encoding);
/// Encodes; integers are rounded to nearest and wrap as the register would.
std::uint64_t encodeNumber(double value, const Entry& entry, Encoding encoding);

/// The drive's view on its object dictionary: values by role, in internal units. Reading an object
/// that does not exist gives the fallback; writing one does nothing.
class DriveValues {
 public:
  /// @param axis whose objects these are, 0 to 7.
  DriveValues(const DriveDefinition& definition, unsigned axis, ObjectDictionary& dictionary,
              double counts_per_turn);

  bool has(Role role) const { return slot(role).entry != nullptr; }
  /// A value in internal units.
  double get(Role role, double fallback) const {
    const Slot& s = slot(role);
    return s.entry == nullptr ? fallback : number(s);
  }
  /// Writes a value in internal units, rounded and wrapped as the register would.
  void set(Role role, double value) {
    if (const Slot& s = slot(role); s.entry != nullptr) setNumber(s, value);
  }
  /// The bare integer, without scale.
  std::int64_t raw(Role role, std::int64_t fallback) const {
    const Slot& s = slot(role);
    return s.entry == nullptr ? fallback : integer(s);
  }
  void setRaw(Role role, std::int64_t value) {
    const Slot& s = slot(role);
    if (s.entry != nullptr) s.entry->number = static_cast<std::uint64_t>(value) & s.bits;
  }
  /// All bits set: how the standard switches a window off (6065h, 6067h).
  bool allOnes(Role role) const {
    const Slot& s = slot(role);
    return s.entry != nullptr && s.encoding == Encoding::integer && s.entry->number == s.bits;
  }
  /// All that the object's numbers span, after which they begin anew; 0 for floats and where there
  /// is no such object.
  double range(Role role) const;
  /// What one of its numbers is, in internal units; 0 for floats and where there is no such object.
  double resolution(Role role) const {
    const Slot& s = slot(role);
    return s.entry == nullptr || s.encoding != Encoding::integer ? 0.0 : 1.0 / scale(s);
  }
  const Entry* entry(Role role) const { return slot(role).entry; }
  Encoding encoding(Role role) const { return slot(role).encoding; }

 private:
  struct Slot {
    Entry* entry = nullptr;
    double scale = 1.0;      ///< where objects of the drive scale it: times theirs
    std::uint64_t bits = 0;  ///< all bits of the number
    Encoding encoding = Encoding::integer;
    bool is_signed = false;
    bool per_encoder = false, geared = false;
    bool speed = false, ramp = false;  ///< Role::rpm_units changes it
  };
  double scale(const Slot& slot) const {
    if (slot.speed && inRpm()) return kRpmSpeeds;
    return slot.per_encoder ? slot.scale * countsPerUnit(slot) : slot.scale;
  }
  static constexpr double kRpmSpeeds = 6000.0;  ///< 0.01 rpm in a turn a second
  bool inRpm() const {
    const Slot& units = slot(Role::rpm_units);
    return units.entry != nullptr && units.entry->number == 1;
  }
  double countsPerUnit(const Slot& slot) const;
  double number(const Slot& slot) const;
  void setNumber(const Slot& slot, double value);
  static std::int64_t integer(const Slot& slot) {
    const std::uint64_t sign = slot.is_signed ? slot.bits ^ (slot.bits >> 1) : 0;
    return static_cast<std::int64_t>(((slot.entry->acting() & slot.bits) ^ sign) - sign);
  }
  const Slot& slot(Role role) const { return slots_[static_cast<std::size_t>(role)]; }

  std::array<Slot, kRoleCount> slots_;
  double counts_per_turn_;  ///< where no object says how many
};

}  // namespace cia402::sim
