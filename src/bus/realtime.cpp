// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <system_error>

#include "bus/memory_pages.h"

namespace cia402::bus {
namespace {

constexpr int kMostInHeap = 1 << 20;    // bytes; what is larger is mapped, and unmapped when freed
constexpr int kMostArenas = 64;         // more than threads: none shares its share of the heap
constexpr int kNeverTrimmed = 1 << 30;  // bytes of free heap that are left alone

std::string words(int error) { return std::generic_category().message(error); }

/// What has been touched stays in memory; what has not takes none. Kernels before 4.4 know only all
/// or nothing: there all that is mapped is locked, the stacks of all threads, too.
bool lockWhatIsTouched() {
  constexpr int kAll = MCL_CURRENT | MCL_FUTURE;
  if (mlockall(kAll | MCL_ONFAULT) == 0) return true;
  return errno == EINVAL && mlockall(kAll) == 0;
}

}  // namespace

void keepMemory() {
  mallopt(M_ARENA_MAX, kMostArenas);
  mallopt(M_MMAP_THRESHOLD, kMostInHeap);
  mallopt(M_TRIM_THRESHOLD, kNeverTrimmed);
  prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
}

RealtimeReport makeRealtime(int priority) {
  RealtimeReport report;
  keepMemory();
  report.memory = lockWhatIsTouched();
  const int memory = errno;
  touchStack();
  touchHeap();
  touchProgram();
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int scheduling = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  report.scheduling = scheduling == 0;
  prctl(PR_SET_TIMERSLACK, 1);  // ns; only matters without SCHED_FIFO
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
