// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "count_allocations.h"
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

TEST(AxisAllocation, TheCyclicCallsOfAMovingAxisDoNotAllocate) {
  for (const char* mode : {"cyclic_position", "cyclic_velocity", "profile_position"}) {
    AxisConfig config = test::testConfig();
    config.mode = mode;
    test::Bench bench(config);
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.enable());
    allocations = 0;
    for (int i = 0; i < 500; ++i) {
      bench.run(test::Bench::kCycle);
      counting = true;
      bench.axis.readFeedback(bench.now);
      bench.axis.update(bench.now);
      static_cast<void>(bench.axis.setTarget(1e-4 * i));
      bench.axis.writeCommands(bench.now);
      counting = false;
    }
    EXPECT_EQ(allocations, 0) << mode;
  }
}

TEST(AxisAllocation, TheCounterCounts) {
  allocations = 0;
  counting = true;
  int* volatile number = new int(1);  // volatile: may not be optimised away
  delete number;
  counting = false;
  EXPECT_GE(allocations, 1);
}

}  // namespace
}  // namespace cia402::drive
