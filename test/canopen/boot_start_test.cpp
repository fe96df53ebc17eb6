// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;

/// A drive without heartbeat: a TPDO that comes by itself tells that it is operational.
class BootStartTest : public test::NodeFixture {
 protected:
  BootStartTest() {
    config.heartbeat = Duration::zero();
    peer.forget("000 01 03");
  }
  /// What the boot waits for with TPDO 1 of this transmission type.
  std::string stepWith(unsigned transmission) {
    config.pdos[1].transmission = static_cast<std::uint8_t>(transmission);
    char type[40];
    std::snprintf(type, sizeof(type), "583 4F 00 18 02 %02X 00 00 00", transmission);
    peer.replace("603 40 00 18 02 00 00 00 00", type);
    boot();
    EXPECT_TRUE(node->started()) << node->problem();
    return node->bootStep();
  }
};

// CiA 301, table 72: 1 to 240 are sent with SYNC, each or every so many; 0 only after an event,
// 252 and 253 after a remote frame, 254 and 255 after an event.
TEST_F(BootStartTest, a_tpdo_is_waited_for_where_sync_brings_it) {
  for (const unsigned type : {1U, 2U, 239U, 240U}) {
    EXPECT_EQ(stepWith(type), "waiting for the first TPDO") << type;
  }
  for (const unsigned type : {0U, 241U, 253U, 254U, 255U}) {
    EXPECT_EQ(stepWith(type), "asking for the NMT state") << type;
  }
}

TEST_F(BootStartTest, a_tpdo_that_comes_seldom_has_three_of_its_periods) {
  master.sync_period = milliseconds(4);
  stepWith(240);  // every 960 ms
  pass(milliseconds(2879));
  EXPECT_EQ(node->health(), Health::booting);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::failed);
}

TEST_F(BootStartTest, one_that_did_not_start_does_not_count_as_started) {
  stepWith(1);
  pass(milliseconds(1000));
  ASSERT_EQ(node->health(), Health::failed);
  EXPECT_FALSE(node->started()) << "its PDOs are not to be believed";
}

}  // namespace
}  // namespace cia402::canopen
