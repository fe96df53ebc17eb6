// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/sync.h"

#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

TEST(SyncProducer, without_a_counter_sends_no_data) {
  SyncProducer sync(0);
  EXPECT_EQ(test::text(sync.next()), "080");
  EXPECT_EQ(test::text(sync.next()), "080");
}

TEST(SyncProducer, counts_from_1_to_the_overflow_value_and_starts_at_1_again) {
  SyncProducer sync(3);
  for (const char* expected : {"080 01", "080 02", "080 03", "080 01", "080 02"}) {
    EXPECT_EQ(test::text(sync.next()), expected);
  }
}

TEST(SyncProducer, reaches_240_the_highest_counter_there_is) {
  SyncProducer sync(240);
  for (int i = 0; i < 239; ++i) sync.next();
  EXPECT_EQ(test::text(sync.next()), "080 F0");
  EXPECT_EQ(test::text(sync.next()), "080 01");
}

TEST(SyncProducer, restarts_at_1) {
  SyncProducer sync(10);
  sync.next();
  sync.next();
  sync.restart();
  EXPECT_EQ(test::text(sync.next()), "080 01");
}

}  // namespace
}  // namespace cia402::canopen
