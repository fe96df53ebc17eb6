// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The first and the last value that a key takes, what no section knows, and several mistakes at
// once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "config/loaded.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The arm with further keys for the shoulder.
LoadedRobot shoulderWith(const std::string& keys) {
  return changed("node_id: 1,", "node_id: 1, " + keys + ",");
}

TEST(RobotBoundaries, NumbersOfAnIdentityHave32Bits) {
  for (const std::string section : {"identity", "simulation", "lss"}) {
    const bool simulated = section == "simulation";
    const std::string others = section == "lss" ? "vendor_id: 1, product_code: 1, revision: 1, "
                                                  "serial: 1"
                                                : "";
    for (const std::string key : {simulated ? "vendor" : "vendor_id",
                                  simulated ? "product" : "product_code", "revision", "serial"}) {
      const auto problems = [&](const std::string& value) {
        std::string keys = others;
        const std::size_t at = keys.find(key + ": 1");
        if (at != std::string::npos) {
          keys.replace(at, key.size() + 3, key + ": " + value);
        } else {
          keys = key + ": " + value;
        }
        return shoulderWith(section + ": {" + keys + "}").problems;
      };
      SCOPED_TRACE(section + "/" + key);
      EXPECT_EQ(problems("0"), "");
      EXPECT_EQ(problems("0xFFFFFFFF"), "");
      const auto refused =
          HasSubstr("axes/shoulder/" + section + "/" + key + ": must be between 0 and 4294967295");
      EXPECT_THAT(problems("-1"), refused);
      EXPECT_THAT(problems("0x100000000"), refused);
    }
  }
}

TEST(RobotBoundaries, OfTheBus) {
  const auto problems = [](const std::string& key) {
    return changed("sync_period: 0.004", key).problems;
  };
  for (const char* allowed :
       {"sync_period: 1", "node_id: 3", "node_id: 127", "heartbeat: 0", "heartbeat: 65.535",
        "listen: 0", "listen: 60", "sync_window: 0", "sync_window: 0.004", "time_interval: 0",
        "time_interval: 0.01", "time_interval: 86400", "sync_counter: 0", "sync_counter: 2",
        "sync_counter: 240", "bitrate: 1000000"}) {
    EXPECT_EQ(problems(allowed), "") << allowed;
  }
  struct Refused {
    const char *key, *problem;
  };
  const Refused refused[] = {
      {"sync_period: 0", "bus/sync_period: must be greater than 0 and at most 1"},
      {"sync_period: 1.000001", "bus/sync_period: must be greater than 0 and at most 1"},
      {"sync_period: 0.000099", "bus/sync_period: must be at least 0.0001 s"},
      {"node_id: 0", "bus/node_id: must be between 1 and 127"},
      {"heartbeat: 65.536", "bus/heartbeat: must be at least 0 and at most 65.535"},
      {"listen: 60.1", "bus/listen: must be at least 0 and at most 60"},
      {"sync_window: 0.004001", "bus/sync_window: must not be longer than sync_period"},
      {"sync_window: 1.1", "bus/sync_window: must be at least 0 and at most 1"},
      {"time_interval: 86400.1", "bus/time_interval: must be at least 0 and at most 86400"},
      {"sync_counter: -1", "bus/sync_counter: must be between 0 and 240"},
      {"bitrate: 0", "bus/bitrate: must be between 1 and 1000000"},
      {"bitrate: 1000001", "bus/bitrate: must be between 1 and 1000000"},
  };
  for (const Refused& test : refused) {
    EXPECT_THAT(problems(test.key), HasSubstr(test.problem)) << test.key;
  }
  EXPECT_EQ(changed("can0", "abcdefghijklmno").problems, "") << "15 letters";
  EXPECT_THAT(problems("sync_period: 0.0001"), Not(HasSubstr("must be at least")));
}

TEST(RobotBoundaries, OfTheRateOfJointStates) {
  const auto problems = [](const std::string& rate) {
    return changed("axes:", "joint_state_rate: " + rate + "\naxes:").problems;
  };
  EXPECT_EQ(problems("0.1"), "");
  EXPECT_EQ(problems("1000"), "");
  const auto refused = HasSubstr("joint_state_rate: must be greater than 0 and at most 1000");
  EXPECT_THAT(problems("0"), refused);
  EXPECT_THAT(problems("1001"), refused);
}

TEST(RobotBoundaries, OfTheBoot) {
  struct Key {
    const char *name, *first, *last, *before, *behind;
  };
  const Key keys[] = {{"retries", "0", "1000", "-1", "1001"},
                      {"retry_delay", "0.01", "3600", "0.009", "3600.1"},
                      {"search_period", "0", "3600", "-0.1", "3600.1"}};
  for (const Key& key : keys) {
    const auto problems = [&](const char* value) {
      return shoulderWith("boot: {" + std::string(key.name) + ": " + value + "}").problems;
    };
    SCOPED_TRACE(key.name);
    EXPECT_EQ(problems(key.first), "");
    EXPECT_EQ(problems(key.last), "");
    EXPECT_THAT(problems(key.before), HasSubstr("axes/shoulder/boot/" + std::string(key.name)));
    EXPECT_THAT(problems(key.behind), HasSubstr("axes/shoulder/boot/" + std::string(key.name)));
  }
}

TEST(RobotBoundaries, OfAnSdoChannel) {
  const auto problems = [](const std::string& request, const std::string& answer) {
    return shoulderWith("sdo: {request: " + request + ", answer: " + answer + "}").problems;
  };
  EXPECT_EQ(problems("1", "0x7FF"), "");
  EXPECT_EQ(problems("0x7FF", "1"), "");
  EXPECT_THAT(problems("0x602", "0x5C1"),
              HasSubstr("axes/shoulder/sdo/request: COB-ID 0x602 belongs to SDO of elbow already"));
  EXPECT_THAT(problems("0x641", "0x582"),
              HasSubstr("axes/shoulder/sdo/answer: COB-ID 0x582 belongs to SDO of elbow already"));
  for (const char* refused : {"0", "0x800"}) {
    EXPECT_THAT(problems(refused, "0x5C1"),
                HasSubstr("axes/shoulder/sdo/request: must be between 1 and 2047"));
    EXPECT_THAT(problems("0x641", refused),
                HasSubstr("axes/shoulder/sdo/answer: must be between 1 and 2047"));
  }
}

TEST(RobotBoundaries, TheDrivesOwnDeadlineHas16BitsOfMilliseconds) {
  const auto timer = [](const char* timeout) {
    const LoadedRobot loaded = shoulderWith(std::string("rpdo_timeout: ") + timeout);
    EXPECT_EQ(loaded.problems, "");
    return loaded.robot.devices[0].axes[0].pdos.at(0).event_timer;
  };
  EXPECT_EQ(timer("65.535"), 65535);
  EXPECT_EQ(timer("0.008"), 8) << "two cycles";
  EXPECT_EQ(timer("0"), 0);
  EXPECT_THAT(shoulderWith("rpdo_timeout: 65.536").problems,
              HasSubstr("axes/shoulder/rpdo_timeout: must be at least 0 and at most 65.535"));
  EXPECT_THAT(shoulderWith("rpdo_timeout: 0.007").problems,
              HasSubstr("axes/shoulder/rpdo_timeout: must be 0 (none) or at least two cycles"));
  EXPECT_THAT(shoulderWith("rpdo_timeout: 0.0085").problems,
              HasSubstr("axes/shoulder/rpdo_timeout: must be a whole number of milliseconds, as "
                        "1400h:05 counts in them"));
}

TEST(RobotBoundaries, OfHowTrajectoriesAreSlowedDown) {
  const auto problems = [](const std::string& key) {
    return changed("axes:", "groups: {arm: {joints: [elbow], " + key + "}}\naxes:").problems;
  };
  EXPECT_EQ(problems("acceleration_margin: 1"), "");
  EXPECT_EQ(problems("lengthening: 0"), "");
  EXPECT_THAT(problems("acceleration_margin: 1.001"),
              HasSubstr("groups/arm/acceleration_margin: must be at least 0 and at most 1"));
  EXPECT_THAT(problems("lengthening: -0.1"),
              HasSubstr("groups/arm/lengthening: must be at least 0"));
}

TEST(RobotBoundaries, LimitsMayBeAsWideAsTheDrivesPosition) {
  const auto problems = [](const std::string& limits) {
    return changed("gear_ratio: 50.0, limits: {lower: -3.0, upper: 3.0}",
                   "type: prismatic, lead: 1, counts_per_turn: 1, limits: {" + limits + "}")
        .problems;
  };
  // A count is a metre.
  EXPECT_EQ(problems("lower: -2147483648, upper: 2147483647"), "");
  const auto refused = HasSubstr("axes/shoulder/limits: `position_actual` holds");
  EXPECT_THAT(problems("upper: 2147483648"), refused);
  EXPECT_THAT(problems("lower: -2147483649"), refused);
}

TEST(RobotBoundaries, ANameBeginsWithALetterOfTheAlphabet) {
  for (const char* name : {"a", "z", "A", "Z", "zZ", "a0", "a9", "a_", "fuzz_AZ_az_09"}) {
    EXPECT_TRUE(isGraphName(name)) << name;
  }
  for (const char* name : {"", "0", "9a", "_a", "a-b", "a/b", "a b", "a.b", "a{", "a`", "a@", "a[",
                           "a:", "\xC3\xA4"}) {
    EXPECT_FALSE(isGraphName(name)) << name;
  }
}

TEST(RobotMistakes, AKeyThatASectionDoesNotKnowIsTold) {
  struct Section {
    const char *from, *to, *path;
  };
  const Section sections[] = {
      {"bus:", "colour: red\nbus:", "  colour"},
      {"interface: can0", "interface: can0, colour: red", "bus/colour"},
      {"axes:", "recorder: {colour: red}\naxes:", "recorder/colour"},
      {"axes:", "groups: {arm: {joints: [elbow], colour: red}}\naxes:", "groups/arm/colour"},
      {"axes:", "groups: {arm: {joints: [elbow], constraints: {elbow: {colour: red}}}}\naxes:",
       "groups/arm/constraints/elbow/colour"},
      {"axes:", "couplings: [{joints: [p], axes: [elbow], matrix: [[1]], colour: red}]\naxes:",
       "couplings[0]/colour"},
      {"upper: 3.0", "upper: 3.0, colour: red", "axes/shoulder/limits/colour"},
      {"method: 17", "method: 17, colour: red", "axes/elbow/homing/colour"},
      {"node_id: 1,", "node_id: 1, identity: {colour: red},", "axes/shoulder/identity/colour"},
      {"node_id: 1,",
       "node_id: 1, lss: {vendor_id: 1, product_code: 2, revision: 3, serial: 4, colour: red},",
       "axes/shoulder/lss/colour"},
      {"node_id: 1,", "node_id: 1, parameters: {colour: red},", "axes/shoulder/parameters/colour"},
      {"node_id: 1,", "node_id: 1, boot: {colour: red},", "axes/shoulder/boot/colour"},
      {"node_id: 1,", "node_id: 1, error_control: {colour: red},",
       "axes/shoulder/error_control/colour"},
      {"node_id: 1,", "node_id: 1, sdo: {request: 0x641, answer: 0x5C1, colour: red},",
       "axes/shoulder/sdo/colour"},
      {"node_id: 1,", "node_id: 1, simulation: {colour: red},", "axes/shoulder/simulation/colour"},
      {"node_id: 1,", "node_id: 1, frame: {parent: a, child: b, colour: red},",
       "axes/shoulder/frame/colour"},
      {"node_id: 1,", "node_id: 1, frame: {parent: a, child: b, origin: {colour: red}},",
       "axes/shoulder/frame/origin/colour"},
  };
  for (const Section& section : sections) {
    EXPECT_THAT(changed(section.from, section.to).problems,
                HasSubstr(std::string(section.path) + ": unknown key"));
  }
}

TEST(RobotMistakes, PositionsInCountsNeedTheCountsOfATurn) {
  EXPECT_THAT(changed("counts_per_turn: 4000, ", "").problems,
              HasSubstr("axes/shoulder: `counts_per_turn` is missing: the drive's position counts "
                        "per motor turn"));
}

TEST(RobotMistakes, ADriveIsNamedByAText) {
  EXPECT_THAT(shoulderWith("unit_system: 1").problems,
              HasSubstr("axes/shoulder/unit_system: profile generic_cia402 knows units of one "));
  const std::string problems = shoulderWith("drive: [generic_cia402]").problems;
  EXPECT_THAT(problems, HasSubstr("axes/shoulder/drive: must be a text, not a list"));
  EXPECT_THAT(problems, Not(HasSubstr("there is no drive profile")));
}

TEST(RobotMistakes, AnUnknownHomingMethodIsToldWithThoseThereAre) {
  EXPECT_THAT(changed("method: 17", "method: 15").problems,
              HasSubstr("axes/elbow/homing/method: profile generic_cia402 has no method 15; it has "
                        "1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 17, 18, 19, 20, 21, 22, "
                        "23, 24, 25, 26, 27, 28, 29, 30, 33, 34, 35, 37\n"));
}

TEST(RobotMistakes, AnAxisIsGivenOnce) {
  EXPECT_THAT(changed("elbow: {node_id: 2,", "shoulder: {joint: elbow, node_id: 2,").problems,
              HasSubstr("axes/shoulder: is given twice"));
}

TEST(RobotMistakes, AGroupIsGivenOnce) {
  EXPECT_THAT(changed("axes:", "groups: {arm: {joints: [elbow]}, arm: {joints: [shoulder]}}\naxes:")
                  .problems,
              HasSubstr("groups/arm: is given twice"));
}

TEST(RobotMistakes, AnUnknownDriveIsTheOnlyProblemWhateverElseTheAxisSays) {
  const std::string problems =
      shoulderWith(
          "lead: 0.1, mode: pv, modes: [pv], feedback: [velocity_actual], lacks: [abc], "
          "stale_after: 3, "
          "rpdo_timeout: 0.1, pdos: {rpdo1: [controlword]}, write: [{object: abc, value: 1}], "
          "error_control: {kind: guarding, period: 0.1}, homing: {method: 99}, quick_stop: hold, "
          "drive: nobodys")
          .problems;
  EXPECT_THAT(problems, HasSubstr("  axes/shoulder/drive: there is no drive profile `nobodys`"));
  EXPECT_EQ(std::count(problems.begin(), problems.end(), '\n'), 1) << problems;
}

TEST(RobotMistakes, AValueThatDoesNotFitIsToldWhereItComesFromTogetherWithTheOthers) {
  struct Value {
    const char *keys, *problem;
  };
  const Value values[] = {
      {"write: [{object: position_window, value: 1.0e+9}]",
       "axes/shoulder/write: shoulder (node 1): position_window (6067:00): 1e+09 does not fit"},
      {"limits: {velocity: 1.0e+12}",
       "axes/shoulder/limits: shoulder (node 1): profile_velocity (6081:00): 1e+12 does not fit"},
      {"mode: pt, rated_torque: 1.0, limits: {effort: 1.0e+9}",
       "axes/shoulder/limits: shoulder (node 1): torque_slope (6087:00): 2e+10 does not fit"},
      {"homing: {method: 17, search_velocity: 1.0e+12}",
       "axes/shoulder/homing: shoulder (node 1): homing_search_velocity (6099:01): 1e+12 does not "
       "fit"},
  };
  std::string text = kArm;
  const std::string limits = "gear_ratio: 50.0, limits: {lower: -3.0, upper: 3.0}";
  const std::size_t at = text.find(limits);
  text.replace(text.find("node_id: 2,"), 11, "node_id: 2, lead: 0.1,");
  for (const Value& value : values) {
    std::string changed_text = text;
    EXPECT_THAT(loadText(changed_text.replace(at, limits.size(), value.keys)).problems,
                AllOf(HasSubstr(value.problem), HasSubstr("axes/elbow/lead: is for prismatic")));
  }
}

TEST(RobotMistakes, ADefaultOfAnotherKindThanTheAxisHasIsNoneForIt) {
  std::string text = kArm;
  text.replace(text.find("{velocity: 2.0, acceleration: 8.0}"), 34, "[2.0, 8.0]");
  text.replace(text.find("upper: 3.0"), 10, "upper: -3.0");
  EXPECT_THAT(loadText(text).problems,
              AllOf(HasSubstr("  axes/shoulder/limits/upper: must be greater than lower"),
                    HasSubstr("  defaults/limits: must be a mapping (key: value), not a list")));
}

TEST(RobotMistakes, InAListOfTheDefaultsAreToldOnce) {
  const std::string problems =
      changed("defaults: {", "defaults: {write: [{object: position_window, value: fast}], ")
          .problems;
  EXPECT_THAT(problems, HasSubstr("  defaults/write[0]/value: must be a number, not `fast`"));
  EXPECT_EQ(std::count(problems.begin(), problems.end(), '\n'), 1) << problems;
}

TEST(RobotMistakes, AFileThatIsNotThereIsToldByItsName) {
  Problems problems;
  readRobotFile("/nowhere/robot.yaml", problems);
  EXPECT_EQ(problems.text(), "  /nowhere/robot.yaml: cannot be read\n");
}

TEST(RobotConfig, LssMayBeLeftOutOrTellDrivesApart) {
  EXPECT_EQ(shoulderWith("lss: false").problems, "");
  std::string text = kArm;
  const std::string lss = "lss: {vendor_id: 1, product_code: 2, revision: 3, serial: ";
  text.replace(text.find("node_id: 1,"), 11, "node_id: 1, " + lss + "4},");
  EXPECT_EQ(loadText(text).problems, "") << "the elbow has none";
  text.replace(text.find("node_id: 2,"), 11, "node_id: 2, " + lss + "5},");
  const LoadedRobot both = loadText(text);
  EXPECT_EQ(both.problems, "");
  EXPECT_EQ(both.robot.devices[1].lss->identity, (canopen::lss::Identity{1, 2, 3, 5}));
}

TEST(RobotMistakes, NoAxisCanDoWithoutItsWordsAndPosition) {
  for (const std::string needed : {"controlword", "statusword", "position_actual"}) {
    EXPECT_THAT(shoulderWith("lacks: [" + needed + "]").problems,
                HasSubstr("axes/shoulder/lacks[0]: no axis can do without `" + needed + "`"));
  }
  EXPECT_THAT(shoulderWith("lacks: [torque_actual, torque_actul]").problems,
              HasSubstr("axes/shoulder/lacks[1]: profile generic_cia402 has no object "
                        "`torque_actul`, did you mean `torque_actual`?"));
  EXPECT_THAT(shoulderWith("lacks: [[torque_actual]]").problems,
              AllOf(HasSubstr("axes/shoulder/lacks[0]: must be a text, not a list"),
                    Not(HasSubstr("has no object"))));
}

TEST(RobotConfig, WhatADriveLacksDoesNotTravelThoughThereIsRoom) {
  const LoadedRobot loaded = shoulderWith("lacks: [following_error]");
  EXPECT_EQ(loaded.problems, "");
  EXPECT_THAT(loaded.robot.devices[0].axes[0].riders, testing::IsEmpty());
  EXPECT_THAT(loaded.robot.devices[1].axes[0].riders, testing::ElementsAre("following_error"));
}

TEST(RobotConfig, OnAFullBusVelocitiesComeForEveryJointStateAndDeadlinesStay) {
  // 5 ms: in every cycle of 4 ms, though for 10 ms every second one would do. In a cycle each axis
  // needs 115 + 95 bits of RPDOs and 125 + 115 of TPDOs: 8 of them more than 3200 of 4000.
  std::string text =
      "bus: {interface: can0}\njoint_state_rate: 200\ndefaults: {drive: generic_cia402, "
      "counts_per_turn: 4000, rpdo_timeout: 0.1, limits: {velocity: 2.0, acceleration: "
      "8.0}}\naxes:\n";
  for (int i = 1; i <= 8; ++i) {
    text += "  a" + std::to_string(i) + ": {node_id: " + std::to_string(i) + "}\n";
  }
  const LoadedRobot loaded = loadText(text);
  EXPECT_EQ(loaded.problems, "");
  for (const canopen::DeviceConfig& axis : loaded.robot.devices) {
    EXPECT_TRUE(axis.axes[0].riders.empty()) << axis.name;
    EXPECT_EQ(axis.axes[0].pdos.at(0).objects.front(), "controlword");
    EXPECT_EQ(axis.axes[0].pdos.at(0).event_timer, 100) << axis.name;
    for (const canopen::PdoLayout& pdo : axis.axes[0].pdos) {
      const auto& objects = pdo.objects;
      if (std::find(objects.begin(), objects.end(), "velocity_actual") == objects.end()) continue;
      EXPECT_EQ(pdo.transmission, 1) << axis.name;
    }
  }
}

TEST(RobotConfig, AJointThatAnAxisCannotStreamToIsInNoGroup) {
  std::string text = kArm;
  text.replace(text.find("node_id: 1,"), 11, "node_id: 1, mode: pv, modes: [],");
  const LoadedRobot single = loadText(text);
  EXPECT_EQ(single.problems, "");
  EXPECT_THAT(single.robot.groups.at(0).joints, testing::ElementsAre("elbow"));
  text.replace(text.find("axes:"), 5,
               "couplings: [{joints: [pitch, roll], axes: [shoulder, elbow], matrix: [[0.5, 0.5], "
               "[1, -1]]}]\naxes:");
  EXPECT_TRUE(loadText(text).robot.groups.empty()) << "the shoulder moves both";
  text.replace(text.find("axes:\n"), 6, "groups: {arm: {joints: [roll]}}\naxes:\n");
  EXPECT_THAT(loadText(text).problems,
              AllOf(HasSubstr("groups/arm/joints: `shoulder` cannot follow trajectories"),
                    Not(HasSubstr("`elbow` cannot follow"))));
}

}  // namespace
}  // namespace cia402::config
