// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the keys of a drive profile mean for an axis and its node, by profiles of the tests' own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using canopen::PdoDirection;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// The generic profile with the first `from` replaced by `to`, and further keys behind it.
struct OwnProfile {
  std::string keys, from, to;
};

struct OwnDrive {
  RobotConfig robot;
  Problems problems;
  canopen::NodeConfig node;
};

/// An axis of that profile, with further keys.
OwnDrive loadOwn(const OwnProfile& profile, const std::string& axis = "") {
  std::ifstream file(cia402::test::configFolder() + "/drives/generic_cia402.yaml");
  std::ostringstream generic;
  generic << file.rdbuf();
  std::string text = generic.str();
  const std::size_t at = text.find(profile.from);
  EXPECT_NE(at, std::string::npos) << profile.from;
  text.replace(at, profile.from.size(), profile.to);
  const std::string path =
      testing::TempDir() + "profile_rules_" + std::to_string(getpid()) + ".yaml";
  std::ofstream(path) << text << "\n" << profile.keys << "\n";
  const std::string robot =
      "bus: {interface: can0}\naxes: {a: {node_id: 1, drive: own, counts_per_turn: 1000, "
      "limits: {velocity: 1, acceleration: 1}" +
      axis + "}}\n";
  OwnDrive loaded;
  const auto file_of = [&](const std::string&) { return path; };
  loaded.robot = loadRobot(YAML::Load(robot), file_of, loaded.problems);
  if (!loaded.problems.empty()) return loaded;
  loaded.node = makeMasterConfig(loaded.robot, loaded.problems).nodes.at(0);
  return loaded;
}

TEST(ProfileRules, AnObjectThatDemandsATransmissionTypeIsNotSentBySdo) {
  const OwnProfile demanding{"", "{object: \"607A:00\", type: int32, quantity: position, pdo: rpdo",
                             "{object: \"607A:00\", type: int32, quantity: position, pdo: rpdo, "
                             "transmission: 1"};
  EXPECT_EQ(loadOwn(demanding).problems.text(), "");
  EXPECT_THAT(loadOwn(demanding, ", pdos: none").problems.text(),
              HasSubstr("axes/a/pdos: `target_position` must come in an RPDO of transmission type "
                        "1 (its `transmission` in profile generic_cia402), which `pdos: none` does "
                        "not have: give the axis PDOs, or `modes` without it"));
  EXPECT_EQ(loadOwn(demanding, ", pdos: none, mode: cyclic_velocity, modes: [cyclic_velocity]")
                .problems.text(),
            "");
}

TEST(ProfileRules, ThereAreAsManyPdosAsTheDriveHas) {
  const OwnDrive loaded = loadOwn({"pdo_rules: {max_rpdos: 2, max_tpdos: 3}", "", ""});
  EXPECT_EQ(loaded.problems.text(), "");
  const auto count = [&](PdoDirection direction) {
    return std::count_if(loaded.node.pdos.begin(), loaded.node.pdos.end(),
                         [&](const canopen::PdoConfig& pdo) { return pdo.direction == direction; });
  };
  EXPECT_EQ(count(PdoDirection::rpdo), 2);
  EXPECT_EQ(count(PdoDirection::tpdo), 3);
}

TEST(ProfileRules, AFifthPdoNeedsACobId) {
  const OwnProfile rules{"pdo_rules: {max_pdos: 5}", "", ""};
  const std::string pdos =
      ", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, position_actual], "
      "tpdo5: ";
  EXPECT_THAT(loadOwn(rules, pdos + "[velocity_actual]}").problems.text(),
              HasSubstr("axes/a/pdos: tpdo5 has no COB-ID: the predefined connection set ends with "
                        "the fourth; give it a `cob_id`"));
  const OwnDrive given = loadOwn(rules, pdos + "{objects: [velocity_actual], cob_id: \"0x1F0\"}}");
  EXPECT_EQ(given.problems.text(), "");
  EXPECT_EQ(given.node.pdos.at(9).cob_id, 0x1F0);
}

TEST(ProfileRules, CobIdsOfTheDriveAreLeftAlone) {
  const OwnDrive loaded = loadOwn({"pdo_rules: {cob_ids: drive}", "", ""});
  EXPECT_EQ(loaded.problems.text(), "");
  ASSERT_EQ(loaded.node.pdos.size(), 8U);
  for (const canopen::PdoConfig& pdo : loaded.node.pdos) EXPECT_EQ(pdo.cob_id, 0);
}

TEST(ProfileRules, ReachTheNode) {
  const OwnProfile profile{"identity: {vendor_id: 17, product_code: 18}\nnmt_reset_node: false",
                           "  boot: 5.0\n", "  boot: 7.5\n"};
  const canopen::NodeConfig node = loadOwn(profile).node;
  EXPECT_EQ(node.vendor_id, 17U);
  EXPECT_EQ(node.product_code, 18U);
  EXPECT_FALSE(node.revision);
  EXPECT_EQ(node.boot_timeout, std::chrono::milliseconds(7500));
  EXPECT_FALSE(node.reset_node_allowed);
  EXPECT_EQ(node.title, "a (node 1)");
  EXPECT_EQ(loadOwn({"", "sdo_retries: 1", "sdo_retries: 3"}).node.sdo.retries, 3);
  const canopen::NodeConfig other = loadOwn(profile, ", identity: {product_code: 19}").node;
  EXPECT_EQ(other.vendor_id, 17U);
  EXPECT_EQ(other.product_code, 19U) << "that of the axis counts";
}

TEST(ProfileRules, LssTakesTheDrivesPartOfTheIdentity) {
  const OwnProfile profile{"identity: {vendor_id: 17, product_code: 18}", "", ""};
  const OwnDrive loaded = loadOwn(profile, ", lss: {revision: 3, serial: 4}");
  EXPECT_EQ(loaded.problems.text(), "");
  ASSERT_TRUE(loaded.robot.devices[0].lss);
  EXPECT_EQ(loaded.robot.devices[0].lss->identity, (canopen::lss::Identity{17, 18, 3, 4}));
  EXPECT_THAT(loadOwn(profile, ", lss: true").problems.text(),
              HasSubstr("axes/a/lss: needs all four numbers of the drive's identity (1018h), here "
                        "or under `identity`; missing: revision, serial"));
}

/// All objects of the axis' PDOs.
std::vector<std::string> planned(const OwnDrive& loaded) {
  std::vector<std::string> objects;
  for (const canopen::PdoLayout& pdo : loaded.robot.devices[0].axes[0].pdos) {
    objects.insert(objects.end(), pdo.objects.begin(), pdo.objects.end());
  }
  return objects;
}

TEST(ProfileRules, TheModeTravelsOnlyWhereItMustBrake) {
  const OwnDrive loaded =
      loadOwn({"", "", ""}, ", rated_torque: 1.0, mode: csp, modes: [csv, cst]");
  EXPECT_EQ(loaded.problems.text(), "");
  EXPECT_THAT(planned(loaded), Not(Contains("mode_of_operation")));
}

// It is no reason to refuse a mode: without it the mode is written.
TEST(ProfileRules, TheModeThatBrakesTravelsWhereItFindsRoom) {
  const std::string torque = "    target: target_torque\n    status_bits: {follows_command: 12}\n";
  const std::string axis = ", rated_torque: 1.0, mode: cst, modes: []";
  const std::string braked = torque + "    stop: mode\n    stop_mode: csv\n";
  const OwnDrive loaded =
      loadOwn({"pdo_rules: {max_entries: 3, max_pdos: 1}", torque, braked}, axis);
  EXPECT_THAT(planned(loaded), Contains("target_velocity")) << loaded.problems.text();
  EXPECT_THAT(planned(loaded), Not(Contains("mode_of_operation")));
}

TEST(ProfileRules, WhatBrakesInAModeIsPlannedWithIt) {
  const std::string torque = "    target: target_torque\n    status_bits: {follows_command: 12}\n";
  const OwnProfile profile{"", torque, torque + "    stop: mode\n    stop_mode: csv\n"};
  const auto modes = [&](const std::string& axis) {
    const OwnDrive loaded = loadOwn(profile, ", rated_torque: 1.0" + axis);
    EXPECT_EQ(loaded.problems.text(), "");
    const std::vector<std::string> objects = planned(loaded);
    EXPECT_THAT(objects, Contains("target_velocity"));
    EXPECT_THAT(objects, Contains("mode_of_operation")) << "it brakes without an answer";
    return loaded.robot.axes[0].modes;
  };
  EXPECT_THAT(modes(", mode: csp, modes: [cst]"),
              ElementsAre("cyclic_position", "cyclic_torque", "cyclic_velocity"));
  EXPECT_THAT(modes(", mode: cst, modes: []"), ElementsAre("cyclic_torque", "cyclic_velocity"));
  EXPECT_THAT(modes(", mode: csp, modes: [csv, cst]"),
              ElementsAre("cyclic_position", "cyclic_velocity", "cyclic_torque"));
}

TEST(ProfileRules, AnAxisWithoutAPlanIsToldOnce) {
  const OwnDrive loaded = loadOwn({"pdo_rules: {max_pdos: 1}", "", ""}, ", modes: [csv]");
  ASSERT_EQ(loaded.problems.list().size(), 1U) << loaded.problems.text();
  EXPECT_THAT(loaded.problems.text(),
              HasSubstr("  axes/a/modes: profile generic_cia402: mode `cyclic_velocity` finds no "
                        "room"));
}

TEST(ProfileRules, HoldingNeedsAWriteThatChoosesIt) {
  const OwnDrive loaded =
      loadOwn({"", "from: quick_stop.hold, raw: 2", "raw: 2"}, ", quick_stop: hold");
  EXPECT_THAT(loaded.problems.text(),
              HasSubstr("axes/a/quick_stop: profile generic_cia402 does not say how its drives "
                        "hold after a quick stop (`quick_stop_holds`, and a write `from: "
                        "quick_stop.hold`)"));
}

}  // namespace
}  // namespace cia402::config
