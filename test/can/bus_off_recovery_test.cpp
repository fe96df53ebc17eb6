// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/bus_off_recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace cia402::can {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct BusOffRecoveryTest : testing::Test {
  /// Lets time pass in milliseconds; the times of the attempts since the beginning of the call.
  std::vector<Duration> attemptsWithin(Duration duration) {
    std::vector<Duration> attempts;
    const Time began = now;
    for (; now < began + duration; now += 1ms) {
      recovery.update(state, now);
      if (recovery.attempt(now)) attempts.push_back(now - began);
    }
    return attempts;
  }
  BusOffRecovery recovery;
  BusState state = BusState::bus_off;
  Time now{50s};
};

TEST_F(BusOffRecoveryTest, WaitsTwiceAsLongBeforeEachAttemptUpToFiveSeconds) {
  EXPECT_THAT(attemptsWithin(22s),
              ElementsAre(100ms, 300ms, 700ms, 1500ms, 3100ms, 6300ms, 11300ms, 16300ms, 21300ms));
  EXPECT_EQ(recovery.attempts(), 9u);
}

TEST_F(BusOffRecoveryTest, AttemptsNothingWhileTheControllerIsWell) {
  for (const BusState well : {BusState::error_active, BusState::error_passive, BusState::down}) {
    state = well;
    EXPECT_THAT(attemptsWithin(1s), ElementsAre());
    EXPECT_EQ(recovery.deadline(), kNever);
  }
}

TEST_F(BusOffRecoveryTest, GoesOnWithTheLongerDelayIfTheControllerFallsOffAgain) {
  EXPECT_THAT(attemptsWithin(101ms), ElementsAre(100ms));
  state = BusState::error_active;
  EXPECT_THAT(attemptsWithin(2s), ElementsAre());
  state = BusState::bus_off;
  EXPECT_THAT(attemptsWithin(250ms), ElementsAre(200ms));
}

TEST_F(BusOffRecoveryTest, BeginsAnewAfterTenSecondsWithoutTrouble) {
  EXPECT_THAT(attemptsWithin(1s), ElementsAre(100ms, 300ms, 700ms));
  state = BusState::error_active;
  EXPECT_THAT(attemptsWithin(9999ms), ElementsAre());
  state = BusState::bus_off;
  EXPECT_THAT(attemptsWithin(801ms), ElementsAre(800ms));
  state = BusState::error_warning;
  EXPECT_THAT(attemptsWithin(10s), ElementsAre());
  state = BusState::bus_off;
  EXPECT_THAT(attemptsWithin(101ms), ElementsAre(100ms));
}

}  // namespace
}  // namespace cia402::can
