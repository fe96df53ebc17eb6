// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a profile says of digital outputs and inputs, and of touch probes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "folders.h"
#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using testing::HasSubstr;

const std::string kDriveWithIo = std::string(kLeastDrive) + R"(
  lamps: {object: "2000:01", type: uint8}
  valves: {object: "2000:02", type: uint8}
  pins: {object: "2000:03", type: uint16, access: ro}
  blind: {object: "2000:04", type: uint16, access: wo}
  label: {object: "2000:05", type: visible_string}
  arm: {object: "2000:06", type: uint16}
  seen: {object: "2000:07", type: uint16, access: ro}
  place: {object: "2000:08", type: int32, quantity: position, access: ro}
  count: {object: "2000:09", type: uint16, access: ro}
modes:
  csp: {value: 8, control: position, cyclic: true, target: target_position}
)";

WholeProfile ioWith(const std::string& text, Problems& problems) {
  return parseDriveFamily(kDriveWithIo + text + "\n", "tested.yaml", problems);
}

TEST(ProfileIo, IsAsWritten) {
  Problems problems;
  const WholeProfile profile = ioWith(
      "outputs:\n"
      "  red: {object: lamps, bit: 7}\n"
      "  gripper: {object: lamps, bit: 0, mask: {object: valves, bit: 3}}\n"
      "inputs: {door: {object: pins, bit: 15, active_low: true}, part: {object: pins, bit: 2}}\n"
      "touch_probe:\n"
      "  function: arm\n"
      "  status: seen\n"
      "  positions: {2: {falling: place}}\n"
      "  counters: {2: {falling: count}}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  ASSERT_EQ(profile.outputs.size(), 2U);
  EXPECT_EQ(profile.outputs.at("red").value.object, "lamps");
  EXPECT_EQ(profile.outputs.at("red").value.bit, 7U);
  EXPECT_FALSE(profile.outputs.at("red").mask);
  EXPECT_EQ(profile.outputs.at("gripper").value.bit, 0U);
  ASSERT_TRUE(profile.outputs.at("gripper").mask);
  EXPECT_EQ(profile.outputs.at("gripper").mask->object, "valves");
  EXPECT_EQ(profile.outputs.at("gripper").mask->bit, 3U);
  EXPECT_EQ(profile.inputs.at("door").value.bit, 15U);
  EXPECT_TRUE(profile.inputs.at("door").active_low);
  EXPECT_FALSE(profile.inputs.at("part").active_low);
  ASSERT_TRUE(profile.touch_probes);
  EXPECT_EQ(profile.touch_probes->function, "arm");
  EXPECT_EQ(profile.touch_probes->status, "seen");
  EXPECT_EQ(profile.touch_probes->probes[0].falling.position, "");
  EXPECT_EQ(profile.touch_probes->probes[1].rising.position, "");
  EXPECT_EQ(profile.touch_probes->probes[1].falling.position, "place");
  EXPECT_EQ(profile.touch_probes->probes[1].falling.counter, "count");
}

TEST(ProfileIo, TellsActiveInputsByTheirNames) {
  Problems problems;
  const WholeProfile profile = ioWith(
      "inputs: {door: {object: pins, bit: 15, active_low: true}, part: {object: pins, bit: 2},\n"
      "  other: {object: seen, bit: 2}}",
      problems);
  const drive::ObjectSpec& pins = *profile.find("pins");
  EXPECT_EQ(drive::activeInputs(profile, pins, 0x8000), "");
  EXPECT_EQ(drive::activeInputs(profile, pins, 0x8004), "part");
  EXPECT_EQ(drive::activeInputs(profile, pins, 0x0004), "door, part");
}

TEST(ProfileIo, IsRefusedWhereItCanMeanNothing) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"outputs: {red: {object: lamp, bit: 0}}",
       "tested.yaml:21: outputs/red/object: the profile has no object `lamp`, did you mean "
       "`lamps`?"},
      {"outputs: {red: {object: lamps, bit: 8}}", "tested.yaml:21: outputs/red/bit"},
      {"outputs: {red: {object: lamps, bit: -1}}", "outputs/red/bit"},
      {"outputs: {red: {object: lamps}}", "outputs/red: `bit` is missing: 0 is its lowest"},
      {"outputs: {red: {bit: 1}}", "outputs/red: `object` is missing"},
      {"outputs: {red: {object: pins, bit: 0}}", "outputs/red/object: `pins` cannot be written"},
      {"outputs: {red: {object: blind, bit: 0}}",
       "outputs/red/object: `blind` is no whole number that the drive lets be read"},
      {"outputs: {red: {object: label, bit: 0}}", "outputs/red/object: `label` is no whole number"},
      {"outputs: {red: {object: lamps, bit: 0, mask: {object: pins, bit: 0}}}",
       "outputs/red/mask/object: `pins` cannot be written"},
      {"outputs: {red: {object: lamps, bit: 0, mask: {object: valves, bit: 8}}}",
       "outputs/red/mask/bit"},
      {"outputs: {red: {object: lamps, bit: 0, on: 1}}", "outputs/red/on"},
      {"inputs: {door: {object: pins, bit: 16}}", "inputs/door/bit"},
      {"inputs: {door: {object: blind, bit: 0}}",
       "inputs/door/object: `blind` is no whole number that the drive lets be read"},
      {"inputs: {door: {object: pins, bit: 0, active_low: maybe}}", "inputs/door/active_low"},
      {"touch_probe: {status: seen, positions: {1: {rising: place}}}",
       "touch_probe: `function` is missing"},
      {"touch_probe: {function: arm, positions: {1: {rising: place}}}",
       "touch_probe: `status` is missing"},
      {"touch_probe: {function: arm, status: seen}", "touch_probe: `positions` is missing"},
      {"touch_probe: {function: seen, status: seen, positions: {}}",
       "touch_probe/function: `seen` cannot be written"},
      {"touch_probe: {function: lamps, status: seen, positions: {}}",
       "touch_probe/function: `lamps` has less than the 16 bits of CiA 402-2"},
      {"touch_probe: {function: arm, status: seen, positions: {3: {rising: place}}}",
       "touch_probe/positions/3"},
      {"touch_probe: {function: arm, status: seen, positions: {1: {rising: count}}}",
       "touch_probe/positions/1/rising: `count` is no position that the drive lets be read"},
      {"touch_probe: {function: arm, status: seen, positions: {1: {rising: places}}}",
       "touch_probe/positions/1/rising: the profile has no object `places`, did you mean `place`?"},
      {"touch_probe: {function: arm, status: seen, positions: {}, counters: {1: {falling: blind}}}",
       "touch_probe/counters/1/falling: `blind` is no whole number"},
  };
  for (const auto& [text, told] : mistakes) {
    Problems problems;
    ioWith(text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(told)) << text;
  }
}

// The bits are those that the manuals print (docs/drives).
TEST(ProfileIo, OfTheFamiliesIsAsTheirManualsSay) {
  struct Row {
    const char *family, *output;
    unsigned bit;
    bool masked;
  };
  const Row rows[] = {{"generic_cia402", "do1", 16, true},  {"generic_cia402", "do16", 31, true},
                      {"sv660c", "do1", 16, true},          {"sv660c", "do5", 20, true},
                      {"megmeet_dm5", "do2", 17, true},     {"nimotion_stepper", "do0", 0, false},
                      {"nimotion_stepper", "do1", 1, false}};
  for (const Row& row : rows) {
    Problems problems;
    const DriveFamily family = loadDriveFamily(
        test::configFolder() + "/drives/" + std::string(row.family) + ".yaml", problems);
    ASSERT_TRUE(problems.empty()) << problems.text();
    ASSERT_EQ(family.drive.outputs.count(row.output), 1U) << row.family << " " << row.output;
    const drive::DigitalOutput& output = family.drive.outputs.at(row.output);
    EXPECT_EQ(output.value.bit, row.bit) << row.family << " " << row.output;
    ASSERT_EQ(output.mask.has_value(), row.masked) << row.family << " " << row.output;
    EXPECT_EQ(output.mask.value_or(output.value).bit, row.bit) << row.family << " " << row.output;
    const bool probes = row.family != std::string("nimotion_stepper");
    EXPECT_EQ(family.drive.touch_probes.has_value(), probes) << row.family;
  }
}

}  // namespace
}  // namespace cia402::config
