// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class BootSuperviseTest : public test::NodeFixture {};

TEST_F(BootSuperviseTest, a_drive_that_took_the_consumer_heartbeat_time_notices_a_dead_master) {
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(node->supervision().kind, ErrorControl::heartbeat);
  EXPECT_TRUE(node->supervision().watched);
  EXPECT_TRUE(node->supervision().watches_master);
  peer.replace("603 23 16 10 01 2C 01 7F 00", "583 80 16 10 01 00 00 02 06");
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(node->supervision().watched);
  EXPECT_FALSE(node->supervision().watches_master);
}

TEST_F(BootSuperviseTest, nobody_notices_a_dead_master_where_that_is_not_asked_for) {
  config.master_timeout = Duration::zero();
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_FALSE(node->supervision().watches_master);
  EXPECT_TRUE(node->supervision().watched);
}

// 16 bits of milliseconds (CiA 301, 7.5.2.18); 0 would switch the heartbeat off.
TEST_F(BootSuperviseTest, a_heartbeat_time_is_the_nearest_that_the_object_can_hold) {
  struct Case {
    Duration heartbeat;
    const char* write;
  };
  for (const Case& c : {Case{microseconds(999), "603 2B 17 10 00 01 00 00 00"},
                        Case{milliseconds(1), "603 2B 17 10 00 01 00 00 00"},
                        Case{milliseconds(65535), "603 2B 17 10 00 FF FF 00 00"},
                        Case{milliseconds(65536), "603 2B 17 10 00 FF FF 00 00"},
                        Case{milliseconds(100000), "603 2B 17 10 00 FF FF 00 00"}}) {
    config.heartbeat = c.heartbeat;
    peer.take();
    boot();
    EXPECT_TRUE(sentLine(c.write)) << toSeconds(c.heartbeat) << " s";
  }
}

TEST(ErrorControlText, is_one_word_each) {
  EXPECT_STREQ(toString(ErrorControl::none), "none");
  EXPECT_STREQ(toString(ErrorControl::heartbeat), "heartbeat");
  EXPECT_STREQ(toString(ErrorControl::guarding), "guarding");
}

}  // namespace
}  // namespace cia402::canopen
