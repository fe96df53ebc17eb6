// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/event_loop.h"

#include <gtest/gtest.h>

#include <thread>

#include "bus/real_clock.h"
#include "ros/callback.h"

namespace cia402::ros_node {
namespace {

using namespace std::chrono_literals;

TEST(EventLoop, OneWakingServesTasksOfSeveralPeriods) {
  EventLoop loop;
  int often = 0, seldom = 0, steps = 0;
  loop.every(10ms, [&] { ++often; });
  loop.every(50ms, [&] { ++seldom; });
  loop.always([&] { ++steps; });
  while (seldom < 3) loop.step();
  EXPECT_LE(often, steps);
  EXPECT_LE(steps, 15 + 3);  // a busy machine leaves tasks out; the kernel may wake a moment early
  EXPECT_GE(often, 3);
}

TEST(EventLoop, LeavesOutWhatIsTooLate) {
  EventLoop loop;
  int done = 0;
  loop.every(1ms, [&] { ++done; });
  const Time late = bus::realNow() + 30ms;
  while (bus::realNow() < late) std::this_thread::yield();
  loop.step();
  EXPECT_EQ(done, 1);
  const Time began = bus::realNow();
  for (int i = 0; i < 10; ++i) loop.step();
  EXPECT_GE(bus::realNow() - began, 5ms) << "made good in a burst";
}

TEST(EventLoop, DoesNotWakeForWhatNobodyWants) {
  EventLoop loop;
  bool wanted = false;
  int done = 0, seldom = 0, steps = 0;
  loop.every(
      1ms, [&] { ++done; }, [&] { return wanted; });
  loop.every(50ms, [&] { ++seldom; });
  for (; seldom == 0; ++steps) loop.step();
  EXPECT_EQ(done, 0);
  EXPECT_LE(steps, 3);  // the kernel may wake a moment early
  wanted = true;
  while (done < 3) loop.step();
}

TEST(EventLoop, GivesATaskAnotherPeriod) {
  EventLoop loop;
  int done = 0;
  const std::size_t task = loop.every(1h, [&] { ++done; });
  loop.retime(task, 1ms);
  while (done < 3) loop.step();
  loop.retime(task, 1h);
  loop.wake();
  loop.step();
  EXPECT_EQ(done, 3);
}

TEST(EventLoop, IsWokenByCallbacksOfOtherThreads) {
  EventLoop loop;
  loop.every(1h, [] { FAIL() << "not due"; });
  bool called = false;
  std::thread other(
      [&] { loop.queue()->addCallback(boost::make_shared<Callback>([&] { called = true; }), 1); });
  while (!called) loop.step();
  other.join();
}

TEST(EventLoop, DoesNotSleepWhereItWasWokenBefore) {
  EventLoop loop;
  loop.every(1h, [] { FAIL() << "not due"; });
  loop.wake();
  loop.step();
}

}  // namespace
}  // namespace cia402::ros_node
