// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A motor that a driver before has left turning is stopped before the drive is reset; in a mode
// whose stop only lets it go another one takes it over first.
#include "canopen/boot_brake_fixture.h"

namespace cia402::canopen {
namespace {

using test::Lines;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(BootBrakeTest, takes_the_motor_over_at_its_velocity_before_the_reset) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskStatusword, kAskShownMode, kAskVelocity, kTarget,
                                             kMode, kAskShownMode, kQuickStop, kAskStatusword));
}

// What an RPDO has left in the drive takes effect with the next SYNC, and is not to undo it.
TEST_F(BootBrakeTest, waits_for_two_syncs_before_it_writes) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  boot();
  EXPECT_THAT(peer.take(), ElementsAre(kAskStatusword, kAskShownMode));
  pass(2 * master.sync_period - std::chrono::nanoseconds(1));
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(std::chrono::nanoseconds(1));
  EXPECT_THAT(peer.take(), Contains(kTarget));
}

// Its ramp is not disturbed: the reset comes once it has no power any more.
TEST_F(BootBrakeTest, waits_until_the_motor_rests) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  peer.on(kAskStatusword, Lines{kQuickStopActive});
  peer.on(kAskStatusword, Lines{kQuickStopActive});
  rests();
  EXPECT_THAT(
      sentBeforeReset(std::chrono::milliseconds(50)),
      ElementsAre(kAskStatusword, kAskShownMode, kAskVelocity, kTarget, kMode, kAskShownMode,
                  kQuickStop, kAskStatusword, kAskStatusword, kAskStatusword));
}

// No answer comes any more while it is waited for rest: the boot sleeps until that is sure.
TEST_F(BootBrakeTest, goes_on_where_nothing_is_told_of_the_ramp) {
  config.brakes = {{}};
  config.brakes.front().statusword = {0x6041, 0};
  peer.on(kAskStatusword, Lines{});
  boot(false);
  pass(std::chrono::milliseconds(99));
  EXPECT_GT(node->nextDeadline(), now);
  EXPECT_THAT(peer.take(), ElementsAre(kAskStatusword, kQuickStop, kAskStatusword));
  pass(std::chrono::milliseconds(500));
  EXPECT_THAT(peer.take(), testing::Not(Contains(kTellPreOperational))) << "it is asked again";
  pass(std::chrono::milliseconds(2));
  EXPECT_THAT(peer.take(), Contains(kTellPreOperational));
}

// A drive may stay in quick stop active for good (605Ah = 5 to 8).
TEST_F(BootBrakeTest, waits_for_rest_for_two_seconds_at_most) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  peer.on(kAskStatusword, kQuickStopActive);
  const Lines sent = sentBeforeReset(std::chrono::seconds(3));
  EXPECT_EQ(std::count(sent.begin(), sent.end(), kAskStatusword), 201);  // every 10 ms
}

// One that was cut off, or stopped (NMT), as the boot began.
TEST_F(BootBrakeTest, takes_it_over_once_it_is_identified_where_it_did_not_answer_before) {
  peer.forget(kAskStatusword);
  boot(false);
  EXPECT_THAT(peer.take(), ElementsAre(kAskStatusword));
  peer.on(kAskStatusword, Lines{kOperationEnabled});
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  pass(std::chrono::milliseconds(400));
  const Lines sent = peer.take();
  const auto brake = std::find(sent.begin(), sent.end(), kAskStatusword);
  ASSERT_GE(sent.end() - brake, 8);
  EXPECT_THAT(Lines(brake, brake + 8),
              ElementsAre(kAskStatusword, kAskShownMode, kAskVelocity, kTarget, kMode,
                          kAskShownMode, kQuickStop, kAskStatusword));
  EXPECT_EQ(std::count(sent.begin(), brake, kTellPreOperational), 1);
  EXPECT_EQ(std::count(brake, sent.end(), kTellPreOperational), 0);
}

/// It was cut off as the boot began, and appears while its boot-up message is waited for. What it
/// tells then; pre-operational: it missed its master and left the state operational by itself.
class BootBrakeAppearsTest : public BootBrakeTest, public testing::WithParamInterface<const char*> {
 protected:
  void appears(Duration after_reset) {
    shows("583 4F 61 60 00 08 00 00 00");
    peer.forget(kAskStatusword);
    peer.forget(kReset);
    boot();
    pass(kUnanswered + after_reset);
    EXPECT_THAT(peer.take(), Contains(kReset));
    peer.on(kAskStatusword, Lines{kOperationEnabled});
    peer.on(kAskStatusword, Lines{kQuickStopActive});
    rests();
    hear(GetParam());
  }
};

TEST_P(BootBrakeAppearsTest, stops_the_motor_before_the_reset_is_sent_again) {
  appears(kAwaitsBootUp - kUnanswered);
  pass(std::chrono::milliseconds(50));
  const Lines sent = peer.take();
  ASSERT_GE(sent.size(), 7U);
  EXPECT_THAT(Lines(sent.begin(), sent.begin() + 7),
              ElementsAre(test::kAskDeviceType, kAskStatusword, kAskShownMode, kQuickStop,
                          kAskStatusword, kAskStatusword, kReset));
}

INSTANTIATE_TEST_SUITE_P(Told, BootBrakeAppearsTest, testing::Values("703 05", "703 7F"));

/// A heartbeat that was on its way as the reset was sent says nothing of it.
using BootBrakeOnItsWayTest = BootBrakeAppearsTest;
TEST_P(BootBrakeOnItsWayTest, waits_for_the_next_heartbeat) {
  appears(std::chrono::milliseconds(20));
  EXPECT_THAT(peer.take(), Not(Contains(kAskStatusword)));
  pass(std::chrono::milliseconds(40));
  hear(GetParam());
  EXPECT_THAT(peer.take(), Contains(kAskStatusword));
}
INSTANTIATE_TEST_SUITE_P(Told, BootBrakeOnItsWayTest, testing::Values("703 7F"));

TEST_F(BootBrakeTest, asks_for_the_state_again_where_a_heartbeat_says_that_the_drive_is_there) {
  shows("583 4F 61 60 00 08 00 00 00");
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, Lines{});
  peer.on(kAskStatusword, Lines{kOperationEnabled});
  rests();
  boot();
  hear("703 05");
  pass(kAwaitsBootUp);
  const Lines sent = peer.take();
  const auto reset = std::find(sent.begin(), sent.end(), kReset);
  const auto stop = std::find(sent.begin(), sent.end(), kQuickStop);
  EXPECT_LT(stop, reset) << "it came only once the drive was reset";
  EXPECT_EQ(std::count(sent.begin(), stop, kAskStatusword), 2);
}

// A stopped drive answers no SDO.
TEST_F(BootBrakeTest, does_not_ask_a_stopped_drive_again) {
  peer.forget(kAskStatusword);
  peer.forget(kReset);
  boot();
  hear("703 04");
  pass(kAwaitsBootUp);
  const Lines sent = peer.take();
  EXPECT_EQ(std::count(sent.begin(), sent.end(), kAskStatusword), 1);
  EXPECT_THAT(sent, Contains(kReset));
}

// It was there all the time, and does not tell: its reset does not wait once more.
TEST_F(BootBrakeTest, resets_again_what_answered_nothing_while_its_heartbeat_went_on) {
  peer.forget(kAskStatusword);
  peer.forget(kReset);
  boot();
  hear("703 05");
  pass(2 * kUnanswered + kAwaitsBootUp);
  peer.take();
  hear("703 05");
  EXPECT_THAT(peer.take(), ElementsAre(kReset));
}

TEST_F(BootBrakeTest, stops_a_motor_in_another_mode_at_once) {
  shows("583 4F 61 60 00 08 00 00 00");
  boot();
  EXPECT_THAT(peer.take(), ElementsAre(kAskStatusword, kAskShownMode, kQuickStop, kAskStatusword));
}

TEST_F(BootBrakeTest, stops_a_motor_without_a_mode_that_takes_it_over_at_once) {
  config.brakes = {{}};
  config.brakes.front().statusword = {0x6041, 0};
  boot();
  EXPECT_THAT(peer.take(), ElementsAre(kAskStatusword, kQuickStop, kAskStatusword));
}

// An RPDO of the driver before, which waits in the drive, may have it go on.
TEST_F(BootBrakeTest, stops_it_once_more_after_two_syncs_where_it_is_enabled_again) {
  shows("583 4F 61 60 00 08 00 00 00");
  const Duration twice = 2 * master.sync_period;
  for (Duration waited{}; waited < twice; waited += std::chrono::milliseconds(10)) {
    peer.on(kAskStatusword, Lines{kQuickStopActive});
  }
  peer.on(kAskStatusword, Lines{kOperationEnabled});
  rests();
  const Lines sent = sentBeforeReset(std::chrono::milliseconds(50));
  EXPECT_EQ(std::count(sent.begin(), sent.end(), kQuickStop), 2);
}

TEST_F(BootBrakeTest, lets_a_fault_reaction_end) {
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, Lines{kFaultReactionActive});
  peer.on(kAskStatusword, Lines{kFaultReactionActive});
  rests();
  EXPECT_THAT(sentBeforeReset(std::chrono::milliseconds(50)),
              ElementsAre(kAskStatusword, kQuickStop, kAskStatusword, kAskStatusword));
}

TEST_F(BootBrakeTest, leaves_a_motor_without_power_alone) {
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, kSwitchOnDisabled);
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskStatusword));
}

TEST_F(BootBrakeTest, stops_it_where_the_mode_cannot_be_read) {
  shows("583 80 61 60 00 00 00 02 06");
  rests();
  EXPECT_THAT(sentBeforeReset(),
              ElementsAre(kAskStatusword, kAskShownMode, kQuickStop, kAskStatusword));
}

TEST_F(BootBrakeTest, writes_nothing_to_the_drive_of_another_maker) {
  config.vendor_id = 0x11223344;
  peer.forget(test::kAskVendor);
  peer.on(test::kAskVendor, "583 43 18 10 01 45 33 22 11");
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});  // would end it, if it were asked
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskStatusword, test::kAskVendor));
}

TEST_F(BootBrakeTest, asks_again_where_an_answer_is_lost_once_it_has_given_one) {
  shows("583 4F 61 60 00 08 00 00 00");
  config.vendor_id = 0x11223344;
  peer.forget(test::kAskVendor);
  peer.on(test::kAskVendor, Lines{});
  peer.on(test::kAskVendor, "583 43 18 10 01 44 33 22 11");
  rests();
  const Lines sent = sentBeforeReset(std::chrono::milliseconds(500));
  EXPECT_THAT(sent, Contains(kQuickStop));
  EXPECT_EQ(std::count(sent.begin(), sent.end(), test::kAskVendor), 2);
}

// It was identified before, and has not started anew since.
TEST_F(BootBrakeTest, does_not_ask_who_it_is_once_more) {
  shows("583 4F 61 60 00 08 00 00 00");
  config.vendor_id = 0x11223344;
  peer.forget(test::kAskVendor);
  peer.on(test::kAskVendor, "583 43 18 10 01 44 33 22 11");
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, kSwitchOnDisabled);
  boot();
  ASSERT_THAT(peer.take(), Contains(test::kAskVendor));
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, Lines{kOperationEnabled});
  rests();
  node->boot(now, true);
  settle();
  const Lines sent = peer.take();
  ASSERT_GE(sent.size(), 5U);
  EXPECT_THAT(Lines(sent.begin(), sent.begin() + 5),
              ElementsAre(kAskStatusword, kAskShownMode, kQuickStop, kAskStatusword, kReset));
}

TEST_F(BootBrakeTest, asks_who_it_is_where_that_is_configured) {
  config.vendor_id = 0x11223344;
  peer.forget(test::kAskVendor);
  peer.on(test::kAskVendor, "583 43 18 10 01 44 33 22 11");
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  EXPECT_THAT(sentBeforeReset(),
              ElementsAre(kAskStatusword, test::kAskVendor, kAskShownMode, kAskVelocity, kTarget,
                          kMode, kAskShownMode, kQuickStop, kAskStatusword));
}

// A reset of the communication stops no motor.
TEST_F(BootBrakeTest, OneThatWasToldToResetIsStillToBeLookedAt) {
  rests();
  boot();
  ASSERT_TRUE(node->seesToMotors());
  node->command(NmtCommand::reset_communication, now);
  EXPECT_TRUE(node->seesToMotors());
}

}  // namespace
}  // namespace cia402::canopen
