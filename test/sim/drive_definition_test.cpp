// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "folders.h"
#include "sim/drive/drive.h"

namespace cia402::sim {
namespace {

using testing::HasSubstr;

std::string errorOf(const std::string& text) {
  const std::string path = testing::TempDir() + "drive_definition_test.yaml";
  std::ofstream(path) << text;
  const auto loaded = loadDriveDefinition(path);
  std::remove(path.c_str());
  return loaded.ok() ? "" : loaded.error().message;
}

TEST(DriveDefinition, EveryDefinitionOfTheRepositoryLoads) {
  for (const char* name : {"generic_cia402", "generic_cia402_guarding", "generic_cia402_narrow",
                           "generic_cia402_dual", "damiao_dm"}) {
    const auto loaded =
        loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/" + name + ".yaml");
    EXPECT_TRUE(loaded.ok()) << (loaded.ok() ? "" : loaded.error().message);
  }
}

TEST(DriveDefinition, ReportsEveryProblemAtOnceWithItsPath) {
  const std::string error = errorOf(
      "name: x\n"
      "dictionary: [[0x6040, 0, controlword, uint16, rw, rt, 0]]\n"
      "colour: red\n"
      "encoding: roman\n"
      "units: {position: -1, torque: much}\n"
      "objects: {nonsense: \"6040:00\", controlword: 12.5}\n"
      "modes:\n"
      "  1: {behaviour: flying}\n"
      "  2: {behavior: homing}\n"
      "state_machine: {halt: perhaps, quick_stop: {values: {1: {ramp: steep}}}}\n"
      "homing: {methods: [17, 15]}\n"
      "faults:\n"
      "  odd: {register: 300}\n");
  for (const char* expected :
       {".yaml:3: colour: unknown key", ".yaml:4: encoding: unknown word `roman`",
        ".yaml:5: units/position: must be", ".yaml:5: units/torque: must be a number",
        "'nonsense' is no role", "controlword: must be an object",
        ".yaml:8: modes/1/behaviour: unknown word `flying`",
        ".yaml:9: modes/2: `behaviour` is missing",
        ".yaml:9: modes/2/behavior: unknown key, did you mean `behaviour`?",
        ".yaml:10: state_machine/halt: must be true or false",
        ".yaml:10: state_machine/quick_stop/values/1/ramp: ", ".yaml:11: homing/methods: ",
        ".yaml:13: faults/odd: `code` is missing", ".yaml:13: faults/odd/register: must be"}) {
    EXPECT_THAT(error, HasSubstr(expected));
  }
}

TEST(DriveDefinition, SaysSoWhenThereIsNoFileOrNoYaml) {
  EXPECT_THAT(loadDriveDefinition("/nowhere/x.yaml").error().message, HasSubstr("/nowhere/x.yaml"));
  EXPECT_THAT(errorOf("a: [1"), HasSubstr("problems"));
  EXPECT_THAT(errorOf("just text"), HasSubstr("must be a mapping"));
  EXPECT_THAT(errorOf("name: x"), HasSubstr("`dictionary` is missing"));
  EXPECT_THAT(errorOf("extends: nothing"), HasSubstr("nothing.yaml"));
}

TEST(DriveDefinition, RefusesWhatIsNoObjectOfItsBusOrItsEffects) {
  const std::string some = "dictionary: [[0x6040, 0, controlword, uint16, rw, rt, 5]]\n";
  EXPECT_THAT(errorOf(some + "own_bus: {node_id: here}"), HasSubstr("own_bus/node_id: must be an"));
  EXPECT_THAT(errorOf(some + "own_bus: {bit_rate: \"2003:01\"}"),
              HasSubstr("own_bus: `rates` is missing"));
  EXPECT_THAT(errorOf(some + "own_bus: {rates: {fast: 5}}"), HasSubstr("'fast' is no number"));
  EXPECT_THAT(errorOf(some + "own_bus: {rates: {1: 2000000}}"), HasSubstr("2000000"));
  for (const char* wrong : {"2003:02-01", "2003:01-xx", "20-03"}) {
    EXPECT_THAT(errorOf(some + "effective: {stop: [\"" + wrong + "\"]}"),
                HasSubstr("effective/stop: '" + std::string(wrong) + "' is no object like"));
  }
  EXPECT_THAT(errorOf(some + "effective: {stop: [\"6040:00\"]}"),
              HasSubstr("effective/stop: '6040:00' is an object of an axis"));
  EXPECT_THAT(errorOf(some + "effective: {later: []}"), HasSubstr("later"));
  EXPECT_THAT(errorOf(some + "clamped: [here]"), HasSubstr("clamped: 'here' is no object like"));
  EXPECT_THAT(errorOf(some + "clamped: [\"6040:00\"]"),
              HasSubstr("clamped: 6040:00 is not in `dictionary` with a range"));
}

TEST(DriveDefinition, AFileCanExtendAnotherBesideIt) {
  const std::string base = testing::TempDir() + "drive_definition_base.yaml";
  const std::string path = testing::TempDir() + "drive_definition_extended.yaml";
  std::ofstream(base) << "dictionary: [[0x6040, 0, controlword, uint16, rw, rt, 5],\n"
                         "             [0x1017, 0, heartbeat, uint16, rw, -, 7],\n"
                         "             [0x1018, 1, vendor, uint32, ro, -, 8]]\n"
                         "faults: {odd: {code: 0x1000}, even: {code: 0x2000}}\n";
  std::ofstream(path) << "extends: drive_definition_base\n"
                         "without: [0x1017]\n"
                         "dictionary: [[0x1018, 1, vendor, uint32, ro, -, 9]]\n"
                         "faults: {odd: {code: 0x1001}}\n";
  const auto loaded = loadDriveDefinition(path);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  struct NoBus : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } bus;
  Drive drive(loaded.value(), 1, bus, {});
  EXPECT_EQ(drive.dictionary().find({0x6040, 0})->number, 5U);
  EXPECT_EQ(drive.dictionary().find({0x1017, 0}), nullptr);
  EXPECT_EQ(drive.dictionary().find({0x1018, 1})->number, 9U);
  EXPECT_THAT(drive.faultNames(), testing::IsSupersetOf({"odd", "even"}));

  std::ofstream(base) << "extends: drive_definition_extended\ncolour: red\n";
  EXPECT_THAT(loadDriveDefinition(path).error().message,
              HasSubstr("do the files extend each other"));
  std::ofstream(base) << "colour: red\n";
  const std::string error = loadDriveDefinition(path).error().message;
  EXPECT_THAT(
      error,
      HasSubstr(
          "drive_definition_extended.yaml:1: extends: drive_definition_base.yaml:1: colour: "));
  EXPECT_THAT(error, HasSubstr("drive_definition_extended.yaml:2: without: "));
  std::remove(base.c_str());
  std::remove(path.c_str());
}

}  // namespace
}  // namespace cia402::sim
