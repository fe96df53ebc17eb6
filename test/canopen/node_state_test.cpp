// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a node tells of itself, before its first boot and when it cannot be used.
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using test::frame;
using test::kStatusword;
using test::Lines;
using ::testing::HasSubstr;

class NodeStateTest : public test::NodeFixture {
 protected:
  void bootReady() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    peer.take();
  }
  void tpdo(const std::string& text) { node->receiveTpdo(0, frame(text), now); }
  fieldbus::ProcessValue statusword() {
    return node->image().input(node->image().inputSlot(kStatusword));
  }
};

TEST_F(NodeStateTest, is_excused_while_it_is_away_and_may_be) {
  for (const bool optional : {false, true}) {
    config.boot.optional = optional;
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    EXPECT_FALSE(node->excused()) << "it is there";
    pass(milliseconds(300));
    ASSERT_EQ(node->health(), Health::lost);
    EXPECT_EQ(node->excused(), optional);
  }
}

TEST_F(NodeStateTest, tells_why_a_stopped_drive_cannot_be_asked) {
  bootReady();
  EXPECT_EQ(node->askingRefusal("6041:00 statusword"), "");
  node->command(NmtCommand::stop, now);
  hear("703 04");
  EXPECT_THAT(node->askingRefusal("6041:00 statusword"),
              HasSubstr("shoulder (node 3): 6041:00 statusword cannot be asked for: the drive's "
                        "heartbeat says stopped"));
}

TEST_F(NodeStateTest, one_that_is_refused_is_made_pre_operational_and_tells_why) {
  bootReady();
  const std::uint32_t before = node->changes();
  node->refuse("cannot be used: two have one COB-ID");
  EXPECT_EQ(peer.take(), Lines{"000 80 03"});
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(), "shoulder (node 3): cannot be used: two have one COB-ID");
  EXPECT_GT(node->changes(), before);
  tpdo("183 37 02 01 00 00 00");
  EXPECT_FALSE(statusword().valid);
}

TEST_F(NodeStateTest, believes_no_tpdo_before_the_first_boot) {
  create();
  tpdo("183 37 02 01 00 00 00");
  EXPECT_FALSE(statusword().valid);
}

TEST_F(NodeStateTest, a_command_out_of_operation_before_the_first_boot_only_leaves) {
  create();
  node->command(NmtCommand::stop, now);
  EXPECT_EQ(peer.take(), Lines{"000 02 03"});
  EXPECT_EQ(node->health(), Health::absent);
  EXPECT_EQ(node->problem(), "");
  hear("703 04");
  EXPECT_EQ(node->health(), Health::absent);
}

TEST_F(NodeStateTest, a_boot_is_news) {
  bool deadlines_changed = false;
  node.emplace(config, master, peer, nullptr, &deadlines_changed);
  const std::uint32_t before = node->changes();
  node->boot(now, false);
  EXPECT_GT(node->changes(), before);
  EXPECT_TRUE(deadlines_changed);
}

TEST_F(NodeStateTest, one_that_rebooted_is_in_no_other_state) {
  bootReady();
  peer.forget(test::kAskDeviceType);
  hear("703 00");
  EXPECT_EQ(node->nmtState(), NmtState::boot_up);
}

TEST_F(NodeStateTest, one_that_is_booted_is_asked_for_no_tpdo) {
  config.pdos[1].transmission = 253;
  peer.replace("603 40 00 18 02 00 00 00 00", "583 4F 00 18 02 FD 00 00 00");
  bootReady();
  node->onSync(now);
  EXPECT_EQ(peer.take(), Lines{"183 R6"});
  peer.forget(test::kAskDeviceType);
  hear("703 00");
  peer.take();
  node->onSync(now);
  EXPECT_TRUE(peer.take().empty());
}

}  // namespace
}  // namespace cia402::canopen
