// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::Lines;
using ::testing::HasSubstr;

const char kLoad[] = "603 23 11 10 01 6C 6F 61 64";  // "load"
const char kResetNode[] = "000 81 03";

class BootRestore : public test::NodeFixture {
 protected:
  BootRestore() {
    config.boot.restore_before_configure = true;
    peer.on(kLoad, "583 60 11 10 01 00 00 00 00");
    peer.on(kResetNode, "703 00");
  }
  std::ptrdiff_t count(const char* line) const {
    return std::count(peer.sent.begin(), peer.sent.end(), line);
  }
};

TEST_F(BootRestore, restores_resets_the_node_and_configures_it_once_per_start) {
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(node->bootUps(), 2U);
  const auto load = std::find(peer.sent.begin(), peer.sent.end(), kLoad);
  ASSERT_NE(load, peer.sent.end());
  EXPECT_EQ(*(load - 1), "603 40 18 10 04 00 00 00 00") << "only once it is known who it is";
  EXPECT_EQ(*(load + 1), kResetNode);
  EXPECT_EQ(*(load + 2), "603 40 00 10 00 00 00 00 00");
  EXPECT_EQ(count(kLoad), 1);
  hear("703 00");  // a reboot later
  EXPECT_EQ(node->health(), Health::ready);
  node->boot(now, true);
  settle();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(count(kLoad), 1);
}

TEST_F(BootRestore, a_drive_that_may_still_move_is_stopped_first) {
  StartupWrite stop;
  stop.object = {0x6040, 0};
  stop.data = {0x02, 0x00};
  stop.only_if_different = false;
  stop.always = true;
  config.writes = {stop};
  peer.on("603 2B 40 60 00 02 00 00 00", "583 60 40 60 00 00 00 00 00");
  boot();
  EXPECT_TRUE(sentLine("603 2B 40 60 00 02 00 00 00"));
  EXPECT_EQ(node->bootStep(),
            "waiting for the drive to stand still before its parameters are restored");
  pass(milliseconds(999));
  EXPECT_EQ(count(kLoad), 0);
  pass(milliseconds(1));
  EXPECT_EQ(count(kLoad), 1);
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootRestore, takes_its_time_for_a_slow_memory) {
  peer.forget(kLoad);
  boot();
  pass(seconds(9));
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "writing 0x64616F6C to 1011:01 restore all default parameters");
  hear("583 60 11 10 01 00 00 00 00");
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(BootRestore, a_refusal_is_an_error_with_a_remedy) {
  peer.replace(kLoad, "583 80 11 10 01 20 00 00 08");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("1011:01 restore all default parameters: the drive "
                                         "refused: 0x08000020"));
  EXPECT_THAT(node->problem(), HasSubstr("leave out `restore_before_configure`"));
  EXPECT_EQ(count(kResetNode), 0);
}

TEST_F(BootRestore, a_drive_that_does_not_reset_is_not_configured) {
  peer.forget(kResetNode);
  boot();
  pass(seconds(5));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("did not reset when told so (NMT reset node); switch its "
                                         "power off and on"));
  EXPECT_FALSE(sentLine("603 2B 17 10 00 64 00 00 00"));
  hear("703 00");  // somebody did
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

// Elmo's pull the CAN lines down for a while when they are reset (ros-industrial/ros_canopen#334).
TEST_F(BootRestore, resets_the_communication_alone_where_the_node_must_not_be_reset) {
  config.reset_node_allowed = false;
  const char kResetCommunication[] = "000 82 03";  // also how each boot begins
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(count(kResetNode), 0);
  const auto load = std::find(peer.sent.begin(), peer.sent.end(), kLoad);
  ASSERT_NE(load, peer.sent.end());
  EXPECT_EQ(*(load + 1), kResetCommunication);
  EXPECT_EQ(count(kLoad), 1);
}

TEST_F(BootRestore, tells_by_which_command_a_drive_did_not_reset) {
  config.reset_node_allowed = false;
  peer.on("000 82 03", Lines{});  // the second time
  boot();
  pass(seconds(5));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("did not reset when told so (NMT reset communication)"));
}

TEST_F(BootRestore, what_1020h_said_before_does_not_count_any_more) {
  config.boot.check = ConfigurationCheck::date;
  config.boot.date = 1;
  config.boot.time = 2;
  peer.on("603 40 16 10 01 00 00 00 00", "583 43 16 10 01 2C 01 7F 00");
  peer.on("603 40 17 10 00 00 00 00 00", "583 4B 17 10 00 64 00 00 00");
  peer.on("603 40 20 10 01 00 00 00 00", "583 43 20 10 01 01 00 00 00");
  peer.on("603 40 20 10 02 00 00 00 00", "583 43 20 10 02 02 00 00 00");
  peer.on("603 23 20 10 01 00 00 00 00", "583 60 20 10 01 00 00 00 00");
  peer.on("603 23 20 10 02 00 00 00 00", "583 60 20 10 02 00 00 00 00");
  peer.on("603 23 20 10 01 01 00 00 00", "583 60 20 10 01 00 00 00 00");
  peer.on("603 23 20 10 02 02 00 00 00", "583 60 20 10 02 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine("603 40 00 1A 01 00 00 00 00")) << "configured, the drive kept 1020h";
  peer.take();
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_FALSE(sentLine("603 40 00 1A 01 00 00 00 00")) << "unchanged since";
}

TEST_F(BootRestore, says_that_it_waits_for_the_boot_up_after_the_reset) {
  peer.forget(kResetNode);
  boot();
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "waiting for boot-up after its parameters were restored");
}

}  // namespace
}  // namespace cia402::canopen
