// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/nmt_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus::test {
namespace {

using namespace std::chrono_literals;
using fieldbus::Health;
using testing::HasSubstr;

NmtServiceCommand nmt(const std::string& axis, const std::string& word) {
  NmtServiceCommand command;
  command.axis = axis;
  command.command = word;
  return command;
}

class NmtJobTest : public testing::Test {
 protected:
  /// Frames with COB-ID 0 since forget().
  std::vector<can::Frame> commands() const {
    std::vector<can::Frame> all;
    for (const auto& sent : world.sentWithId(0x000)) all.push_back(sent.frame);
    return all;
  }
  void forget() { world.sent.clear(); }
  RobotWorld world;
};

TEST_F(NmtJobTest, StopTakesOneNodeOutUntilItIsStartedAgain) {
  world.boot();
  forget();
  const auto answers = world.begin(nmt("shoulder", "stop"));
  EXPECT_EQ(commands(), std::vector<can::Frame>{can::Frame(0x000, {0x02, 1})});
  world.run(20ms);
  EXPECT_TRUE(answers->empty()) << "the drive's heartbeat must say so";
  world.network.receive(can::Frame(0x701, {0x04}), world.now, world.now);
  const Answer stopped = world.wait(answers);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_THAT(stopped.message, HasSubstr("shoulder (node 1): nmt stop: the drive is stopped"));
  EXPECT_EQ(world.node(0).health(), Health::failed);
  EXPECT_EQ(world.node(1).health(), Health::ready);
  const Answer started = world.call(nmt("shoulder", "start"));
  EXPECT_TRUE(started.success) << started.message;
  EXPECT_THAT(started.message, HasSubstr("nmt start: the drive is configured and operational"));
  EXPECT_EQ(world.node(0).health(), Health::ready);
}

TEST_F(NmtJobTest, PreOperationalForAllIsOneFrameAndWaitsForAll) {
  world.boot();
  forget();
  const Answer answer = world.call(nmt("", "pre_operational"));
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(answer.message, "nmt pre_operational done on 2 of 2 nodes");
  EXPECT_EQ(commands(), std::vector<can::Frame>{can::Frame(0x000, {0x80, 0})});
}

TEST_F(NmtJobTest, AResetIsAnsweredOnceTheNodeIsConfiguredAgain) {
  world.boot();
  for (const auto& [word, specifier] :
       {std::pair<const char*, int>{"reset_node", 0x81}, {"reset_communication", 0x82}}) {
    forget();
    const Answer answer = world.call(nmt("elbow", word));
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_THAT(answer.message, HasSubstr("elbow (node 2)"));
    EXPECT_THAT(answer.message, HasSubstr("it is disabled"));
    ASSERT_FALSE(commands().empty());
    EXPECT_EQ(commands().front(), can::Frame(0x000, {static_cast<std::uint8_t>(specifier), 2}));
    EXPECT_EQ(world.node(1).health(), Health::ready);
  }
}

// Elmo's pull the CAN lines down for a while when they are reset (ros-industrial/ros_canopen#334).
TEST(NmtJob, ResetsNoNodeWhoseProfileForbidsIt) {
  config::RobotConfig config = testRobot();
  auto profile = std::make_shared<canopen::DeviceProfile>(*config.devices[1].profile);
  profile->nmt_reset_node = false;
  config.devices[1].profile = profile;
  RobotWorld world(config);
  world.boot();
  world.sent.clear();
  for (const char* axis : {"elbow", ""}) {
    const Answer answer = world.call(nmt(axis, "reset_node"));
    EXPECT_FALSE(answer.success);
    EXPECT_THAT(answer.message, HasSubstr("elbow (node 2): nmt reset_node is refused: by its "
                                          "profile (nmt_reset_node)"));
    EXPECT_THAT(answer.message, HasSubstr("use reset_communication"));
  }
  EXPECT_TRUE(world.sentWithId(0x000).empty());
  const Answer communication = world.call(nmt("elbow", "reset_communication"));
  EXPECT_TRUE(communication.success) << communication.message;
  const Answer other = world.call(nmt("shoulder", "reset_node"));
  EXPECT_TRUE(other.success) << other.message;
}

TEST_F(NmtJobTest, NothingIsSentWhileAnAxisIsEnabled) {
  world.enable();
  forget();
  for (const char* word : {"stop", "pre_operational", "reset_node", "reset_communication"}) {
    for (const char* axis : {"elbow", ""}) {
      const Answer answer = world.call(nmt(axis, word));
      EXPECT_FALSE(answer.success);
      EXPECT_THAT(answer.message, HasSubstr("is not disabled (operation enabled)"));
      EXPECT_THAT(answer.message, HasSubstr("quick_stop or disable it first"));
    }
  }
  EXPECT_TRUE(commands().empty());
  EXPECT_TRUE(world.drives[0].enabled());
  EXPECT_TRUE(world.drives[1].enabled());
}

TEST_F(NmtJobTest, OneEnabledAxisForbidsTheCommandToAll) {
  world.boot();
  ASSERT_TRUE(world.call(drive::ProcedureKind::enable, "elbow").success);
  forget();
  EXPECT_THAT(world.call(nmt("", "reset_node")).message, HasSubstr("elbow (node 2)"));
  EXPECT_TRUE(commands().empty());
  EXPECT_TRUE(world.call(nmt("shoulder", "reset_node")).success);
  EXPECT_TRUE(world.drives[1].enabled());
}

TEST_F(NmtJobTest, StartOfAnEnabledAxisChangesNothing) {
  world.enable();
  forget();
  EXPECT_TRUE(world.call(nmt("", "start")).success);
  EXPECT_TRUE(commands().empty());
  EXPECT_TRUE(world.drives[0].enabled());
}

TEST_F(NmtJobTest, StartIsAnsweredByWhatTheDriveTellsAfterIt) {
  world.boot();
  world.drives[0].operational = false;  // as after a bus-off; its last heartbeat said operational
  const Answer answer = world.call(nmt("shoulder", "start"));
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(world.drives[0].operational);
  EXPECT_EQ(world.node(0).health(), Health::ready);
}

TEST_F(NmtJobTest, ANodeThatIsStartedAgainWhileTheOthersAreWaitedForIsTold) {
  world.boot();
  world.drives[1].silent = true;  // its heartbeat is waited for
  const auto answers = world.begin(nmt("", "pre_operational"));
  world.run(600ms);
  ASSERT_TRUE(answers->empty());
  EXPECT_TRUE(world.call(nmt("shoulder", "start")).success);
  const Answer answer = world.wait(answers);
  EXPECT_TRUE(world.drives[0].operational);
  EXPECT_THAT(answer.message, HasSubstr("nmt pre_operational done on 0 of 2 nodes"));
  EXPECT_THAT(answer.message, HasSubstr("shoulder (node 1): nmt pre_operational: the drive did so, "
                                        "but by now it is configured and started again"));
}

TEST_F(NmtJobTest, ADriveWithoutHeartbeatIsNotWaitedFor) {
  world.drives[0].aborts[{0x1017, 0}] = 0x06020000;
  world.boot();
  const Time before = world.now;
  EXPECT_TRUE(world.call(nmt("shoulder", "start")).success);
  const Answer answer = world.call(nmt("shoulder", "stop"));
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("has no heartbeat to tell whether it obeyed"));
  EXPECT_LT(world.now - before, 100ms);
}

TEST_F(NmtJobTest, ARunningProcedureIsNotCutOff) {
  world.boot();
  world.drives[0].deaf_to_controlword = true;
  const auto enabling = world.begin(drive::ProcedureKind::enable, "shoulder");
  world.run(20ms);
  EXPECT_THAT(world.call(nmt("shoulder", "stop")).message, HasSubstr("enable runs ("));
  EXPECT_TRUE(enabling->empty());
}

TEST_F(NmtJobTest, ARecoverThatWaitsForItsNodeIsNotCutOff) {
  world.boot();
  world.drives[0].silent = true;
  world.run(1s);
  ASSERT_NE(world.axis(0).state().health, fieldbus::Health::ready);
  const auto recovering = world.begin(drive::ProcedureKind::recover, "shoulder");
  world.run(20ms);
  ASSERT_TRUE(recovering->empty());
  EXPECT_THAT(world.call(nmt("shoulder", "reset_node")).message, HasSubstr("recover runs ("));
}

TEST_F(NmtJobTest, ADriveThatDoesNotObeyIsTold) {
  world.boot();
  world.drives[0].silent = true;
  const Answer answer = world.call(nmt("shoulder", "stop"));
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("sent, but the drive's heartbeat says"));
}

TEST_F(NmtJobTest, ADriveThatDoesNotComeBackFromAResetIsTold) {
  world.boot();
  world.drives[0].silent = true;
  const Answer answer = world.call(nmt("shoulder", "reset_node"));
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("nmt reset_node: sent, but the node is not operational"));
  EXPECT_THAT(answer.message, HasSubstr("does not answer"));
}

TEST_F(NmtJobTest, UnknownWordsAndAxesAreRefused) {
  world.boot();
  forget();
  EXPECT_EQ(world.call(nmt("elbow", "halt")).message,
            "nmt: unknown command \"halt\"; there are start, stop, pre_operational, reset_node, "
            "reset_communication");
  EXPECT_EQ(world.call(nmt("knee", "stop")).message, "there is no axis \"knee\"");
  EXPECT_TRUE(commands().empty());
}

TEST_F(NmtJobTest, AShutdownAnswersWhatWaits) {
  world.boot();
  world.drives[0].silent = true;
  const auto answers = world.begin(nmt("shoulder", "reset_node"));
  world.network.beginShutdown(world.now);
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_THAT(answers->front().message, HasSubstr("shutdown"));
}

TEST_F(NmtJobTest, WhatWasAskedForIsTold) {
  world.boot();
  EXPECT_TRUE(world.call(nmt("elbow", "pre_operational")).success);
  EXPECT_TRUE(world.call(nmt("", "start")).success);
  EXPECT_EQ(world.eventsWith("nmt pre_operational to elbow was asked for"), 1u);
  EXPECT_EQ(world.eventsWith("nmt start to all nodes was asked for"), 1u) << world.allEvents();
}

// A second after the command; the cycle before is the one at 0.999 s.
TEST_F(NmtJobTest, OfADriveThatDoesNotObeyTheLastHeartbeatIsTold) {
  world.boot();
  world.run(200ms);
  ASSERT_EQ(world.node(0).nmtState(), canopen::NmtState::operational);
  ASSERT_TRUE(world.runUntil([&] { return world.network.cycle().lastCycle() == world.now; }));
  world.run(1ms);
  world.drives[0].silent = true;
  const auto answers = world.begin(nmt("shoulder", "stop"));
  world.run(1001ms);
  ASSERT_TRUE(answers->empty());
  world.network.receive(can::Frame(0x701, {0x7F}), world.now, world.now);
  world.run(4ms);
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_THAT(answers->front().message,
              HasSubstr("sent, but the drive's heartbeat says pre-operational"));
}

}  // namespace
}  // namespace cia402::bus::test
