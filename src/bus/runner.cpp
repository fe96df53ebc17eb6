// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/runner.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <system_error>
#include <utility>

namespace cia402::bus {
namespace {

constexpr Duration kIdleInterval = std::chrono::milliseconds(20);  // while there is no cycle
constexpr Duration kFlushTime = std::chrono::milliseconds(20);     // for the last frames
constexpr int kFramesToFlush = 256;  // per millisecond: a flood does not keep it from its end

}  // namespace

BusRunner::BusRunner(config::RobotConfig robot, canopen::MasterConfig master,
                     std::unique_ptr<can::Interface> interface, Options options)
    : options_(std::move(options)),
      time_(options_.time, options_.clock),
      interface_(std::move(interface)),
      loop_(std::move(robot), std::move(master), *interface_, *this),
      wake_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      snapshots_(first()),
      recordings_(loop_.recorder(), loop_.network().config(), loop_.network().master().config(),
                  time_) {
  if (wake_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

BusRunner::~BusRunner() {
  requestShutdown();
  join();
  close(wake_fd_);
}

void BusRunner::start() {
  running_ = true;
  thread_ = std::thread([this] { run(); });
}

void BusRunner::requestShutdown() {
  shutdown_requested_ = true;
  wake();
}

void BusRunner::join() {
  if (thread_.joinable()) thread_.join();
}

bool BusRunner::post(Command command) {
  bool queued = false;
  {
    const std::lock_guard<std::mutex> lock(producers_);
    queued = running_ && mailbox_.push(std::move(command));
  }
  if (queued) {
    wake();
  } else {           // not moved from: push() leaves what it does not take
    command.refuse(  // NOLINT(bugprone-use-after-move)
        running_ ? "refused: too many commands are waiting, try again"
                 : "refused: the driver is not running");
  }
  return queued;
}

NetworkSnapshot BusRunner::snapshot() {
  const std::lock_guard<std::mutex> lock(readers_);
  snapshots_.refresh();
  return snapshots_.front();
}

RealtimeReport BusRunner::realtime() {
  const std::lock_guard<std::mutex> lock(realtime_mutex_);
  return realtime_;
}

void BusRunner::onEvent(const Event& event) {
  loop_.recorder().onEvent(event);
  if (!events_.push(Event(event))) ++lost_events_;
}

void BusRunner::onEmergency(const EmergencyEvent& event) {
  loop_.recorder().onEmergency(event);
  if (!emergencies_.push(EmergencyEvent(event))) ++lost_emergencies_;
}

void BusRunner::run() {
  pthread_setname_np(pthread_self(), "bus");  // as ps and top show it
  if (options_.priority > 0) {
    const RealtimeReport report = makeRealtime(options_.priority);
    Event event;
    event.severity = report.complete() ? Event::Severity::info : Event::Severity::warning;
    event.stamp = time_.now();
    event.text.assign(report.text);
    onEvent(event);
    const std::lock_guard<std::mutex> lock(realtime_mutex_);
    realtime_ = report;
  }
  while (!loop_.network().shutDown()) {
    iterate(time_.advance(due_));
    if (!loop_.network().shutDown()) wait();
  }
  const auto advance = [this] { return time_.advance(interface_->nextDeadline()); };
  Time now = advance();
  const Time flushed = now + kFlushTime;  // the last frames are still on their way
  for (; now < flushed; now = advance()) {
    for (int i = 0; i < kFramesToFlush && interface_->receive(now); ++i) {
    }
    interface_->maintain(now);
    if (interface_->nextDeadline() > time_.now()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  publish(now);
  refuseRest();
}

void BusRunner::iterate(Time now) {
  Network& network = loop_.network();
  if (shutdown_requested_) network.beginShutdown(now);
  if (network.config().bus.time_interval > Duration::zero()) {
    network.setWallTime(time_.toClock(now).time_since_epoch() + wallClockDistance(), now);
  }
  if (looked_.exchange(false)) network.cycle().look();
  // A bus in this process stands where it was looked at last: what is sent now shall not be on it
  // before.
  if (options_.time == BusTime::Kind::simulated) interface_->maintain(now);
  loop_.step(now);
  Command command;
  while (mailbox_.pop(command)) network.execute(std::move(command), now);
  if (loop_.recorder().triggered()) recordings_.wake();
  publish(now);
}

NetworkSnapshot BusRunner::first() const {
  NetworkSnapshot snapshot;
  fill(snapshot, time_.now());
  return snapshot;
}

void BusRunner::publish(Time now) {
  const std::uint64_t cycle = loop_.network().statistics().cycles();
  if (cycle == published_cycle_ && now < published_ + kIdleInterval) return;
  published_cycle_ = cycle;
  published_ = now;
  fill(snapshots_.back(), now);
  snapshots_.publish();
}

void BusRunner::fill(NetworkSnapshot& snapshot, Time now) const {
  loop_.network().fill(snapshot);
  snapshot.now = now;
  snapshot.bus_state = interface_->state();
  snapshot.counters = interface_->counters();
  snapshot.bus_load = loop_.meter().load();
  snapshot.most_bus_load = loop_.meter().mostLoad();
  snapshot.bus_text.assign(loop_.watch().text());
  snapshot.pending = interface_->pending();
  snapshot.error_counters = interface_->errorCounters();
}

void BusRunner::wait() {
  pollfd sources[2] = {{wake_fd_, POLLIN, 0}, {interface_->fd(), POLLIN, 0}};
  due_ = loop_.nextDeadline();
  const Time now = time_.now();
  const std::int64_t left = (std::clamp(due_, now, now + kIdleInterval) - now).count();
  const timespec timeout{static_cast<std::time_t>(left / 1'000'000'000),
                         static_cast<long>(left % 1'000'000'000)};
  const nfds_t count = sources[1].fd >= 0 ? 2 : 1;
  if (ppoll(sources, count, &timeout, nullptr) > 0 && sources[0].revents != 0) {
    std::uint64_t wakes = 0;
    (void)!read(wake_fd_, &wakes, sizeof wakes);
  }
}

void BusRunner::wake() const {
  const std::uint64_t one = 1;
  (void)!write(wake_fd_, &one, sizeof one);
}

void BusRunner::refuseRest() {
  const std::lock_guard<std::mutex> lock(producers_);
  running_ = false;
  Command command;
  while (mailbox_.pop(command)) command.refuse("refused: the driver is shutting down");
}

}  // namespace cia402::bus
