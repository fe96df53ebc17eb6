// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/nmt/nmt.h"

#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

TEST(Nmt, commands_are_two_bytes_on_identifier_0) {
  EXPECT_EQ(test::text(nmtFrame(NmtCommand::start, 5)), "000 01 05");
  EXPECT_EQ(test::text(nmtFrame(NmtCommand::stop, 5)), "000 02 05");
  EXPECT_EQ(test::text(nmtFrame(NmtCommand::enter_pre_operational, 127)), "000 80 7F");
  EXPECT_EQ(test::text(nmtFrame(NmtCommand::reset_node, 1)), "000 81 01");
  EXPECT_EQ(test::text(nmtFrame(NmtCommand::reset_communication, 0)), "000 82 00");
}

TEST(Nmt, states_and_commands_have_names) {
  EXPECT_STREQ(toString(NmtState::pre_operational), "pre-operational");
  EXPECT_STREQ(toString(NmtState::boot_up), "boot-up");
  EXPECT_STREQ(toString(NmtState::unknown), "unknown");
  EXPECT_STREQ(toString(NmtCommand::reset_communication), "reset communication");
}

}  // namespace
}  // namespace cia402::canopen
