// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "config/drive_family.h"

namespace cia402::config {

// A profile with every key, each with a value of its own.
inline const char* const kHead = R"(name: full
description: has it all
identity: {device_type: 0x00020192, vendor_id: 0x1234, product_code: 0x5678}
units: {position: count, velocity: count/s, torque: per_mille_of_rated}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int16}
  mode_display: {object: "6061:00", type: int16, access: const, pdo: tpdo}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: both}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo}
  target_torque: {object: "6071:00", type: int16, quantity: torque, access: wo, pdo: rpdo}
  profile_velocity: {object: "6081:01", type: uint32, quantity: velocity, unit: turn/min,
    factor: 2.5}
  plain: {object: "2000:00", type: uint8, pdo: none}
modes:
)";
inline const char* const kModes = R"(
  pp: {value: 1, control: position, target: target_position, handshake: new_set_point,
    controlword_bits: 0x0020, status_bits: {target_reached: 10, set_point_acknowledge: 12,
    following_error: 13}, stop: halt}
  pt: {value: 4, control: torque, target: target_torque, stop: quick_stop,
    status_bits: {speed_zero: 9, follows_command: 14},
    entry_writes: [{object: profile_velocity, from: limits.velocity, times: 1.5, optional: true}]}
  csp: {value: 300, control: position, cyclic: true, target: target_position, stop: set_points}
  homing: {value: 6, control: homing, status_bits: {target_reached: 10, homing_attained: 12,
    homing_error: 13}}
)";
inline const char* const kRest = R"(
output_shaft: true
halt_supported: false
warning_stops: true
statusword: {7: none, 8: abnormal stop, 15: homed}
mode_change: disabled
fault_reset_tries: 4
fault_reset_nmt_stop: 0.15
quick_stop_holds: [5, -6]
sync: {counter: 12, counter_object: true, period_object: false, period_step: 0.001}
heartbeat: {producer: false, consumer: false, node_guarding: true}
timing: {boot: 1.5, state_change: 2.5, transitions: {4: 4.25, 16: 0.125}, mode_change: 3.5, brake_release: 0.25, sdo: 0.75,
  sdo_retries: 3}
parameters: {save: [2, 3], restore: [4], timeout: 4.5, power_cycle_after_save: true}
homing:
  kind: drive
  methods: {-1: to the stop, -2: {text: here as well, moves: false}, 35: here}
  needs_zero_attained_before_start: true
  writes: [{object: plain, raw: 7}]
startup: [{object: "2001:02", type: uint16, value: 0x1FF}, {object: plain, value: 9}]
before_enable: [{object: target_position, from: position_actual}]
pdo_rules: {max_rpdos: 5, max_tpdos: 6, max_entries: 3, map_count_may_be_read_only: true,
  fixed_entries: 6, cob_ids: drive, rpdo_deadline: true, fixed: {tpdo6: [statusword]}}
pdos:
  rpdo1: [controlword, target_position]
  rpdo5: {objects: [target_torque], transmission: 254, event_timer: 0.123, refresh_every: 7,
    cob_id: 0x1A5}
  tpdo1: {objects: [statusword, position_actual], transmission: 0, inhibit: 0.0456,
    cob_id: "$NODEID+0x1A0"}
  tpdo2: {objects: [mode_display], transmission: 253, request_every: 8, cob_id: drive}
default_modes: [csp, profile_position]
feedback: [mode_display, target_position]
signals: [plain]
errors:
  0x2310: too much current
  0x8250: {text: late, cause: nobody sent, remedy: send, missing: rpdo}
  0xFF0B: {text: overload, reset: power_cycle, wait: 60}
)";

inline std::string problemsOfFull(const std::string& text) {
  Problems problems;
  parseDriveFamily(text, "full.yaml", problems);
  return problems.text();
}

}  // namespace cia402::config
