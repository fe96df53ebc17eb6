// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/values.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sim/definition/drive_definition.h"
#include "sim/dictionary/axis_objects.h"

namespace cia402::sim {
namespace {

using R = Role;
using Q = Quantity;

// In the order of Role; indices of CiA 402-2; {0, 0}: no standard object.
constexpr RoleInfo kRoles[] = {
    {R::abort_connection_option, "abort_connection_option", {0x6007, 0}, Q::none},
    {R::error_code, "error_code", {0x603F, 0}, Q::none},
    {R::error_code_copy, "error_code_copy", {0, 0}, Q::none},
    {R::controlword, "controlword", {0x6040, 0}, Q::none},
    {R::statusword, "statusword", {0x6041, 0}, Q::none},
    {R::vl_target_velocity, "vl_target_velocity", {0x6042, 0}, Q::motor_speed},
    {R::vl_velocity_demand, "vl_velocity_demand", {0x6043, 0}, Q::motor_speed},
    {R::vl_minimum, "vl_minimum", {0x6046, 1}, Q::motor_speed},
    {R::vl_maximum, "vl_maximum", {0x6046, 2}, Q::motor_speed},
    {R::vl_acceleration_speed, "vl_acceleration_speed", {0x6048, 1}, Q::motor_speed},
    {R::vl_acceleration_time, "vl_acceleration_time", {0x6048, 2}, Q::none},
    {R::vl_deceleration_speed, "vl_deceleration_speed", {0x6049, 1}, Q::motor_speed},
    {R::vl_deceleration_time, "vl_deceleration_time", {0x6049, 2}, Q::none},
    {R::vl_quick_stop_speed, "vl_quick_stop_speed", {0x604A, 1}, Q::motor_speed},
    {R::vl_quick_stop_time, "vl_quick_stop_time", {0x604A, 2}, Q::none},
    {R::quick_stop_option, "quick_stop_option", {0x605A, 0}, Q::none},
    {R::shutdown_option, "shutdown_option", {0x605B, 0}, Q::none},
    {R::disable_operation_option, "disable_operation_option", {0x605C, 0}, Q::none},
    {R::halt_option, "halt_option", {0x605D, 0}, Q::none},
    {R::fault_reaction_option, "fault_reaction_option", {0x605E, 0}, Q::none},
    {R::mode, "mode", {0x6060, 0}, Q::none},
    {R::mode_display, "mode_display", {0x6061, 0}, Q::none},
    {R::position_demand, "position_demand", {0x6062, 0}, Q::position},
    {R::position_internal, "position_internal", {0x6063, 0}, Q::position},
    {R::position_actual, "position_actual", {0x6064, 0}, Q::position},
    {R::following_error_window, "following_error_window", {0x6065, 0}, Q::position},
    {R::following_error_timeout, "following_error_timeout", {0x6066, 0}, Q::time},
    {R::position_window, "position_window", {0x6067, 0}, Q::position},
    {R::position_window_time, "position_window_time", {0x6068, 0}, Q::time},
    {R::velocity_demand, "velocity_demand", {0x606B, 0}, Q::velocity},
    {R::velocity_actual, "velocity_actual", {0x606C, 0}, Q::velocity},
    {R::velocity_window, "velocity_window", {0x606D, 0}, Q::velocity},
    {R::velocity_window_time, "velocity_window_time", {0x606E, 0}, Q::time},
    {R::velocity_threshold, "velocity_threshold", {0x606F, 0}, Q::velocity},
    {R::velocity_threshold_time, "velocity_threshold_time", {0x6070, 0}, Q::time},
    {R::target_torque, "target_torque", {0x6071, 0}, Q::torque},
    {R::max_torque, "max_torque", {0x6072, 0}, Q::torque},
    {R::torque_actual, "torque_actual", {0x6077, 0}, Q::torque},
    {R::current_actual, "current_actual", {0x6078, 0}, Q::current},
    {R::target_position, "target_position", {0x607A, 0}, Q::position},
    {R::home_offset, "home_offset", {0x607C, 0}, Q::position},
    {R::position_range_minimum, "position_range_minimum", {0x607B, 1}, Q::position},
    {R::position_range_maximum, "position_range_maximum", {0x607B, 2}, Q::position},
    {R::position_minimum, "position_minimum", {0x607D, 1}, Q::position},
    {R::position_maximum, "position_maximum", {0x607D, 2}, Q::position},
    {R::max_profile_velocity, "max_profile_velocity", {0x607F, 0}, Q::velocity},
    {R::max_motor_speed, "max_motor_speed", {0x6080, 0}, Q::motor_speed},
    {R::profile_velocity, "profile_velocity", {0x6081, 0}, Q::velocity},
    {R::profile_acceleration, "profile_acceleration", {0x6083, 0}, Q::acceleration},
    {R::profile_deceleration, "profile_deceleration", {0x6084, 0}, Q::acceleration},
    {R::quick_stop_deceleration, "quick_stop_deceleration", {0x6085, 0}, Q::acceleration},
    {R::motion_profile_type, "motion_profile_type", {0x6086, 0}, Q::none},
    {R::polarity, "polarity", {0x607E, 0}, Q::none},
    {R::torque_slope, "torque_slope", {0x6087, 0}, Q::torque},
    {R::homing_method, "homing_method", {0x6098, 0}, Q::none},
    {R::homing_search_speed, "homing_search_speed", {0x6099, 1}, Q::velocity},
    {R::homing_zero_speed, "homing_zero_speed", {0x6099, 2}, Q::velocity},
    {R::homing_acceleration, "homing_acceleration", {0x609A, 0}, Q::acceleration},
    {R::profile_jerk_1, "profile_jerk_1", {0x60A4, 1}, Q::acceleration},
    {R::profile_jerk_2, "profile_jerk_2", {0x60A4, 2}, Q::acceleration},
    {R::interpolation_target, "interpolation_target", {0x60C1, 1}, Q::position},
    {R::interpolation_time, "interpolation_time", {0x60C2, 1}, Q::none},
    {R::interpolation_exponent, "interpolation_exponent", {0x60C2, 2}, Q::none},
    {R::max_acceleration, "max_acceleration", {0x60C5, 0}, Q::acceleration},
    {R::max_deceleration, "max_deceleration", {0x60C6, 0}, Q::acceleration},
    {R::position_offset, "position_offset", {0x60B0, 0}, Q::position},
    {R::velocity_offset, "velocity_offset", {0x60B1, 0}, Q::velocity},
    {R::torque_offset, "torque_offset", {0x60B2, 0}, Q::torque},
    {R::touch_probe_function, "touch_probe_function", {0x60B8, 0}, Q::none},
    {R::touch_probe_status, "touch_probe_status", {0x60B9, 0}, Q::none},
    {R::touch_probe_1_rising, "touch_probe_1_rising", {0x60BA, 0}, Q::position},
    {R::touch_probe_1_falling, "touch_probe_1_falling", {0x60BB, 0}, Q::position},
    {R::touch_probe_2_rising, "touch_probe_2_rising", {0x60BC, 0}, Q::position},
    {R::touch_probe_2_falling, "touch_probe_2_falling", {0x60BD, 0}, Q::position},
    {R::touch_probe_1_rising_count, "touch_probe_1_rising_count", {0x60D5, 0}, Q::none},
    {R::touch_probe_1_falling_count, "touch_probe_1_falling_count", {0x60D6, 0}, Q::none},
    {R::touch_probe_2_rising_count, "touch_probe_2_rising_count", {0x60D7, 0}, Q::none},
    {R::touch_probe_2_falling_count, "touch_probe_2_falling_count", {0x60D8, 0}, Q::none},
    {R::positioning_option, "positioning_option", {0x60F2, 0}, Q::none},
    {R::following_error_actual, "following_error_actual", {0x60F4, 0}, Q::position},
    {R::position_demand_internal, "position_demand_internal", {0x60FC, 0}, Q::position},
    {R::digital_inputs, "digital_inputs", {0x60FD, 0}, Q::none},
    {R::digital_outputs, "digital_outputs", {0x60FE, 1}, Q::none},
    {R::digital_outputs_mask, "digital_outputs_mask", {0x60FE, 2}, Q::none},
    {R::target_velocity, "target_velocity", {0x60FF, 0}, Q::velocity},
    {R::clear_errors, "clear_errors", {0, 0}, Q::none},
    {R::save_zero, "save_zero", {0, 0}, Q::none},
    {R::homing_start, "homing_start", {0, 0}, Q::none},
    {R::software_reset, "software_reset", {0, 0}, Q::none},
    {R::reversed, "reversed", {0, 0}, Q::none},
    {R::brake_delay, "brake_delay", {0, 0}, Q::time},
    {R::encoder_resolution, "encoder_resolution", {0, 0}, Q::none},
    {R::gear_numerator, "gear_numerator", {0, 0}, Q::none},
    {R::encoder_revolutions, "encoder_revolutions", {0, 0}, Q::none},
    {R::gear_denominator, "gear_denominator", {0, 0}, Q::none},
    {R::sync_tolerance, "sync_tolerance", {0, 0}, Q::none},
    {R::position_limits_use, "position_limits_use", {0, 0}, Q::none},
    {R::homing_stop_torque, "homing_stop_torque", {0, 0}, Q::torque},
    {R::homing_stop_time, "homing_stop_time", {0, 0}, Q::time},
    {R::targets_dropped, "targets_dropped", {0, 0}, Q::none},
    {R::homing_time_limit, "homing_time_limit", {0, 0}, Q::time},
    {R::forward_torque_limit, "forward_torque_limit", {0, 0}, Q::torque},
    {R::reverse_torque_limit, "reverse_torque_limit", {0, 0}, Q::torque},
    {R::output_1_function, "output_1_function", {0, 0}, Q::none},
    {R::output_2_function, "output_2_function", {0, 0}, Q::none},
    {R::output_3_function, "output_3_function", {0, 0}, Q::none},
    {R::output_4_function, "output_4_function", {0, 0}, Q::none},
    {R::output_5_function, "output_5_function", {0, 0}, Q::none},
    {R::output_1_logic, "output_1_logic", {0, 0}, Q::none},
    {R::output_2_logic, "output_2_logic", {0, 0}, Q::none},
    {R::output_1_used, "output_1_used", {0, 0}, Q::none},
    {R::output_2_used, "output_2_used", {0, 0}, Q::none},
    {R::outputs_by_parameter, "outputs_by_parameter", {0, 0}, Q::none},
    {R::output_levels, "output_levels", {0, 0}, Q::none},
    {R::outputs_offline, "outputs_offline", {0, 0}, Q::none},
    {R::homing_time_unit, "homing_time_unit", {0, 0}, Q::none},
    {R::error_details, "error_details", {0, 0}, Q::none},
    {R::not_ready_reason, "not_ready_reason", {0, 0}, Q::none},
    {R::alarm_select, "alarm_select", {0, 0}, Q::none},
    {R::alarm_code, "alarm_code", {0, 0}, Q::none},
    {R::alarm_time, "alarm_time", {0, 0}, Q::time},
    {R::emergency_stop, "emergency_stop", {0, 0}, Q::none},
    {R::input_1_function, "input_1_function", {0, 0}, Q::none},
    {R::input_2_function, "input_2_function", {0, 0}, Q::none},
    {R::input_3_function, "input_3_function", {0, 0}, Q::none},
    {R::input_4_function, "input_4_function", {0, 0}, Q::none},
    {R::input_5_function, "input_5_function", {0, 0}, Q::none},
    {R::limit_switch_action, "limit_switch_action", {0, 0}, Q::none},
    {R::home_offset_mode, "home_offset_mode", {0, 0}, Q::none},
    {R::torque_reached_base, "torque_reached_base", {0, 0}, Q::torque},
    {R::torque_reached_on, "torque_reached_on", {0, 0}, Q::torque},
    {R::torque_reached_off, "torque_reached_off", {0, 0}, Q::torque},
    {R::torque_ramp, "torque_ramp", {0, 0}, Q::torque},
    {R::torque_ramp_to_zero, "torque_ramp_to_zero", {0, 0}, Q::torque},
    {R::position_error_range, "position_error_range", {0, 0}, Q::position},
    {R::position_error_off, "position_error_off", {0, 0}, Q::none},
    {R::brake_fitted, "brake_fitted", {0, 0}, Q::none},
    {R::brake_close_speed, "brake_close_speed", {0, 0}, Q::motor_speed},
    {R::brake_close_time, "brake_close_time", {0, 0}, Q::time},
    {R::brake_power_time, "brake_power_time", {0, 0}, Q::time},
    {R::rpm_units, "rpm_units", {0, 0}, Q::none},
    {R::acceleration_clamp, "acceleration_clamp", {0, 0}, Q::acceleration},
    {R::velocity_filter, "velocity_filter", {0, 0}, Q::time},
    {R::stall_error, "stall_error", {0, 0}, Q::none},
    {R::stall_speed, "stall_speed", {0, 0}, Q::motor_speed},
    {R::stall_time, "stall_time", {0, 0}, Q::time},
    {R::maker_mode, "maker_mode", {0, 0}, Q::none},
    {R::step_amount, "step_amount", {0, 0}, Q::position},
    {R::step_speed, "step_speed", {0, 0}, Q::motor_speed},
    {R::maker_speed_source, "maker_speed_source", {0, 0}, Q::none},
    {R::maker_speed, "maker_speed", {0, 0}, Q::motor_speed},
    {R::maker_acceleration_time, "maker_acceleration_time", {0, 0}, Q::none},
    {R::maker_deceleration_time, "maker_deceleration_time", {0, 0}, Q::none},
    {R::pulse_width, "pulse_width", {0, 0}, Q::none},
};
static_assert(sizeof(kRoles) / sizeof(kRoles[0]) == kRoleCount, "one line for each role");

double fromFloatBits(std::uint32_t bits) {
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof(value));
  return static_cast<double>(value);
}

std::uint32_t toFloatBits(double value) {
  const float single = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &single, sizeof(bits));
  return bits;
}

/// Halves away from zero, as std::llround(), which is a call.
inline std::uint64_t rounded(double value) {
  const double wrapped = std::fabs(value) < 9e18 ? value : 0.0;
  const auto whole = static_cast<std::int64_t>(wrapped);
  const double rest = wrapped - static_cast<double>(whole);
  return static_cast<std::uint64_t>(whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0));
}

std::uint64_t mask(const Entry& entry) {
  const unsigned width = widthBits(entry.type);
  return width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
}

}  // namespace

const RoleInfo& roleInfo(Role role) { return kRoles[static_cast<std::size_t>(role)]; }

std::optional<Role> findRole(std::string_view name) {
  for (const RoleInfo& info : kRoles) {
    if (name == info.name) return info.role;
  }
  return std::nullopt;
}

std::optional<Role> findRole(fieldbus::ObjectId object) {
  for (const RoleInfo& info : kRoles) {
    if (object == info.object && object.index != 0) return info.role;
  }
  return std::nullopt;
}

double decodeNumber(const Entry& entry, Encoding encoding) {
  const auto word = static_cast<std::uint32_t>(entry.number & 0xFFFFU);
  switch (encoding) {
    case Encoding::float32:
      return fromFloatBits(static_cast<std::uint32_t>(entry.number));
    case Encoding::bfloat16:
      return fromFloatBits(word << 16);
    case Encoding::scaled_unsigned:
      return fromFloatBits(word * 65535U);
    case Encoding::scaled_signed:
      return fromFloatBits((word >= 0x8000U ? word - 0x10000U : word) * 65535U);
    case Encoding::integer:
      break;
  }
  return fieldbus::isSigned(entry.type) ? static_cast<double>(asSigned(entry))
                                        : static_cast<double>(entry.number);
}

std::uint64_t encodeNumber(double value, const Entry& entry, Encoding encoding) {
  if (encoding == Encoding::integer) {
    return rounded(value) & mask(entry);
  }
  const std::uint32_t bits = toFloatBits(value);
  if (encoding == Encoding::float32) return bits;
  if (encoding == Encoding::bfloat16) {
    return ((bits + 0x7FFFU + ((bits >> 16) & 1U)) >> 16) & 0xFFFFU;
  }
  return (bits / 65535U) & 0xFFFFU;
}

namespace {
constexpr double kHardest = 1000.0 / 60.0 / 0.001;  // turns/s^2: 1000 rpm in a millisecond
}  // namespace

DriveValues::DriveValues(const DriveDefinition& definition, unsigned axis,
                         ObjectDictionary& dictionary, double counts_per_turn)
    : counts_per_turn_(counts_per_turn) {
  for (const RoleInfo& info : kRoles) {
    const auto moved = definition.objects.find(info.role);
    const fieldbus::ObjectId object =
        moved == definition.objects.end() ? info.object : moved->second;
    Slot& slot = slots_[static_cast<std::size_t>(info.role)];
    slot.entry = dictionary.find(ofAxis(object, axis));
    if (slot.entry != nullptr) {
      slot.bits = mask(*slot.entry);
      slot.is_signed = fieldbus::isSigned(slot.entry->type);
    }
    const auto own = definition.units_of.find(info.role);
    const UnitScale& unit = own != definition.units_of.end()
                                ? own->second
                                : definition.units[static_cast<std::size_t>(info.quantity)];
    slot.scale = unit.per == UnitScale::Per::count ? unit.factor * counts_per_turn : unit.factor;
    const bool by_own = own != definition.units_of.end();
    slot.speed = !by_own && info.quantity == Quantity::velocity;
    slot.ramp = !by_own && info.quantity == Quantity::acceleration;
    slot.geared = unit.per == UnitScale::Per::gear;
    slot.per_encoder = slot.geared || unit.per == UnitScale::Per::encoder;
    const auto special = definition.encodings.find(object);
    if (info.quantity == Quantity::none) {
      slot.scale = 1.0;
      slot.per_encoder = slot.geared = false;
    } else {
      slot.encoding = special == definition.encodings.end() ? definition.encoding : special->second;
    }
  }
}

double DriveValues::countsPerUnit(const Slot& slot) const {
  const auto told = static_cast<double>(raw(Role::encoder_resolution, 0));
  const double counts = (told > 0.0 ? told : counts_per_turn_) /
                        static_cast<double>(raw(Role::encoder_revolutions, 1));
  if (!slot.geared) return counts;
  return counts * static_cast<double>(raw(Role::gear_denominator, 1)) /
         static_cast<double>(raw(Role::gear_numerator, 1));
}

double DriveValues::number(const Slot& slot) const {
  if (slot.encoding != Encoding::integer) {
    return decodeNumber(*slot.entry, slot.encoding) / scale(slot);
  }
  const double number = slot.is_signed ? static_cast<double>(integer(slot))
                                       : static_cast<double>(slot.entry->acting());
  if (slot.ramp && inRpm()) return kHardest / std::max(number, 1.0);
  return number / scale(slot);
}

double DriveValues::range(Role role) const {
  const Slot& s = slot(role);
  if (s.entry == nullptr || s.encoding != Encoding::integer) return 0.0;
  return std::ldexp(1.0, static_cast<int>(widthBits(s.entry->type))) / scale(s);
}

void DriveValues::setNumber(const Slot& slot, double value) {
  const double scaled = value * scale(slot);
  slot.entry->number = slot.encoding == Encoding::integer
                           ? rounded(scaled) & slot.bits
                           : encodeNumber(scaled, *slot.entry, slot.encoding);
}

}  // namespace cia402::sim
