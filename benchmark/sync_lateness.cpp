// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How punctual SYNC is: the driver's thread beside a bare loop.
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "bus/jobs/procedure_command.h"
#include "bus/real_clock.h"
#include "bus/realtime.h"
#include "bus/runner.h"
#include "figures.h"
#include "robots.h"
#include "scripted_drives.h"

namespace cia402::benchmark {
namespace {

using std::chrono::milliseconds;

constexpr Duration kPeriod = milliseconds(4);
constexpr int kAxes = 6, kPriority = 80;
constexpr int kBlocks = 20, kSamples = 500;

/// The absolute deadlines of a periodic task: what is overdue by a period or more is left out.
class Deadlines {
 public:
  explicit Deadlines(Time first) : next_(first) {}
  Time next() const { return next_; }
  /// @return how late the event at `time` was, in seconds.
  double meet(Time time) {
    const Duration late = time - next_;
    next_ += kPeriod;
    if (next_ <= time) next_ += ((time - next_) / kPeriod + 1) * kPeriod;
    return toSeconds(late);
  }

 private:
  Time next_;
};

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// What the bus thread saw; read once it has ended.
struct Record {
  Time start{};
  std::vector<Time> syncs;
};

/// Scripted drives on an interface that notes when SYNC was handed to it.
class MeasuringInterface final : public can::Interface {
 public:
  explicit MeasuringInterface(Record& record) : record_(record), drives_(kAxes) {
    pending_.reserve(256);
  }

  bool send(const can::Frame& frame) override {
    std::vector<Time>& syncs = record_.syncs;
    if (frame.id == 0x080 && syncs.size() < syncs.capacity()) syncs.push_back(bus::realNow());
    ++counters_.frames_sent;
    drives_.receive(frame, pending_);
    return true;
  }
  std::optional<can::ReceivedFrame> receive(Time now) override {
    if (record_.start == Time{}) record_.start = now;  // the round in which the robot was started
    drives_.tick(now, pending_);
    if (next_ < pending_.size()) return can::ReceivedFrame{pending_[next_++], now};
    pending_.clear();
    next_ = 0;
    return std::nullopt;
  }
  void maintain(Time) override {}
  Time nextDeadline() const override {
    return next_ < pending_.size() ? Time{} : drives_.nextHeartbeat();
  }
  int fd() const override { return -1; }
  can::BusState state() const override { return can::BusState::error_active; }
  const can::BusCounters& counters() const override { return counters_; }
  std::string describe() const override { return "scripted drives"; }

 private:
  Record& record_;
  ScriptedDrives drives_;
  std::vector<can::Frame> pending_;
  std::size_t next_ = 0;
  can::BusCounters counters_;
};

void waitUntilAll(bus::BusRunner& runner, bool (*condition)(const drive::AxisState&)) {
  for (int i = 0; i < 1000; ++i) {
    const bus::NetworkSnapshot snapshot = runner.snapshot();
    const bool all = std::all_of(snapshot.axes.begin(), snapshot.axes.end(),
                                 [&](const bus::AxisSnapshot& a) { return condition(a.state); });
    if (all) return;
    std::this_thread::sleep_for(milliseconds(10));
  }
  std::string told;
  for (bus::Event event; runner.nextEvent(event);) told += "\n" + event.text.str();
  throw std::runtime_error("the axes were not enabled within 10 s:" + told);
}

/// Latenesses of kSamples SYNCs of a driver with all axes enabled.
std::vector<double> driverBlock(const TestRobot& config) {
  Record record;
  record.syncs.reserve(10000);
  bus::BusRunner::Options options;
  options.priority = kPriority;
  bus::BusRunner runner(config.robot, config.master, std::make_unique<MeasuringInterface>(record),
                        options);
  runner.start();
  waitUntilAll(runner, [](const drive::AxisState& state) { return state.feedback_valid; });
  bus::ProcedureCommand enable;
  enable.request.kind = drive::ProcedureKind::enable;
  runner.post(bus::Command(enable));
  waitUntilAll(runner, [](const drive::AxisState& state) { return state.ready_for_motion; });
  const Time begin = bus::realNow();
  std::this_thread::sleep_for((kSamples + 5) * kPeriod);
  runner.requestShutdown();
  runner.join();
  Deadlines deadlines(record.start + kPeriod);
  std::vector<double> latenesses;
  for (Time sync : record.syncs) {
    const double late = deadlines.meet(sync);
    if (sync >= begin && latenesses.size() < kSamples) latenesses.push_back(late);
  }
  return latenesses;
}

/// The same of a thread that does nothing but wait.
std::vector<double> bareBlock() {
  std::vector<double> latenesses;
  latenesses.reserve(kSamples);
  std::thread thread([&latenesses] {
    (void)bus::makeRealtime(kPriority);  // what is refused is refused to the driver, too
    Deadlines deadlines(bus::realNow() + kPeriod);
    while (latenesses.size() < kSamples) {
      const std::int64_t at = deadlines.next().time_since_epoch().count();
      const timespec deadline{at / 1'000'000'000, at % 1'000'000'000};
      while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
      }
      latenesses.push_back(deadlines.meet(bus::realNow()));
    }
  });
  thread.join();
  return latenesses;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

// Blocks alternate, and the middle one of each counts: other programs on the machine disturb a
// block now and then, and whichever is hit.
int syncLateness() {
  TestRobot config = genericRobot(kAxes, toSeconds(kPeriod), Layout::lean);
  config.robot.bus.listen = Duration::zero();  // SYNC counts from the start, not from its end
  std::vector<double> driver, bare;
  for (int i = 0; i < kBlocks; ++i) {
    driver.push_back(rms(driverBlock(config)));
    bare.push_back(rms(bareBlock()));
  }
  std::fprintf(stderr, "rms lateness of SYNC %.1f us, of the bare loop %.1f us\n",
               median(driver) * 1e6, median(bare) * 1e6);
  print("sync_lateness", median(driver) / median(bare), "ratio");
  return 0;
}

}  // namespace cia402::benchmark
