// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/last_stop.h"

#include "canopen/last_stop_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(LastStopTest, a_lost_node_is_told_to_stop_its_motor_by_sdo_and_then_by_nmt_again_and_again) {
  lose();
  EXPECT_THAT(times(kNmtStop, milliseconds(450)), ElementsAre(40, 60, 80, 100, 120, 220, 320, 420));
}

TEST_F(LastStopTest, the_motor_is_stopped_before_nmt_takes_sdo_away) {
  lose();
  EXPECT_THAT(times(kMotorStop, milliseconds(450)), ElementsAre(0, 8, 16, 24, 32));
}

const char kBrake[] = "603 2F 60 60 00 09 00 00 00";

TEST_F(LastStopInTorqueTest, the_mode_that_brakes_comes_before_the_stop_that_lets_go) {
  loseIn("04");
  const Lines sent = peer.take();
  EXPECT_THAT(sent, Contains(kBrake));
  EXPECT_THAT(sent, Not(Contains(kMotorStop)));
  EXPECT_THAT(times(kBrake, milliseconds(10)), ElementsAre(8));
  EXPECT_THAT(times(kMotorStop, milliseconds(300)), ElementsAre(6, 14, 22, 30, 38));
}

TEST_F(LastStopInTorqueTest, a_mode_whose_stop_brakes_is_left) {
  loseIn("08");
  const Lines sent = peer.take();
  EXPECT_THAT(sent, Contains(kMotorStop));
  EXPECT_THAT(sent, Not(Contains(kBrake)));
}

TEST_F(LastStopTest, without_anything_to_write_it_is_stopped_by_nmt_at_once) {
  config.writes.clear();
  lose();
  EXPECT_THAT(times(kNmtStop, milliseconds(250)), ElementsAre(0, 20, 40, 60, 80, 180));
}

TEST_F(LastStopTest, a_node_that_is_booted_anew_but_takes_no_reset_is_told_to_stop_its_motor) {
  lose();
  peer.forget("000 82 03");
  pass(milliseconds(100));
  node->boot(now, true);
  pass(milliseconds(49));
  peer.take();
  hear("703 05");  // it may have left before the reset
  EXPECT_THAT(peer.take(), Not(Contains(kMotorStop)));
  pass(milliseconds(1));
  hear("703 05");
  EXPECT_THAT(peer.take(), Contains(kMotorStop)) << "though it is not identified yet";
  hear("703 7F");
  EXPECT_THAT(peer.take(), Not(Contains(kMotorStop))) << "it has obeyed";
}

TEST_F(LastStopTest, a_node_that_was_never_identified_is_told_nothing) {
  peer.forget("000 82 03");
  boot();
  pass(milliseconds(50));
  hear("703 05");
  EXPECT_THAT(peer.take(), Not(Contains(kMotorStop)));
}

TEST_F(LastStopTest, ends_three_seconds_after_the_loss) {
  lose();
  pass(milliseconds(2999));
  peer.take();
  pass(seconds(60));
  EXPECT_THAT(peer.take(), IsEmpty());
  EXPECT_EQ(node->nextDeadline(), kNever);
}

TEST_F(LastStopTest, a_node_that_says_operational_is_told_again_at_once_and_not_booted_yet) {
  lose();
  pass(milliseconds(160));
  peer.take();
  hear("703 05");
  EXPECT_EQ(peer.take(), Lines{kMotorStop});
  EXPECT_EQ(node->health(), Health::lost);
  EXPECT_THAT(times(kNmtStop, milliseconds(60)), ElementsAre(40, 60));
}

TEST_F(LastStopTest, what_was_on_its_way_when_it_was_told_is_no_reason_to_tell_it_again) {
  lose();
  pass(milliseconds(49));
  peer.take();
  hear("703 05");  // told 9 ms ago
  EXPECT_THAT(times(kNmtStop, milliseconds(31)), ElementsAre(11, 31));
  EXPECT_EQ(node->health(), Health::lost);
}

TEST_F(LastStopTest, a_node_that_says_stopped_is_booted_and_told_no_more) {
  lose();
  pass(milliseconds(50));
  peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  peer.take();
  hear("703 04");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  const Lines sent = peer.take();
  EXPECT_EQ(sent[0], "000 80 03");
  EXPECT_THAT(sent, Not(Contains(kNmtStop)));
  hear("703 05");
  pass(milliseconds(200));
  EXPECT_THAT(peer.take(), Not(Contains(kNmtStop)));
}

TEST_F(LastStopTest, a_node_that_takes_no_nmt_stop_is_booted_half_a_second_after_its_loss) {
  lose();
  peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  pass(milliseconds(499));
  hear("703 05");
  EXPECT_EQ(node->health(), Health::lost);
  pass(milliseconds(1));
  hear("703 05");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(LastStopTest, a_node_that_rebooted_is_told_no_more) {
  lose();
  peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  peer.take();
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(peer.take(), Not(Contains(kNmtStop)));
}

TEST_F(LastStopTest, an_answer_to_the_posted_stop_is_taken_for_none_to_a_later_request) {
  lose();
  peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  peer.forget("603 40 00 10 00 00 00 00 00");
  peer.take();
  hear("703 04");
  // The fence: an object that never changes is read before anything else.
  EXPECT_EQ(peer.take(), (Lines{"000 80 03", "603 40 00 10 00 00 00 00 00"}));
  hear("583 60 40 60 00 00 00 00 00");  // of the posted write, late
  EXPECT_THAT(peer.take(), IsEmpty());
  EXPECT_EQ(node->health(), Health::booting);
}

TEST_F(LastStopTest, is_told_nothing_any_more_when_three_seconds_are_over_to_the_moment) {
  lose();
  pass(milliseconds(180));
  peer.take();
  hear("703 05");  // told anew: NMT stop 40 ms later, then four more, then every 100 ms
  const std::vector<int> at = times(kNmtStop, milliseconds(2900));
  ASSERT_FALSE(at.empty());
  EXPECT_EQ(at.front(), 40);
  EXPECT_EQ(at.back(), 2720) << "2.9 s after the loss; the next would be after 3 s";
}

}  // namespace
}  // namespace cia402::canopen
