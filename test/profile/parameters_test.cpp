// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a profile says of saving and restoring parameters, and of what numbers they hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kDriveWithMemory = std::string(kLeastDrive) + R"(
  keep: {object: "2000:01", type: uint16}
  initialise: {object: "2000:02", type: uint16}
  restart: {object: "2000:03", type: uint16}
  layer: {object: "2000:04", type: uint16}
  told: {object: "2000:05", type: uint16, access: ro}
  label: {object: "2000:06", type: visible_string}
modes:
  csp: {value: 8, control: position, cyclic: true, target: target_position}
)";

WholeProfile memoryWith(const std::string& text, Problems& problems) {
  return parseDriveFamily(kDriveWithMemory + text + "\n", "tested.yaml", problems);
}

TEST(ProfileParameters, AreSavedAndRestoredByTheMakersObjects) {
  Problems problems;
  const WholeProfile profile = memoryWith(
      "parameters: {save: [1, 2], restore: [3], timeout: 4, power_cycle_after_save: true,\n"
      "  save_by: {object: keep, on: 3, off: 2},\n"
      "  restore_by: {object: initialise, value: 7, then: set its node-ID},\n"
      "  commands: [restart, initialise], load_last: [layer]}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const auto& parameters = profile.parameters;
  EXPECT_THAT(parameters.save, ElementsAre(1, 2));
  EXPECT_THAT(parameters.restore, ElementsAre(3));
  EXPECT_EQ(parameters.timeout, std::chrono::seconds(4));
  EXPECT_TRUE(parameters.power_cycle_after_save);
  const drive::ParameterRecipes& recipes = parameters.recipes;
  EXPECT_EQ(recipes.memory.object, "keep");
  EXPECT_EQ(recipes.memory.on, 3);
  EXPECT_EQ(recipes.memory.off, 2);
  EXPECT_EQ(recipes.restore.object, "initialise");
  EXPECT_EQ(recipes.restore.value, 7);
  EXPECT_EQ(recipes.restore.then, "set its node-ID");
  EXPECT_THAT(recipes.commands, ElementsAre("restart", "initialise"));
  EXPECT_THAT(recipes.load_last, ElementsAre("layer"));
}

TEST(ProfileParameters, AreThoseOfCia301WithoutThem) {
  Problems problems;
  const WholeProfile profile = memoryWith("", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_EQ(profile.parameters.recipes.memory.object, "");
  EXPECT_EQ(profile.parameters.recipes.restore.object, "");
  EXPECT_FALSE(profile.parameter_names.typeOf({0x2000, 1}, 2));
}

TEST(ProfileParameters, ThatAreWrongAreTold) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"parameters: {save_by: {on: 1}}", "parameters/save_by: `object` is missing"},
      {"parameters: {save_by: {object: told}}",
       "parameters/save_by/object: `told` cannot be written"},
      {"parameters: {save_by: {object: kept}}", "did you mean `keep`?"},
      {"parameters: {save_by: {object: keep, on: -1}}", "parameters/save_by/on"},
      {"parameters: {restore_by: {value: 1}}", "parameters/restore_by: `object` is missing"},
      {"parameters: {restore_by: {object: label}}",
       "parameters/restore_by/object: `label` is no whole number"},
      {"parameters: {restore_by: {object: keep, raw: 1}}", "raw"},
      {"parameters: {commands: [gone]}", "parameters/commands[0]: the profile has no object"},
      {"parameters: {load_last: [label]}", "parameters/load_last[0]: `label`"},
      {"parameter_names: {prefix: P, index: 0x2000, last_group: 1, signed: [x]}",
       "parameter_names/signed[0]: `x` is no range of objects"},
      {"parameter_names: {prefix: P, index: 0x2000, last_group: 1, steps: {0.2: []}}",
       "parameter_names/steps/0.2: `0.2` is no step such as 0.1 or 0.001"},
      {"parameter_names: {prefix: P, index: 0x2000, last_group: 1, steps: {0.1: [x]}}",
       "parameter_names/steps/0.1[0]: `x` is no range of objects"},
  };
  for (const auto& [text, told] : mistakes) {
    Problems problems;
    memoryWith(text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(told)) << text;
  }
}

TEST(ProfileParameters, HoldTheNumbersThatTheManualPrints) {
  Problems problems;
  const WholeProfile profile = memoryWith(
      "parameter_names: {prefix: P, index: 0x2000, subindex: 1, last_group: 3, whole: true,\n"
      "  signed: [\"2001:02-03\"], steps: {0.1: [\"2001:02\"], 0.001: [\"2002\"]}}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  using fieldbus::DataType;
  const drive::ParameterNames& names = profile.parameter_names;
  EXPECT_EQ(names.typeOf({0x2001, 2}, 2), DataType::int16);
  EXPECT_EQ(names.typeOf({0x2001, 3}, 4), DataType::int32);
  EXPECT_EQ(names.typeOf({0x2001, 4}, 2), DataType::uint16);
  EXPECT_EQ(names.typeOf({0x2001, 4}, 4), DataType::uint32);
  EXPECT_FALSE(names.typeOf({0x2001, 4}, 1));
  EXPECT_FALSE(names.typeOf({0x2004, 1}, 2)) << "of no group";
  EXPECT_EQ(names.printed({0x2001, 2}, 480), "48.0");
  EXPECT_EQ(names.printed({0x2001, 2}, -5), "-0.5");
  EXPECT_EQ(names.printed({0x2002, 9}, 5), "0.005");
  EXPECT_EQ(names.printed({0x2001, 3}, 480), "");
  const std::pair<const char*, const char*> counted[] = {
      {"48.0", "480"}, {"48", "48"}, {"0.5", "5"},     {"-0.5", "-5"},     {".5", "5"},
      {"0.0", "0"},    {"5.", "50"}, {"0x1A", "0x1A"}, {"1.0e3", "1.0e3"}, {"007.0", "70"}};
  for (const auto& [text, number] : counted) {
    EXPECT_EQ(names.counted({0x2001, 2}, text).value(), number) << text;
  }
  EXPECT_EQ(names.counted({0x2001, 2}, "0.50").value(), "5");
  EXPECT_FALSE(names.counted({0x2001, 2}, "0.55"));
  EXPECT_EQ(names.counted({0x2001, 3}, "0.55").value(), "0.55") << "nothing is known of it";
}

}  // namespace
}  // namespace cia402::config
