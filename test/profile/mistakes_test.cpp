// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The mistakes in a drive profile that file_test.cpp does not make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/full_profile.h"

namespace cia402::config {
namespace {

using testing::HasSubstr;

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
       "modes/a: `control` is missing: position, velocity, torque, homing"},
      {"  a: {value: 4, control: position, target: target_position, cyclic: true, handshake: "
       "new_set_point, status_bits: {set_point_acknowledge: 12}}\n",
       "a cyclic mode cannot wait for an acknowledgement of each set-point"},
      {"  a: {value: 4, control: velocity, target: profile_velocity, handshake: new_set_point, "
       "status_bits: {set_point_acknowledge: 12}}\n",
       "modes/a/handshake: only positions are handed over one by one"},
      {"  a: {value: 4, control: position, target: target_position, handshake: {words: [0]}}\n",
       "modes/a/handshake/words: needs the word at rest and 1 to 7 that hand a set-point over"},
      {"  a: {value: 4, control: position, target: target_position, handshake: {words: [0, "
       "0x8F]}}\n",
       "modes/a/handshake/words[1]: must leave bits 0 to 3 and 7 to the state machine"},
      {"  a: {value: 4, control: position, target: target_position, handshake: {words: [0, 16], "
       "acknowledge: rise}}\n",
       "modes/a/handshake/acknowledge: needs status_bits/set_point_acknowledge"},
      {"  a: {value: 4, control: position, target: target_position, handshake: {words: [0, 16], "
       "each_for: 11}}\n",
       "modes/a/handshake/each_for: "},
      {"  a: {value: 4, control: position, target: target_position, handshake: new_set_point}\n",
       "modes/a/handshake: new_set_point needs status_bits/set_point_acknowledge"},
      {"timing: {transitions: {13: 1}}\n",
       "timing/transitions/13: a transition of CiA 402 that is waited for is a number from 2 to "
       "16"},
      {"timing: {transitions: {17: 1}}\n", "not `17`"},
      {"timing: {transitions: {4: 0}}\n", "timing/transitions/4: "},
      {"statusword: {9: mine}\n",
       "statusword/9: names bits 7, 8 and 10 to 15, not `9`: the others are the state"},
      {"statusword: {fault: mine}\n", "not `fault`"},
      {"signals: [plan]\n", "signals[0]: the profile has no object `plan`, did you mean `plain`?"},
      {"signals: [plain, plain]\n", "signals[1]: `plain` is given twice"},
      {"homing: {kind: drive, methods: {1: {moves: false}}}\n",
       "homing/methods/1: `text` is missing: say in words how home is found"},
      {"  a: {value: 4, control: position, target: target_position, status_bits: {speed_zer: 1}}\n",
       "did you mean `speed_zero`"},
      {"  a: {value: 4, control: homing, status_bits: {target_reached: 10}}\n",
       "homing needs status_bits/homing_attained"},
      {"homing: {methods: {1: x}}\n", "homing: `kind` is missing: none, drive or declare_zero"},
      {"homing: {kind: drive, methods: {1: x}}\n", "a drive that homes by itself needs a mode"},
      {"homing: {kind: drive, methods: {-129: x}}\n", "from -128 to 127, not `-129`"},
      {"homing: {kind: drive, methods: {128: x}}\n", "from -128 to 127, not `128`"},
      {"errors: {0x8250: {cause: x}}\n", "`text` is missing: say in words what the code means"},
      {"errors: {0x8250: {text: x, reset: sometimes}}\n", "errors/0x8250/reset: unknown word"},
      {"errors: {0x8250: {text: x, wait: -1}}\n", "errors/0x8250/wait: "},
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
      {"{object: \"2100:00\", type: uint8, range: [0]}",
       "objects/more/range: is [lowest, highest], in the drive's own numbers"},
      {"{object: \"2100:00\", type: uint8, range: [0, 256]}", "more/range: does not fit uint8"},
      {"{object: \"2100:00\", type: int16, range: [-32769, 0]}", "more/range: does not fit int16"},
      {"{object: \"2100:00\", type: uint8, range: [3, 2]}",
       "more/range: its lowest number is above its highest"},
      {"{object: \"2100:00\", type: visible_string, range: [3, 4]}", "only numbers have a range"},
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
