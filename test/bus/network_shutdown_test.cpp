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

struct NetworkShutdown : testing::Test {
  bool shutDownIn(Duration limit) {
    const Time begun = world.now;
    world.network.beginShutdown(world.now);
    const bool done = world.runUntil([&] { return world.network.shutDown(); }, limit);
    took = world.now - begun;
    return done;
  }
  void expectPreOperationalLast() const {
    ASSERT_FALSE(world.sent.empty());
    EXPECT_EQ(world.sent.back().frame, can::Frame(0x000, {0x80, 0x00}));
  }
  RobotWorld world;
  Duration took{};
};

TEST_F(NetworkShutdown, IsDoneAtOnceIfNothingWasStarted) {
  world.network.beginShutdown(world.now);
  EXPECT_TRUE(world.network.shutDown());
  EXPECT_TRUE(world.sent.empty());
}

TEST_F(NetworkShutdown, RampsMotionDownThenDisablesThenSendsPreOperational) {
  world.enable();
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);  // 1.5 rad/s
  world.drives[0].targets.clear();
  ASSERT_TRUE(shutDownIn(2s));
  EXPECT_LT(took, 1s);
  const auto& targets = world.drives[0].targets;
  ASSERT_GT(targets.size(), 30u);  // 1.5 rad/s at 10 rad/s² take 150 ms
  for (std::size_t i = 2; i < targets.size(); ++i) {
    const int change = targets[i] - 2 * targets[i - 1] + targets[i - 2];
    EXPECT_LE(std::abs(change), 16 + 3) << i;  // 10 rad/s² * (4 ms)², rounded
  }
  EXPECT_LE(targets.back() - targets[targets.size() - 2], 3);  // came to rest
  EXPECT_EQ(world.drives[0].statusword, 0x0250);
  EXPECT_EQ(world.drives[1].statusword, 0x0250);
  expectPreOperationalLast();
  EXPECT_EQ(world.network.nextDeadline(), kNever);
  world.sent.clear();
  world.run(1s);
  EXPECT_TRUE(world.sent.empty());
}

TEST_F(NetworkShutdown, EndsInTimeThoughTheDrivesDoNotObey) {
  world.enable();
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  for (auto& drive : world.drives) drive.deaf_to_controlword = true;
  ASSERT_TRUE(shutDownIn(2s));
  EXPECT_GE(took, 1700ms);  // they were given their time
  expectPreOperationalLast();
}

TEST_F(NetworkShutdown, EndsInTimeThoughNobodyIsThere) {
  world.enable();
  for (auto& drive : world.drives) drive.silent = true;
  ASSERT_TRUE(shutDownIn(2s));
  expectPreOperationalLast();
}

TEST_F(NetworkShutdown, EndsWhileTheDrivesBoot) {
  world.network.start(world.now);
  world.run(10ms);
  ASSERT_TRUE(shutDownIn(2s));
  expectPreOperationalLast();
}

TEST_F(NetworkShutdown, GivesAllPendingRepliesAndTakesNoMoreCommands) {
  world.enable();
  world.drives[0].deaf_to_controlword = true;
  const auto disable = world.begin(ProcedureKind::disable, "shoulder");
  world.drives[1].sdo_silent = true;
  std::vector<RobotWorld::Answers<ObjectAnswer>> reads;
  for (int i = 0; i < 30; ++i) reads.push_back(world.begin(ReadObjectCommand{"elbow", "6098:00"}));
  ASSERT_TRUE(shutDownIn(2s));
  EXPECT_EQ(disable->size(), 1u);
  EXPECT_FALSE(disable->front().success);
  for (const auto& read : reads) {
    ASSERT_EQ(read->size(), 1u);
    EXPECT_FALSE(read->front().success);
  }
  EXPECT_EQ(reads.back()->front().message, "elbow (node 2): ended by the shutdown of the driver");
  EXPECT_EQ(world.begin(ProcedureKind::enable)->front().message,
            "refused: the driver is shutting down");
}

TEST_F(NetworkShutdown, AnswersWhatRunsOnceOnlyAndWhatIsReadWithTheReason) {
  config::RobotConfig config = test::testRobot();
  config.axes[0].homing = test::homingOfOrder(0);
  RobotWorld homing(config);
  homing.enable();
  homing.drives[0].homing_is_slow = true;
  homing.drives[0].deaf_to_controlword = true;
  homing.drives[1].sdo_silent = true;
  const auto home = homing.begin(ProcedureKind::home, "shoulder");
  homing.run(50ms);
  std::vector<RobotWorld::Answers<HistoryAnswer>> histories;
  for (int i = 0; i < 30; ++i) histories.push_back(homing.begin(ErrorHistoryCommand{"elbow"}));
  homing.network.beginShutdown(homing.now);
  ASSERT_TRUE(homing.runUntil([&] { return homing.network.shutDown(); }, 2s));
  ASSERT_EQ(home->size(), 1u);
  EXPECT_EQ(home->front().message, "home: ended by the shutdown of the driver");
  for (const auto& history : histories) {
    ASSERT_EQ(history->size(), 1u);
    EXPECT_FALSE(history->front().success);
  }
  EXPECT_THAT(histories.back()->front().message,
              AllOf(HasSubstr("elbow (node 2): error history (1003h)"),
                    HasSubstr("ended by the shutdown of the driver")));
}

TEST_F(NetworkShutdown, AnswersAnNmtCommandOnceThoughItIsDoneMeanwhile) {
  world.boot();
  ASSERT_TRUE(world.call(ProcedureKind::enable, "shoulder").success);
  world.drives[0].deaf_to_controlword = true;  // the shutdown waits for it
  const auto answers = world.begin(NmtServiceCommand{"elbow", "pre_operational"});
  ASSERT_TRUE(shutDownIn(2s));
  EXPECT_GT(took, 1s);
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_THAT(answers->front().message, HasSubstr("ended by the shutdown of the driver"));
}

TEST_F(NetworkShutdown, IsFollowedByNoSync) {
  world.boot();
  ASSERT_TRUE(shutDownIn(2s));
  world.sent.clear();
  world.network.produceSync(world.now + 1s);
  EXPECT_TRUE(world.sent.empty());
}

}  // namespace
}  // namespace cia402::bus
