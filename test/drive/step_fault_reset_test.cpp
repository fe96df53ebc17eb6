// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Fault resets that take more than one edge, and what they wait for.
#include "drive/procedure_steps.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::stepsOf;
using test::testConfig;
using test::testProfile;
using S = FakeDrive::S;
using namespace std::chrono_literals;

AxisConfig withTries(int tries, Duration nmt_stop = Duration::zero()) {
  DriveProfile profile = testProfile();
  profile.fault_reset.tries = tries;
  profile.fault_reset.pause = nmt_stop;
  return testConfig(profile);
}

struct FaultedBench : Bench {
  explicit FaultedBench(AxisConfig config = testConfig()) : Bench(std::move(config)) {
    EXPECT_TRUE(boot());
    fail(0x8611);
    run(milliseconds(40));
    each_cycle = [this] {
      if (drive.resets != seen_) edges.push_back(now);
      seen_ = drive.resets;
      if (drive.operational != operational_) ++(drive.operational ? starts : stops);
      operational_ = drive.operational;
      const bool high = (drive.controlword & 0x80) != 0;
      if (high && low_for_ > 0) shortest_low = std::min(shortest_low, low_for_);
      low_for_ = high ? 0 : low_for_ + 1;
    };
  }
  std::vector<Time> edges;  ///< of controlword bit 7, as the drive saw them
  int starts = 0, stops = 0;
  int shortest_low = 1000;  ///< cycles in which the drive saw bit 7 low before an edge

 private:
  int seen_ = 0, low_for_ = 0;
  bool operational_ = true;
};

TEST(FaultResetStep, TellsWhatItWaitsFor) {
  FaultedBench world;
  EXPECT_EQ(
      stepsOf(world, ProcedureKind::clear_faults),
      (std::vector<std::string>{"waiting for the fault reaction to end | the drive to show fault",
                                "resetting the fault | controlword bit 7 to be sent low, then high",
                                "resetting the fault | the drive to leave fault",
                                "fault reset | controlword bit 7 to be sent low again",
                                "fault reset | the fault to stay away"}));
  EXPECT_TRUE(world.axis.procedure().success);
}

TEST(FaultResetStep, TriesAsOftenAsTheProfileSaysAndASecondApart) {
  FaultedBench world(withTries(3));
  world.drive.stuck.insert(S::fault);
  const std::vector<std::string> steps = stepsOf(world, ProcedureKind::clear_faults);
  EXPECT_FALSE(world.axis.procedure().success);
  ASSERT_EQ(world.edges.size(), 3u);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_GE(world.edges[i] - world.edges[i - 1], 1s);
    EXPECT_LT(world.edges[i] - world.edges[i - 1], 1100ms);
  }
  EXPECT_GE(world.now - world.edges[2], 2s) << "the last one has the time of a state change";
  EXPECT_GE(world.shortest_low, 2) << "a frame may get lost";
  EXPECT_THAT(steps, testing::Contains("resetting the fault again | try 2 of 3"));
  EXPECT_THAT(steps, testing::Contains("resetting the fault again | try 3 of 3"));
  EXPECT_THAT(world.axis.procedure().message,
              HasSubstr("the fault reset (6040:00 bit 7) (3 tries) did not clear it within 2"));
}

TEST(FaultResetStep, StopsTryingOnceTheFaultIsGone) {
  FaultedBench world(withTries(3));
  world.drive.stuck.insert(S::fault);
  const auto count = world.each_cycle;
  world.each_cycle = [&] {
    count();
    if (world.drive.resets == 1) world.drive.stuck.clear();
  };
  const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(world.drive.resets, 2);
}

TEST(FaultResetStep, ResetsOnceMoreWhatCameBackWhereTheProfileAllowsIt) {
  for (const int until : {1, 2}) {  // resets that do not help
    SCOPED_TRACE(until);
    FaultedBench world(withTries(2));
    const auto count = world.each_cycle;
    world.each_cycle = [&] {
      count();
      world.drive.fault_persists = world.drive.resets < until;
    };
    world.drive.fault_persists = true;
    const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
    EXPECT_EQ(status.success, until < 2) << status.message;
    EXPECT_EQ(world.drive.resets, 2);
    if (until == 2) {
      EXPECT_THAT(status.message, HasSubstr("came back at once after the reset"));
    }
  }
}

TEST(FaultResetStep, TakesTheNodeThroughNmtStopAndStartAndResetsOnceMore) {
  FaultedBench world(withTries(2, 500ms));
  world.drive.stuck.insert(S::fault);
  Time stopped{}, started{};
  const auto count = world.each_cycle;
  world.each_cycle = [&] {
    count();
    if (world.stops == 1 && stopped == Time{}) stopped = world.now;
    if (world.starts == 1 && started == Time{}) started = world.now;
    if (world.starts == 1) world.drive.stuck.clear();
  };
  const std::vector<std::string> steps = stepsOf(world, ProcedureKind::clear_faults);
  const ProcedureStatus& status = world.axis.procedure();
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("fault 0x8611 following error"));
  EXPECT_EQ(world.drive.resets, 3);
  EXPECT_GE(started - stopped, 500ms);
  EXPECT_THAT(steps, testing::Contains(
                         "taking the node through NMT stop and start for the fault reset | the "
                         "drive to be operational and to send its feedback again"));
  EXPECT_EQ(world.device().health(), fieldbus::Health::ready);
}

TEST(FaultResetStep, TakesTheNodeThroughNmtStopAndStartOnce) {
  FaultedBench world(withTries(1, 500ms));
  world.drive.stuck.insert(S::fault);
  const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(world.stops, 1);
  EXPECT_EQ(world.drive.resets, 2);
  EXPECT_THAT(status.message, HasSubstr("(2 tries) did not clear it"));
}

TEST(FaultResetStep, SaysWhereNothingComesAfterNmtStopAndStart) {
  FaultedBench world(withTries(1, 500ms));
  world.drive.stuck.insert(S::fault);
  const auto count = world.each_cycle;
  world.each_cycle = [&] {
    count();
    if (world.stops == 1) world.drive.silent = true;
  };
  const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(world.drive.resets, 1);
  EXPECT_THAT(status.message, HasSubstr("after NMT stop and start no statusword came for 3.5"))
      << "stopped for 0.5 s, 1 s to start, 2 s for its state";
}

TEST(FaultResetStep, ClearsTheErrorHistoryFirstWhereTheProfileSaysSo) {
  for (const bool refused : {false, true}) {
    SCOPED_TRACE(refused);
    DriveProfile profile = testProfile();
    profile.fault_reset.clears_history = true;
    FaultedBench world(testConfig(profile));
    if (refused) world.drive.aborts[{0x1003, 0}] = 0x06090030;
    world.drive.writes.clear();
    const auto count = world.each_cycle;
    world.each_cycle = [&] {
      count();
      if (!refused && world.drive.resets > 0) {
        EXPECT_EQ(world.drive.writes.size(), 1u);
      }
    };
    const std::vector<std::string> steps = stepsOf(world, ProcedureKind::clear_faults);
    EXPECT_TRUE(world.axis.procedure().success) << world.axis.procedure().message;
    EXPECT_EQ(world.drive.resets, 1);
    using Write = std::pair<unsigned, std::uint64_t>;
    EXPECT_EQ(world.drive.writes,
              refused ? std::vector<Write>{} : (std::vector<Write>{{0x1003, 0}}));
    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps[0], "clearing the error history | the drive to take 1003:00 = 0");
  }
}

TEST(FaultResetStep, AFaultReactionThatDoesNotEndIsNoTimeForAReset) {
  FaultedBench world;
  world.drive.shows = {S::reaction};
  world.run(milliseconds(8));
  const Time began = world.now;
  const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(world.drive.resets, 0);
  EXPECT_GE(world.now - began, 2s);
  EXPECT_THAT(status.message, HasSubstr("the drive's fault reaction did not end within 2"));
}

// Bit 7 that stays high would be no edge when the next reset is asked for.
TEST(FaultResetStep, OneThatIsCutOffTakesItsBitBack) {
  FaultedBench world;
  world.drive.stuck.insert(S::fault);
  ASSERT_TRUE(world.axis.start({ProcedureKind::clear_faults, {}, 0.0}, world.now));
  ASSERT_TRUE(world.runUntil([&] { return (world.drive.controlword & 0x80) != 0; }));
  ASSERT_TRUE(world.axis.start({ProcedureKind::disable, {}, 0.0}, world.now));
  world.run(milliseconds(20));
  EXPECT_EQ(world.drive.controlword & 0x80, 0);
  world.drive.stuck.clear();
  EXPECT_TRUE(world.perform(ProcedureKind::clear_faults).success);
}

TEST(FaultResetStep, ADriveThatIsSilentForAWhileAfterTheResetIsWaitedFor) {
  FaultedBench world;
  const auto count = world.each_cycle;
  Time silent_from{};
  world.each_cycle = [&] {
    count();
    if (world.axis.procedure().waiting_for == "the drive to leave fault") {
      world.drive.silent = true;
      if (silent_from == Time{}) silent_from = world.now;
    }
    if (silent_from != Time{} && world.now - silent_from >= 1s) world.drive.silent = false;
  };
  const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(world.drive.resets, 1);
}

TEST(FaultResetStep, ADriveThatFallsSilentWhileTheFaultIsToStayAwayIsNotSaidToBeCleared) {
  FaultedBench world;
  const auto count = world.each_cycle;
  world.each_cycle = [&] {
    count();
    if (world.axis.procedure().waiting_for == "the fault to stay away") world.drive.silent = true;
  };
  const ProcedureStatus& status = world.perform(ProcedureKind::clear_faults);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("nothing tells whether the fault reset has cleared"));
}

TEST(FaultResetStep, AnEnabledAxisIsLeftDisabledWhereItsWarningIsCleared) {
  DriveProfile profile = testProfile();
  profile.warning_stops = true;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.warning = true;
  bench.drive.quick_stop_ends = false;
  bench.run(milliseconds(20));
  ASSERT_EQ(bench.drive.state, S::quick) << "stopped for the warning";
  bench.each_cycle = [&] {
    if ((bench.drive.controlword & 0x80) != 0) bench.drive.warning = false;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("the axis is disabled"));
  EXPECT_EQ(bench.drive.state, S::disabled);
}

// A drive that took its set-points up again, at the speed of its own stop, would jerk.
TEST(FaultResetStep, AMotorThatAWarningStopsRestsBeforeTheReset) {
  DriveProfile profile = testProfile();
  profile.warning_stops = true;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.warning = true;
  bench.drive.quick_stop_ends = false;
  bench.drive.coast = 50000.0;  // counts/s
  bench.run(milliseconds(20));
  int cycles = 0;
  bench.each_cycle = [&] {
    if (++cycles == 50) bench.drive.coast = 0.0;
    if (bench.drive.coast > 0.0) {
      EXPECT_EQ(bench.drive.controlword & 0x80, 0) << cycles;
      EXPECT_NE(bench.drive.state, S::disabled) << cycles;
    }
    if ((bench.drive.controlword & 0x80) != 0) bench.drive.warning = false;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_EQ(bench.drive.state, S::disabled);
}

}  // namespace
}  // namespace cia402::drive
