// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/last_stop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::Lines;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

const char kNmtStop[] = "000 02 03";
const char kMotorStop[] = "603 2B 40 60 00 02 00 00 00";  // controlword 0x0002, quick stop

class LastStopTest : public test::NodeFixture {
 protected:
  LastStopTest() {
    StartupWrite stop;
    stop.object = {0x6040, 0};
    stop.name = "controlword";
    stop.data = {0x02, 0x00};
    stop.only_if_different = false;
    stop.always = true;
    config.writes = {stop};
    config.boot.search_period = Duration::zero();
    peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  }
  /// Until the last heartbeat is 0.3 s old. Nobody hears the node then, and it hears nobody.
  void lose() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    peer.take();
    peer.forget(kMotorStop);
    pass(milliseconds(300));
    ASSERT_EQ(node->health(), Health::lost);
  }
  /// When each of `line` was sent, ms from now on.
  std::vector<int> times(const char* line, Duration span) {
    std::vector<int> at;
    const Lines sent = peer.take();
    const auto count = [&](const Lines& lines, int ms) {
      for (const std::string& text : lines) {
        if (text == line) at.push_back(ms);
      }
    };
    count(sent, 0);
    for (int ms = 1; milliseconds(ms) <= span; ++ms) {
      pass(milliseconds(1));
      count(peer.take(), ms);
    }
    return at;
  }
};

TEST_F(LastStopTest, a_lost_node_is_told_to_stop_its_motor_by_sdo_and_then_by_nmt_again_and_again) {
  lose();
  EXPECT_THAT(times(kNmtStop, milliseconds(450)), ElementsAre(40, 60, 80, 100, 120, 220, 320, 420));
}

TEST_F(LastStopTest, the_motor_is_stopped_before_nmt_takes_sdo_away) {
  lose();
  EXPECT_THAT(times(kMotorStop, milliseconds(450)), ElementsAre(0, 8, 16, 24, 32));
}

/// Mode 4 pushes; mode 9 brakes. The mode comes with the position.
class LastStopInTorqueTest : public LastStopTest {
 protected:
  LastStopInTorqueTest() {
    config.brakes = {brakeByMode9({4})};
    PdoConfig& tpdo = config.pdos.at(1);
    tpdo.entries.at(1) = {{0x6061, 0}, 8, "mode display"};
    peer.on("603 40 41 60 00 00 00 00 00", "583 4B 41 60 00 50 02 00 00");  // as the boot begins
    peer.forget("603 40 00 1A 02 00 00 00 00");
    peer.on("603 40 00 1A 02 00 00 00 00", "583 43 00 1A 02 08 00 61 60");
  }
  void loseIn(const char* mode) {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    node->receiveTpdo(0, test::frame(std::string("183 37 12 ") + mode), now);
    peer.take();
    peer.forget(kMotorStop);
    pass(milliseconds(300));
    ASSERT_EQ(node->health(), Health::lost);
  }
};

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

/// It left operational by itself, and what it is asked, or its answer, is lost.
class LeftOperational : public LastStopInTorqueTest {
 protected:
  void leave(const char* mode, const char* heartbeat = "703 7F") {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    if (*mode != 0) node->receiveTpdo(0, test::frame(std::string("183 37 12 ") + mode), now);
    peer.take();
    peer.forget(kMotorStop);
    peer.forget(kAskStatusword);
    hear(heartbeat);
    ASSERT_EQ(node->health(), Health::booting);
  }
  /// What is sent with each heartbeat, 90 ms apart.
  Lines sentWithHeartbeat() {
    pass(milliseconds(90));
    peer.take();
    hear("703 7F");
    return peer.take();
  }
  const char* const kAskStatusword = "603 40 41 60 00 00 00 00 00";
};

TEST_F(LeftOperational, its_motor_is_told_to_stop_with_each_heartbeat_until_it_tells_its_state) {
  leave("08");
  EXPECT_EQ(peer.take(), (Lines{kAskStatusword, kMotorStop}));
  EXPECT_EQ(sentWithHeartbeat(), Lines{kMotorStop});
  EXPECT_EQ(sentWithHeartbeat(), Lines{kMotorStop});
  hear("583 4B 41 60 00 37 12 00 00");  // operation enabled; its mode is asked for before the stop
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_THAT(sentWithHeartbeat(), Not(Contains(kMotorStop)));
}

const char kStart[] = "000 01 03";
const char kOn[] = "203 0F 00 44 33 22 11", kStopOn[] = "203 02 00 44 33 22 11";

/// It has a set-point, and answers no SDO from when it leaves on.
class LeftMute : public LeftOperational {
 protected:
  void goOn() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    node->receiveTpdo(0, test::frame("183 37 12 08"), now);
    node->image().setOutput(node->image().outputSlot({0x6040, 0}), 0x000F);
    node->image().setOutput(node->image().outputSlot({0x607A, 0}), 0x11223344);
    peer.take();
    node->sendRpdos(now);
    ASSERT_EQ(peer.take(), Lines{kOn});
  }
  void leaveAndBeAsked(const char* heartbeat) {
    peer.forget(kMotorStop);
    peer.forget(kAskStatusword);
    hear(heartbeat);
    ASSERT_EQ(node->health(), Health::booting);
    EXPECT_EQ(peer.take(), (Lines{kAskStatusword, kMotorStop}));
  }
};

TEST_F(LeftMute, it_is_started_and_told_to_stop_by_pdo_behind_its_last_set_point) {
  goOn();
  peer.forget(kStart);  // which the script answers by a heartbeat at once
  leaveAndBeAsked("703 7F");
  pass(milliseconds(49));
  hear("703 7F");  // several may come together, after a stall
  EXPECT_EQ(peer.take(), Lines{kMotorStop});
  pass(milliseconds(1));
  hear("703 7F");
  EXPECT_EQ(peer.take(), (Lines{kStart, kStopOn, kMotorStop}));
  pass(milliseconds(50));
  hear("703 05");
  EXPECT_EQ(peer.take(), (Lines{kStopOn, kMotorStop})) << "it has been started";
}

TEST_F(LeftMute, one_that_is_stopped_by_nmt_is_not_started) {
  goOn();
  leaveAndBeAsked("703 7F");
  pass(milliseconds(60));
  hear("703 04");
  pass(milliseconds(10));
  EXPECT_THAT(peer.take(), Not(Contains(kStopOn)));
}

TEST_F(LeftMute, one_that_answers_within_50_ms_is_not_started) {
  goOn();
  leaveAndBeAsked("703 7F");
  pass(milliseconds(45));
  hear("583 4B 41 60 00 37 12 00 00");
  peer.take();
  pass(milliseconds(45));
  hear("703 7F");
  EXPECT_THAT(peer.take(), Not(Contains(kStart)));
}

// It may have been another one, or be configured in another way since.
TEST_F(LeftMute, one_that_has_rebooted_gets_no_set_point_of_before) {
  goOn();
  peer.forget(kAskStatusword);
  hear("703 00");
  ASSERT_EQ(node->health(), Health::booting);
  peer.forget(kMotorStop);
  for (int i = 0; i < 4; ++i) {
    pass(milliseconds(90));
    hear("703 7F");
  }
  EXPECT_THAT(peer.take(), Not(Contains(kStopOn)));
}

TEST_F(LeftMute, one_that_was_sent_no_set_point_is_not_started) {
  leave("08");
  sentWithHeartbeat();
  EXPECT_EQ(sentWithHeartbeat(), Lines{kMotorStop});
}

TEST_F(LeftMute, in_a_mode_whose_stop_lets_go_it_is_not_started) {
  goOn();
  node->receiveTpdo(0, test::frame("183 37 12 04"), now);
  peer.forget(kMotorStop);
  peer.forget(kAskStatusword);
  hear("703 7F");
  pass(milliseconds(90));
  peer.take();
  hear("703 7F");
  EXPECT_THAT(peer.take(), IsEmpty());
}

// The answers to what nobody waits for come after the fence's own, and prove nothing.
TEST_F(LeftOperational, what_is_told_while_the_fence_waits_moves_the_fence) {
  leave("08");
  peer.forget("603 40 00 10 00 00 00 00 00");
  peer.forget("603 40 18 10 00 00 00 00 00");
  sentWithHeartbeat();
  pass(milliseconds(220));
  EXPECT_THAT(peer.take(), Contains("603 40 00 10 00 00 00 00 00"));
  hear("703 7F");
  EXPECT_EQ(peer.take(), (Lines{kMotorStop, "603 40 18 10 00 00 00 00 00"}));
  hear("583 43 00 10 00 92 01 02 00");
  EXPECT_THAT(peer.take(), IsEmpty());
  hear("583 4F 18 10 00 04 00 00 00");
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
}

TEST_F(LeftOperational, in_a_mode_whose_stop_lets_go_its_motor_is_told_nothing_unasked) {
  leave("04");
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  EXPECT_THAT(sentWithHeartbeat(), Not(Contains(kMotorStop)));
}

TEST_F(LeftOperational, in_a_mode_that_nobody_knows_its_motor_is_told_nothing_unasked) {
  leave("");
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  EXPECT_THAT(sentWithHeartbeat(), Not(Contains(kMotorStop)));
}

TEST_F(LeftOperational, a_stopped_one_is_told_nothing_for_it_hears_no_sdo) {
  leave("08", "703 04");
  EXPECT_THAT(peer.take(), Not(Contains(kMotorStop)));
}

TEST_F(LeftOperational, one_that_is_stopped_meanwhile_is_told_nothing_more) {
  leave("08");
  peer.take();
  hear("703 04");
  EXPECT_THAT(peer.take(), Not(Contains(kMotorStop)));
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
