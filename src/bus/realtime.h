// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::bus {

/// What the operating system granted to the calling thread.
struct RealtimeReport {
  bool scheduling = false;  ///< SCHED_FIFO
  bool memory = false;      ///< mlockall
  std::string text;         ///< a sentence: what was granted, what not and how to get it
  bool complete() const { return scheduling && memory; }
};

/// Asks for SCHED_FIFO and exact timers for the calling thread, and has memory ready for it: what
/// the process has touched stays in memory, and what this thread will need is touched here (its
/// stack, its share of the heap, the code of the program). What is mapped but never used takes no
/// memory. What is refused is told in the report, never fatal.
/// @param priority 1..99
RealtimeReport makeRealtime(int priority);

/// Settings of the whole process that makeRealtime() relies on and makes, too; best made first in
/// main(). Memory that is freed stays with the process, so that using it again is no page fault;
/// there are no huge pages, of which one byte used would take 2 MB.
void keepMemory();

}  // namespace cia402::bus
