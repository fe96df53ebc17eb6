// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/cycle_statistics.h"

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

TEST(CycleStatistics, IsZeroBeforeTheFirstSync) {
  const CycleStatistics statistics;
  EXPECT_EQ(statistics.cycles(), 0u);
  EXPECT_EQ(statistics.rmsLateness(), 0.0);
  EXPECT_EQ(statistics.maxLateness(), 0.0);
}

TEST(CycleStatistics, TellsLastLargestAndRootMeanSquareLateness) {
  CycleStatistics statistics;
  statistics.syncSent(4ms);
  statistics.syncSent(3ms);
  EXPECT_EQ(statistics.cycles(), 2u);
  EXPECT_DOUBLE_EQ(statistics.lastLateness(), 0.003);
  EXPECT_DOUBLE_EQ(statistics.maxLateness(), 0.004);
  EXPECT_NEAR(statistics.rmsLateness(), 0.0035355339, 1e-9);  // sqrt((16 + 9) / 2) ms
}

TEST(CycleStatistics, CountsLatenessInBandsThatIncludeTheirUpperEnd) {
  CycleStatistics statistics;
  for (const Duration late : {Duration(0), Duration(10us), Duration(11us), Duration(1ms),
                              Duration(5ms), Duration(5001us), Duration(1s)}) {
    statistics.syncSent(late);
  }
  const std::array<std::uint64_t, 10> expected{2, 1, 0, 0, 0, 0, 1, 0, 1, 2};
  for (std::size_t band = 0; band < expected.size(); ++band) {
    EXPECT_EQ(statistics.inBand(band), expected[band]) << band;
  }
}

TEST(CycleStatistics, AddsUpSkippedCycles) {
  CycleStatistics statistics;
  statistics.cyclesSkipped(3);
  statistics.cyclesSkipped(1);
  EXPECT_EQ(statistics.overruns(), 4u);
}

}  // namespace
}  // namespace cia402::bus
