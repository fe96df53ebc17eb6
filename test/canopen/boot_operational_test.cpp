// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The end of a boot: what tells that the drive has become operational.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BootOperationalTest : public test::NodeFixture {};

TEST_F(BootOperationalTest, is_ready_only_when_the_heartbeat_says_operational) {
  peer.forget("000 01 03");
  boot();
  EXPECT_EQ(node->bootStep(), "waiting for the heartbeat to say operational");
  hear("703 7F");  // was on its way
  EXPECT_EQ(node->health(), Health::booting);
  hear("703 05");
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(BootOperationalTest, fails_when_the_drive_does_not_become_operational) {
  peer.forget("000 01 03");
  boot();
  for (int i = 0; i < 11; ++i) {
    hear("703 7F");
    pass(milliseconds(100));
  }
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("did not say operational"));
  EXPECT_EQ(peer.take().back(), "000 80 03");
}

TEST_F(BootOperationalTest, without_heartbeat_its_first_tpdo_tells_that_it_is_operational) {
  config.heartbeat = Duration::zero();
  config.master_timeout = Duration::zero();
  peer.forget("000 01 03");
  boot();
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "waiting for the first TPDO");
  EXPECT_FALSE(sentLine("603 2B 17 10 00 64 00 00 00"));
  EXPECT_FALSE(sentLine("603 23 16 10 01 2C 01 7F 00"));
  EXPECT_EQ(peer.take().back(), "000 01 03");
  pass(milliseconds(250));
  EXPECT_EQ(peer.take(), Lines{"000 01 03"}) << "the first one may have been lost";
  node->receiveTpdo(0, test::frame("183 37 02 01 00 00 00"), now);
  pass(milliseconds(0));
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("cannot notice a dead master: neither"),
                                         HasSubstr("not supervised, its loss will show in missing "
                                                   "TPDOs only")));
}

TEST_F(BootOperationalTest, without_heartbeat_and_without_tpdos_in_time_the_boot_fails) {
  config.heartbeat = Duration::zero();
  peer.forget("000 01 03");
  boot();
  pass(milliseconds(1000));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(),
              HasSubstr("was started (NMT), but none of its TPDOs came in time; read its error"));
  EXPECT_EQ(peer.take().back(), "000 80 03");
}

TEST_F(BootOperationalTest, where_no_tpdo_comes_by_itself_it_is_asked_for_its_state) {
  config.heartbeat = Duration::zero();
  config.pdos[1].transmission = 255;
  peer.replace("603 40 00 18 02 00 00 00 00", "583 4F 00 18 02 FF 00 00 00");
  peer.forget("000 01 03");
  peer.on("703 R1", "703 05");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("not supervised")));
  peer.forget("703 R1");
  boot();
  EXPECT_EQ(node->health(), Health::booting);
  pass(milliseconds(100));
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes().back(), HasSubstr("nothing tells whether it became operational"));
}

TEST_F(BootOperationalTest, a_start_command_that_was_lost_is_repeated) {
  peer.forget("000 01 03");
  boot();
  peer.take();
  hear("703 7F");
  peer.on("000 01 03", "703 05");
  pass(milliseconds(250));
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(peer.take(), Lines{"000 01 03"});
}

}  // namespace
}  // namespace cia402::canopen
