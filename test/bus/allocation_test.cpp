// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bus/canopen/reload_command.h"
#include "bus/flight_recorder.h"
#include "bus/robot_world.h"
#include "count_allocations.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

class AnySink : public can::Sink {
 public:
  bool send(const can::Frame&) override { return true; }
};

/// A recorder that looks on while a robot is enabled, moves and fails.
class RecorderAllocation : public testing::Test {
 protected:
  RecorderAllocation() {
    recorder.watch(world.network);
    world.boot();
  }
  /// Everything that the cycle asks of the recorder, without a single allocation.
  void record(Duration time) {
    for (const Time end = world.now + time; world.now < end;) {
      world.run(test::kPeriod);
      const Event event = world.events.empty() ? Event() : world.events.back();
      allocations = 0;
      counting = true;
      recorder.observe();
      recorder.received(can::Frame(0x181, {1, 2, 3}), world.now);
      recorder.send(can::Frame(0x201, {1, 2, 3}));
      recorder.onEvent(event);
      counting = false;
      ASSERT_EQ(allocations, 0);
    }
  }
  static config::RobotConfig configuration() {
    config::RobotConfig robot = test::testRobot();
    robot.recorder.duration = 1s;  // the rings of axes and notes run over
    robot.recorder.keep = 5;
    return robot;
  }
  AnySink sink;
  config::RobotConfig config = configuration();
  test::RobotWorld world{config};
  FlightRecorder recorder{config, sink};
};

TEST_F(RecorderAllocation, RecordingAllocatesNothingWhateverHappens) {
  const std::size_t memory = recorder.memory();
  record(100ms);
  const auto enabled = world.begin(drive::ProcedureKind::enable);
  record(1s);
  ASSERT_TRUE(enabled->front().success);
  ASSERT_TRUE(world.move({1.0, -1.0}, 2.0).success);
  record(1s);
  world.drives[0].fault(0x8611);
  record(8s);
  RecordingTrigger trigger;
  ASSERT_TRUE(recorder.nextTrigger(trigger));
  EXPECT_EQ(recorder.memory(), memory);
  const Recording recording = recorder.copy(world.now);
  EXPECT_GT(recording.axes.size(), 19U);
}

TEST_F(RecorderAllocation, AStormOfEmergenciesHidesNoFaultOfTheSameAxis) {
  EmergencyEvent emergency;
  emergency.emergency.code = 0x8130;
  for (int i = 0; i < 100; ++i) {
    emergency.emergency.stamp = world.now - 2s + i * 10ms;
    recorder.onEmergency(emergency);
  }
  RecordingTrigger trigger;
  while (recorder.nextTrigger(trigger)) {
  }
  world.drives[0].fault(0x8611);
  record(100ms);
  ASSERT_TRUE(recorder.nextTrigger(trigger));
  EXPECT_EQ(trigger.kind, RecordingTrigger::Kind::fault);
}

TEST_F(RecorderAllocation, TheCounterCounts) {
  allocations = 0;
  counting = true;
  int* volatile number = new int(1);  // volatile: may not be optimised away
  delete number;
  counting = false;
  EXPECT_GE(allocations, 1);
}

TEST(ReloadAllocation, WhatIsChangedInMotionTakesNoMemoryOfTheBus) {
  const config::RobotConfig robot = test::testRobot();
  config::RobotConfig next = robot;
  next.groups[0].tolerances["elbow"] = {0.1, 0.01};
  next.axes[0].command_timeout = 50ms;
  const canopen::MasterConfig master = test::masterOf(robot);
  const auto reload = makeReload({robot, master}, {next, master}, false);
  test::RobotWorld world(robot);
  world.enable();
  ASSERT_TRUE(world.move({1.0, -1.0}, 2.0).success);
  world.run(500ms);
  bool done = false;
  Command command(ReloadCommand{reload},
                  [&done](const ReloadAnswer& answer) { done = answer.success; });
  allocations = 0;
  counting = true;
  world.network.execute(std::move(command), world.now);
  counting = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(done);
  EXPECT_EQ(world.group().config().tolerances.at("elbow").goal, 0.01);
  EXPECT_TRUE(reload->groups[0].tolerances.empty()) << "what was before is freed by who asked";
}

/// Counts what the network takes of memory in its cycles, also for frames received; commands apart.
struct CycleAllocation : testing::Test {
  CycleAllocation() {
    world.enable();
    world.in_cycle = &counting;
    allocations = 0;
  }
  ~CycleAllocation() override { world.in_cycle = nullptr; }
  /// Gives it to the group, and lets it lead for a while.
  void follow(TrajectoryCommand command) {
    command.ended = [this](const TrajectoryOutcome& outcome) {
      if (outcome.end == TrajectoryEnd::replaced) ++replaced;
    };
    const auto answers = world.begin(std::move(command));
    ASSERT_FALSE(answers->empty());
    ASSERT_TRUE(answers->front().success) << answers->front().message;
    world.run(40ms);
    ASSERT_TRUE(world.group().executing());
  }
  test::RobotWorld world;
  int replaced = 0;
};

TEST_F(CycleAllocation, TrajectoriesThatReplaceEachOtherTakeNone) {
  for (int i = 0; i < 100; ++i) {
    const double place = 0.014 * i;
    follow(world.trajectory("arm", {{{place, -place}, 0.5}, {{2 * place, 0.0}, 1.0}}));
  }
  EXPECT_EQ(replaced, 99);
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(std::abs(world.drives[0].position), 1000);
}

TEST_F(CycleAllocation, OnesThatBeginLaterTakeNoneEither) {
  for (int i = 0; i < 50; ++i) {
    const double place = 0.02 * i;
    TrajectoryCommand command = world.trajectory("arm", {{{place, -place}, 0.5}});
    command.start_time = world.now + 30ms;
    follow(std::move(command));
  }
  EXPECT_EQ(replaced, 49);
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(std::abs(world.drives[0].position), 1000);
}

TEST_F(CycleAllocation, AStreamOfSinglePointsTakesNone) {
  for (int i = 0; i < 100; ++i) {
    TrajectoryCommand command = world.trajectory("arm", {{{0.01 * i, -0.01 * i}, 0.06}});
    command.points[0].velocities.clear();
    command.streamed = true;
    follow(std::move(command));
  }
  EXPECT_EQ(replaced, 99);
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(std::abs(world.drives[0].position), 1000);
}

TEST_F(CycleAllocation, TheCounterIsOnInACycle) {
  world.in_cycle = nullptr;
  world.run(4ms);
  EXPECT_EQ(allocations, 0);
  world.in_cycle = &counting;
  world.drives[0].fault(0x8611);  // it is told of in words
  world.run(100ms);
  EXPECT_GT(allocations, 0);
}

}  // namespace
}  // namespace cia402::bus
