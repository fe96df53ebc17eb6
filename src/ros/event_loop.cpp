// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/event_loop.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "bus/real_clock.h"

namespace cia402::ros_node {
namespace {

constexpr Duration kTogether = std::chrono::milliseconds(1);  // what is due so soon is done, too

}  // namespace

EventLoop::EventLoop() : wake_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)), began_(bus::realNow()) {
  if (wake_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

EventLoop::~EventLoop() { close(wake_fd_); }

std::size_t EventLoop::every(Duration period, std::function<void()> task,
                             std::function<bool()> wanted) {
  tasks_.push_back({period, began_ + period, std::move(task), std::move(wanted)});
  return tasks_.size() - 1;
}

void EventLoop::retime(std::size_t task, Duration period) {
  Task& known = tasks_[task];
  if (known.period == period) return;
  known.period = period;
  known.due = began_ + ((bus::realNow() - began_) / period + 1) * period;
}

void EventLoop::wake() const {
  const std::uint64_t one = 1;
  (void)!write(wake_fd_, &one, sizeof one);
}

void EventLoop::step() {
  sleep();
  for (const auto& task : always_) task();
  queue_.callAll();
  const Time now = bus::realNow() + kTogether;
  for (Task& task : tasks_) {
    if (task.due > now) continue;
    if (task.counts()) task.work();
    task.due += ((now - task.due) / task.period + 1) * task.period;
  }
}

void EventLoop::sleep() {
  Time due = kNever;
  for (const Task& task : tasks_) {
    if (task.counts()) due = std::min(due, task.due);
  }
  const std::int64_t left = std::max<std::int64_t>((due - bus::realNow()).count(), 0);
  const timespec timeout{static_cast<std::time_t>(left / 1'000'000'000),
                         static_cast<long>(left % 1'000'000'000)};
  pollfd source{wake_fd_, POLLIN, 0};
  if (ppoll(&source, 1, &timeout, nullptr) <= 0) return;
  std::uint64_t wakes = 0;
  (void)!read(wake_fd_, &wakes, sizeof wakes);
}

}  // namespace cia402::ros_node
