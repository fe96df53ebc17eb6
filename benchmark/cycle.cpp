// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What one cycle of the driver costs.
#include <algorithm>
#include <ctime>
#include <vector>

#include "driven_robot.h"
#include "figures.h"

/// Its name is what the instruction counter looks for.
// NOLINTNEXTLINE(readability-identifier-naming): as valgrind is told it
extern "C" __attribute__((noinline)) void cia402_measured_cycle(
    cia402::benchmark::DrivenRobot& robot) {
  robot.cycle();
}

namespace cia402::benchmark {
namespace {

/// Processor time of this thread in seconds.
double processorTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

/// Moves frames as a driver that does nothing else would: one copy in, one copy out through a sink.
class Mover final : private can::Sink {
 public:
  Mover() { outgoing_.reserve(256); }
  __attribute__((noinline)) void move(const std::vector<can::Frame>& received,
                                      const std::vector<can::Frame>& sent) {
    outgoing_.clear();
    for (const can::Frame& frame : received) {
      const can::Frame copy = frame;
      asm volatile("" : : "r"(&copy) : "memory");  // or the copy would be left out
    }
    can::Sink* sink = this;
    asm volatile("" : "+r"(sink));  // or the virtual call would be left out
    for (const can::Frame& frame : sent) sink->send(frame);
  }

 private:
  bool send(const can::Frame& frame) override {
    outgoing_.push_back(frame);
    return true;
  }
  std::vector<can::Frame> outgoing_;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int cycleCost() {
  constexpr int kCycles = 20000, kRepeats = 20;  // moves are too short for one reading each
  DrivenRobot robot(6, 0.004, kCycles);
  Mover mover;
  std::vector<double> driver, bare;
  for (int i = 0; i < kCycles; ++i) {
    robot.prepare();
    const double begin = processorTime();
    cia402_measured_cycle(robot);
    const double between = processorTime();
    for (int k = 0; k < kRepeats; ++k) mover.move(robot.received(), robot.sent());
    const double end = processorTime();
    driver.push_back(between - begin);
    bare.push_back((end - between) / kRepeats);
  }
  robot.check();
  print("cycle_cost_6_axes", median(driver) / median(bare), "ratio");
  return 0;
}

int groupCost() {
  constexpr int kCycles = 20000;
  DrivenRobot moving(6, 0.004, kCycles);
  DrivenRobot holding(6, 0.004, 0);
  std::vector<double> moves, holds;
  for (int i = 0; i < kCycles; ++i) {
    moving.prepare();
    holding.prepare();
    const double begin = processorTime();
    cia402_measured_cycle(moving);
    const double between = processorTime();
    cia402_measured_cycle(holding);
    const double end = processorTime();
    moves.push_back(between - begin);
    holds.push_back(end - between);
  }
  moving.check();
  holding.check();
  print("group_cost_6_axes", median(moves) / median(holds), "ratio");
  return 0;
}

int countedCycles(int axes, int cycles) {
  DrivenRobot robot(axes, 0.01, cycles);
  for (int i = 0; i < cycles; ++i) {
    robot.prepare();
    cia402_measured_cycle(robot);
  }
  robot.check();
  return 0;
}

}  // namespace cia402::benchmark
