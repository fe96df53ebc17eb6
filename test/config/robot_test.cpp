// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "config/drive_family.h"
#include "config/loaded.h"
#include "folders.h"

namespace cia402::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RobotConfig, MergesDefaultsUnderEveryAxis) {
  const LoadedRobot loaded = loadText(kArm);
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.warnings, IsEmpty());
  ASSERT_EQ(loaded.robot.axes.size(), 2u);
  const drive::AxisConfig& shoulder = loaded.robot.axes[0];
  EXPECT_EQ(shoulder.limits.velocity, 2.0);
  EXPECT_EQ(shoulder.limits.upper, 3.0);
  EXPECT_EQ(shoulder.geometry.gear_ratio, 50.0);
  EXPECT_EQ(shoulder.joint, "shoulder");
  EXPECT_EQ(shoulder.mode, "cyclic_position");
  EXPECT_EQ(shoulder.profile, loaded.robot.axes[1].profile) << "a profile is read once";
}

TEST(RobotConfig, ChoosesWhatFollowsAQuickStop) {
  EXPECT_FALSE(loadText(kArm).robot.axes[0].quick_stop_holds);
  const LoadedRobot holding = changed("gear_ratio: 50.0", "quick_stop: hold");
  EXPECT_EQ(holding.problems, "");
  EXPECT_TRUE(holding.robot.axes[0].quick_stop_holds);
  EXPECT_FALSE(holding.robot.axes[1].quick_stop_holds);
  EXPECT_EQ(changed("gear_ratio: 50.0", "quick_stop: disable").problems, "");
  EXPECT_THAT(changed("gear_ratio: 50.0", "quick_stop: brake").problems,
              HasSubstr("axes/shoulder/quick_stop"));
}

TEST(RobotConfig, ChoosesTheWayOutOfOperationAndTheSideOfTheGear) {
  const LoadedRobot loaded = changed("gear_ratio: 50.0", "disable_by: [8, 7], output_shaft: true");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.axes[0].disabling.transitions(), ElementsAre(8, 7));
  EXPECT_THAT(loaded.robot.axes[1].disabling.transitions(), ElementsAre(5, 10)) << "the profile's";
  EXPECT_TRUE(loaded.robot.axes[0].profile->output_shaft);
  EXPECT_FALSE(loaded.robot.axes[1].profile->output_shaft);
  EXPECT_THAT(changed("gear_ratio: 50.0", "disable_by: [7, 8]").problems,
              HasSubstr("axes/shoulder/disable_by: from operation enabled"));
}

TEST(RobotConfig, RefusesToHoldWhereTheProfileDoesNotSayHow) {
  Problems problems;
  const auto file = [](const std::string& drive) {
    return cia402::test::testFolder() + "/config/" + drive + ".yaml";
  };
  loadRobot(YAML::Load("bus: {interface: can0}\naxes: {a: {node_id: 1, drive: own_pdos_drive,\n"
                       "counts_per_turn: 1000, limits: {velocity: 1, acceleration: 1},\n"
                       "quick_stop: hold}}"),
            file, problems);
  EXPECT_THAT(problems.text(), HasSubstr("axes/a/quick_stop: profile own_pdos_drive does not say "
                                         "how its drives hold after a quick stop"));
}

TEST(RobotConfig, ChoosesWhatIsSavedAndRestored) {
  const LoadedRobot loaded = changed("gear_ratio: 50.0", "parameters: {save: [2, 3]}");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.axes[0].saved(), ElementsAre(2, 3));
  EXPECT_THAT(loaded.robot.axes[0].restored(), ElementsAre(1)) << "the profile's";
  EXPECT_THAT(loaded.robot.axes[1].saved(), ElementsAre(1));
  EXPECT_THAT(changed("gear_ratio: 50.0", "parameters: {save: [0]}").problems,
              HasSubstr("axes/shoulder/parameters/save[0]: must be between 1 and 127"));
  EXPECT_THAT(changed("gear_ratio: 50.0", "parameters: {save: 2}").problems,
              HasSubstr("axes/shoulder/parameters/save: must be a list of sub-indices"));
}

TEST(RobotConfig, TakesTheIdentityForLss) {
  const LoadedRobot by_identity = changed(
      "gear_ratio: 50.0",
      "lss: true, identity: {vendor_id: 1, product_code: 2, revision: 3, serial: \"0x80000004\"}");
  EXPECT_EQ(by_identity.problems, "");
  ASSERT_TRUE(by_identity.robot.devices[0].lss);
  EXPECT_EQ(by_identity.robot.devices[0].lss->identity,
            (canopen::lss::Identity{1, 2, 3, 0x80000004}));
  EXPECT_FALSE(by_identity.robot.devices[0].lss->store);
  EXPECT_FALSE(by_identity.robot.devices[1].lss);
  const LoadedRobot own =
      changed("gear_ratio: 50.0",
              "lss: {vendor_id: 1, product_code: 2, revision: 3, serial: 4, store: true}");
  EXPECT_EQ(own.problems, "");
  EXPECT_TRUE(own.robot.devices[0].lss->store);
  EXPECT_EQ(own.robot.devices[0].serial, 4u) << "the boot compares what LSS has selected";
  EXPECT_FALSE(changed("gear_ratio: 50.0", "lss: false").robot.devices[0].lss);
}

TEST(RobotConfig, RefusesAnLssThatCannotTellDrivesApart) {
  EXPECT_THAT(
      changed("gear_ratio: 50.0", "lss: {vendor_id: 1, serial: 4}").problems,
      HasSubstr("axes/shoulder/lss: needs all four numbers of the drive's identity (1018h), "
                "here or under `identity`; missing: product_code, revision"));
  EXPECT_THAT(changed("gear_ratio: 50.0", "lss: maybe").problems, HasSubstr("axes/shoulder/lss"));
  EXPECT_THAT(changed("gear_ratio: 50.0",
                      "identity: {serial: 5}, lss: {vendor_id: 1, product_code: 2, revision: 3, "
                      "serial: 4}")
                  .problems,
              HasSubstr("axes/shoulder/lss/serial: is another number than that under `identity`"));
  EXPECT_THAT(
      loadText(std::string(kArm).replace(
                   std::string(kArm).find("defaults: {"), 11,
                   "defaults: {lss: {vendor_id: 1, product_code: 2, revision: 3, serial: 4}, "))
          .problems,
      HasSubstr("`shoulder` has the same identity: LSS cannot tell the drives apart"));
}

TEST(RobotConfig, WithoutGroupsAllPositionJointsFormOne) {
  const LoadedRobot loaded = loadText(kArm);
  ASSERT_EQ(loaded.robot.groups.size(), 1u);
  EXPECT_EQ(loaded.robot.groups[0].name, "joints");
  EXPECT_THAT(loaded.robot.groups[0].joints, ElementsAre("shoulder", "elbow"));
}

TEST(RobotConfig, TheDemoRobotHasNoProblemsAndTellsWhatItsStepperCannot) {
  Problems problems;
  const YAML::Node tree =
      readRobotFile(cia402::test::configFolder() + "/robots/demo.yaml", problems);
  const RobotConfig robot =
      loadRobot(tree, profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_THAT(robot.warnings,
              ElementsAre(HasSubstr("axes/wrist: this drive watches no heartbeat")));
  std::vector<std::string> families;
  for (const drive::AxisConfig& axis : robot.axes) families.push_back(axis.profile->name);
  EXPECT_THAT(families,
              ElementsAre("sv660c", "megmeet_dm5", "nimotion_stepper", "id286_cnfa", "damiao_dm"));
  EXPECT_EQ(robot.bus.sync_counter, 0) << "most of them know none";
  EXPECT_EQ(robot.frames.size(), 5u);
  EXPECT_THAT(robot.groups.at(0).joints,
              ElementsAre("shoulder", "elbow", "wrist", "tool", "gripper"));
}

TEST(RobotConfig, TellsTenMistakesAtOnce) {
  Problems problems;
  const YAML::Node tree =
      readRobotFile(cia402::test::testFolder() + "/config/ten_mistakes.yaml", problems);
  loadRobot(tree, profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  const std::string text = problems.text();
  EXPECT_EQ(problems.list().size(), 10u) << text;
  for (const char* expected : {
           "  bus/sync_period: must be greater than 0 and at most 1, not `-0.004`\n",
           "  axes/base/colour: unknown key",
           "  axes/base/gear_ratio: must be a number, not `fast`\n",
           "  axes/shoulder/node_id: 1 is the node-ID of `base` already; `device_axis`, 0 to 7, "
           "tells the axes of one drive apart\n",
           "  axes/shoulder/drive: there is no drive profile `generic_402`",
           "  axes/elbow/pdos/tpdo1: is 80 bits long (16 + 32 + 32)",
           "  axes/elbow/limits/upper: must be greater than lower (2.0), not `-2.0`\n",
           "  axes/wrist/counts_per_turn: must be greater than 0, not `0`\n",
           "  axes/hand/mode: profile generic_cia402 has no mode `cyclic_postion` to start in, did "
           "you mean `cyclic_position`?\n",
           "  groups/arm/joints[1]: there is no joint `elbw`, did you mean `elbow`?\n",
       }) {
    EXPECT_THAT(text, HasSubstr(expected));
  }
}

struct Mistake {
  const char *from, *to, *problem;
};
const Mistake kMistakes[] = {
    {"interface: can0", "bitrate: 500000", "bus: `interface` is missing"},
    {"interface: can0", "interface: can0, bitrate: 123456", "bus/bitrate: is no bit rate"},
    {"sync_period: 0.004", "sync_period: .nan", "bus/sync_period: must be a finite number"},
    {"sync_period: 0.004", "sync_period: 0.0040001", "bus/sync_period: must be a whole number of"},
    {"sync_period: 0.004", "sync_period: 0.003333", "needs the period in 60C2h"},
    {"sync_period: 0.004", "node_id: 1", "axes/shoulder/node_id: 1 is the master's own"},
    {"sync_period: 0.004", "heartbeat: -1", "bus/heartbeat: must be at least 0"},
    {"sync_period: 0.004", "sync_counter: 1", "bus/sync_counter: 1 is no counter"},
    {"sync_period: 0.004", "listen: -0.1", "bus/listen: must be at least 0"},
    {"sync_period: 0.004", "reset: none", "bus/reset: "},
    {"defaults: {", "defaults: {gear: 5, ", "  defaults/gear: unknown key"},
    {"node_id: 1,", "node_id: 128,", "axes/shoulder/node_id: must be between 1 and 127"},
    {"node_id: 1,", "", "axes/shoulder: `node_id` is missing"},
    {"node_id: 1,", "node_id: 1, direction: 0,", "axes/shoulder/direction: must be 1 or -1"},
    {"node_id: 1,", "node_id: 1, lead: 0.01,", "axes/shoulder/lead: is for prismatic axes"},
    {"node_id: 1,", "node_id: 1, type: prismatic,", "`lead` is missing"},
    {"node_id: 1,", "node_id: 1, type: round,", "axes/shoulder/type: unknown word `round`"},
    {"node_id: 1,", "node_id: 1, type: continuous,", "a continuous joint has neither"},
    {"node_id: 1,", "node_id: 1, joint: elbow,", "the joint `elbow` is that of `shoulder`"},
    {"node_id: 1,", "node_id: 1, mode: homing,", "has no mode `homing` to start in"},
    {"node_id: 1,", "node_id: 1, mode: pt,", "needs `rated_torque`"},
    {"node_id: 1,",
     "node_id: 1, pdos: {rpdo1: [controlword], tpdo1: [statusword, position_actual]},",
     "mode `cyclic_position` needs `target_position` in an RPDO"},
    {"node_id: 1,", "node_id: 1, pdos: {rpdo1: [target_position], tpdo1: [statusword]},",
     "`controlword` must be in an RPDO"},
    {"node_id: 1,", "node_id: 1, pdos: {rpdo1: [controlword, target_position]},",
     "`position_actual` must be in a TPDO"},
    {"node_id: 1,", "node_id: 1, write: [{object: \"0x2000:01\", value: 5}],", "add its type"},
    {"node_id: 1,", "node_id: 1, write: [{object: 4120, value: 5, type: uint16}],",
     "4120h or, if 0x1018 is meant, 1018h"},
    {"node_id: 1,", "node_id: 1, write: [{object: no_such, value: 5}],", "has no object `no_such`"},
    {"node_id: 1,", "node_id: 1, write: [{object: \"0x6065\", value: 0.5}],",
     "write `object: following_error_window`"},
    {"node_id: 1,", "node_id: 1, frame: {parent: base},",
     "axes/shoulder/frame: `child` is missing"},
    {"node_id: 1,", "node_id: 1, simulation: {home_switch: [2, 1]},", "must be a range"},
    {"upper: 3.0", "upper: 1.0e+9", "would wrap around inside these limits"},
    {"method: 17", "method: 99",
     "axes/elbow/homing/method: profile generic_cia402 has no method 99"},
    {"method: 17", "timeout: 5", "axes/elbow/homing: `method` is missing"},
    {"elbow: {node_id: 2,", "elbow: {drive: damiao_dm, node_id: 2,",
     "axes/elbow/homing/method: this drive has no homing methods"},
    {"elbow:", "el-bow:", "axes/el-bow: an axis is named by a letter"},
    {"axes:", "groups: {elbow: {joints: [shoulder]}}\naxes:",
     "groups/elbow: is the name of an axis"},
    {"axes:", "groups: {arm: {joints: [elbow, elbow]}}\naxes:", "`elbow` is listed twice"},
    {"axes:", "groups: {arm: {joints: []}}\naxes:", "groups/arm/joints: must not be empty"},
    {"axes:\n  shoulder: {",
     "groups: {arm: {joints: [shoulder]}}\naxes:\n  shoulder: {mode: pv, modes: [], ",
     "`shoulder` cannot follow trajectories: no RPDO holds the target of its mode cyclic_position; "
     "add cyclic_position to `axes/shoulder/modes`"},
    {"axes:\n  shoulder: {",
     "groups: {arm: {joints: [shoulder]}}\naxes:\n  shoulder: {mode: pv, pdos: {rpdo1: "
     "[controlword, "
     "target_velocity], tpdo1: [statusword, position_actual]}, ",
     "map target_position into an RPDO in `axes/shoulder/pdos`"},
    {"axes:", "groups: {arm: {joints: [elbow], constraints: {shoulder: {goal: 1}}}}\naxes:",
     "groups/arm/constraints/shoulder: unknown key"},
    {"axes:",
     "couplings: [{joints: [p, r], axes: [shoulder, elbow], matrix: [[1, 2], [2, 4]]}]\naxes:",
     "couplings[0]/matrix: is refused"},
    {"axes:", "couplings: [{joints: [p], axes: [shoulder, elbow], matrix: [[1, 2]]}]\naxes:",
     "couplings[0]/matrix: is that of a gantry"},
    {"axes:", "joint_state_rate: 0\naxes:", "joint_state_rate: must be greater than 0"},
    {"sync_period: 0.004", "sync_period: 0.0005", "bus/sync_period: the PDOs need"},
};

TEST(RobotConfig, TellsEveryMistakeWithItsPath) {
  for (const Mistake& mistake : kMistakes) {
    EXPECT_THAT(changed(mistake.from, mistake.to).problems, HasSubstr(mistake.problem))
        << mistake.to;
  }
}

// rosparam makes 24677 of an unquoted 0x6065, and 363900 of 6065:00.
TEST(RobotConfig, TakesAnObjectsIndexForWhatYamlMadeOfIt) {
  for (const char* index : {"24677", "363900", "6065h:0", "\"0x6065\""}) {
    const LoadedRobot loaded = changed(
        "node_id: 1,", std::string("node_id: 1, write: [{object: ") + index + ", value: 5000}],");
    EXPECT_EQ(loaded.problems, "") << index;
    ASSERT_EQ(loaded.robot.axes[0].writes.size(), 1u) << index;
    Problems problems;
    const canopen::MasterConfig master = makeMasterConfig(loaded.robot, problems);
    EXPECT_EQ(master.nodes[0].writes.back().object, (fieldbus::ObjectId{0x6065, 0})) << index;
  }
}

TEST(RobotConfig, TellsAMistakeInTheDefaultsOnce) {
  const std::string problems = changed("counts_per_turn: 4000", "counts_per_turn: -1").problems;
  EXPECT_EQ(problems, "  defaults/counts_per_turn: must be greater than 0, not `-1`\n");
}

TEST(RobotConfig, WarnsOfALoadOverEightyPercentAndRefusesOneOverAHundred) {
  // Two axes of 115 + 95 + 125 bits, and at 0.9 ms 115 / 11 + 115 / 44, each, 55 for SYNC: 751 bits
  // a cycle; at 0.7 ms 115 / 14 + 115 / 57: 745 bits; at 0.95 ms, the next period of 60C2h at
  // which all fits, 115 / 10 + 115 / 42: 753 bits. And 3 * 650 bits/s of heartbeats.
  EXPECT_THAT(loadText(kArm).robot.warnings, IsEmpty());
  const LoadedRobot busy = changed("sync_period: 0.004", "sync_period: 0.0009");
  EXPECT_EQ(busy.problems, "");
  ASSERT_EQ(busy.robot.warnings.size(), 1u);
  EXPECT_THAT(busy.robot.warnings[0], HasSubstr("need 84 % of the bus at 1111 Hz"));
  const LoadedRobot full = changed("sync_period: 0.004", "sync_period: 0.0007");
  EXPECT_THAT(full.problems, HasSubstr("need 107 % of the bus at 1429 Hz"));
  EXPECT_THAT(full.problems, HasSubstr("at most 1059 Hz keep it below 80 %"));
}

TEST(RobotConfig, WarnsOfAnEffortLimitThatCannotBeSent) {
  const LoadedRobot loaded = changed("upper: 3.0", "upper: 3.0, effort: 10");
  EXPECT_EQ(loaded.problems, "");
  ASSERT_EQ(loaded.robot.warnings.size(), 1u);
  EXPECT_THAT(loaded.robot.warnings[0], HasSubstr("give `rated_torque`"));
}

TEST(RobotConfig, DamiaoTakesOnlyItsOwnStepsOfThePeriod) {
  const std::string text =
      "bus: {interface: can0, sync_period: 0.0012}\naxes: {a: {node_id: 1, drive: damiao_dm}}\n";
  EXPECT_THAT(loadText(text).problems,
              HasSubstr("`a` (profile damiao_dm) takes multiples of 0.0005 s"));
}

TEST(RobotConfig, AnObjectThatNothingSetsIsKeptAsTheDriveHasItInAnRpdo) {
  const std::string axis =
      "bus: {interface: can0}\naxes: {a: {node_id: 1, drive: generic_cia402, counts_per_turn: "
      "1000, rated_torque: 1.0, limits: {velocity: 1, acceleration: 1}, pdos: {rpdo1: "
      "[controlword, mode_of_operation, target_position], tpdo1: [statusword, position_actual]";
  EXPECT_EQ(loadText(axis + "}}}").problems, "");
  const LoadedRobot loaded = loadText(axis + ", rpdo2: [target_torque, max_torque]}}}");
  EXPECT_EQ(loaded.problems, "");
  Problems problems;
  const canopen::MasterConfig master = makeMasterConfig(loaded.robot, problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  unsigned kept = 0;
  for (const canopen::PdoConfig& pdo : master.nodes.at(0).pdos) {
    for (const canopen::PdoEntry& entry : pdo.entries) {
      EXPECT_EQ(entry.kept, entry.name == "max_torque") << entry.name;
      kept += entry.kept ? 1U : 0U;
    }
  }
  EXPECT_EQ(kept, 1U);
}

TEST(RobotConfig, WarnsOfWhatCannotBeNoticedOrLimited) {
  const std::string text =
      "bus: {interface: can0, heartbeat: 0}\naxes: {a: {node_id: 1, drive: damiao_dm}}\n";
  const LoadedRobot loaded = loadText(text);
  EXPECT_EQ(loaded.problems, "");
  ASSERT_EQ(loaded.robot.warnings.size(), 2u);
  EXPECT_THAT(loaded.robot.warnings[0], HasSubstr("axes/a/limits: no velocity limit"));
  EXPECT_THAT(loaded.robot.warnings[1], HasSubstr("bus/heartbeat: is 0"));
}

TEST(RobotConfig, NothingAtAllIsAProblemToo) {
  EXPECT_THAT(loadText("").problems, HasSubstr("it needs `bus` and `axes`"));
  const std::string empty = loadText("{}").problems;
  EXPECT_THAT(empty, HasSubstr("bus: `interface` is missing"));
  EXPECT_THAT(empty, HasSubstr("axes: is missing"));
}

TEST(RobotHoming, IsByTheNumberOfAMethodOrItsWords) {
  const auto told =
      changed("method: 17", "method: \"home switch, start negative, negative edge, inside\"");
  EXPECT_EQ(told.problems, "");
  EXPECT_EQ(told.robot.axes[1].homing->method, 29);
  EXPECT_THAT(
      changed("method: 17", "method: home switch").problems,
      HasSubstr("axes/elbow/homing/method: is the number of a homing method, or its words; "
                "profile generic_cia402 has 1 (negative limit switch, then index pulse), "));
  EXPECT_THAT(changed("method: 17", "method: home switch").problems,
              HasSubstr(", 37 (the present position), and no `home switch`"));
  EXPECT_THAT(changed("method: 17", "method: [17]").problems,
              HasSubstr("axes/elbow/homing/method"));
}

TEST(RobotWrites, AreInTheWordsOfTheObjectToo) {
  const auto written = [](const std::string& value) {
    return changed("node_id: 1,", "node_id: 1, write: [{object: halt_option, " + value + "}],");
  };
  const auto told = written("raw: \"quick stop ramp, holds\"");
  EXPECT_EQ(told.problems, "");
  ASSERT_EQ(told.robot.axes[0].writes.size(), 1U);
  EXPECT_EQ(told.robot.axes[0].writes[0].raw, 2);
  EXPECT_EQ(written("value: \"slow down ramp, holds\"").robot.axes[0].writes[0].raw, 1);
  EXPECT_THAT(
      written("raw: coasts").problems,
      HasSubstr("/raw: must be a number or words of halt_option: 1 (slow down ramp, holds), "
                "2 (quick stop ramp, holds), 3 (by the current limit, holds), 4 (by the "
                "voltage limit, holds); not `coasts`"));
}

/// Of the iD286 the meanings are not printed.
TEST(RobotWrites, OptionCodesOfStopsHaveWordsInEveryFamilyThatHasAny) {
  unsigned found = 0;
  for (const auto& file : std::filesystem::directory_iterator(test::configFolder() + "/drives")) {
    Problems problems;
    const DriveFamily family = loadDriveFamily(file.path().string(), problems);
    for (std::uint16_t index = 0x605A; index <= 0x605E; ++index) {
      const drive::ObjectSpec* object = family.drive.find(fieldbus::ObjectId{index, 0});
      if (object == nullptr || !object->writable || family.drive.name == "id286_cnfa") continue;
      EXPECT_GE(object->words.size(), 2U) << family.drive.name << ": " << object->name;
      ++found;
    }
  }
  EXPECT_GE(found, 5U + 1U + 5U + 4U + 4U) << "generic, Damiao, NiMotion, DM5, SV660C";
}

TEST(RobotHoming, NoTwoMethodsOfAFamilyHaveTheSameWords) {
  std::size_t families = 0;
  for (const auto& file : std::filesystem::directory_iterator(test::configFolder() + "/drives")) {
    Problems problems;
    const DriveFamily family = loadDriveFamily(file.path().string(), problems);
    ASSERT_TRUE(problems.empty()) << problems.text();
    std::set<std::string> words;
    for (const auto& [number, method] : family.drive.homing.methods) {
      EXPECT_TRUE(words.insert(method.text).second) << family.drive.name << ": " << method.text;
    }
    ++families;
  }
  EXPECT_GE(families, 6U);
}

}  // namespace
}  // namespace cia402::config
