// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a profile says of settings of the drive: those that it expects, counts of a turn, brake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* const kDriveWithSettings = R"(name: tested
units: {position: count, velocity: count/s, time: {unit: s, scale: 0.001}}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int8}
  mode_display: {object: "6061:00", type: int8, access: ro}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: rpdo}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo}
  source: {object: "2000:01", type: uint8}
  resolution: {object: "2000:02", type: uint32}
  gear: {object: "2000:03", type: uint32}
  brake: {object: "2000:04", type: uint16, quantity: time}
  label: {object: "2000:05", type: visible_string}
  blind: {object: "2000:06", type: uint16, access: wo}
modes:
  csp: {value: 8, control: position, cyclic: true, target: target_position}
)";

WholeProfile settingsWith(const std::string& text, Problems& problems) {
  return parseDriveFamily(kDriveWithSettings + text + "\n", "tested.yaml", problems);
}

TEST(ProfileSettings, AreAsWritten) {
  Problems problems;
  const WholeProfile profile = settingsWith(
      "expected: [{object: source, raw: 8, modes: [csp], text: it is off, remedy: turn it on}]\n"
      "counts_rule: {times: [resolution], over: [gear]}\n"
      "timing: {brake_release: {object: brake, at_most: 0.5}}\n"
      "sync: {period_min: 0.001, period_max: 0.02}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  ASSERT_EQ(profile.expected.size(), 1U);
  EXPECT_EQ(profile.expected[0].object, "source");
  EXPECT_EQ(profile.expected[0].raw, 8);
  EXPECT_THAT(profile.expected[0].modes, ElementsAre("cyclic_position"));
  EXPECT_EQ(profile.expected[0].text, "it is off");
  EXPECT_EQ(profile.expected[0].remedy, "turn it on");
  EXPECT_THAT(profile.counts_rule.times, ElementsAre("resolution"));
  EXPECT_THAT(profile.counts_rule.over, ElementsAre("gear"));
  EXPECT_EQ(profile.sync_period_min, std::chrono::milliseconds(1));
  EXPECT_EQ(profile.sync_period_max, std::chrono::milliseconds(20));
  EXPECT_EQ(profile.timing.brake_object, "brake");
  EXPECT_EQ(profile.timing.brake_release, std::chrono::milliseconds(500));
}

TEST(ProfileSettings, AreRefusedWhereTheyCanMeanNothing) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"expected: [{object: sorce, raw: 8, text: a, remedy: b}]",
       "expected[0]/object: the profile has no object `sorce`, did you mean `source`?"},
      {"expected: [{object: label, raw: 8, text: a, remedy: b}]",
       "expected[0]/object: `label` is no whole number that the drive lets be read"},
      {"expected: [{object: blind, raw: 8, text: a, remedy: b}]",
       "expected[0]/object: `blind` is no whole number that the drive lets be read"},
      {"expected: [{object: source, raw: 256, text: a, remedy: b}]", "expected[0]/raw"},
      {"expected: [{object: source, raw: 8, remedy: b}]", "expected[0]: `text` is missing"},
      {"expected: [{object: source, raw: 8, text: a}]", "expected[0]: `remedy` is missing"},
      {"expected: [{object: source, text: a, remedy: b}]", "expected[0]: `raw` is missing"},
      {"expected: [{object: source, raw: 8, modes: [pp], text: a, remedy: b}]",
       "expected[0]/modes[0]"},
      {"counts_rule: {over: [gear]}", "counts_rule: `times` is missing"},
      {"counts_rule: {times: [label]}", "counts_rule/times[0]: `label` is no whole number"},
      {"timing: {brake_release: {object: gear, at_most: 1}}",
       "timing/brake_release/object: `gear` does not measure a time"},
      {"timing: {brake_release: {object: brake}}",
       "timing/brake_release: `at_most` is missing: the longest that it may say, s"},
      {"timing: {brake_release: {object: brake, at_most: 60.1}}", "timing/brake_release/at_most"},
      {"sync: {period_min: 0.02, period_max: 0.01}", "sync: period_max is below period_min"},
  };
  for (const auto& [text, told] : mistakes) {
    Problems problems;
    settingsWith(text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(told)) << text;
  }
}

}  // namespace
}  // namespace cia402::config
