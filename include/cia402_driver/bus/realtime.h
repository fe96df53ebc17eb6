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

/// Asks for SCHED_FIFO for the calling thread, locks the process' memory, touches the stack, and
/// asks for exact timers. What is refused is told in the report, never fatal.
/// @param priority 1..99
RealtimeReport makeRealtime(int priority);

}  // namespace cia402::bus
