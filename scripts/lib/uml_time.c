// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
//
// Preloaded into user-mode Linux: the time of that machine does not depend on the speed of this
// one. All that a kernel knows of time comes through the calls below.
//
// - While it works, its clock goes at a quarter of the speed of ours, and not at all while it gets
//   no processor: it sees a faster processor than there is, that nobody else uses.
// - While it is idle, its clock jumps to the next timer: nothing comes from outside that it could
//   wait for.
//
// User-mode Linux makes these calls in one thread, and in the handlers of that thread's signals.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdint.h>
#include <time.h>

enum { second = 1000000000 };  // all times are in ns

static const int64_t slowness = 4;
// The clock is read at every system call. What lies longer between two readings than this is not
// counted: most likely somebody else had the processor.
static const int64_t longest_step = 1000000;

static int64_t guest_time;  // the time in there; 0: not yet known
static int64_t last_host;   // this machine's time at the last reading
static int64_t next_timer;  // when the timer is to fire in the time of in there; 0: not armed
static timer_t timer;

#define LIBC(name) ((__typeof__(&name))libc(#name))

static void* libc(const char* name) { return dlsym(RTLD_NEXT, name); }

static int64_t toNs(struct timespec time) { return time.tv_sec * (int64_t)second + time.tv_nsec; }

static struct timespec toTimespec(int64_t ns) {
  return (struct timespec){.tv_sec = ns / second, .tv_nsec = ns % second};
}

static int64_t hostTime(void) {
  static __typeof__(&clock_gettime) read;
  if (!read) read = LIBC(clock_gettime);
  struct timespec now;
  read(CLOCK_MONOTONIC, &now);
  return toNs(now);
}

// A handler may read the clock within a reading: added is what each of them found, so that it never
// goes back.
static int64_t guestTime(void) {
  const int64_t host = hostTime();
  if (guest_time == 0) {
    guest_time = last_host = host;
    return guest_time;
  }
  int64_t step = host - __atomic_exchange_n(&last_host, host, __ATOMIC_SEQ_CST);
  if (step < 0) step = 0;
  if (step > longest_step) step = longest_step;
  return __atomic_add_fetch(&guest_time, step / slowness, __ATOMIC_SEQ_CST);
}

static int armHost(int64_t delay, int64_t interval) {
  static __typeof__(&timer_settime) arm;
  if (!arm) arm = LIBC(timer_settime);
  const struct itimerspec setting = {.it_value = toTimespec(delay),
                                     .it_interval = toTimespec(interval)};
  return arm(timer, 0, &setting, NULL);
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  // The date of the day is asked for at the start only.
  if (clock != CLOCK_MONOTONIC) return LIBC(clock_gettime)(clock, time);
  *time = toTimespec(guestTime());
  return 0;
}

int timer_settime(timer_t id, int flags, const struct itimerspec* setting,
                  struct itimerspec* before) {
  (void)flags;   // user-mode Linux has one timer, and sets delays
  (void)before;  // and does not ask
  timer = id;
  // It fires at intervals only while the kernel starts; then each time is set alone.
  const int64_t delay = toNs(setting->it_value), interval = toNs(setting->it_interval);
  next_timer = delay != 0 && interval == 0 ? guestTime() + delay : 0;
  return armHost(delay * slowness, interval * slowness);
}

int sigsuspend(const sigset_t* mask) {
  const int64_t wait = next_timer == 0 ? 0 : next_timer - guestTime();
  if (wait > 0) __atomic_add_fetch(&guest_time, wait, __ATOMIC_SEQ_CST);
  if (next_timer != 0) armHost(1, 0);
  static __typeof__(&sigsuspend) suspend;
  if (!suspend) suspend = LIBC(sigsuspend);
  const int result = suspend(mask);
  last_host = hostTime();
  return result;
}
