// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/master.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "canopen/scripted_drive.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::frame;
using test::ScriptedPeer;
using ::testing::Contains;
using ::testing::ElementsAre;
using Lines = std::vector<std::string>;

class Log : public MasterListener {
 public:
  void onEmergency(Node& node, const Emergency& emergency) override {
    lines.push_back(node.name() + " emergency " + fieldbus::emergencyText(emergency.code));
  }
  void onMalformedEmergency(Node& node, std::size_t size) override {
    lines.push_back(node.name() + " malformed emergency of " + std::to_string(size) + " bytes");
  }
  void onBootUp(Node& node, Time) override { lines.push_back(node.name() + " boot-up"); }
  void onHealthChange(Node& node, Health before, Time) override {
    lines.push_back(node.name() + " " + toString(before) + " -> " + toString(node.health()));
  }
  void onForeignSync(const can::Frame&, Time, Time) override { ++foreign_syncs; }
  int foreign_syncs = 0;
  Lines take() {
    Lines result;
    result.swap(lines);
    return result;
  }
  Lines lines;
};

class MasterTest : public ::testing::Test {
 protected:
  MasterTest() {
    config.nodes = {test::servoConfig(3, "shoulder"), test::servoConfig(5, "elbow")};
    test::addServo(peer, 3);
    test::addServo(peer, 5);
    peer.on("000 82 03", "703 00").on("000 82 05", "705 00");
    peer.on("000 82 00", std::vector<std::string>{"703 00", "705 00"});
  }
  void create() { master.emplace(config, peer, &log); }
  void settle() {
    peer.deliver([this](const can::Frame& received) { master->receive(received, now, now); });
  }
  void start() {
    create();
    master->start(now);
    settle();
  }
  void hear(const std::string& text) {
    master->receive(frame(text), now, now);
    settle();
  }
  void pass(Duration duration) {
    const Time end = now + duration;
    while (master->nextDeadline() <= end) {
      now = std::max(now, master->nextDeadline());
      master->tick(now);
      settle();
    }
    now = end;
  }

  ScriptedPeer peer;
  Log log;
  MasterConfig config;
  std::optional<Master> master;
  Time now{};
};

TEST_F(MasterTest, starts_with_its_boot_up_its_heartbeat_and_a_reset_for_each_of_its_nodes) {
  create();
  master->start(now);
  EXPECT_EQ(peer.take(), (Lines{"77F 00", "77F 05", "000 82 03", "000 82 05"}));
}

TEST_F(MasterTest, starts_with_one_reset_for_all_where_that_is_configured) {
  config.reset_all = true;
  create();
  master->start(now);
  EXPECT_EQ(peer.take(), (Lines{"77F 00", "77F 05", "000 82 00"}));
  settle();
  EXPECT_EQ(master->find(5)->health(), Health::ready);
}

TEST_F(MasterTest, boots_all_nodes_in_parallel) {
  start();
  EXPECT_EQ(master->find(3)->health(), Health::ready);
  EXPECT_EQ(master->find(5)->health(), Health::ready);
  const Lines sent = peer.take();
  // Both are asked for their identity before either is configured.
  EXPECT_EQ(Lines(sent.begin() + 4, sent.begin() + 8),
            (Lines{"603 40 00 10 00 00 00 00 00", "605 40 00 10 00 00 00 00 00",
                   "603 40 18 10 01 00 00 00 00", "605 40 18 10 01 00 00 00 00"}));
}

TEST_F(MasterTest, a_silent_node_does_not_delay_the_others) {
  peer.forget("605 40 18 10 01 00 00 00 00");
  start();
  EXPECT_EQ(master->find(3)->health(), Health::ready);
  EXPECT_EQ(master->find(5)->health(), Health::booting);
}

TEST_F(MasterTest, without_reset_brings_each_node_to_pre_operational) {
  create();
  master->start(now, false);
  const Lines sent = peer.take();
  EXPECT_THAT(sent, Contains("000 80 03"));
  EXPECT_THAT(sent, Contains("000 80 05"));
  EXPECT_THAT(sent, ::testing::Not(Contains("000 82 00")));
  settle();
  EXPECT_EQ(master->find(5)->health(), Health::ready);
}

TEST_F(MasterTest, tells_boot_ups_and_changes_of_health) {
  start();
  EXPECT_THAT(log.take(), ElementsAre("shoulder absent -> booting", "elbow absent -> booting",
                                      "shoulder boot-up", "elbow boot-up",
                                      "shoulder booting -> ready", "elbow booting -> ready"));
  pass(milliseconds(200));
  hear("703 05");
  pass(milliseconds(100));
  EXPECT_THAT(log.take(), ElementsAre("elbow ready -> lost"));
  hear("705 7F");
  EXPECT_THAT(log.take(), ElementsAre("elbow lost -> booting", "elbow booting -> ready"));
  peer.forget("603 40 00 10 00 00 00 00 00");
  hear("703 00");
  EXPECT_THAT(log.take(), ElementsAre("shoulder boot-up", "shoulder ready -> booting"));
}

TEST_F(MasterTest, tells_emergencies) {
  create();
  hear("085 10 42 09 00 00 00 00 00");
  EXPECT_THAT(log.take(), ElementsAre("elbow emergency device temperature too high"));
  hear("083 10 23 03 00 00 00 00 00");
  EXPECT_THAT(log.take(),
              ElementsAre("shoulder emergency continuous overcurrent, device output side"));
  hear("083 11");
  EXPECT_THAT(log.take(), ElementsAre("shoulder malformed emergency of 1 bytes"));
}

TEST_F(MasterTest, gives_each_tpdo_to_its_node) {
  start();
  hear("185 37 02 2A 00 00 00");
  const PdoImage& elbow = master->find(5)->image();
  const PdoImage& shoulder = master->find(3)->image();
  EXPECT_EQ(elbow.input(elbow.inputSlot({0x6064, 0})).raw, 42U);
  EXPECT_FALSE(shoulder.input(shoulder.inputSlot({0x6064, 0})).valid);
  EXPECT_EQ(master->strayFrames(), 0U);
}

TEST_F(MasterTest, counts_frames_that_belong_to_nobody) {
  start();
  hear("184 37 02 2A 00 00 00");
  hear("704 05");
  hear("100 00 00 00 00 00 00");
  can::Frame extended = frame("185 37 02 2A 00 00 00");
  extended.extended = true;
  master->receive(extended, now, now);
  can::Frame remote = frame("705");
  remote.remote = true;
  master->receive(remote, now, now);
  EXPECT_EQ(master->strayFrames(), 5U);
  can::Frame error = frame("004 00 00 00 00 00 00 00 00");
  error.error = true;
  master->receive(error, now, now);
  EXPECT_EQ(master->strayFrames(), 5U);
  EXPECT_FALSE(
      master->find(5)->image().input(master->find(5)->image().inputSlot({0x6064, 0})).valid);
}

TEST_F(MasterTest, beats_its_own_heart) {
  config.nodes.clear();
  start();
  peer.take();
  pass(milliseconds(350));
  EXPECT_EQ(peer.take(), (Lines{"77F 05", "77F 05", "77F 05"}));
}

TEST_F(MasterTest, sends_sync_without_and_with_counter) {
  create();
  master->sendSync(now);
  EXPECT_EQ(peer.take(), Lines{"080"});
  config.sync_counter = 2;
  create();
  for (int i = 0; i < 3; ++i) master->sendSync(now);
  EXPECT_EQ(peer.take(), (Lines{"080 01", "080 02", "080 01"}));
  master->start(now);  // CiA 301, 7.2.5.3.1: after reset communication the first one is 1
  peer.take();
  master->sendSync(now);
  EXPECT_EQ(peer.take(), Lines{"080 01"});
}

TEST_F(MasterTest, sends_the_rpdos_of_ready_nodes_only) {
  peer.forget("605 40 18 10 01 00 00 00 00");
  start();
  peer.take();
  master->sendRpdos(now);
  EXPECT_EQ(peer.take(), Lines{"203 00 00 00 00 00 00"});
}

TEST_F(MasterTest, commands_all_nodes_with_one_frame) {
  start();
  peer.take();
  log.take();
  master->commandAll(NmtCommand::enter_pre_operational, now);
  EXPECT_EQ(peer.take(), Lines{"000 80 00"});
  EXPECT_THAT(log.take(), ElementsAre("shoulder ready -> failed", "elbow ready -> failed"));
}

TEST_F(MasterTest, a_missing_node_stays_missing_when_all_are_commanded) {
  peer.replace("000 82 00", "703 00");
  peer.forget("605 40 00 10 00 00 00 00 00");
  start();
  for (int i = 0; i < 60; ++i) {
    pass(milliseconds(100));
    hear("703 05");
  }
  ASSERT_EQ(master->find(5)->health(), Health::absent);
  ASSERT_EQ(master->find(3)->health(), Health::ready);
  master->commandAll(NmtCommand::stop, now);
  EXPECT_EQ(master->find(5)->health(), Health::absent);
  EXPECT_EQ(master->find(3)->health(), Health::failed);
}

TEST_F(MasterTest, tells_a_change_that_was_commanded_at_the_node_itself) {
  start();
  log.take();
  peer.forget("603 40 18 10 01 00 00 00 00");
  master->find(3)->boot(now, false);
  settle();
  EXPECT_THAT(log.take(), ElementsAre("shoulder ready -> booting"));
}

TEST_F(MasterTest, starts_transfers_that_others_queued) {
  start();
  peer.take();
  EXPECT_GT(master->nextDeadline(), now);
  SdoClient& sdo = master->find(5)->sdo();
  EXPECT_GT(master->nextDeadline(), now);
  sdo.upload({0x6041, 0});
  EXPECT_LE(master->nextDeadline(), now);
  master->tick(now);
  EXPECT_EQ(peer.take(), Lines{"605 40 41 60 00 00 00 00 00"});
}

TEST_F(MasterTest, finds_configured_nodes_only) {
  create();
  EXPECT_EQ(master->find(3)->name(), "shoulder");
  EXPECT_EQ(master->find(4), nullptr);
}

TEST_F(MasterTest, refuses_node_ids_and_cob_ids_that_cannot_be) {
  config.nodes[1].node_id = 3;
  EXPECT_THROW(create(), std::invalid_argument);
  for (const NodeId none : {NodeId{0}, NodeId{128}}) {
    config.nodes[1].node_id = none;
    EXPECT_THROW(create(), std::invalid_argument) << unsigned{none};
  }
  for (const NodeId last : {NodeId{1}, NodeId{127}}) {
    config.nodes[1].node_id = last;
    if (last == 127) config.node_id = 126;
    EXPECT_NO_THROW(create()) << unsigned{last};
  }
  config.nodes[1] = test::servoConfig(5, "elbow");
  config.nodes[1].pdos[1].cob_id = 0x183;
  EXPECT_THROW(create(), std::invalid_argument);
  config.nodes[1].pdos[1].cob_id = 0x800;
  EXPECT_THROW(create(), std::invalid_argument);
  config.nodes[1] = test::servoConfig(5, "elbow");
  config.nodes[1].sdo_channel.answer = 0x583;  // the shoulder's
  EXPECT_THROW(create(), std::invalid_argument);
  config.nodes[1].sdo_channel = {0x603, 0x5C5};
  EXPECT_THROW(create(), std::invalid_argument);
  config.nodes[1].sdo_channel = {0x645, 0x800};
  EXPECT_THROW(create(), std::invalid_argument);
  config.nodes[1].sdo_channel = {0x645, 0x5C5};
  EXPECT_NO_THROW(create());
}

TEST_F(MasterTest, speaks_to_a_node_on_the_sdo_channel_that_it_has) {
  config.nodes[1].sdo_channel = {0x645, 0x5C5};
  create();
  const SdoTicket ticket = master->find(5)->sdo().upload({0x6061, 0});
  master->tick(now);
  EXPECT_THAT(peer.sent, Contains("645 40 61 60 00 00 00 00 00"));
  hear("585 4F 61 60 00 07 00 00 00");
  EXPECT_FALSE(ticket->done()) << "that is nobody's identifier now";
  hear("5C5 4F 61 60 00 08 00 00 00");
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(ticket->data(), Bytes{8});
}

TEST_F(MasterTest, follows_a_tpdo_to_the_cob_id_that_the_drive_insists_on) {
  peer.replace("603 40 00 18 01 00 00 00 00", "583 43 00 18 01 A3 01 00 00");  // 1A3h
  peer.on("603 23 00 18 01 A3 01 00 80", "583 80 00 18 01 02 00 01 06");       // read-only
  start();
  const Node& shoulder = *master->find(3);
  ASSERT_EQ(shoulder.health(), Health::ready) << shoulder.problem();
  EXPECT_THAT(
      shoulder.notes(),
      Contains(::testing::HasSubstr("TPDO 1 has the COB-ID 0x1A3 that the drive insists on")));
  hear("183 37 02 2A 00 00 00");
  EXPECT_EQ(master->strayFrames(), 1U);
  hear("1A3 37 02 2A 00 00 00");
  EXPECT_EQ(shoulder.image().input(shoulder.image().inputSlot({0x6064, 0})).raw, 42U);
}

TEST_F(MasterTest, refuses_a_drive_that_insists_on_the_cob_id_of_another) {
  peer.replace("603 40 00 18 01 00 00 00 00", "583 43 00 18 01 85 01 00 00");  // elbow's 185h
  peer.on("603 23 00 18 01 85 01 00 80", "583 80 00 18 01 02 00 01 06");
  start();
  EXPECT_EQ(master->find(3)->health(), Health::failed);
  EXPECT_THAT(
      master->find(3)->problem(),
      ::testing::HasSubstr("TPDO 1 with COB-ID 0x185: that is used twice, by elbow already"));
  EXPECT_EQ(master->find(5)->health(), Health::ready);
  for (int i = 0; i < 3; ++i) hear("703 7F");
  EXPECT_EQ(std::count(peer.sent.begin(), peer.sent.end(), "000 80 03"), 1) << "refused once";
  master->find(3)->sdo().upload({0x1008, 0});
  pass(milliseconds(1));
  EXPECT_EQ(std::count(peer.sent.begin(), peer.sent.end(), "000 80 03"), 1) << "whatever follows";
  hear("185 37 02 2A 00 00 00");
  const PdoImage& elbow = master->find(5)->image();
  EXPECT_EQ(elbow.input(elbow.inputSlot({0x6064, 0})).raw, 42U);
}

TEST_F(MasterTest, no_two_rpdos_share_a_cob_id) {
  config.nodes[1].pdos[0].cob_id = 0x203;
  EXPECT_THROW(create(), std::invalid_argument);
}

TEST_F(MasterTest, asks_for_tpdos_by_remote_frame_right_after_sync) {
  config.nodes.pop_back();
  config.nodes[0].pdos[1].transmission = 253;
  peer.replace("603 40 00 18 02 00 00 00 00", "583 4F 00 18 02 FD 00 00 00");
  start();
  ASSERT_EQ(master->find(3)->health(), Health::ready) << master->find(3)->problem();
  peer.take();
  master->sendSync(now);
  EXPECT_EQ(peer.take(), (Lines{"080", "183 R6"}));
}

TEST_F(MasterTest, tells_syncs_of_others_and_does_not_call_them_stray) {
  start();
  hear("080");
  EXPECT_EQ(log.foreign_syncs, 1);
  EXPECT_EQ(master->strayFrames(), 0U);
}

TEST_F(MasterTest, pdos_whose_cob_ids_the_drives_will_tell_are_in_nobodys_way) {
  for (NodeConfig& node : config.nodes) {
    for (PdoConfig& pdo : node.pdos) pdo.cob_id = 0;
  }
  EXPECT_NO_THROW(create());
  hear("000 01 03");  // another master
  EXPECT_EQ(master->strayFrames(), 1U);
}

TEST_F(MasterTest, sends_time_from_its_start_on_once_it_knows_it) {
  config.nodes.clear();
  config.heartbeat = Duration::zero();
  config.time_interval = seconds(1);
  now = Time(seconds(1));
  create();
  master->setWallTime(seconds(441763200), now);  // 1984-01-01 00:00 UTC
  master->start(now);
  peer.take();
  pass(milliseconds(1999));
  EXPECT_EQ(peer.take(), (Lines{"100 00 00 00 00 00 00", "100 E8 03 00 00 00 00"}));
}

}  // namespace
}  // namespace cia402::canopen
