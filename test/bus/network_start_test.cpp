// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

config::RobotConfig listening() {
  config::RobotConfig robot = test::testRobot();
  robot.bus.listen = 150ms;
  return robot;
}

class NetworkStart : public testing::Test {
 protected:
  NetworkStart() : world(listening()) {}
  void hear(const can::Frame& frame) { world.network.receive(frame, world.now, world.now); }
  std::string syncProblem() {
    NetworkSnapshot snapshot;
    world.network.fill(snapshot);
    return snapshot.sync_problem.str();
  }
  RobotWorld world;
};

TEST_F(NetworkStart, ListensBeforeTheFirstFrameIsSent) {
  world.network.start(world.now);
  EXPECT_EQ(world.network.nextDeadline(), world.now + 150ms);
  world.run(149ms);
  EXPECT_TRUE(world.sent.empty());
  world.run(2ms);
  ASSERT_GE(world.sent.size(), 6u);
  EXPECT_EQ(world.sent[0].frame, can::Frame(0x77F, {0x00}));
  EXPECT_EQ(world.sent[1].frame, can::Frame(0x77F, {0x05}));
  // Whether their motors turn is asked first.
  EXPECT_EQ(world.sent[2].frame, can::Frame(0x601, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(world.sent[3].frame, can::Frame(0x000, {0x82, 0x01}));
  EXPECT_EQ(world.sent[4].frame, can::Frame(0x602, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(world.sent[5].frame, can::Frame(0x000, {0x82, 0x02}));
}

TEST_F(NetworkStart, ShowsWhatItWaitsFor) {
  const auto step = [&] {
    NetworkSnapshot snapshot;
    world.network.fill(snapshot);
    EXPECT_EQ(snapshot.axes[0].words.step.str(), snapshot.axes[1].words.step.str());
    return snapshot.axes[0].words.step.str();
  };
  world.network.start(world.now);
  EXPECT_EQ(step(), "listening for another master");
  world.run(50ms);
  hear(can::Frame(0x77F, {0x05}));
  EXPECT_EQ(step(), "waiting until there is no other master on the bus");
  world.run(149ms);
  EXPECT_EQ(step(), "waiting until there is no other master on the bus");
  world.run(2ms);
  EXPECT_THAT(step(), testing::Not(HasSubstr("master on the bus")));
}

TEST_F(NetworkStart, SendsNothingWhileThereIsAnotherMasterAndSaysSo) {
  world.network.start(world.now);
  for (int i = 0; i < 50; ++i) {
    world.run(100ms);
    hear(can::Frame(0x201, {0x0F, 0x00, 0x08, 0, 0, 0, 0}));
  }
  EXPECT_TRUE(world.sent.empty());
  EXPECT_EQ(world.eventsWith("another master is on the bus, heard: RPDO 1 of shoulder (COB-ID "
                             "0x201); nothing is sent until none for 0.15 s"),
            1u);
  EXPECT_THAT(syncProblem(), HasSubstr("another master is on the bus"));
  const auto answers = world.begin(ProcedureKind::recover);
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_FALSE(answers->front().success);
  EXPECT_THAT(answers->front().message,
              AllOf(HasSubstr("refused: another master is on the bus"), HasSubstr("0x201")));
}

TEST_F(NetworkStart, GoesOnByItselfOnceTheBusIsFree) {
  world.network.start(world.now);
  hear(can::Frame(0x000, {0x01, 0x00}));
  world.run(100ms);
  hear(can::Frame(0x080, {}));
  world.run(149ms);
  EXPECT_TRUE(world.sent.empty());
  world.run(2ms);
  EXPECT_FALSE(world.sent.empty());
  EXPECT_EQ(world.eventsWith("there is no other master on the bus any more"), 1u);
  EXPECT_EQ(syncProblem(), "");
  EXPECT_TRUE(
      world.runUntil([&] { return world.axis(0).state().health == fieldbus::Health::ready; }));
}

TEST_F(NetworkStart, ASecondStartChangesNothing) {
  world.network.start(world.now);
  world.run(100ms);
  world.network.start(world.now);
  world.run(52ms);
  EXPECT_FALSE(world.sent.empty());
  const std::size_t resets = world.sentWithId(0x000).size();
  world.network.start(world.now);
  world.run(10ms);
  EXPECT_EQ(world.sentWithId(0x000).size(), resets);
}

TEST_F(NetworkStart, ListensForAsLongAgainAfterEachFrameOfAnotherMasterAndSendsNoCycleWithIt) {
  world.network.start(world.now);
  world.run(100ms);
  hear(can::Frame(0x77F, {0x05}));
  EXPECT_EQ(world.network.nextDeadline(), world.now + 150ms);
  world.run(100ms);
  hear(can::Frame(0x77F, {0x05}));
  EXPECT_EQ(world.network.nextDeadline(), world.now + 150ms)
      << "nothing new, but it is still there";
  EXPECT_EQ(world.eventsWith("another master is on the bus"), 1u);
  EXPECT_EQ(world.network.cycle().lastCycle(), Time());
  const Time free = world.now + 150ms;
  ASSERT_TRUE(world.runUntil([&] { return !world.sent.empty(); }));
  EXPECT_EQ(world.sent.front().time, free);
  world.run(1ms);
  EXPECT_EQ(world.network.cycle().lastCycle(), Time()) << "the first SYNC comes after a period";
}

TEST_F(NetworkStart, SixtyFourCallsWaitAtMostAndSetPointsDoNot) {
  world.network.start(world.now);
  EXPECT_THAT(world.begin(SetpointCommand{0, 1.0})->at(0).message,
              HasSubstr("refused: the bus is still listened to for another master; try again"));
  EXPECT_EQ(world.begin(world.trajectory("arm", {{{1.0, 0.0}, 1.0}}))->size(), 1u);
  for (int i = 0; i < 64; ++i) {
    EXPECT_TRUE(world.begin(ReadObjectCommand{"shoulder", "6098:00"})->empty()) << i;
  }
  const auto refused = world.begin(ReadObjectCommand{"shoulder", "6098:00"});
  ASSERT_EQ(refused->size(), 1u);
  EXPECT_THAT(refused->front().message, HasSubstr("try again"));
}

TEST_F(NetworkStart, ACallDuringTheListeningWaitsForItsEnd) {
  world.network.start(world.now);
  const auto answers = world.begin(ProcedureKind::recover);
  world.run(140ms);
  EXPECT_TRUE(answers->empty());
  const Answer answer = world.wait(answers);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(world.drives[0].enabled());
}

TEST_F(NetworkStart, ACallThatWaitsIsRefusedWhenAnotherMasterIsHeard) {
  world.network.start(world.now);
  const auto answers = world.begin(ProcedureKind::recover);
  world.run(50ms);
  hear(can::Frame(0x77F, {0x05}));
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_THAT(answers->front().message, HasSubstr("a heartbeat with the master's node-ID"));
}

// Who was here before may have left a motor turning.
TEST_F(NetworkStart, ListensToTheEndAndLooksAtItsDrivesWhenItIsShutDownMeanwhile) {
  world.network.start(world.now);
  const Time listened = world.now + 150ms;
  const auto answers = world.begin(ProcedureKind::recover);
  world.run(50ms);
  world.network.beginShutdown(world.now);
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_EQ(answers->front().message, "refused: the driver is shutting down");
  ASSERT_TRUE(world.runUntil([&] { return world.network.shutDown(); }, 1s));
  EXPECT_LT(world.now, listened + 100ms) << "they answer at once, and rest";
  for (const std::uint32_t request : {0x601u, 0x602u}) {
    const auto asked = world.sentWithId(request);
    ASSERT_FALSE(asked.empty());
    EXPECT_GE(asked[0].time, listened);
    EXPECT_EQ(asked[0].frame, can::Frame(request, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}));
  }
  EXPECT_EQ(world.sentWithId(0x000).back().frame, can::Frame(0x000, {0x80, 0x00}));
  world.sent.clear();
  world.run(1s);
  EXPECT_TRUE(world.sent.empty());
}

TEST_F(NetworkStart, StopsOneThatTurnsWhenItIsShutDownMeanwhile) {
  world.drives[1].statusword = 0x0237;  // operation enabled
  world.network.start(world.now);
  world.network.beginShutdown(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.network.shutDown(); }, 2s));
  EXPECT_EQ(world.drives[1].statusword & 0x6Fu, 0x40u) << "switch on disabled";
}

TEST_F(NetworkStart, EndsInTimeWhenItIsShutDownThoughNobodyIsThere) {
  for (auto& drive : world.drives) drive.silent = true;
  world.network.start(world.now);
  const Time begun = world.now;
  world.network.beginShutdown(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.network.shutDown(); }, 2s));
  EXPECT_LT(world.now - begun, 600ms) << "each was asked once, and told once to stop";
}

TEST(NetworkStartAtAShutdown, SendsNothingWhereAnotherMasterIsHeardOrTheBusIsLost) {
  for (const bool lost : {true, false}) {
    for (const bool before : {true, false}) {
      SCOPED_TRACE(std::string(lost ? "lost" : "heard") + (before ? " before" : " after"));
      RobotWorld world(listening());
      const auto trouble = [&] {
        if (lost) return world.network.busLost("can0 is bus-off", world.now);
        world.network.receive(can::Frame(0x77F, {0x05}), world.now, world.now);
      };
      world.network.start(world.now);
      world.run(50ms);
      if (before) trouble();
      world.network.beginShutdown(world.now);
      EXPECT_EQ(world.network.shutDown(), before);
      if (!before) trouble();
      world.run(1s);
      EXPECT_TRUE(world.network.shutDown());
      EXPECT_TRUE(world.sent.empty());
    }
  }
}

TEST_F(NetworkStart, WhatCouldNotBeHeardIsListenedToAnew) {
  world.network.start(world.now);
  world.run(100ms);
  world.network.busLost("can0 is bus-off", world.now);
  world.run(1s);
  EXPECT_TRUE(world.sent.empty());
  world.network.busBack(true, world.now);
  world.run(100ms);
  EXPECT_TRUE(world.sent.empty());
  world.run(100ms);
  EXPECT_FALSE(world.sent.empty());
}

TEST_F(NetworkStart, WhatElseIsHeardOfAnotherMasterIsShownAndNotToldAgain) {
  world.network.start(world.now);
  hear(can::Frame(0x77F, {0x05}));
  hear(can::Frame(0x201, {0x0F, 0x00, 0x08, 0, 0, 0, 0}));
  EXPECT_EQ(world.eventsWith("another master is on the bus"), 1u) << world.allEvents();
  EXPECT_THAT(syncProblem(), AllOf(HasSubstr("a heartbeat with the master's node-ID"),
                                   HasSubstr("RPDO 1 of shoulder (COB-ID 0x201)")));
}

TEST_F(NetworkStart, TellsOfNoOtherMasterOnceItIsShutDown) {
  world.network.start(world.now);
  world.network.beginShutdown(world.now);
  hear(can::Frame(0x77F, {0x05}));
  EXPECT_EQ(world.eventsWith("another master"), 0u) << world.allEvents();
}

TEST_F(NetworkStart, ASyncDuringTheListeningIsNoneBesideItsOwn) {
  world.network.start(world.now);
  hear(can::Frame(0x080, {}));
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  EXPECT_EQ(snapshot.foreign_syncs, 0u);
}

}  // namespace
}  // namespace cia402::bus
