// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace cia402::bus {
namespace {

std::string words(int error) { return std::generic_category().message(error); }

void touchStack() {
  constexpr std::size_t kPage = 4096;
  std::array<volatile char, 64 * kPage> stack;
  for (std::size_t i = 0; i < stack.size(); i += kPage) stack[i] = 0;
}

}  // namespace

RealtimeReport makeRealtime(int priority) {
  RealtimeReport report;
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int scheduling = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  report.scheduling = scheduling == 0;
  report.memory = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  const int memory = errno;
  prctl(PR_SET_TIMERSLACK, 1);  // ns; only matters without SCHED_FIFO
  touchStack();
  if (report.complete()) {
    report.text = "the bus thread runs at real-time priority " + std::to_string(priority) +
                  " with its memory locked";
    return report;
  }
  report.text = "the bus thread does not run in real time, SYNC will be late under load:";
  if (!report.scheduling) {
    report.text += " real-time priority " + std::to_string(priority) + " was refused (" +
                   words(scheduling) +
                   "): add `@realtime - rtprio 99` to /etc/security/limits.conf"
                   " and the user to that group;";
  }
  if (!report.memory) {
    report.text += " locking memory was refused (" + words(memory) +
                   "): add `@realtime - memlock unlimited` there;";
  }
  report.text.back() = '.';
  return report;
}

}  // namespace cia402::bus
