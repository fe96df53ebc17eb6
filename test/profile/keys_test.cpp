// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every key of a drive profile with a value of its own, found again where it belongs, and the
// mistakes that test/profile/file_test.cpp does not make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cia402_driver/config/drive_family.h"

namespace cia402::config {
namespace {

using canopen::CobIdSpec;
using drive::ControlKind;
using drive::DriveProfile;
using drive::Encoding;
using drive::ErrorText;
using drive::Handshake;
using drive::HomingSpec;
using drive::ModeSpec;
using drive::ObjectSpec;
using drive::Quantity;
using drive::StopBy;
using drive::UnitSpec;
using fieldbus::DataType;
using fieldbus::ObjectId;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kHead = R"(name: full
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
const char* const kModes = R"(
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
const char* const kRest = R"(
output_shaft: true
halt_supported: false
warning_stops: true
mode_change: disabled
fault_reset_tries: 4
fault_reset_nmt_stop: 0.15
quick_stop_holds: [5, -6]
sync: {counter: 12, counter_object: true, period_object: false, period_step: 0.001}
heartbeat: {producer: false, consumer: false, node_guarding: true}
timing: {boot: 1.5, state_change: 2.5, mode_change: 3.5, brake_release: 0.25, sdo: 0.75,
  sdo_retries: 3}
parameters: {save: [2, 3], restore: [4], timeout: 4.5, power_cycle_after_save: true}
homing:
  kind: drive
  methods: {-1: to the stop, 35: here}
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
errors:
  0x2310: too much current
  0x8250: {text: late, cause: nobody sent, remedy: send, missing: rpdo}
)";

std::string problemsOfFull(const std::string& text) {
  Problems problems;
  parseDriveFamily(text, "full.yaml", problems);
  return problems.text();
}

class ProfileKeys : public testing::Test {
 protected:
  ProfileKeys() {
    const DriveFamily family =
        parseDriveFamily(std::string(kHead) + kModes + kRest, "full.yaml", problems);
    profile = family.drive;
    device = family.device;
    EXPECT_EQ(problems.text(), "");
  }
  Problems problems;
  DriveProfile profile;
  canopen::DeviceProfile device;
};

TEST_F(ProfileKeys, NamesTheDevice) {
  EXPECT_EQ(profile.name, "full");
  EXPECT_EQ(profile.description, "has it all");
  EXPECT_EQ(device.device_type, 0x00020192U);
  EXPECT_EQ(device.vendor_id, 0x1234U);
  EXPECT_EQ(device.product_code, 0x5678U);
}

TEST_F(ProfileKeys, ObjectsHaveTheirAccessAndMapping) {
  struct Row {
    const char* name;
    ObjectId id;
    DataType type;
    Quantity quantity;
    bool readable, writable, rpdo, tpdo;
  };
  const Row rows[] = {
      {"controlword", {0x6040, 0}, DataType::uint16, Quantity::none, true, true, true, false},
      {"statusword", {0x6041, 0}, DataType::uint16, Quantity::none, true, false, false, true},
      {"mode_display", {0x6061, 0}, DataType::int16, Quantity::none, true, false, false, true},
      {"target_position", {0x607A, 0}, DataType::int32, Quantity::position, true, true, true, true},
      {"target_torque", {0x6071, 0}, DataType::int16, Quantity::torque, false, true, true, false},
      {"profile_velocity",
       {0x6081, 1},
       DataType::uint32,
       Quantity::velocity,
       true,
       true,
       false,
       false},
      {"plain", {0x2000, 0}, DataType::uint8, Quantity::none, true, true, false, false},
  };
  for (const Row& row : rows) {
    const ObjectSpec* object = profile.find(row.name);
    ASSERT_NE(object, nullptr) << row.name;
    EXPECT_EQ(object, profile.find(row.id)) << row.name;
    EXPECT_EQ(object->type, row.type) << row.name;
    EXPECT_EQ(object->quantity, row.quantity) << row.name;
    EXPECT_EQ(object->readable, row.readable) << row.name;
    EXPECT_EQ(object->writable, row.writable) << row.name;
    EXPECT_EQ(object->rpdo, row.rpdo) << row.name;
    EXPECT_EQ(object->tpdo, row.tpdo) << row.name;
  }
  const ObjectSpec* velocity = profile.find("profile_velocity");
  EXPECT_DOUBLE_EQ(velocity->factor, 2.5);
  ASSERT_TRUE(velocity->unit);
  EXPECT_EQ(velocity->unit->base, UnitSpec::Base::turn);
  EXPECT_TRUE(velocity->unit->per_minute);
  EXPECT_EQ(profile.find("nothing"), nullptr);
  EXPECT_EQ(profile.find(ObjectId{0x2000, 1}), nullptr);
}

TEST_F(ProfileKeys, ModesHaveTheirBits) {
  const ModeSpec* pp = profile.mode("pp");
  ASSERT_NE(pp, nullptr);
  EXPECT_EQ(pp->name, "profile_position");
  EXPECT_EQ(pp->value, 1);
  EXPECT_EQ(pp->kind, ControlKind::position);
  EXPECT_FALSE(pp->cyclic);
  EXPECT_EQ(pp->target, "target_position");
  EXPECT_EQ(pp->handshake, Handshake::new_set_point);
  EXPECT_EQ(pp->controlword_bits, 0x0020);
  EXPECT_EQ(pp->target_reached_bit, 10);
  EXPECT_EQ(pp->set_point_acknowledge_bit, 12);
  EXPECT_EQ(pp->following_error_bit, 13);
  EXPECT_EQ(pp->stop, StopBy::halt);
  EXPECT_FALSE(pp->speed_zero_bit || pp->homing_attained_bit || pp->homing_error_bit ||
               pp->follows_command_bit);
  const ModeSpec* pt = profile.mode("pt");
  ASSERT_NE(pt, nullptr);
  EXPECT_EQ(pt->kind, ControlKind::torque);
  EXPECT_EQ(pt->speed_zero_bit, 9);
  EXPECT_EQ(pt->follows_command_bit, 14);
  EXPECT_EQ(pt->stop, StopBy::quick_stop);
  EXPECT_EQ(pt->stop_mode, "");
  ASSERT_EQ(pt->entry_writes.size(), 1U);
  EXPECT_EQ(pt->entry_writes[0].object, "profile_velocity");
  EXPECT_EQ(pt->entry_writes[0].from, "limits.velocity");
  EXPECT_DOUBLE_EQ(pt->entry_writes[0].times, 1.5);
  EXPECT_TRUE(pt->entry_writes[0].optional);
  const ModeSpec* csp = profile.mode("csp");
  ASSERT_NE(csp, nullptr);
  EXPECT_EQ(csp->value, 300) << "6060h has 16 bits here";
  EXPECT_TRUE(csp->cyclic);
  EXPECT_EQ(csp->stop, StopBy::set_points);
  const ModeSpec* homing = profile.mode("homing");
  ASSERT_NE(homing, nullptr);
  EXPECT_EQ(homing->kind, ControlKind::homing);
  EXPECT_EQ(homing->target_reached_bit, 10);
  EXPECT_EQ(homing->homing_attained_bit, 12);
  EXPECT_EQ(homing->homing_error_bit, 13);
  EXPECT_FALSE(homing->stop);
}

TEST_F(ProfileKeys, BehaviourIsAsWritten) {
  EXPECT_TRUE(profile.output_shaft);
  EXPECT_FALSE(profile.halt_supported);
  EXPECT_TRUE(profile.warning_stops);
  EXPECT_TRUE(profile.mode_change.needs_disabling);
  EXPECT_THAT(profile.quick_stop_holds, ElementsAre(5, -6));
  EXPECT_EQ(device.sync_counter, 12);
  EXPECT_TRUE(device.has_sync_counter_object);
  EXPECT_FALSE(device.has_sync_period_object);
  EXPECT_EQ(device.sync_period_step, milliseconds(1));
  EXPECT_FALSE(device.heartbeat_supported);
  EXPECT_FALSE(device.heartbeat_consumer_supported);
  EXPECT_TRUE(device.node_guarding_supported);
  EXPECT_EQ(device.boot_time, milliseconds(1500));
  EXPECT_EQ(profile.timing.state_change, milliseconds(2500));
  EXPECT_EQ(profile.timing.mode_change, milliseconds(3500));
  EXPECT_EQ(profile.timing.brake_release, milliseconds(250));
  EXPECT_EQ(device.sdo.timeout, milliseconds(750));
  EXPECT_EQ(device.sdo.retries, 3);
  EXPECT_THAT(profile.parameters.save, ElementsAre(2, 3));
  EXPECT_THAT(profile.parameters.restore, ElementsAre(4));
  EXPECT_EQ(profile.parameters.timeout, milliseconds(4500));
  EXPECT_TRUE(profile.parameters.power_cycle_after_save);
  EXPECT_EQ(profile.fault_reset_tries, 4);
  EXPECT_EQ(profile.fault_reset_nmt_stop, milliseconds(150));
}

TEST_F(ProfileKeys, WritesAreAsWritten) {
  EXPECT_EQ(profile.homing.kind, HomingSpec::Kind::drive);
  EXPECT_THAT(profile.homing.methods,
              ElementsAre(std::make_pair(-1, "to the stop"), std::make_pair(35, "here")));
  EXPECT_TRUE(profile.homing.needs_zero_attained_before_start);
  ASSERT_EQ(profile.homing.writes.size(), 1U);
  EXPECT_EQ(profile.homing.writes[0].raw, 7);
  ASSERT_EQ(profile.startup.size(), 2U);
  EXPECT_EQ(profile.startup[0].object, "2001:02");
  EXPECT_EQ(profile.startup[0].type, DataType::uint16);
  EXPECT_EQ(profile.startup[0].raw, 0x1FF);
  EXPECT_FALSE(profile.startup[0].optional || profile.startup[0].when_homed);
  EXPECT_EQ(profile.startup[1].value, 9.0);
  EXPECT_DOUBLE_EQ(profile.startup[1].times, 1.0);
  ASSERT_EQ(profile.before_enable.size(), 1U);
  EXPECT_EQ(profile.before_enable[0].from, "position_actual");
}

TEST_F(ProfileKeys, PdosAreAsWritten) {
  EXPECT_EQ(device.max_rpdos, 5U);
  EXPECT_EQ(device.max_tpdos, 6U);
  EXPECT_EQ(device.max_pdo_entries, 3U);
  EXPECT_TRUE(device.pdo_map_count_may_be_read_only);
  EXPECT_EQ(device.fixed_pdo_entries, 6U);
  EXPECT_TRUE(device.cob_ids_of_drive);
  EXPECT_TRUE(device.rpdo_deadline);
  ASSERT_EQ(device.fixed_pdos.size(), 1U);
  EXPECT_EQ(device.fixed_pdos[0].number, 6U);
  ASSERT_EQ(device.pdos.size(), 4U);
  const canopen::PdoLayout& plain = device.pdos[0];
  EXPECT_EQ(plain.direction, canopen::PdoDirection::rpdo);
  EXPECT_EQ(plain.transmission, 1);
  EXPECT_EQ(plain.cob_id.kind, CobIdSpec::Kind::predefined);
  EXPECT_THAT(plain.objects, ElementsAre("controlword", "target_position"));
  const canopen::PdoLayout& fifth = device.pdos[1];
  EXPECT_EQ(fifth.number, 5U);
  EXPECT_EQ(fifth.transmission, 254);
  EXPECT_EQ(fifth.event_timer, 123);
  EXPECT_EQ(fifth.inhibit, 0);
  EXPECT_EQ(fifth.refresh_every, 7);
  EXPECT_EQ(fifth.cob_id.kind, CobIdSpec::Kind::absolute);
  EXPECT_EQ(fifth.cob_id.value, 0x1A5);
  const canopen::PdoLayout& sampled = device.pdos[2];
  EXPECT_EQ(sampled.direction, canopen::PdoDirection::tpdo);
  EXPECT_EQ(sampled.transmission, 0);
  EXPECT_EQ(sampled.inhibit, 456);
  EXPECT_EQ(sampled.cob_id.kind, CobIdSpec::Kind::node_id);
  EXPECT_EQ(sampled.cob_id.value, 0x1A0);
  const canopen::PdoLayout& asked = device.pdos[3];
  EXPECT_EQ(asked.transmission, 253);
  EXPECT_EQ(asked.request_every, 8);
  EXPECT_EQ(asked.cob_id.kind, CobIdSpec::Kind::drive);
  EXPECT_THAT(profile.default_modes, ElementsAre("cyclic_position", "profile_position"));
  EXPECT_THAT(profile.feedback, ElementsAre("mode_display", "target_position"));
}

TEST_F(ProfileKeys, ErrorsHaveWords) {
  ASSERT_EQ(profile.errors.size(), 2U);
  EXPECT_EQ(profile.errors[0x2310].text, "too much current");
  EXPECT_EQ(profile.errors[0x2310].missing, ErrorText::Missing::nothing);
  EXPECT_EQ(profile.errors[0x8250].text, "late");
  EXPECT_EQ(profile.errors[0x8250].cause, "nobody sent");
  EXPECT_EQ(profile.errors[0x8250].remedy, "send");
  EXPECT_EQ(profile.errors[0x8250].missing, ErrorText::Missing::rpdo);
}

TEST(ProfileDefaults, AreThoseOfTheStandards) {
  Problems problems;
  const DriveFamily family = parseDriveFamily(
      std::string(kHead) + "  csp: {value: 8, control: position, target: target_position}\n",
      "full.yaml", problems);
  const DriveProfile& profile = family.drive;
  const canopen::DeviceProfile& device = family.device;
  EXPECT_EQ(problems.text(), "");
  EXPECT_TRUE(profile.halt_supported);
  EXPECT_FALSE(profile.output_shaft || profile.warning_stops ||
               profile.mode_change.needs_disabling);
  EXPECT_THAT(profile.quick_stop_holds, IsEmpty());
  EXPECT_FALSE(device.sync_counter);
  EXPECT_TRUE(device.has_sync_counter_object && device.has_sync_period_object);
  EXPECT_EQ(device.sync_period_step, microseconds(1));
  EXPECT_TRUE(device.heartbeat_supported && device.heartbeat_consumer_supported);
  EXPECT_FALSE(device.node_guarding_supported);
  EXPECT_EQ(device.max_rpdos, 4U);
  EXPECT_EQ(device.max_tpdos, 4U);
  EXPECT_EQ(device.max_pdo_entries, 8U);
  EXPECT_EQ(device.fixed_pdo_entries, 0U);
  EXPECT_FALSE(device.pdo_map_count_may_be_read_only || device.cob_ids_of_drive ||
               device.rpdo_deadline);
  EXPECT_EQ(profile.fault_reset_tries, 1);
  EXPECT_EQ(profile.fault_reset_nmt_stop, Duration::zero());
  EXPECT_FALSE(profile.parameters.power_cycle_after_save);
  EXPECT_EQ(profile.homing.kind, HomingSpec::Kind::none);
  EXPECT_FALSE(profile.mode("csp")->cyclic);
  EXPECT_EQ(profile.mode("csp")->handshake, Handshake::none);
}

struct WrongKey {
  const char* text;  ///< after modes
  const char* problem;
};

TEST(ProfileMistakes, AreToldWithWhatToDo) {
  const WrongKey mistakes[] = {
      {"  pt: {value: 4, control: torque, target: target_torque, stop: set_points}\n",
       "modes/pt/stop: a torque of 0 lets the axis coast; write halt, quick_stop or mode"},
      {"  pt: {value: 4, control: torque, target: target_torque, stop: mode}\n",
       "modes/pt: `stop: mode` and `stop_mode`, the mode that brakes, go together"},
      {"  pt: {value: 4, control: torque, target: target_torque, stop_mode: csp}\n",
       "modes/pt: `stop: mode` and `stop_mode`, the mode that brakes, go together"},
      {"  pt: {value: 4, control: torque, target: target_torque, stop: mode, stop_mode: csv}\n",
       "modes/profile_torque/stop_mode: there is no mode `cyclic_velocity`"},
      {"  pt: {value: 4, control: torque, target: target_torque, stop: mode, stop_mode: csp}\n",
       "modes/profile_torque/stop_mode: `cyclic_position` follows no stream of velocities"},
      {"  pp: {value: 1, control: position, target: target_position, stop: mode, stop_mode: csp}\n",
       "modes/pp/stop: another mode brakes torque modes only"},
      {"  pt: {value: 4, control: torque, target: target_torque, stop: mode, stop_mode: csv}\n"
       "  csv: {value: 9, control: velocity, cyclic: true, target: profile_velocity}\n"
       "mode_change: disabled\n",
       "modes/profile_torque/stop_mode: the drive does not go into `cyclic_velocity` while "
       "enabled"},
      {"  a: {value: 4, control: position}\n",
       "modes/a: `target` is missing: the object that takes the mode's set-points"},
      {"  a: {control: position, target: target_position}\n",
       "modes/a: `value` is missing: the number that mode_of_operation (6060h) takes"},
      {"  a: {value: 4, target: target_position}\n",
       "modes/a: `control` is missing: position, velocity, torque or homing"},
      {"  a: {value: 4, control: position, target: target_position, cyclic: true, handshake: "
       "new_set_point, status_bits: {set_point_acknowledge: 12}}\n",
       "a cyclic mode cannot wait for an acknowledgement of each set-point"},
      {"  a: {value: 4, control: position, target: target_position, status_bits: {speed_zer: 1}}\n",
       "did you mean `speed_zero`"},
      {"  a: {value: 4, control: homing, status_bits: {target_reached: 10}}\n",
       "homing needs status_bits/homing_attained"},
      {"homing: {methods: {1: x}}\n", "homing: `kind` is missing: none, drive or declare_zero"},
      {"homing: {kind: drive, methods: {1: x}}\n", "a drive that homes by itself needs a mode"},
      {"homing: {kind: drive, methods: {-129: x}}\n", "from -128 to 127, not `-129`"},
      {"homing: {kind: drive, methods: {128: x}}\n", "from -128 to 127, not `128`"},
      {"errors: {0x8250: {cause: x}}\n", "`text` is missing: say in words what the code means"},
      {"errors: {0: x}\n", "an error code is a number from 0x0001 to 0xFFFF, not `0`"},
      {"errors: {0x8250: x, 33360: y}\n", "errors/33360: the code is given twice"},
      {"sync: {counter: 4, counter_object: false}\n",
       "sync/counter: a counter needs the object 1019h, but `counter_object` is false"},
      {"sync: {counter: 241}\n", "sync/counter: must be between 0 and 240"},
      {"startup: [{raw: 1}]\n", "`object` is missing: name it by profile name or index"},
      {"startup: [{object: \"2000:07\", type: int7, raw: 1}]\n", "unknown type `int7`"},
      {"startup: [{object: \"2000:07\", type: visible_string, raw: 1}]\n",
       "only numbers can be written"},
      {"startup: [{object: \"2000:07\", raw: 1}]\n",
       "profile full does not name 2000:07; add its type, for example `type: uint16`"},
      {"startup: [{object: plain, value: 1, raw: 2}]\n", "has both `value` and `raw`; keep one"},
      {"startup: [{object: plain}]\n", "has no value: write `value`, `raw` or `from`"},
      {"startup: [{object: \"6081:01\", value: 1.5}]\n",
       "write `object: profile_velocity` to give it in SI units"},
      {"startup: [{object: plain, from: nowhere_at_all}]\n", "unknown source `nowhere_at_all`"},
      {"before_enable: [{object: plain, from: target_torque}]\n", "`target_torque` cannot be read"},
      {"pdos: {rpdo1: [profile_velocity]}\n",
       "`profile_velocity` cannot be mapped into an RPDO (see its `pdo:` in the profile)"},
      {"pdos: {tpdo1: [controlword]}\n",
       "`controlword` cannot be mapped into a TPDO (see its `pdo:` in the profile)"},
      {"pdos: {rpdo0: [controlword]}\n",
       "no such PDO; there are rpdo1 to rpdo4 and tpdo1 to tpdo4"},
      {"pdos: {qpdo1: [controlword]}\n", "no such PDO"},
      {"pdos: {rpdo1: {transmission: 1}}\n",
       "`objects` is missing: list the objects by profile name"},
      {"pdos: {rpdo1: {objects: [controlword], transmission: 252}}\n", "only TPDOs can be"},
      {"pdos: {rpdo1: {objects: [controlword], transmission: 241}}\n", "241 to 251 are reserved"},
      {"pdos: {tpdo1: {objects: [statusword], transmission: 251}}\n", "241 to 251 are reserved"},
      {"pdos: {tpdo1: {objects: [statusword], request_every: 2}}\n",
       "is for TPDOs of transmission type 252 or 253"},
      {"pdos: {tpdo1: {objects: [statusword], refresh_every: 2}}\n", "is for RPDOs"},
      {"pdos: {tpdo1: {objects: [statusword], cob_id: 0x180}}\n", "not `0x180`"},
      {"pdos: {tpdo1: {objects: [statusword], cob_id: 0x6E0}}\n", "not `0x6E0`"},
      {"pdos: {tpdo1: {objects: [statusword], cob_id: \"$NODEID+0x17F\"}}\n", "+0x17F`"},
      {"pdo_rules: {max_entries: 1}\npdos: {tpdo1: [statusword, mode_display]}\n",
       "maps 2 objects, the drive takes 1 in a PDO"},
      {"pdo_rules: {fixed_entries: 1}\npdos: {tpdo1: [statusword, mode_display]}\n",
       "maps 2 objects, the drive takes 1 in a PDO"},
      {"pdo_rules: {fixed_entries: 65}\n", "pdo_rules/fixed_entries: must be between 1 and 64"},
      {"pdo_rules: {fixed_entries: all}\n", "pdo_rules/fixed_entries"},
      {"pdo_rules: {max_pdos: 2}\npdos: {tpdo3: [statusword]}\n",
       "there are rpdo1 to rpdo2 and tpdo1 to tpdo2"},
      {"default_modes: [cps]\n", "profile full has no mode `cps`"},
      {"feedback: [controlword]\n", "`controlword` cannot be mapped into a TPDO"},
      {"parameters: {save: []}\n", "must be a list of sub-indices"},
      {"parameters: {restore: [128]}\n", "must be between 1 and 127"},
      {"fault_reset_nmt_stop: 11\n", "fault_reset_nmt_stop"},
      {"fault_reset_nmt_stop: long\n", "fault_reset_nmt_stop"},
      {"parameters: {power_cycle_after_save: 3}\n", "parameters/power_cycle_after_save"},
      {"timing: {boot: 0}\n", "timing/boot"},
      {"timing: {sdo_retries: 11}\n", "timing/sdo_retries: must be between 0 and 10"},
      {"heartbeat: {producr: false}\n", "did you mean `producer`"},
      {"mode_change: sometimes\n", "mode_change: unknown word `sometimes`"},
      {"mode_change: {detours: {csp: {csv: disabled}}}\n",
       "mode_change/detours: there is no mode `cyclic_velocity`"},
      {"mode_change: {again: same, detours: {csp: {csp: disabled}}}\n",
       "cyclic_position to cyclic_position is to go by disabling, but the drive forgets what it is "
       "told while disabled (again: same); name a mode to go through instead of `disabled`"},
  };
  const std::string head = std::string(kHead) +
                           "  csp: {value: 8, control: position, cyclic: true, target: "
                           "target_position}\n";
  ASSERT_EQ(problemsOfFull(head), "");
  for (const WrongKey& mistake : mistakes) {
    EXPECT_THAT(problemsOfFull(head + mistake.text), HasSubstr(mistake.problem)) << mistake.text;
  }
}

TEST(ProfileMistakes, OfObjectsAreToldWithWhatToDo) {
  const WrongKey mistakes[] = {
      {"{object: \"2100:00\", type: real32, encoding: integer}",
       "real32 is a float, not an integer; leave `encoding` out"},
      {"{object: \"2100:00\", type: uint8, unit: count}", "a unit needs a `quantity`"},
      {"{object: \"2100:00\", type: visible_string, quantity: position}",
       "a visible_string measures no quantity"},
      {"{object: \"2100:00\", type: boolean, quantity: position}",
       "a boolean measures no quantity"},
      {"{type: uint8}", "`object` is missing: write index and sub-index, for example \"6041:00\""},
      {"{object: \"2100:00\"}", "`type` is missing: write for example `type: uint16`"},
      {"{object: \"2100:00\", type: uint8, access: wo, pdo: tpdo}",
       "a write-only object cannot be in a TPDO"},
      {"{object: \"2100:00\", type: uint8, acces: wo}", "did you mean `access`"},
  };
  const std::string head(kHead);
  const std::string before = head.substr(0, head.find("modes:"));
  const std::string after =
      "\nmodes:\n  csp: {value: 8, control: position, target: target_position}\n";
  for (const WrongKey& mistake : mistakes) {
    EXPECT_THAT(problemsOfFull(before + "  more: " + mistake.text + after),
                HasSubstr(mistake.problem))
        << mistake.text;
  }
  EXPECT_THAT(problemsOfFull(before + "  \"2100\": {object: \"2100:00\", type: uint8}" + after),
              HasSubstr("the name reads like an index; choose another one"));
}

TEST(ProfileMistakes, OfTheObjectsThatEveryAxisNeedsAreTold) {
  struct Change {
    const char *from, *to, *problem;
  };
  const Change changes[] = {
      {"controlword: {object: \"6040:00\", type: uint16, pdo: rpdo}",
       "controlword: {object: \"6040:00\", type: uint16}",
       "objects/controlword must be mappable into an RPDO"},
      {"statusword: {object: \"6041:00\", type: uint16, access: ro, pdo: tpdo}",
       "statusword: {object: \"6041:00\", type: uint16, access: ro}",
       "objects/statusword must be mappable into a TPDO"},
      {"controlword: {object: \"6040:00\", type: uint16",
       "controlword: {object: \"6040:00\", type: int16", "objects/controlword must be a uint16"},
      {"statusword: {object: \"6041:00\", type: uint16",
       "statusword: {object: \"6041:00\", type: uint32", "objects/statusword must be a uint16"},
      {"position_actual:", "position_actua:", "objects/position_actual is missing; every axis"},
      {"mode_of_operation:", "mode_of_op:", "objects/mode_of_operation is missing; every axis"},
      {"mode_display:", "mode_displ:", "objects/mode_display is missing; every axis needs it"},
      {"name: full", "nam: full", "`name` is missing: the file's name without .yaml"},
      {"units: {", "units_: {", "`units` is missing: how the drive counts"},
      {"objects:\n", "objects_:\n", "`objects` is missing: the drive's objects by name"},
      {"modes:\n", "modes_:\n", "`modes` is missing: at least one mode"},
  };
  for (const Change& change : changes) {
    std::string text = std::string(kHead) +
                       "  csp: {value: 8, control: position, target: "
                       "target_position}\n";
    text.replace(text.find(change.from), std::string(change.from).size(), change.to);
    EXPECT_THAT(problemsOfFull(text), HasSubstr(change.problem)) << change.to;
  }
}

}  // namespace
}  // namespace cia402::config
