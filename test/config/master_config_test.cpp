// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/robot.h"
#include "folders.h"

namespace cia402::config {
namespace {

using canopen::NodeConfig;
using canopen::PdoConfig;
using testing::ElementsAre;
using testing::HasSubstr;

canopen::MasterConfig make(const std::string& yaml) {
  Problems problems;
  const RobotConfig robot =
      loadRobot(YAML::Load(yaml), profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  const canopen::MasterConfig master = makeMasterConfig(robot, problems);
  EXPECT_EQ(problems.text(), "");
  return master;
}

const char* const kTwo = R"(
bus: {interface: can0, sync_period: 0.004, node_id: 100, heartbeat: 0.2}
axes:
  servo:
    node_id: 5
    drive: generic_cia402
    counts_per_turn: 6283.185307179586
    limits: {velocity: 2.0, acceleration: 8.0}
    identity: {vendor_id: "0x80000181", serial: 7}
    write: [{object: "0x6065", value: 5000}, {object: position_window, value: 0.01}]
  joint: {node_id: 6, drive: damiao_dm, limits: {velocity: 2.0, effort: 7.0}}
)";

std::vector<std::uint8_t> written(const NodeConfig& node, fieldbus::ObjectId object) {
  for (const auto& write : node.writes) {
    if (write.object == object) return write.data;
  }
  return {};
}

const PdoConfig& pdo(const NodeConfig& node, canopen::PdoDirection direction, unsigned number) {
  for (const PdoConfig& config : node.pdos) {
    if (config.direction == direction && config.number == number) return config;
  }
  throw std::logic_error("no such PDO");
}

TEST(MasterConfig, CobIdsAreThoseOfThePredefinedConnectionSet) {
  const canopen::MasterConfig master = make(kTwo);
  const NodeConfig& node = master.nodes.at(0);
  const auto rpdo = canopen::PdoDirection::rpdo, tpdo = canopen::PdoDirection::tpdo;
  ASSERT_EQ(node.pdos.size(), 8u);
  EXPECT_EQ(pdo(node, rpdo, 1).cob_id, 0x205);
  EXPECT_EQ(pdo(node, rpdo, 4).cob_id, 0x505);
  EXPECT_EQ(pdo(node, tpdo, 1).cob_id, 0x185);
  EXPECT_EQ(pdo(node, tpdo, 4).cob_id, 0x485);
}

TEST(MasterConfig, MapsTheLayoutAndDisablesTheRest) {
  const canopen::MasterConfig master = make(kTwo);
  const PdoConfig& first = pdo(master.nodes.at(0), canopen::PdoDirection::rpdo, 1);
  EXPECT_TRUE(first.enabled);
  ASSERT_EQ(first.entries.size(), 2u);
  EXPECT_EQ(first.entries[0].object, (fieldbus::ObjectId{0x6040, 0}));
  EXPECT_EQ(first.entries[0].bits, 16);
  EXPECT_EQ(first.entries[1].object, (fieldbus::ObjectId{0x607A, 0}));
  EXPECT_EQ(first.entries[1].bits, 32);
  EXPECT_FALSE(pdo(master.nodes.at(0), canopen::PdoDirection::rpdo, 3).enabled);
  EXPECT_EQ(pdo(master.nodes.at(0), canopen::PdoDirection::tpdo, 3).transmission, 10);
}

TEST(MasterConfig, StartUpWritesAreBytesInWireOrder) {
  const canopen::MasterConfig master = make(kTwo);
  const NodeConfig& servo = master.nodes.at(0);
  EXPECT_THAT(written(servo, {0x6081, 0}), ElementsAre(0xD0, 0x07, 0x00, 0x00));  // 2000 counts/s
  EXPECT_THAT(written(servo, {0x6085, 0}), ElementsAre(0x80, 0x3E, 0x00, 0x00));  // 16000
  EXPECT_THAT(written(servo, {0x60C2, 1}), ElementsAre(0x04));
  EXPECT_THAT(written(servo, {0x60C2, 2}), ElementsAre(0xFD));                    // 10^-3 s
  EXPECT_THAT(written(servo, {0x6065, 0}), ElementsAre(0x88, 0x13, 0x00, 0x00));  // raw, by index
  EXPECT_THAT(written(servo, {0x6067, 0}), ElementsAre(0x0A, 0x00, 0x00, 0x00));  // 0.01 rad
  const NodeConfig& joint = master.nodes.at(1);
  EXPECT_THAT(written(joint, {0x6083, 0}), ElementsAre(0x00, 0x00, 0xA0, 0x41));  // 20.0, default
  EXPECT_THAT(written(joint, {0x6072, 0}), ElementsAre(0x00, 0x00, 0xE0, 0x40));  // 7.0
  EXPECT_THAT(written(joint, {0x605A, 0}), ElementsAre(0x02, 0x00));
  EXPECT_THAT(written(joint, {0x1029, 1}), ElementsAre(0x00));
}

TEST(MasterConfig, NamesIdentitySupervisionAndSync) {
  const canopen::MasterConfig master = make(kTwo);
  EXPECT_EQ(master.node_id, 100);
  EXPECT_EQ(master.heartbeat, std::chrono::milliseconds(200));
  EXPECT_EQ(master.sync_counter, 240);
  const NodeConfig& servo = master.nodes.at(0);
  EXPECT_EQ(servo.name, "servo");
  EXPECT_EQ(servo.vendor_id, 0x80000181u);
  EXPECT_EQ(servo.serial, 7u);
  EXPECT_FALSE(servo.device_type);
  EXPECT_EQ(servo.heartbeat, std::chrono::milliseconds(200));
  EXPECT_EQ(servo.heartbeat_timeout, std::chrono::milliseconds(600));
  EXPECT_EQ(servo.master_timeout, std::chrono::milliseconds(600));
  EXPECT_EQ(servo.sync_counter, 240);
  EXPECT_EQ(servo.sync_period_us, 4000u);
  EXPECT_EQ(master.nodes.at(1).device_type, 0x00030000u);
  EXPECT_TRUE(master.nodes.at(1).map_count_may_be_read_only);
}

TEST(MasterConfig, WithoutACounterOnlyDrivesThatExpectOneAreTold) {
  std::string text = kTwo;
  text.replace(text.find("node_id: 100"), 12, "sync_counter: 0");
  const canopen::MasterConfig master = make(text);
  EXPECT_EQ(master.sync_counter, 0);
  EXPECT_FALSE(master.nodes.at(0).sync_counter);
  EXPECT_EQ(master.nodes.at(1).sync_counter, 0);
}

TEST(BusLoad, CountsBitsAsTheStandardDoes) {
  // SYNC 47/55 bits, one RPDO and one TPDO of 6 bytes 95/115 each, at 250 Hz; no heartbeats.
  canopen::MasterConfig master;
  master.heartbeat = Duration(0);
  NodeConfig node;
  node.heartbeat = Duration(0);
  PdoConfig six;
  six.entries = {{{0x6041, 0}, 16, "statusword"}, {{0x6064, 0}, 32, "position_actual"}};
  six.direction = canopen::PdoDirection::tpdo;
  node.pdos.push_back(six);
  six.direction = canopen::PdoDirection::rpdo;
  node.pdos.push_back(six);
  master.nodes.push_back(node);
  BusLoad load = busLoad(master, 1e6);
  EXPECT_DOUBLE_EQ(load.nominal, (47 + 2 * 95) * 250 / 1e6);
  EXPECT_DOUBLE_EQ(load.worst, (55 + 2 * 115) * 250 / 1e6);
  EXPECT_DOUBLE_EQ(load.feasible_rate, 0.8e6 / (55 + 2 * 115));

  master.nodes[0].pdos[0].transmission = 5;  // every fifth SYNC
  master.sync_counter = 240;                 // one byte more in SYNC
  master.heartbeat = std::chrono::milliseconds(100);
  load = busLoad(master, 5e5);
  EXPECT_DOUBLE_EQ(load.worst, ((65 + 115 + 23) * 250 + 650) / 5e5);

  master.nodes[0].pdos[0].enabled = false;
  load = busLoad(master, 5e5);
  EXPECT_DOUBLE_EQ(load.nominal, ((55 + 95) * 250 + 550) / 5e5);

  master.nodes[0].pdos[0].enabled = true;
  master.nodes[0].pdos[0].transmission = 255;
  master.nodes[0].pdos[0].inhibit = 500;  // at most 20 a second
  load = busLoad(master, 5e5);
  EXPECT_DOUBLE_EQ(load.worst, ((65 + 115) * 250 + 650 + 115 * 20) / 5e5);
}

TEST(BusLoad, FiveDemoAxesLeaveRoomAt100Hertz) {
  Problems problems;
  const YAML::Node tree =
      readRobotFile(cia402::test::configFolder() + "/robots/demo.yaml", problems);
  const RobotConfig robot =
      loadRobot(tree, profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  EXPECT_EQ(robot.bus.sync_period, Duration(std::chrono::milliseconds(10)));
  EXPECT_LT(busLoad(makeMasterConfig(robot, problems), robot.bus.bitrate).worst, 0.8);
}

TEST(BusLoad, CountsRemoteFramesRefreshedRpdosAndTime) {
  canopen::MasterConfig master;
  master.heartbeat = Duration(0);
  master.time_interval = std::chrono::seconds(1);  // 6 bytes: 95, 115
  NodeConfig node;
  node.heartbeat = Duration(0);
  PdoConfig two;
  two.entries = {{{0x6041, 0}, 16, "statusword"}};
  two.transmission = 253;
  two.request_every = 5;
  two.direction = canopen::PdoDirection::tpdo;
  node.pdos.push_back(two);  // 63, 75 and the remote frame 47, 55
  two.direction = canopen::PdoDirection::rpdo;
  two.transmission = 1;
  two.refresh_every = 10;
  node.pdos.push_back(two);
  master.nodes.push_back(node);
  const BusLoad load = busLoad(master, 1e6);
  EXPECT_NEAR(load.nominal, ((47 + (63 + 47) / 5.0 + 63 / 10.0) * 250 + 95) / 1e6, 1e-12);
  EXPECT_NEAR(load.worst, ((55 + (75 + 55) / 5.0 + 75) * 250 + 115) / 1e6, 1e-12);
}

TEST(PdoTable, ShowsWhoSendsWhatWhenAndWhatItCosts) {
  const std::string table = pdoTable(make(kTwo), 1e6);
  // 6 bytes at 250 Hz: 95 * 250 = 2.375 %, 115 * 250 = 2.875 %.
  EXPECT_THAT(table, HasSubstr("servo                5  rpdo1   0x205   sync                 48"
                               "    2.38    2.88  controlword 6040:00, target_position 607A:00\n"));
  // 6 bytes at 25 Hz: 95 * 25 = 0.2375 %, 115 * 25 = 0.2875 %.
  EXPECT_THAT(table, HasSubstr("joint                6  tpdo3   0x386   sync / 10            48"
                               "    0.24    0.29  error_code 603F:00, following_error 60F4:00\n"));
  EXPECT_THAT(table, HasSubstr("total, with SYNC and heartbeats, at 1000000 bit/s and 250 Hz: "));
}

constexpr const char* kServo = R"(
bus: {interface: can0, sync_period: 0.004BUS}
axes:
  servo: {node_id: 5, drive: generic_cia402, counts_per_turn: 4000,
          limits: {velocity: 2.0, acceleration: 8.0}AXIS}
)";

/// The servo with more keys of the bus and of the axis; its problems go to `text`.
canopen::MasterConfig servo(const std::string& bus, const std::string& axis, std::string& text) {
  std::string yaml = kServo;
  yaml.replace(yaml.find("BUS"), 3, bus);
  yaml.replace(yaml.find("AXIS"), 4, axis);
  Problems problems;
  const RobotConfig robot =
      loadRobot(YAML::Load(yaml), profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  canopen::MasterConfig master;
  if (problems.empty()) master = makeMasterConfig(robot, problems);
  text = problems.text();
  return master;
}

TEST(MasterConfig, CobIdsMayBeGivenOrLeftToTheDrive) {
  std::string problems;
  const canopen::MasterConfig master = servo("", R"(, pdos: {rpdo1: [controlword, target_position],
              tpdo1: {objects: [statusword, position_actual], cob_id: "0x1A5"},
              tpdo2: {objects: [velocity_actual], cob_id: "$NODEID+0x1C0"},
              tpdo3: {objects: [torque_actual], cob_id: drive}})",
                                             problems);
  EXPECT_EQ(problems, "");
  const auto tpdo = canopen::PdoDirection::tpdo;
  EXPECT_EQ(pdo(master.nodes.at(0), tpdo, 1).cob_id, 0x1A5);
  EXPECT_EQ(pdo(master.nodes.at(0), tpdo, 2).cob_id, 0x1C5);
  EXPECT_EQ(pdo(master.nodes.at(0), tpdo, 3).cob_id, 0);
}

TEST(MasterConfig, RefusesCobIdsThatAreTakenOrReserved) {
  std::string problems;
  servo("", R"(, pdos: {rpdo1: [controlword, target_position],
          tpdo1: {objects: [statusword, position_actual], cob_id: "0x205"}})",
        problems);
  EXPECT_THAT(problems,
              HasSubstr("axes/servo/pdos: tpdo1 of `servo` has the COB-ID 0x205, which is "
                        "that of rpdo1 of `servo` already"));
  servo("", R"(, pdos: {rpdo1: [controlword, target_position],
          tpdo1: {objects: [statusword, position_actual], cob_id: "0x600"}})",
        problems);
  EXPECT_THAT(problems, HasSubstr("COB-ID 0x600, which CiA 301 keeps for something else"));
  servo("", R"(, pdos: {rpdo1: [controlword, target_position],
          tpdo1: {objects: [statusword, position_actual], cob_id: "0x080"}})",
        problems);
  EXPECT_THAT(problems, HasSubstr("tpdo1/cob_id: must be `drive`, a number from 0x181"));
}

TEST(MasterConfig, RemoteFramesAskForTypes252And253Only) {
  std::string problems;
  const canopen::MasterConfig master =
      servo("", R"(, stale_after: 3, pdos: {rpdo1: [controlword, target_position],
          tpdo1: [statusword, position_actual],
          tpdo2: {objects: [velocity_actual], transmission: 252, request_every: 5}})",
            problems);
  EXPECT_EQ(problems, "");
  const PdoConfig& asked = pdo(master.nodes.at(0), canopen::PdoDirection::tpdo, 2);
  EXPECT_EQ(asked.transmission, 252);
  EXPECT_EQ(asked.request_every, 5);
  EXPECT_EQ(asked.stale_after, 3);
  servo("", R"(, pdos: {rpdo1: {objects: [controlword, target_position], transmission: 253},
          tpdo1: {objects: [statusword, position_actual], request_every: 2}})",
        problems);
  EXPECT_THAT(problems, HasSubstr("rpdo1/transmission: types 252 and 253 are asked for"));
  EXPECT_THAT(problems, HasSubstr("tpdo1/request_every: is for TPDOs of transmission type 252"));
}

TEST(MasterConfig, TheDrivesOwnDeadlineStandsOnTheControlword) {
  std::string problems;
  const canopen::MasterConfig master = servo("", ", rpdo_timeout: 0.05", problems);
  EXPECT_EQ(problems, "");
  const auto rpdo = canopen::PdoDirection::rpdo;
  EXPECT_EQ(pdo(master.nodes.at(0), rpdo, 1).event_timer, 50);
  EXPECT_EQ(pdo(master.nodes.at(0), rpdo, 2).event_timer, 0) << "it is sent on change";
  EXPECT_EQ(pdo(make(kTwo).nodes.at(1), rpdo, 1).event_timer, 100) << "the profile says it has one";
  EXPECT_EQ(pdo(make(kTwo).nodes.at(0), rpdo, 1).event_timer, 0);
  servo("", ", rpdo_timeout: 0.005", problems);
  EXPECT_THAT(problems, HasSubstr("axes/servo/rpdo_timeout: must be 0 (none) or at least two"));
}

TEST(MasterConfig, SyncMayComeFromOutsideAndHaveAWindow) {
  std::string problems;
  const canopen::MasterConfig master =
      servo(", sync: external, sync_window: 0.003, time_interval: 1.0", "", problems);
  EXPECT_EQ(problems, "");
  EXPECT_TRUE(master.external_sync);
  EXPECT_EQ(master.time_interval, std::chrono::seconds(1));
  EXPECT_THAT(written(master.nodes.at(0), {0x1007, 0}), ElementsAre(0xB8, 0x0B, 0x00, 0x00));
  EXPECT_THAT(written(servo("", "", problems).nodes.at(0), {0x1007, 0}), testing::IsEmpty());
  servo(", sync: other, sync_window: 0.005, time_interval: 0.001", "", problems);
  EXPECT_THAT(problems, HasSubstr("bus/sync: "));
  EXPECT_THAT(problems, HasSubstr("bus/sync_window: must not be longer than sync_period"));
  EXPECT_THAT(problems, HasSubstr("bus/time_interval: must be 0"));
}

TEST(MasterConfig, ResetsItsOwnNodesUnlessToldOtherwiseOrLssNeedsIt) {
  const auto resetsAll = [](const std::string& from, const std::string& to) {
    std::string yaml = kTwo;
    yaml.replace(yaml.find(from), from.size(), to);
    return make(yaml).reset_all;
  };
  EXPECT_FALSE(make(kTwo).reset_all);
  EXPECT_FALSE(resetsAll("heartbeat: 0.2", "reset: each"));
  EXPECT_TRUE(resetsAll("heartbeat: 0.2", "reset: all"));
  EXPECT_TRUE(
      resetsAll("    identity:",
                "    lss: {vendor_id: \"0x80000181\", product_code: 2, revision: 3, serial: 7}\n"
                "    identity:"));
}

TEST(MasterConfig, ModesThatCannotBeServedAreRefused) {
  std::string problems;
  servo("", ", modes: [cyclic_velocity, cyclic_spline]", problems);
  EXPECT_THAT(problems, HasSubstr("axes/servo/modes[1]: profile generic_cia402 has no mode"));
  servo("", R"(, modes: [cyclic_velocity], pdos: {rpdo1: [controlword, target_position],
          tpdo1: [statusword, position_actual]})",
        problems);
  EXPECT_THAT(problems,
              HasSubstr("axes/servo/modes: mode `cyclic_velocity` needs `target_velocity` "
                        "in an RPDO"));
}

TEST(BusLoad, TellsTheLargestFeasibleRate) {
  std::string yaml =
      "bus: {interface: can0, sync_period: 0.001}\ndefaults: {drive: generic_cia402, "
      "counts_per_turn: 4000, modes: [], feedback: [], limits: {velocity: 2.0, "
      "acceleration: 8.0}}\naxes:\n";
  for (int i = 1; i <= 6; ++i) {
    yaml += "  a" + std::to_string(i) + ": {node_id: " + std::to_string(i) + "}\n";
  }
  Problems problems;
  loadRobot(YAML::Load(yaml), profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  // Worst: 55 + 6 * (115 + 125) bits per cycle, seven heartbeats of 65 bits at 10 Hz:
  // (0.8e6 - 4550) / 1495 = 532 Hz.
  EXPECT_THAT(problems.text(),
              HasSubstr("bus/sync_period: the PDOs need 150 % of the bus at 1000 Hz"));
  EXPECT_THAT(problems.text(), HasSubstr("at most 532 Hz keep it below 80 %"));
}

/// That many generic axes at 250 Hz on 1 Mbit/s.
RobotConfig genericAxes(int count) {
  std::string yaml =
      "bus: {interface: can0}\ndefaults: {drive: generic_cia402, counts_per_turn: "
      "4000, limits: {velocity: 2.0, acceleration: 8.0}}\naxes:\n";
  for (int i = 1; i <= count; ++i) {
    yaml += "  a" + std::to_string(i) + ": {node_id: " + std::to_string(i) + "}\n";
  }
  Problems problems;
  return loadRobot(YAML::Load(yaml), profilesIn({cia402::test::configFolder() + "/drives"}),
                   problems);
}

TEST(BusLoad, WhatTravelsForTheRoomOnlyStaysAwayFromAFullBus) {
  EXPECT_THAT(genericAxes(1).devices[0].axes[0].riders, testing::ElementsAre("following_error"));
  const RobotConfig full = genericAxes(8);
  for (const canopen::DeviceConfig& device : full.devices) {
    EXPECT_TRUE(device.axes[0].riders.empty());
    for (const canopen::PdoLayout& pdo : device.axes[0].pdos) {
      EXPECT_THAT(pdo.objects, testing::Not(testing::Contains("following_error")));
    }
  }
  for (int count = 1; count <= 8; ++count) {
    const RobotConfig robot = genericAxes(count);
    Problems problems;
    const double worst = busLoad(makeMasterConfig(robot, problems), robot.bus.bitrate).worst;
    EXPECT_TRUE(worst <= 0.8 || robot.devices[0].axes[0].riders.empty()) << count << ": " << worst;
  }
}

TEST(BusLoad, TheRateThatIsToldIsFeasibleWithThePlanOfThatRate) {
  const auto yaml = [](const std::string& period) {
    return "bus: {interface: can0, bitrate: 250000, sync_period: " + period +
           "}\naxes:\n  a: {node_id: 1, drive: generic_cia402, counts_per_turn: 4000, "
           "limits: {velocity: 2.0, acceleration: 8.0}}\n";
  };
  const auto load = [&](const std::string& period, Problems& problems) {
    return loadRobot(YAML::Load(yaml(period)),
                     profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  };
  Problems refused;
  load("0.001", refused);
  const std::string text = refused.text();
  const std::size_t at = text.find("write `sync_period` of ");
  ASSERT_NE(at, std::string::npos) << text;
  const std::string period = text.substr(at + 23, text.find(' ', at + 23) - at - 23);
  Problems problems;
  const RobotConfig robot = load(period, problems);
  EXPECT_EQ(problems.text(), "") << "60C2h must be able to tell it, too";
  EXPECT_TRUE(robot.warnings.empty()) << robot.warnings.front();
  const BusLoad there = busLoad(makeMasterConfig(robot, problems), 250000);
  EXPECT_LE(there.worst, 0.8);
  EXPECT_GT(there.worst, 0.77);
}

}  // namespace
}  // namespace cia402::config
