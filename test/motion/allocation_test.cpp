// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "motion/coupling.h"
#include "motion/setpoint_limiter.h"
#include "motion/trajectory.h"

namespace {
std::size_t allocations = 0;
}

// Counts what the whole program allocates with new. Not inlined, or the compiler sees half of a
// pair and takes it for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace cia402::motion {
namespace {

TEST(Allocation, NothingInTheCyclicPathAllocates) {
  const std::vector<Joint> joints{{"shoulder", {}, {}}, {"elbow", {}, {}}};
  std::vector<MotionState> states(2);
  const auto trajectory = Trajectory::create(
      joints, states, {{{1, 1}, {0, 0}, {0, 0}, std::chrono::seconds(1)}}, TrajectoryStart{});
  Joint joint;
  joint.limits = {-1, 1, 1, 5, {}, {}, false};
  PositionLimiter positions(joint);
  VelocityLimiter velocities(joint);
  const auto coupling = Coupling::create({"a", "b"}, {"1", "2"}, Eigen::Matrix2d::Identity());
  Eigen::VectorXd from = Eigen::VectorXd::Ones(2), to(2);

  const std::size_t before = allocations;
  ASSERT_GT(before, 0U);
  for (Time now{}; now < Time{std::chrono::seconds(2)}; now += std::chrono::milliseconds(4)) {
    trajectory->sample(now, states);
    static_cast<void>(positions.command(0.3));
    static_cast<void>(velocities.command(0.3));
    positions.step(now);
    velocities.step(now, 0);
    coupling->toAxes(from, to);
    coupling->effortToJoints(to, from);
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace cia402::motion
