// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <system_error>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using testing::HasSubstr;

/// In a thread of its own, so that the tests after it run as before.
RealtimeReport reportFor(int priority, int& policy) {
  RealtimeReport report;
  std::thread([&] {
    report = makeRealtime(priority);
    sched_param parameters{};
    pthread_getschedparam(pthread_self(), &policy, &parameters);
  }).join();
  munlockall();
  return report;
}

TEST(Realtime, TellsWhatWasGrantedAndForTheRestHowToGetIt) {
  int policy = SCHED_OTHER;
  const RealtimeReport report = reportFor(10, policy);
  EXPECT_EQ(report.scheduling, policy == SCHED_FIFO);
  if (report.complete()) {
    EXPECT_EQ(report.text, "the bus thread runs at real-time priority 10 with its memory locked");
  }
  EXPECT_EQ(!report.scheduling, report.text.find("rtprio") != std::string::npos) << report.text;
  EXPECT_EQ(!report.memory, report.text.find("memlock") != std::string::npos) << report.text;
}

// Where anybody else is granted it, so is the thread of the bus.
TEST(Realtime, AsksForThePriorityAndTheMemoryThatTheSystemGrants) {
  int refused = 0, policy = SCHED_OTHER;
  std::thread([&] {
    sched_param parameters{};
    parameters.sched_priority = 10;
    refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  }).join();
  const bool locked = mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
  munlockall();
  const RealtimeReport report = reportFor(10, policy);
  EXPECT_EQ(report.scheduling, refused == 0);
  EXPECT_EQ(report.memory, locked);
  if (refused != 0) {
    EXPECT_THAT(report.text, HasSubstr(std::generic_category().message(refused)));
  }
}

// Joining pages into huge ones takes time in the middle of a cycle.
TEST(Realtime, KeepsTheSystemFromJoiningItsPages) {
  const int before = prctl(PR_GET_THP_DISABLE, 0, 0, 0, 0);
  if (before < 0) GTEST_SKIP() << "this system does not know that";
  prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0);
  int policy = SCHED_OTHER;
  reportFor(10, policy);
  EXPECT_EQ(prctl(PR_GET_THP_DISABLE, 0, 0, 0, 0), 1);
  prctl(PR_SET_THP_DISABLE, static_cast<unsigned long>(before), 0, 0, 0);
}

// No system grants a priority that does not exist, whoever asks.
TEST(Realtime, SaysWhyAPriorityWasRefusedAndWhatToDo) {
  int policy = SCHED_OTHER;
  const RealtimeReport report = reportFor(1000, policy);
  EXPECT_FALSE(report.scheduling);
  EXPECT_FALSE(report.complete());
  EXPECT_EQ(policy, SCHED_OTHER);
  EXPECT_THAT(report.text, HasSubstr("real-time priority 1000 was refused (Invalid argument)"));
  EXPECT_THAT(report.text, HasSubstr("/etc/security/limits.conf"));
  EXPECT_THAT(report.text, HasSubstr("SYNC will be late"));
  EXPECT_EQ(report.text.find("memlock") != std::string::npos, !report.memory) << report.text;
  EXPECT_EQ(report.text.back(), '.');
}

}  // namespace
}  // namespace cia402::bus
