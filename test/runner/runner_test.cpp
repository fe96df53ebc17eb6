// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/runner.h"

#include <cmath>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "runner/runner_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::BusRunnerTest;

TEST_F(BusRunnerTest, RefusesCommandsBeforeItsStart) {
  auto answer = post(ProcedureKind::enable);
  EXPECT_FALSE(posted);
  EXPECT_EQ(answer.get().message, "refused: the driver is not running");
}

TEST_F(BusRunnerTest, ShowsAllThatIsConfiguredAsUnknownBeforeItsFirstCycle) {
  const NetworkSnapshot snapshot = runner->snapshot();
  ASSERT_EQ(snapshot.axes.size(), 2u);
  for (const AxisSnapshot& axis : snapshot.axes) {
    EXPECT_EQ(axis.state.health, fieldbus::Health::absent);
    EXPECT_FALSE(axis.state.feedback_valid);
  }
  ASSERT_EQ(snapshot.joints.size(), 2u);
  for (const JointState& joint : snapshot.joints) {
    EXPECT_FALSE(joint.known);
    EXPECT_TRUE(std::isnan(joint.position));
  }
  EXPECT_EQ(snapshot.groups.size(), 1u);
}

TEST_F(BusRunnerTest, EndsCleanlyThoughItWasNeverStarted) {
  runner.reset();
  EXPECT_EQ(wire->frames, 0);
}

TEST_F(BusRunnerTest, WaitsForAMissingInterfaceAndStartsTheRobotWhenItIsThere) {
  wire->state = can::BusState::missing;
  const Time before = realNow();
  runner->start();
  while (runner->snapshot().now < before) std::this_thread::yield();
  waitFor([&] { return seen("can0 is missing"); });
  EXPECT_EQ(post(ProcedureKind::enable).get().message,
            "refused: the bus interface can0 is not there yet");
  EXPECT_EQ(wire->frames, 0);
  wire->state = can::BusState::error_active;
  wire->first_frame.get_future().wait();
  waitFor([&] { return seen("elbow (node 2): booted in"); });
  EXPECT_EQ(runner->snapshot().bus_state, can::BusState::error_active);
}

TEST_F(BusRunnerTest, CarriesCommandsOutAndShowsTheResultInItsSnapshot) {
  runner->start();
  waitFor([&] { return ready(); });
  const Answer enabled = post(ProcedureKind::enable).get();
  EXPECT_TRUE(enabled.success) << enabled.message;
  waitFor(
      [&] { return runner->snapshot().axes[1].state.state == drive::State::operation_enabled; });
  const NetworkSnapshot snapshot = runner->snapshot();
  EXPECT_GT(snapshot.statistics.cycles(), 0u);
  EXPECT_GT(snapshot.counters.frames_received, 0u);
  EXPECT_EQ(snapshot.axes.size(), 2u);
  EXPECT_EQ(runner->lostEvents(), 0u);
}

TEST_F(BusRunnerTest, AFloodDoesNotKeepItFromItsEnd) {
  wire->while_flushing = [&] { wire->flood = true; };
  runner->start();
  wire->first_frame.get_future().wait();
  runner->requestShutdown();
  runner->join();
  EXPECT_TRUE(wire->flood);
  EXPECT_FALSE(runner->running());
}

TEST_F(BusRunnerTest, SleepsUntilSomethingIsDue) {
  runner->start();
  waitFor([&] { return ready(); });
  const auto cycles = [&] { return runner->snapshot().statistics.cycles(); };
  const std::uint64_t from = cycles();
  const long before = wire->rounds;
  while (cycles() < from + 20) std::this_thread::yield();
  EXPECT_LT(wire->rounds - before, 20 * 100);
}

TEST_F(BusRunnerTest, RefusesCommandsAfterItsEnd) {
  runner->start();
  wire->first_frame.get_future().wait();
  runner->requestShutdown();
  runner->join();
  EXPECT_FALSE(runner->running());
  EXPECT_TRUE(runner->snapshot().shut_down);
  auto answer = post(ProcedureKind::enable);
  EXPECT_FALSE(posted);
  EXPECT_EQ(answer.get().message, "refused: the driver is not running");
}

TEST_F(BusRunnerTest, ShutsDownInItsDestructorAndAnswersWhatWaits) {
  runner->start();
  waitFor([&] { return ready(); });
  std::future<Answer> homed = post(ProcedureKind::home);
  std::vector<std::future<ObjectAnswer>> answers;
  for (int i = 0; i < 50; ++i) answers.push_back(post(ReadObjectCommand{"elbow", "6098:00"}));
  runner.reset();
  EXPECT_FALSE(homed.get().message.empty());
  for (auto& answer : answers) EXPECT_FALSE(answer.get().message.empty());
  wire->shut_down.get_future().wait();
}

TEST_F(BusRunnerTest, AnswersCommandsThatComeWhileItEnds) {
  std::future<Answer> answer;
  wire->while_flushing = [&] { answer = post(ProcedureKind::enable); };
  runner->start();
  wire->first_frame.get_future().wait();
  runner->requestShutdown();
  runner->join();
  ASSERT_TRUE(posted);
  ASSERT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  EXPECT_EQ(answer.get().message, "refused: the driver is shutting down");
}

TEST_F(BusRunnerTest, RefusesCommandsThatFindNoRoom) {
  runner->start();
  std::promise<void> arrived, release;
  CallCommand call;
  call.function = [&](Time) {
    arrived.set_value();
    release.get_future().wait();
    return Answer();
  };
  auto blocking = post(call);
  arrived.get_future().wait();
  std::vector<std::future<Answer>> queued;
  do {
    queued.push_back(post(SetpointCommand{0, 1.0}));
  } while (posted && queued.size() < 1000);
  EXPECT_EQ(queued.size(), 257u);
  EXPECT_EQ(queued.back().get().message, "refused: too many commands are waiting, try again");
  release.set_value();
  blocking.wait();
  meet();
}

}  // namespace
}  // namespace cia402::bus
