// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A motor that a driver before has left turning in a mode whose stop only lets it go: another mode
// takes it over before the drive is reset.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using test::Lines;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const char kReset[] = "000 82 03";
const char kTellPreOperational[] = "000 80 03";
const char kAskShownMode[] = "603 40 61 60 00 00 00 00 00";
const char kAskStatusword[] = "603 40 41 60 00 00 00 00 00";
const char kAskVelocity[] = "603 40 6C 60 00 00 00 00 00";
const char kTarget[] = "603 23 FF 60 00 10 27 00 00";  // 10000, as it turns
const char kOperationEnabled[] = "583 4B 41 60 00 37 12 00 00";
const char kQuickStopActive[] = "583 4B 41 60 00 17 12 00 00";
const char kSwitchOnDisabled[] = "583 4B 41 60 00 50 02 00 00";
const char kMode[] = "603 2F 60 60 00 09 00 00 00";

/// Modes 4 and 10 push; mode 9 brakes.
class BootBrakeTest : public test::NodeFixture {
 protected:
  BootBrakeTest() {
    config.brakes = {brakeByMode9({4, 10})};
    for (const char* line : {kAskShownMode, kAskStatusword, kAskVelocity}) peer.forget(line);
    peer.on(kAskShownMode, Lines{"583 4F 61 60 00 0A 00 00 00"});
    peer.on(kAskStatusword, Lines{kOperationEnabled});
    peer.on(kAskVelocity, "583 43 6C 60 00 10 27 00 00");
    peer.on(kTarget, "583 60 FF 60 00 00 00 00 00");
    peer.on(kMode, "583 60 60 60 00 00 00 00 00");
  }
  void shows(const char* mode_answer) {
    peer.forget(kAskShownMode);
    peer.on(kAskShownMode, mode_answer);
  }
  void rests() { peer.on(kAskStatusword, Lines{kSwitchOnDisabled}); }
  /// What is sent until the reset.
  Lines sentBeforeReset(Duration within = Duration::zero()) {
    boot();
    pass(2 * master.sync_period + within);
    Lines lines;
    for (const std::string& line : peer.take()) {
      if (line == kReset) return lines;
      lines.push_back(line);
    }
    ADD_FAILURE() << "it was not reset";
    return lines;
  }
};

TEST_F(BootBrakeTest, takes_the_motor_over_at_its_velocity_before_the_reset) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskShownMode, kAskStatusword, kAskVelocity, kTarget,
                                             kMode, kAskShownMode, kAskStatusword));
}

// What an RPDO has left in the drive takes effect with the next SYNC, and is not to undo it.
TEST_F(BootBrakeTest, waits_for_two_syncs_before_it_writes) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  boot();
  EXPECT_THAT(peer.take(), ElementsAre(kAskShownMode, kAskStatusword));
  pass(2 * master.sync_period - std::chrono::nanoseconds(1));
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(std::chrono::nanoseconds(1));
  EXPECT_THAT(peer.take(), Contains(kTarget));
}

// Its ramp is not disturbed: the reset comes once it has no power any more.
TEST_F(BootBrakeTest, waits_until_the_motor_rests) {
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  peer.on(kAskStatusword, Lines{kOperationEnabled});
  peer.on(kAskStatusword, Lines{kQuickStopActive});
  rests();
  EXPECT_THAT(sentBeforeReset(std::chrono::milliseconds(50)),
              ElementsAre(kAskShownMode, kAskStatusword, kAskVelocity, kTarget, kMode,
                          kAskShownMode, kAskStatusword, kAskStatusword, kAskStatusword));
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
  peer.forget(kAskShownMode);
  boot(false);
  EXPECT_THAT(peer.take(), ElementsAre(kAskShownMode));
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 04 00 00 00"});
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  pass(std::chrono::milliseconds(200));
  const Lines sent = peer.take();
  const auto brake = std::find(sent.begin(), sent.end(), kAskShownMode);
  ASSERT_GE(sent.end() - brake, 7);
  EXPECT_THAT(Lines(brake, brake + 7), ElementsAre(kAskShownMode, kAskStatusword, kAskVelocity,
                                                   kTarget, kMode, kAskShownMode, kAskStatusword));
  EXPECT_EQ(std::count(sent.begin(), brake, kTellPreOperational), 1);
  EXPECT_EQ(std::count(brake, sent.end(), kTellPreOperational), 0);
}

TEST_F(BootBrakeTest, leaves_a_motor_in_another_mode_alone) {
  shows("583 4F 61 60 00 08 00 00 00");
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskShownMode));
}

TEST_F(BootBrakeTest, leaves_a_motor_without_power_alone) {
  peer.forget(kAskStatusword);
  peer.on(kAskStatusword, kSwitchOnDisabled);
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskShownMode, kAskStatusword));
}

TEST_F(BootBrakeTest, goes_on_to_the_reset_where_the_mode_cannot_be_read) {
  shows("583 80 61 60 00 00 00 02 06");
  EXPECT_THAT(sentBeforeReset(), ElementsAre(kAskShownMode));
}

TEST_F(BootBrakeTest, writes_nothing_to_the_drive_of_another_maker) {
  config.vendor_id = 0x11223344;
  peer.forget(test::kAskVendor);
  peer.on(test::kAskVendor, "583 43 18 10 01 45 33 22 11");
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});  // would end it, if it were asked
  EXPECT_THAT(sentBeforeReset(), ElementsAre(test::kAskVendor));
}

TEST_F(BootBrakeTest, asks_who_it_is_where_that_is_configured) {
  config.vendor_id = 0x11223344;
  peer.forget(test::kAskVendor);
  peer.on(test::kAskVendor, "583 43 18 10 01 44 33 22 11");
  peer.on(kAskShownMode, Lines{"583 4F 61 60 00 09 00 00 00"});
  rests();
  EXPECT_THAT(sentBeforeReset(),
              ElementsAre(test::kAskVendor, kAskShownMode, kAskStatusword, kAskVelocity, kTarget,
                          kMode, kAskShownMode, kAskStatusword));
}

}  // namespace
}  // namespace cia402::canopen
