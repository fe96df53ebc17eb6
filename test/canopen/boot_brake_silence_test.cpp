// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that was silent as its boot began, and may turn its motor: told to stop without an
// answer, and found by the first thing that it tells.
#include "canopen/boot_brake_fixture.h"

namespace cia402::canopen {
namespace {

using test::Lines;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Of a drive that was silent as the boot began: its heartbeat may be late by its whole period.
TEST_F(BootBrakeTest, asks_for_the_state_again_where_a_tpdo_says_that_the_drive_is_there) {
  shows("583 4F 61 60 00 08 00 00 00");
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, Lines{});
  peer.on(kAskStatusword, Lines{kOperationEnabled});
  rests();
  boot();
  pass(kUnanswered - std::chrono::milliseconds(20));
  tpdo("183 37 12");
  pass(kAwaitsBootUp);
  const Lines sent = peer.take();
  const auto reset = std::find(sent.begin(), sent.end(), kReset);
  const auto stop = std::find(sent.begin(), sent.end(), kQuickStop);
  EXPECT_LT(stop, reset) << "it came only once the drive was reset";
  EXPECT_EQ(std::count(sent.begin(), stop, kAskStatusword), 2);
}

// One that was on its way as the reset was sent says nothing of it.
TEST_F(BootBrakeTest, stops_the_motor_of_a_drive_that_appears_by_a_tpdo_after_its_reset) {
  shows("583 4F 61 60 00 08 00 00 00");
  peer.forget(kAskStatusword);
  peer.forget(kReset);
  boot();
  pass(kUnanswered);
  EXPECT_THAT(peer.take(), Contains(kReset));
  tpdo("183 37 12");
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(std::chrono::milliseconds(25));
  for (const char* answer : {kOperationEnabled, kQuickStopActive}) peer.on(kAskStatusword, answer);
  rests();
  tpdo("183 37 12");
  pass(std::chrono::milliseconds(50));
  const Lines sent = peer.take();
  ASSERT_GE(sent.size(), 7U);
  EXPECT_THAT(Lines(sent.begin(), sent.begin() + 7),
              ElementsAre(test::kAskDeviceType, kAskStatusword, kAskShownMode, kQuickStop,
                          kAskStatusword, kAskStatusword, kReset));
  tpdo("183 37 12");
  EXPECT_THAT(peer.take(), IsEmpty()) << "its motors were asked for already";
}

TEST_F(BootBrakeTest, does_not_ask_a_drive_again_that_says_after_a_tpdo_that_it_is_stopped) {
  peer.forget(kAskStatusword);
  peer.forget(kReset);
  boot();
  tpdo("183 37 12");
  hear("703 04");
  pass(kAwaitsBootUp);
  const Lines sent = peer.take();
  EXPECT_EQ(std::count(sent.begin(), sent.end(), kAskStatusword), 1);
  EXPECT_THAT(sent, Contains(kReset));
}

// Silent until a moment ago: its reset alone would not stop its motor. The mode whose stop only
// lets the motor go is not known to be left; what was never seen may be anything.
TEST_F(BootBrakeTest, tells_a_known_drive_that_answers_nothing_to_stop_before_the_reset) {
  for (const bool was_seen : {true, false}) {
    for (const bool lets_go : {true, false}) {
      config.brakes = {brakeByMode9(lets_go ? std::vector<int>{4, 10} : std::vector<int>{})};
      peer.forget(kAskStatusword);
      create();
      if (was_seen) {
        rests();
        boot();
        pass(std::chrono::milliseconds(60));
        ASSERT_EQ(node->health(), Health::ready);
        peer.forget(kAskStatusword);
      }
      peer.take();
      node->boot(now, true);
      settle();
      pass(kUnanswered + std::chrono::milliseconds(45));
      const Lines sent = peer.take();
      const bool told = was_seen && !lets_go;
      EXPECT_EQ(std::count(sent.begin(), sent.end(), kReset), told ? 0 : 1);
      const auto reset = std::find(sent.begin(), sent.end(), kReset);
      EXPECT_EQ(std::count(sent.begin(), reset, kQuickStop), told ? 1 : 0);
      pass(std::chrono::milliseconds(10));
      const Lines then = peer.take();
      EXPECT_EQ(std::count(then.begin(), then.end(), kReset), told ? 1 : 0);
    }
  }
}

TEST_F(BootBrakeTest, asks_a_drive_that_tells_of_itself_after_it_was_told_to_stop) {
  config.brakes = {brakeByMode9({})};
  peer.forget(kAskStatusword);
  rests();
  boot();
  pass(std::chrono::milliseconds(60));
  ASSERT_EQ(node->health(), Health::ready);
  peer.forget(kAskStatusword);
  node->boot(now, true);
  settle();
  pass(kUnanswered + std::chrono::milliseconds(10));
  peer.take();
  for (const char* answer : {kOperationEnabled, kQuickStopActive}) peer.on(kAskStatusword, answer);
  rests();
  tpdo("183 37 12");
  pass(std::chrono::milliseconds(30));
  const Lines sent = peer.take();
  const auto asked = std::find(sent.begin(), sent.end(), kAskStatusword);
  EXPECT_LT(asked, std::find(sent.begin(), sent.end(), kReset));
  EXPECT_THAT(Lines(asked, sent.end()), Contains(kQuickStop)) << "for its motor turns";
}

}  // namespace
}  // namespace cia402::canopen
