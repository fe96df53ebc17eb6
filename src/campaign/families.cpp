// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/families.h"

#include <algorithm>
#include <stdexcept>

namespace cia402::campaign {
namespace {

Family genericDrive() {
  Family family{"generic_cia402", 0.3};
  family.counts = {4096.0, 65536.0, 131072.0};
  family.rated_torque = 0.64;
  family.rated_acceleration = 300.0;
  family.strongest = 3.0;
  family.fastest = 60.0;
  family.modes = {{"cyclic_position", 'p'}, {"profile_position", 'p'}, {"profile_velocity", 'v'},
                  {"cyclic_velocity", 'v'}, {"profile_torque", 't'},   {"cyclic_torque", 't'}};
  family.names_modes = false;
  family.searches = {"33", "34"};
  family.searches_switches = true;
  family.faults = {"overcurrent",
                   "short_circuit",
                   "overvoltage",
                   "undervoltage",
                   "encoder",
                   "hardware",
                   "following_error",
                   "overtemperature",
                   "0x7305",
                   "power_cycle",
                   "overtemperature_warning"};
  family.values = {"6066:00 20", "position_window_time 10", "digital_outputs 1", "6041:00 0",
                   "5FFF:00 1"};
  return family;
}

Family damiao() {
  Family family{"damiao_dm", 0.2};
  family.joint_units = true;
  family.rated_torque = 3.0;
  family.rated_acceleration = 400.0;
  family.strongest = 2.33;
  family.modes = {{"cyclic_position", 'p'},   {"profile_position", 'p'},
                  {"position_velocity", 'p'}, {"position_velocity_torque", 'p'},
                  {"profile_velocity", 'v'},  {"cyclic_velocity", 'v'},
                  {"velocity_torque", 'v'},   {"profile_torque", 't'}};
  family.names_modes = false;
  family.faults = {"overcurrent",  "overvoltage", "undervoltage",    "motor_overtemperature",
                   "encoder",      "hardware",    "following_error", "overtemperature_warning",
                   "not_a_number", "0x7305",      "power_cycle"};
  family.values = {"following_error_window nan",
                   "following_error_window 0.5",
                   "position_window -0.0",
                   "position_window inf",
                   "200A:03 100.0",
                   "2004:03 1000.0"};
  return family;
}

Family sv660c() {
  Family family{"sv660c", 0.125};
  family.counts_sync = false;
  family.counts = {100000.0};
  family.rated_torque = 2.39;
  family.rated_acceleration = 1000.0;
  family.strongest = 3.0;
  family.fastest = 50.0;
  // 2^23 counts of its encoder, reduced.
  family.writes = "{object: gear_numerator, raw: 262144}, {object: gear_denominator, raw: 3125}";
  family.modes = {{"interpolated_position", 'p'},
                  {"profile_position", 'p'},
                  {"profile_velocity", 'v'},
                  {"cyclic_velocity", 'v'},
                  {"profile_torque", 't'}};
  family.declares = "35";
  family.searches = {"33", "34", "-3"};
  family.searches_switches = true;
  family.faults = {"overcurrent",     "overvoltage", "undervoltage",   "overtemperature",
                   "encoder",         "overspeed",   "motor_overload", "overload_warning",
                   "following_error", "parameter",   "sync_error",     "power_cycle"};
  family.values = {"6066:00 20", "position_window_time 10", "digital_outputs 65536", "6041:00 0",
                   "5FFF:00 1"};
  return family;
}

Family nimotion() {
  Family family{"nimotion_stepper", 0.125};
  family.options = "unwatched_streams: true, ";
  family.counts_sync = false;
  family.counts = {4000.0};
  family.rated_torque = 1.27;
  family.rated_acceleration = 300.0;
  family.strongest = 2.0;
  family.fastest = 9.0;  // 600/min from the factory
  family.limits_effort = false;
  family.writes =  // the limit switches at its terminals, active high
      "{object: di0_function, raw: 15}, {object: di0_logic, raw: 1}, "
      "{object: di1_function, raw: 14}, {object: di1_logic, raw: 1}";
  family.modes = {{"cyclic_position", 'p'},  {"interpolated_position", 'p'},
                  {"profile_position", 'p'}, {"velocity", 'v'},
                  {"profile_velocity", 'v'}, {"cyclic_velocity", 'v'}};
  family.declares = "35";
  family.searches_switches = true;
  family.faults = {"over_current",      "over_voltage", "under_voltage", "over_temperature",
                   "can_overrun",       "stall",        "driver_spi",    "encoder_frame",
                   "eeprom_self_check", "licence_key",  "power_cycle"};
  family.values = {"6066:00 20", "position_window_time 10", "digital_outputs 1", "6041:00 0",
                   "5FFF:00 1"};
  return family;
}

Family id286() {
  Family family{"id286_cnfa", 0.125};
  family.counts_sync = false;
  family.counts = {10000.0};
  family.rated_torque = 1.27;
  family.rated_acceleration = 250.0;
  family.strongest = 1.2;
  family.fastest = 30.0;
  family.limits_effort = false;
  family.options = "keeps: [motor_current], unwatched_streams: true, ";
  family.writes = "{object: following_error_limit, raw: 20000}";  // two turns, at 30 turns/s
  family.modes = {{"position_by_velocity", 'p'}, {"position_by_set_points", 'p'},
                  {"profile_position", 'p'},     {"profile_velocity", 'v'},
                  {"cyclic_velocity", 'v'},      {"profile_torque", 't'}};
  family.declares = "35";
  family.searches = {"33", "34"};
  family.searches_switches = true;
  family.faults = {"over_current",     "under_voltage",   "over_voltage",
                   "gate_driver",      "encoder",         "following_error",
                   "current_overload", "voltage_warning", "power_cycle"};
  family.values = {"in_position_range 20", "idle_current_delay 10", "6041:00 0", "5FFF:00 1"};
  return family;
}

Family dm5() {
  Family family{"megmeet_dm5", 0.125};
  family.counts_sync = false;
  family.counts = {8388608.0};
  family.rated_torque = 1.27;
  family.rated_acceleration = 1740.0;
  family.strongest = 3.0;
  family.fastest = 36.0;
  family.hardest = 250.0;
  family.long_range = false;
  family.options = "adjust: [control_mode], ";
  family.writes =  // reverse and forward limit switch at its terminals, home switch, nothing
      "{object: di1_function, raw: 36}, {object: di2_function, raw: 35}, "
      "{object: di3_function, raw: 32}, {object: di4_function, raw: 0}";
  family.modes = {{"cyclic_position", 'p'}, {"profile_position", 'p'}, {"profile_velocity", 'v'},
                  {"cyclic_velocity", 'v'}, {"profile_torque", 't'},   {"cyclic_torque", 't'}};
  family.declares = "35";
  family.searches = {"33", "34"};
  family.searches_switches = true;
  family.faults = {"overcurrent",     "overvoltage",    "undervoltage",
                   "encoder",         "overspeed",      "motor_overload_warning",
                   "following_error", "board_mismatch", "emergency_stop_warning",
                   "power_cycle"};
  family.values = {"6066:00 20", "position_window_time 10", "digital_outputs 65536", "6041:00 0",
                   "5FFF:00 1"};
  return family;
}

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> kFamilies{genericDrive(), damiao(), sv660c(),
                                             nimotion(),     id286(),  dm5()};
  return kFamilies;
}

const Family& family(const std::string& profile) {
  const auto& all = families();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Family& known) { return known.profile == profile; });
  if (found == all.end()) throw std::invalid_argument("no drive family " + profile);
  return *found;
}

}  // namespace cia402::campaign
