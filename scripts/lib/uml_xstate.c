// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
//
// Preloaded into user-mode Linux 6.1, which knows no processor state larger than that of AVX-512
// (2696 bytes). Where the processor has more (AMX), the host's kernel refuses to set the registers
// of a process from so short a buffer, and the first process dies. Here the short buffer is laid
// over the process's whole state and that is set.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <elf.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

typedef long (*Ptrace)(enum __ptrace_request, ...);

static long hostPtrace(enum __ptrace_request request, pid_t pid, void* addr, void* data) {
  static Ptrace ptrace_of_libc;
  if (!ptrace_of_libc) ptrace_of_libc = (Ptrace)dlsym(RTLD_NEXT, "ptrace");
  return ptrace_of_libc(request, pid, addr, data);
}

static long setWholeState(pid_t pid, const struct iovec* part) {
  static char whole[1 << 16];  // user-mode Linux runs this in one thread only, on a small stack
  struct iovec all = {whole, sizeof(whole)};
  if (hostPtrace(PTRACE_GETREGSET, pid, (void*)NT_X86_XSTATE, &all) != 0) return -1;
  if (part->iov_len < all.iov_len) memcpy(whole, part->iov_base, part->iov_len);
  return hostPtrace(PTRACE_SETREGSET, pid, (void*)NT_X86_XSTATE, &all);
}

long ptrace(enum __ptrace_request request, ...) {
  va_list arguments;
  va_start(arguments, request);
  pid_t pid = va_arg(arguments, pid_t);
  void* addr = va_arg(arguments, void*);
  void* data = va_arg(arguments, void*);
  va_end(arguments);

  long result = hostPtrace(request, pid, addr, data);
  if (result != 0 && request == PTRACE_SETREGSET && addr == (void*)NT_X86_XSTATE) {
    return setWholeState(pid, data);
  }
  return result;
}
