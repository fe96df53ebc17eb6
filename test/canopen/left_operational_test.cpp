// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A node that leaves the state operational by itself, and may turn its motor on.
#include "canopen/last_stop_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

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

// Its heartbeat made the boot begin, so it is there, and the question, or its answer, was lost.
TEST_F(LeftOperational, it_is_asked_again_before_another_heartbeat_comes) {
  leave("04");
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  pass(milliseconds(299));
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(milliseconds(1));
  EXPECT_THAT(peer.take(), AllOf(Contains(kAskStatusword), Not(Contains("000 80 03"))));
  pass(milliseconds(100));
  EXPECT_THAT(peer.take(), AllOf(Contains(kAskStatusword), Not(Contains("000 80 03"))));
  hear("583 4B 41 60 00 37 12 00 00");
  EXPECT_THAT(peer.take(), Contains("603 40 61 60 00 00 00 00 00")) << "whether it pushes";
}

const char kStart[] = "000 01 03";
const char kBrakeMode[] = "603 2F 60 60 00 09 00 00 00";
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

TEST_F(LeftMute, nor_does_it_get_one_when_that_boot_is_given_up_and_another_begins) {
  goOn();
  peer.forget("603 40 00 10 00 00 00 00 00");
  hear("703 00");
  peer.forget(kMotorStop);
  peer.forget(kAskStatusword);
  node->boot(now, false);
  settle();
  for (int i = 0; i < 3; ++i) {
    pass(milliseconds(90));
    hear("703 7F");
  }
  EXPECT_THAT(peer.take(), AllOf(Contains(kMotorStop), Not(Contains(kStopOn))));
}

TEST_F(LeftMute, one_that_was_sent_no_set_point_is_not_started) {
  leave("08");
  sentWithHeartbeat();
  EXPECT_EQ(sentWithHeartbeat(), Lines{kMotorStop});
}

TEST_F(LeftMute, in_a_mode_whose_stop_lets_go_that_is_better_than_to_push_on) {
  goOn();
  node->receiveTpdo(0, test::frame("183 37 12 04"), now);
  peer.forget(kStart);
  peer.forget(kMotorStop);
  peer.forget(kAskStatusword);
  peer.forget(kBrakeMode);
  hear("703 7F");
  pass(milliseconds(49));
  peer.take();
  hear("703 7F");
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(milliseconds(1));
  hear("703 7F");
  EXPECT_EQ(peer.take(), (Lines{kStart, kBrakeMode})) << "its mode is not in a PDO";
  pass(milliseconds(50));
  hear("703 05");
  EXPECT_EQ(peer.take(), (Lines{kStopOn, kMotorStop}));
}

TEST_F(LeftMute, in_a_mode_that_nobody_knows_it_is_not_started) {
  boot();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  node->sendRpdos(now);
  peer.take();
  peer.forget(kAskStatusword);
  hear("703 7F");
  for (int i = 0; i < 3; ++i) {
    pass(milliseconds(60));
    hear("703 7F");
  }
  EXPECT_THAT(peer.take(), AllOf(Not(Contains(kStart)), Not(Contains(kMotorStop))));
}

/// Its RPDO carries the mode, and the velocity that the mode that brakes would take over at.
class LeftMuteInTorque : public LeftOperational {
 protected:
  LeftMuteInTorque() {
    config.pdos.at(0).entries = {
        {{0x6040, 0}, 16, "controlword"}, {{0x6060, 0}, 8, "mode"}, {{0x60FF, 0}, 32, "velocity"}};
    for (const auto& [asked, said] :
         {std::pair{"603 40 00 16 00 00 00 00 00", "583 4F 00 16 00 03 00 00 00"},
          std::pair{"603 40 00 16 02 00 00 00 00", "583 43 00 16 02 08 00 60 60"},
          std::pair{"603 40 00 16 03 00 00 00 00", "583 43 00 16 03 20 00 FF 60"}}) {
      peer.forget(asked);
      peer.on(asked, said);
    }
  }
  /// It was told 10000 for 60FFh last.
  void push() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    node->receiveTpdo(0, test::frame("183 37 12 04"), now);
    PdoImage& image = node->image();
    image.setOutput(image.outputSlot({0x6040, 0}), 0x000F);
    image.setOutput(image.outputSlot({0x6060, 0}), 4);
    image.setOutput(image.outputSlot({0x60FF, 0}), 10000);
    peer.take();
    node->sendRpdos(now);
    ASSERT_EQ(peer.take(), Lines{"203 0F 00 04 10 27 00 00"});
    for (const char* line : {kStart, kMotorStop, kAskStatusword, kBrakeMode}) peer.forget(line);
  }
  const char* const kTakeOver = "203 0F 00 09 10 27 00 00";
  const char* const kStopBraking = "203 02 00 09 10 27 00 00";
};

TEST_F(LeftMuteInTorque, the_mode_that_brakes_takes_over_and_stops_with_the_next_heartbeat) {
  push();
  hear("703 7F");
  pass(milliseconds(50));
  peer.take();
  hear("703 7F");
  EXPECT_EQ(peer.take(), (Lines{kStart, kBrakeMode, kTakeOver}));
  pass(milliseconds(50));
  hear("703 7F");  // the command was lost
  EXPECT_EQ(peer.take(), (Lines{kStart, kStopBraking, kMotorStop}));
  pass(milliseconds(50));
  hear("703 05");
  EXPECT_EQ(peer.take(), (Lines{kStopBraking, kMotorStop}));
}

TEST_F(LeftMuteInTorque, one_that_is_lost_is_told_that_mode_by_pdo_as_well) {
  push();
  pass(milliseconds(300));
  ASSERT_EQ(node->health(), Health::lost);
  EXPECT_EQ(peer.take(), (Lines{kBrakeMode, kTakeOver}));
  pass(milliseconds(8));
  EXPECT_EQ(peer.take(), (Lines{kBrakeMode, kTakeOver}));
  pass(milliseconds(8));
  EXPECT_EQ(peer.take(), Lines{kMotorStop});
}

TEST_F(LeftMuteInTorque, one_that_answers_within_50_ms_is_braked_by_sdo_alone) {
  push();
  hear("703 7F");
  pass(milliseconds(45));
  hear("583 4B 41 60 00 37 12 00 00");
  peer.take();
  pass(milliseconds(45));
  hear("703 7F");
  EXPECT_THAT(peer.take(), AllOf(Not(Contains(kStart)), Not(Contains(kTakeOver))));
}

TEST_F(LeftMuteInTorque, one_that_has_booted_since_and_pushes_no_more_is_not_taken_over) {
  push();
  peer.on(kAskStatusword, "583 4B 41 60 00 50 02 00 00");
  peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  peer.on(kStart, "703 05");
  hear("703 7F");
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  node->receiveTpdo(0, test::frame("183 50 02 08"), now);
  pass(milliseconds(300));
  ASSERT_EQ(node->health(), Health::lost);
  EXPECT_THAT(peer.take(), AllOf(Contains(kMotorStop), Not(Contains(kTakeOver))));
}

TEST_F(LeftMuteInTorque, one_whose_boot_after_a_reboot_is_given_up_is_not_taken_over) {
  push();
  peer.forget("603 40 00 10 00 00 00 00 00");
  hear("703 00");
  node->boot(now, false);
  settle();
  for (int i = 0; i < 3; ++i) {
    pass(milliseconds(90));
    hear("703 7F");
  }
  EXPECT_THAT(peer.take(), AllOf(Not(Contains(kTakeOver)), Not(Contains(kStopBraking))));
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

}  // namespace
}  // namespace cia402::canopen
