// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Several axes in one device (CiA 402-2): what the configuration makes of them.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <sstream>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using canopen::PdoConfig;
using canopen::PdoDirection;
using fieldbus::ObjectId;
using testing::ElementsAre;
using testing::HasSubstr;

/// Two axes of node 3, and one of node 4.
std::string twoAxesText(const std::string& left = "", const std::string& right = "",
                        const std::string& drive = "generic_cia402") {
  return "bus: {interface: can0, sync_period: 0.004}\n"
         "defaults: {drive: " +
         drive +
         ", counts_per_turn: 4000, limits: {velocity: 2.0, acceleration: 8.0}}\n"
         "axes:\n"
         "  left: {node_id: 3, device_axis: 0" +
         left +
         "}\n"
         "  right: {node_id: 3, device_axis: 1" +
         right +
         "}\n"
         "  other: {node_id: 4}\n";
}

struct Configured {
  RobotConfig robot;
  Problems problems;
  canopen::MasterConfig master;
};

Configured configured(const std::string& yaml, const ProfileLookup& profiles) {
  Configured made;
  made.robot = loadRobot(YAML::Load(yaml), profiles, made.problems);
  if (made.problems.empty()) made.master = makeMasterConfig(made.robot, made.problems);
  return made;
}

Configured configured(const std::string& yaml) {
  return configured(yaml, profilesIn({test::configFolder() + "/drives"}));
}

/// The generic profile with a line of `pdo_rules`.
Configured configuredWithRules(const std::string& rules, const std::string& yaml) {
  std::ifstream file(test::configFolder() + "/drives/generic_cia402.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string path = testing::TempDir() + "device_axes_" + std::to_string(getpid()) + ".yaml";
  std::ofstream(path) << text.str() << "\npdo_rules: " << rules << "\n";
  return configured(yaml, [&](const std::string&) { return path; });
}

/// Enabled PDOs: number, and what is mapped.
std::map<unsigned, std::vector<ObjectId>> mappedBy(const canopen::NodeConfig& node,
                                                   PdoDirection direction) {
  std::map<unsigned, std::vector<ObjectId>> found;
  for (const PdoConfig& pdo : node.pdos) {
    if (!pdo.enabled || pdo.direction != direction) continue;
    for (const canopen::PdoEntry& entry : pdo.entries) found[pdo.number].push_back(entry.object);
  }
  return found;
}

unsigned cobIdOf(const canopen::NodeConfig& node, PdoDirection direction, unsigned number) {
  for (const PdoConfig& pdo : node.pdos) {
    if (pdo.direction == direction && pdo.number == number) return pdo.cob_id;
  }
  return 0xFFFFFFFF;
}

TEST(DeviceAxes, OneNodeIsMadeOfAllOfADevice) {
  const Configured made = configured(twoAxesText());
  ASSERT_EQ(made.problems.text(), "");
  ASSERT_EQ(made.robot.axes.size(), 3U);
  ASSERT_EQ(made.robot.devices.size(), 2U);
  ASSERT_EQ(made.master.nodes.size(), 2U);
  EXPECT_EQ(made.master.nodes[0].node_id, 3);
  EXPECT_EQ(made.master.nodes[0].title, "left, right (node 3)");
  EXPECT_EQ(drive::whoIs(made.robot.axes[1]), "right (node 3, axis 1)");
  EXPECT_EQ(made.master.nodes[1].title, "other (node 4)");
  EXPECT_EQ(made.robot.axes[1].profile->find("statusword")->id, (ObjectId{0x6841, 0}));
}

TEST(DeviceAxes, EachHasThePdosThatCia402GivesItWithFreeCobIds) {
  const canopen::NodeConfig node = configured(twoAxesText()).master.nodes.at(0);
  const auto rpdos = mappedBy(node, PdoDirection::rpdo), tpdos = mappedBy(node, PdoDirection::tpdo);
  ASSERT_FALSE(rpdos.empty());
  for (const auto& [number, objects] : rpdos) {
    for (const ObjectId id : objects) EXPECT_EQ(drive::axisOf(id), number > 64 ? 1U : 0U) << number;
  }
  for (const auto& [number, objects] : tpdos) {
    for (const ObjectId id : objects) EXPECT_EQ(drive::axisOf(id), number > 64 ? 1U : 0U) << number;
  }
  ASSERT_EQ(rpdos.count(1), 1U);
  EXPECT_EQ(rpdos.at(1).front(), (ObjectId{0x6040, 0}));
  ASSERT_EQ(rpdos.count(65), 1U);
  EXPECT_EQ(rpdos.at(65).front(), (ObjectId{0x6840, 0}));
  ASSERT_EQ(tpdos.count(65), 1U);
  EXPECT_EQ(tpdos.at(65).front(), (ObjectId{0x6841, 0}));
  EXPECT_EQ(cobIdOf(node, PdoDirection::rpdo, 1), 0x203U);
  EXPECT_EQ(cobIdOf(node, PdoDirection::tpdo, 1), 0x183U);
  // The next ones of node 3 that axis 0 does not use; then such as no device has by default.
  std::map<unsigned, int> used;
  for (const PdoConfig& pdo : node.pdos) {
    if (pdo.enabled) ++used[pdo.cob_id];
  }
  for (const auto& [id, count] : used) {
    EXPECT_EQ(count, 1) << id;
    const bool own = (id & 0x7FU) == 3 && id >= 0x183 && id <= 0x503;
    EXPECT_TRUE(own || (id >= 0x680 && id <= 0x6DF)) << id;
  }
  unsigned free = 0x203;  // the first that axis 0 leaves
  while (cobIdOf(node, PdoDirection::rpdo, (free - 0x203) / 0x100 + 1) == free &&
         rpdos.count((free - 0x203) / 0x100 + 1) != 0) {
    free += 0x100;
  }
  EXPECT_EQ(cobIdOf(node, PdoDirection::rpdo, 65), free);
}

TEST(DeviceAxes, EightOfThemFindRoom) {
  std::string text = "bus: {interface: can0, sync_period: 0.02}\naxes:\n";
  for (int i = 0; i < 8; ++i) {
    text += "  a" + std::to_string(i) + ": {node_id: 3, device_axis: " + std::to_string(i) +
            ", drive: generic_cia402, counts_per_turn: 4000, "
            "limits: {velocity: 2.0, acceleration: 8.0}}\n";
  }
  const Configured made = configured(text);
  ASSERT_EQ(made.problems.text(), "");
  ASSERT_EQ(made.master.nodes.size(), 1U);
  const canopen::NodeConfig& node = made.master.nodes[0];
  std::map<unsigned, int> used;
  for (const PdoConfig& pdo : node.pdos) {
    if (pdo.enabled) ++used[pdo.cob_id];
  }
  for (const auto& [id, count] : used) EXPECT_EQ(count, 1) << id;
  EXPECT_EQ(mappedBy(node, PdoDirection::rpdo).count(64 * 7 + 1), 1U);
  EXPECT_EQ(mappedBy(node, PdoDirection::rpdo).at(64 * 7 + 1).front(), (ObjectId{0x9840, 0}));
}

TEST(DeviceAxes, OnlyOneOfThemMayBeUsed) {
  const Configured made = configured(
      "bus: {interface: can0, sync_period: 0.004}\n"
      "axes: {right: {node_id: 3, device_axis: 1, drive: generic_cia402, counts_per_turn: 4000,\n"
      "       limits: {velocity: 2.0, acceleration: 8.0}}}\n");
  ASSERT_EQ(made.problems.text(), "");
  const canopen::NodeConfig& node = made.master.nodes.at(0);
  for (const auto& [number, objects] : mappedBy(node, PdoDirection::rpdo)) EXPECT_GT(number, 64U);
  EXPECT_EQ(cobIdOf(node, PdoDirection::rpdo, 65), 0x203U) << "nobody else has it";
  EXPECT_EQ(node.title, "right (node 3, axis 1)");
}

TEST(DeviceAxes, AllAreStoppedBeforeAnyIsConfigured) {
  const canopen::NodeConfig node = configured(twoAxesText()).master.nodes.at(0);
  ASSERT_GE(node.writes.size(), 3U);
  EXPECT_EQ(node.writes[0].object, (ObjectId{0x6040, 0}));
  EXPECT_EQ(node.writes[1].object, (ObjectId{0x6840, 0}));
  EXPECT_THAT(node.writes[0].data, ElementsAre(0x02, 0x00));  // quick stop
  EXPECT_THAT(node.writes[1].data, ElementsAre(0x02, 0x00));
  EXPECT_TRUE(node.writes[0].always && node.writes[1].always);
  int first = 0, second = 0;
  for (const canopen::StartupWrite& write : node.writes) {
    first += write.object == ObjectId{0x6085, 0} ? 1 : 0;
    second += write.object == ObjectId{0x6885, 0} ? 1 : 0;
  }
  EXPECT_EQ(first, 1) << "the quick-stop ramp of each";
  EXPECT_EQ(second, 1);
}

TEST(DeviceAxes, WherePdosAreTheDevicesTheAxesShareThem) {
  const Configured made = configuredWithRules("{pdos_per_axis: 0}", twoAxesText());
  ASSERT_EQ(made.problems.text(), "");
  const canopen::NodeConfig& node = made.master.nodes.at(0);
  EXPECT_EQ(node.pdos.size(), 8U) << "each once";
  bool first = false, second = false;
  for (const auto direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
    for (const auto& [number, objects] : mappedBy(node, direction)) {
      EXPECT_LE(number, 4U);
      for (const ObjectId id : objects) {
        first = first || id == ObjectId{0x6064, 0};
        second = second || id == ObjectId{0x6864, 0};
      }
      EXPECT_EQ(cobIdOf(node, direction, number),
                (direction == PdoDirection::rpdo ? 0x203U : 0x183U) + 0x100U * (number - 1));
    }
  }
  EXPECT_TRUE(first && second);
}

TEST(DeviceAxes, OfSharedPdosTheFirstAxisLeavesTheOthersTheirPart) {
  const Configured made = configuredWithRules("{pdos_per_axis: 0, max_pdos: 2}", twoAxesText());
  ASSERT_EQ(made.problems.text(), "");
  const canopen::NodeConfig& node = made.master.nodes.at(0);
  for (const auto direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
    const auto pdos = mappedBy(node, direction);
    ASSERT_EQ(pdos.size(), 2U);
    EXPECT_EQ(drive::axisOf(pdos.at(1).front()), 0U);
    EXPECT_EQ(drive::axisOf(pdos.at(2).front()), 1U);
  }
}

TEST(DeviceAxes, SharedPdosThatAreTooFewAreToldWithWhatEachGets) {
  const Configured made = configuredWithRules("{pdos_per_axis: 0, max_rpdos: 1}", twoAxesText());
  EXPECT_THAT(made.problems.text(),
              HasSubstr("1 RPDO of 64 bits with at most 8 objects, of which this axis gets 0 as "
                        "the device has several"));
}

TEST(DeviceAxes, SharedPdosOfTheUsersOwnMayNotMeet) {
  const std::string own =
      ", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, position_actual]}";
  const Configured made = configuredWithRules("{pdos_per_axis: 0}", twoAxesText(own, own));
  EXPECT_THAT(made.problems.text(),
              HasSubstr("axes/right/pdos: rpdo1 carries objects of another axis of this drive "
                        "already: its axes share their PDOs"));
  const Configured apart = configured(twoAxesText(own, own));
  ASSERT_EQ(apart.problems.text(), "");
  EXPECT_EQ(mappedBy(apart.master.nodes[0], PdoDirection::rpdo).at(65),
            (std::vector<ObjectId>{{0x6840, 0}, {0x687A, 0}}))
      << "rpdo1 is the axis' own first one";
}

TEST(DeviceAxes, FollowingNumbersAreAnotherWayToHaveThem) {
  const Configured made = configuredWithRules("{pdos_per_axis: 4}", twoAxesText());
  ASSERT_EQ(made.problems.text(), "");
  const auto rpdos = mappedBy(made.master.nodes.at(0), PdoDirection::rpdo);
  ASSERT_EQ(rpdos.count(5), 1U);
  EXPECT_EQ(rpdos.at(5).front(), (ObjectId{0x6840, 0}));
}

TEST(DeviceAxes, TwoOfThemCannotBeTheSame) {
  const std::string text =
      twoAxesText("", "").replace(twoAxesText().find("device_axis: 1"), 14, "device_axis: 0");
  EXPECT_THAT(configured(text).problems.text(),
              HasSubstr("axes/right/node_id: 3 is the node-ID of `left` already; `device_axis`, 0 "
                        "to 7, tells the axes of one drive apart"));
  std::string eighth = twoAxesText();
  eighth.replace(eighth.find("device_axis: 1"), 14, "device_axis: 8");
  EXPECT_THAT(configured(eighth).problems.text(), HasSubstr("axes/right/device_axis: must be"));
}

TEST(DeviceAxes, AFirstAxisWithoutADriveIsAProblemOfItsOwn) {
  for (const char* drive : {"", ", drive: none_such"}) {
    const LoadedRobot loaded = loadText(
        std::string("bus: {interface: can0, sync_period: 0.004, sync_counter: 0}\naxes:\n"
                    "  left: {node_id: 3, device_axis: 0, counts_per_turn: 4000") +
        drive +
        "}\n  right: {node_id: 3, device_axis: 1, drive: generic_cia402, counts_per_turn: 4000, "
        "modes: [cyclic_position], limits: {velocity: 2.0}}\n");
    EXPECT_THAT(loaded.problems, HasSubstr("axes/left")) << drive;
    EXPECT_THAT(loaded.problems, HasSubstr("drive")) << drive;
  }
}

TEST(DeviceAxes, WhatIsOfTheDeviceIsSaidOnce) {
  EXPECT_EQ(configured(twoAxesText(", optional: true")).problems.text(), "");
  EXPECT_TRUE(configured(twoAxesText(", optional: true")).robot.devices[0].boot.optional);
  EXPECT_EQ(configured(twoAxesText(", optional: true", ", optional: true")).problems.text(), "");
  EXPECT_THAT(configured(twoAxesText("", ", optional: true")).problems.text(),
              HasSubstr("axes/right/optional: is of the whole device, and `left`, which sits in "
                        "it, too, does not say so: give it there"));
  EXPECT_THAT(
      configured(twoAxesText(", identity: {serial: 1}", ", identity: {serial: 2}")).problems.text(),
      HasSubstr("axes/right/identity: is of the whole device, and `left`, which sits in it, too, "
                "says something else: say it there only"));
  EXPECT_THAT(configured(twoAxesText("", ", drive: damiao_dm")).problems.text(),
              HasSubstr("axes/right/drive: is of the whole device"));
}

TEST(DeviceAxes, AreNotSupervisedTwice) {
  const Configured made = configured(twoAxesText(", error_control: none"));
  int warnings = 0;
  for (const std::string& warning : made.robot.warnings) {
    warnings += warning.find("not supervised") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(warnings, 1);
}

}  // namespace
}  // namespace cia402::config
