// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::bus {

/// 256 KB of the calling thread's stack, so that using them is no page fault.
void touchStack();

/// The calling thread's share of the heap, 1 MB that is free afterwards, and what the process has
/// allocated so far. Freed memory must stay with the process, see keepMemory().
void touchHeap();

/// Code and data of the program and of the libraries that a thread without ROS uses. Others, some
/// 60 MB in a ROS node, are left to those who use them.
void touchProgram();

}  // namespace cia402::bus
