// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a profile says of settings of the drive: those that it expects, counts of a turn, brake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kDriveWithSettings = std::string(kLeastDrive) + R"(
  source: {object: "2000:01", type: uint8}
  resolution: {object: "2000:02", type: uint32}
  gear: {object: "2000:03", type: uint32}
  brake: {object: "2000:04", type: uint16, quantity: time}
  label: {object: "2000:05", type: visible_string}
  blind: {object: "2000:06", type: uint16, access: wo}
  told: {object: "2000:07", type: uint16, access: ro, words: {0: nothing, 7: too hot}}
  polarity: {object: "607E:00", type: uint8}
modes:
  csp: {value: 8, control: position, cyclic: true, target: target_position}
  homing: {value: 6, control: homing, status_bits: {homing_attained: 12}}
homing: {kind: drive, methods: {17: lower limit switch}}
)";

WholeProfile settingsWith(const std::string& text, Problems& problems) {
  return parseDriveFamily(kDriveWithSettings + text + "\n", "tested.yaml", problems);
}

TEST(ProfileSettings, AreAsWritten) {
  Problems problems;
  const WholeProfile profile = settingsWith(
      "checks: [{object: source, is: 8, modes: [csp], text: it is off, remedy: turn it on,\n"
      "  write: asked, power_cycle: true, if_given: limits.lower, texts: {1: lost, 0x02: found},\n"
      "  unless: {object: gear, not: [5, 6]}},\n"
      " {any_of: [source, gear], above: 3, before: homing, methods: [17], else: warn,\n"
      "  text: a, remedy: b}]\n"
      "counts_rule: {times: [resolution], over: [gear]}\n"
      "timing: {brake_release: {object: brake, at_most: 0.5}, transitions: {5: 3.0},\n"
      "  power_off: {object: brake, at_most: 30}}\n"
      "fault_memory: {base: 0xFF00, faults: [{code: told, with: [gear, source]}, {code: gear}]}\n"
      "sync: {period_min: 0.001, period_max: 0.02}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  ASSERT_EQ(profile.checks.size(), 2U);
  const drive::SettingCheck& check = profile.checks[0];
  EXPECT_THAT(check.objects, ElementsAre("source"));
  EXPECT_EQ(check.condition.kind, drive::Condition::Kind::is);
  EXPECT_THAT(check.condition.numbers, ElementsAre(8));
  EXPECT_THAT(check.modes, ElementsAre("cyclic_position"));
  EXPECT_EQ(check.text, "it is off");
  EXPECT_EQ(check.remedy, "turn it on");
  EXPECT_EQ(check.write, drive::SettingCheck::Write::asked);
  EXPECT_TRUE(check.power_cycle);
  EXPECT_FALSE(check.only_warns);
  EXPECT_EQ(check.before, drive::SettingCheck::Before::enabling);
  EXPECT_EQ(check.if_given, "limits.lower");
  EXPECT_EQ(check.meaning(1), "lost");
  EXPECT_EQ(check.meaning(2), "found");
  EXPECT_EQ(check.meaning(3), "it is off");
  EXPECT_EQ(check.unless, "gear");
  EXPECT_EQ(check.unless_is.kind, drive::Condition::Kind::is_not);
  EXPECT_THAT(check.unless_is.numbers, ElementsAre(5, 6));
  const drive::SettingCheck& second = profile.checks[1];
  EXPECT_THAT(second.objects, ElementsAre("source", "gear"));
  EXPECT_EQ(second.condition.kind, drive::Condition::Kind::above);
  EXPECT_EQ(second.before, drive::SettingCheck::Before::homing);
  EXPECT_THAT(second.methods, ElementsAre(17));
  EXPECT_TRUE(second.only_warns);
  EXPECT_EQ(second.write, drive::SettingCheck::Write::never);
  EXPECT_THAT(profile.counts_rule.times, ElementsAre("resolution"));
  EXPECT_THAT(profile.counts_rule.over, ElementsAre("gear"));
  EXPECT_EQ(profile.sync_period_min, std::chrono::milliseconds(1));
  EXPECT_EQ(profile.sync_period_max, std::chrono::milliseconds(20));
  EXPECT_EQ(profile.timing.brake_object, "brake");
  EXPECT_EQ(profile.timing.brake_release, std::chrono::milliseconds(500));
  EXPECT_EQ(profile.timing.power_object, "brake");
  EXPECT_EQ(profile.timing.power_off, std::chrono::seconds(30));
  EXPECT_EQ(profile.timing.longest(5), std::chrono::seconds(33));
  EXPECT_EQ(profile.timing.longest(7), std::chrono::seconds(2)) << "not out of operation";
  EXPECT_EQ(profile.timing.longest(8), std::chrono::seconds(32));
  EXPECT_EQ(profile.timing.longest(12), std::chrono::seconds(32));
  EXPECT_EQ(profile.timing.longest(14), std::chrono::seconds(2));
  EXPECT_EQ(profile.fault_memory.base, 0xFF00);
  ASSERT_EQ(profile.fault_memory.faults.size(), 2U);
  EXPECT_EQ(profile.fault_memory.faults[0].code, "told");
  EXPECT_THAT(profile.fault_memory.faults[0].with, ElementsAre("gear", "source"));
  EXPECT_TRUE(profile.fault_memory.faults[1].with.empty());
}

TEST(ProfileSettings, OfBitsWordsAndTheMakersNamesAreAsWritten) {
  Problems problems;
  const WholeProfile profile = settingsWith(
      "checks: [{object: statusword, bits: 0x0210, is: 0x0200, text: a, remedy: b}]\n"
      "counts_rule: {times: [resolution, gear], over: [source], adjustable: true}\n"
      "rated_torque: told\n"
      "bus_settings: {node_id: {object: source, counts: after_power_cycle},\n"
      "  bit_rate: {object: gear, numbers: {500000: 3}}, saved_apart: true,\n"
      "  memory: {object: polarity, on: 2, off: 9}, sample_points: {1000000: [0.8, 0.7]}}\n"
      "not_ready_reason: told\n"
      "homed_bit: 14\n"
      "if_silent: set it at the panel\n"
      "identity: {known_products: [7, 0x0D]}\n"
      "parameter_names: {prefix: P, index: 0x2000, subindex: 1, last_group: 20}\n"
      "error_details: {object: gear, bits: 0xFFF, prefix: Er., digits: 3,\n"
      "  codes: {0x12: {text: a, cause: b, remedy: c}}}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const drive::Condition& condition = profile.checks[0].condition;
  EXPECT_TRUE(condition.holds(0x0237 & ~0x0010));
  EXPECT_FALSE(condition.holds(0x0237));
  EXPECT_FALSE(condition.holds(0x0000));
  EXPECT_EQ(condition.complaint(0x0237), "0x0237, of which 0x0210 is 0x0210");
  EXPECT_EQ(drive::textOf(profile.find("told")->words, 7), "too hot");
  EXPECT_EQ(drive::textOf(profile.find("told")->words, 8), "");
  EXPECT_TRUE(profile.counts_rule.adjustable);
  const canopen::BusSettings& bus = profile.bus_settings;
  EXPECT_EQ(bus.node_id.object, "source");
  EXPECT_EQ(bus.node_id.counts, canopen::BusSetting::Counts::after_power_cycle);
  EXPECT_EQ(bus.bit_rate.numbers.at(500000), 3);
  EXPECT_EQ(bus.memory, "polarity");
  EXPECT_EQ(bus.memory_on, 2);
  EXPECT_EQ(bus.memory_off, 9);
  EXPECT_TRUE(bus.saved_apart);
  EXPECT_THAT(bus.sample_points.at(1000000), ElementsAre(0.8, 0.7));
  EXPECT_EQ(profile.rated_torque, "told");
  EXPECT_EQ(profile.not_ready_reason, "told");
  EXPECT_EQ(profile.homed_bit, 14);
  EXPECT_EQ(profile.if_silent, "set it at the panel");
  EXPECT_THAT(profile.known_products, ElementsAre(7U, 13U));
  const drive::ParameterNames& names = profile.parameter_names;
  EXPECT_EQ(names.find("P20.15"), (fieldbus::ObjectId{0x2014, 0x10})) << "both decimal";
  EXPECT_EQ(names.find("p02.00"), (fieldbus::ObjectId{0x2002, 1}));
  EXPECT_EQ(names.nameOf({0x2014, 0x10}), "P20.15");
  EXPECT_EQ(names.nameOf({0x2002, 101}), "P02.100");
  for (const char* none : {"P21.00", "P0A.00", "P2.0", "P02", "Q02.00", "P02.", "P02.255", ""}) {
    EXPECT_FALSE(names.find(none)) << none;
  }
  EXPECT_EQ(names.nameOf({0x2015, 1}), "") << "beyond the last group";
  EXPECT_EQ(names.nameOf({0x2002, 0}), "") << "before number 0";
  const drive::ErrorDetails& details = profile.error_details;
  EXPECT_EQ(details.object, "gear");
  EXPECT_EQ(details.bits, 0xFFFU);
  EXPECT_EQ(details.prefix, "Er.");
  EXPECT_EQ(details.digits, 3);
  EXPECT_EQ(details.codes.at(0x12).cause, "b");
}

TEST(ProfileSettings, AreRefusedWhereTheyCanMeanNothing) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"checks: [{object: sorce, is: 8, text: a, remedy: b}]",
       "checks[0]/object: the profile has no object `sorce`, did you mean `source`?"},
      {"checks: [{object: label, is: 8, text: a, remedy: b}]",
       "checks[0]/object: `label` is no whole number that the drive lets be read"},
      {"checks: [{object: blind, is: 8, text: a, remedy: b}]",
       "checks[0]/object: `blind` is no whole number that the drive lets be read"},
      {"checks: [{object: source, is: 256, text: a, remedy: b}]", "checks[0]/is"},
      {"checks: [{object: source, is: [1, 256], text: a, remedy: b}]", "checks[0]/is[1]"},
      {"checks: [{object: source, is: [], text: a, remedy: b}]",
       "checks[0]/is: expected at least one number"},
      {"checks: [{object: source, above: [1], text: a, remedy: b}]",
       "checks[0]/above: expected one number"},
      {"checks: [{object: source, is: 8, remedy: b}]", "checks[0]: `text` is missing"},
      {"checks: [{object: source, is: 8, text: a}]", "checks[0]: `remedy` is missing"},
      {"checks: [{object: source, text: a, remedy: b}]",
       "checks[0]: needs one of `is`, `not`, `above`, `below`"},
      {"checks: [{object: source, is: 1, not: 2, text: a, remedy: b}]",
       "checks[0]: needs one of `is`, `not`, `above`, `below`"},
      {"checks: [{is: 1, text: a, remedy: b}]", "checks[0]: needs `object`"},
      {"checks: [{object: source, any_of: [gear], is: 1, text: a, remedy: b}]",
       "checks[0]: needs `object`"},
      {"checks: [{object: source, is: 8, modes: [pp], text: a, remedy: b}]", "checks[0]/modes[0]"},
      {"checks: [{object: source, is: 8, methods: [18], text: a, remedy: b}]",
       "checks[0]/methods[0]: the profile has no homing method 18"},
      {"checks: [{object: source, above: 8, write: asked, text: a, remedy: b}]",
       "checks[0]/write: what is written must be given by `is`, of one `object`"},
      {"checks: [{object: told, is: 8, write: always, text: a, remedy: b}]",
       "checks[0]/write: `told` cannot be written"},
      {"checks: [{object: source, is: 8, write: asked, before: homing, text: a, remedy: b}]",
       "checks[0]/write: what is compared before homing is not written"},
      {"checks: [{object: source, is: 8, texts: {one: x}, text: a, remedy: b}]",
       "checks[0]/texts/one: `one` is no whole number"},
      {"checks: [{object: source, is: 8, unless: {object: gear}, text: a, remedy: b}]",
       "checks[0]/unless: needs one of"},
      {"checks: [{object: source, bits: 2, is: 3, text: a, remedy: b}]",
       "checks[0]/bits: 3 has other bits, so that it never is"},
      {"checks: [{object: source, bits: 2, above: 2, text: a, remedy: b}]",
       "checks[0]/bits: go with `is` and `not`"},
      {"checks: [{object: source, bits: 2, is: 2, write: asked, text: a, remedy: b}]",
       "checks[0]/write: single bits (`bits`) are not written"},
      {"checks: [{object: source, bits: 256, is: 0, text: a, remedy: b}]", "checks[0]/bits"},
      {"counts_rule: {times: [resolution], over: [gear], adjustable: true}",
       "counts_rule: `adjustable` needs two objects in `times`"},
      {"counts_rule: {times: [resolution, told], over: [gear], adjustable: true}",
       "counts_rule: `adjustable` needs two objects in `times`"},
      {"bus_settings: {node_id: {object: told}}",
       "bus_settings/node_id/object: `told` cannot be written"},
      {"bus_settings: {bit_rate: {object: gear}}", "bus_settings/bit_rate: needs `numbers`"},
      {"bus_settings: {sample_points: {fast: [0.8]}}",
       "bus_settings/sample_points/fast: `fast` is no bit rate of CAN"},
      {"bus_settings: {sample_points: {500000: [1.2]}}", "bus_settings/sample_points/500000"},
      {"bus_settings: {bit_rate: {object: gear, numbers: {fast: 1}}}",
       "bus_settings/bit_rate/numbers/fast: `fast` is no bit rate of CAN"},
      {"not_ready_reason: label", "not_ready_reason: `label` is no whole number"},
      {"rated_torque: torque", "rated_torque: the profile has no object `torque`"},
      {"homed_bit: 6", "homed_bit: must be between 7 and 15"},
      {"parameter_names: {index: 0x2000, last_group: 1}", "parameter_names: `prefix` is missing"},
      {"parameter_names: {prefix: P, last_group: 1}", "parameter_names: `index` is missing"},
      {"parameter_names: {prefix: P, index: 0xFFFF, last_group: 1}",
       "parameter_names: the last group lies beyond FFFFh"},
      {"error_details: {bits: 1}", "error_details: `object` is missing"},
      {"error_details: {object: label}", "error_details/object: `label` is no whole number"},
      {"error_details: {object: gear, codes: {0: a}}",
       "error_details/codes/0: an error code is a number from 0x0001 to 0xFFFFFFFF"},
      {"counts_rule: {over: [gear]}", "counts_rule: `times` is missing"},
      {"counts_rule: {times: [label]}", "counts_rule/times[0]: `label` is no whole number"},
      {"timing: {brake_release: {object: gear, at_most: 1}}",
       "timing/brake_release/object: `gear` does not measure a time"},
      {"timing: {brake_release: {object: brake}}",
       "timing/brake_release: `at_most` is missing: the longest that it may say, s"},
      {"timing: {brake_release: {object: brake, at_most: 60.1}}", "timing/brake_release/at_most"},
      {"timing: {power_off: {object: gear, at_most: 1}}",
       "timing/power_off/object: `gear` does not measure a time"},
      {"fault_memory: {base: 1}", "fault_memory: `faults` is missing"},
      {"fault_memory: {faults: [{with: [gear]}]}", "fault_memory/faults[0]: `code` is missing"},
      {"fault_memory: {faults: [{code: label}]}",
       "fault_memory/faults[0]/code: `label` is no whole number"},
      {"fault_memory: {faults: [{code: gear, with: [gaer]}]}",
       "fault_memory/faults[0]/with[0]: the profile has no object `gaer`"},
      {"sync: {period_min: 0.02, period_max: 0.01}", "sync: period_max is below period_min"},
  };
  for (const auto& [text, told] : mistakes) {
    Problems problems;
    settingsWith(text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(told)) << text;
  }
}

const char* const kSourceIsChecked =
    "checks: [{object: source, is: 0, text: a, remedy: b}]\nunit_systems: ";

TEST(ProfileUnitSystems, KeepTheUnitsThatTheyDoNotName) {
  Problems problems;
  const WholeProfile profile = settingsWith(
      std::string(kSourceIsChecked) +
          "{object: source, 1: {acceleration: {unit: s, scale: 0.001, to: 1000, of: turn/min}}}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_EQ(profile.unit_systems.object, "source");
  const drive::Units& units = profile.unit_systems.others.at(1);
  EXPECT_EQ(units.at(drive::Quantity::position).base,
            profile.units.at(drive::Quantity::position).base);
  const drive::UnitSpec& acceleration = units.at(drive::Quantity::acceleration);
  EXPECT_EQ(acceleration.to, 1000.0);
  EXPECT_EQ(acceleration.scale, 0.001);
  EXPECT_TRUE(acceleration.per_minute);
}

TEST(ProfileUnitSystems, AreToldTheirMistakes) {
  const std::pair<std::string, const char*> mistakes[] = {
      {"unit_systems: {1: {}}", "unit_systems: `object` is missing"},
      {"unit_systems: {object: source}", "unit_systems/object: `checks` must compare it"},
      {std::string(kSourceIsChecked) + "{object: source, one: {}}",
       "unit_systems/one: a unit system is a number that `source` may hold"},
      {std::string(kSourceIsChecked) +
           "{object: source, 1: {velocity: {unit: s, to: 1, of: turn/min}}}",
       "unit_systems/1/velocity/to: is of accelerations that are times"},
      {std::string(kSourceIsChecked) +
           "{object: source, 1: {acceleration: {unit: s, to: 1, of: turn/min/s}}}",
       "unit_systems/1/acceleration/of: `turn/min/s` is no unit of velocity"},
      {std::string(kSourceIsChecked) + "{object: source, 1: {acceleration: {unit: s, to: 1}}}",
       "unit_systems/1/acceleration: `of` is missing"},
      {std::string(kSourceIsChecked) +
           "{object: source, 1: {acceleration: {unit: s, to: 0, of: turn/min}}}",
       "unit_systems/1/acceleration/to"},
  };
  for (const auto& [text, told] : mistakes) {
    Problems problems;
    settingsWith(text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(told)) << text;
  }
}

}  // namespace
}  // namespace cia402::config
