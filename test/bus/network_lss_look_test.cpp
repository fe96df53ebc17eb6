// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What becomes of a drive that is looked for by its identity, and of scans and recoveries that
// others end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/lss_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using fieldbus::Health;
using test::byIdentity;
using test::LssWorld;
using test::ready;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

/// The shoulder has been in operation and is gone.
void lose(LssWorld& world) {
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.takeAway(0);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == Health::lost; }));
}

TEST(NetworkLssLook, ADriveThatGotItsNodeIdIsAskedOnceItHadTheTimeForItsBootUpMessage) {
  LssWorld world(1);
  lose(world);
  const auto hear = world.bystanders;
  world.bystanders = [&](const can::Frame& frame) {
    const auto answer = hear(frame);
    world.drives[0].silent = true;  // but for LSS
    return answer;
  };
  world.bringBack(0);
  const char* const got = "shoulder (node 1): LSS: the device got node-ID 1";
  ASSERT_TRUE(world.runUntil([&] { return world.eventsWith(got) == 2; })) << world.allEvents();
  const Time assigned = world.now;
  world.sent.clear();
  ASSERT_TRUE(world.runUntil([&] { return !world.sentWithId(0x601).empty(); }));
  EXPECT_EQ(world.now - assigned, 500ms);
}

TEST(NetworkLssLook, ThatFindsNobodyAsksNobodyBySdo) {
  const auto requests = [](const config::RobotConfig& config, std::size_t unconfigured) {
    LssWorld world(unconfigured, config);
    lose(world);
    world.sent.clear();
    world.run(20s);
    EXPECT_EQ(world.sentWithId(0x7E5).empty(), unconfigured == 0);
    return world.sentWithId(0x601).size();
  };
  EXPECT_EQ(requests(byIdentity(1), 1), requests(test::testRobot(), 0));
}

TEST(NetworkLssLook, AProblemOfTheNodeIdIsOverOnceTheDriveHasIt) {
  LssWorld world(1);
  world.takeAway(0);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == Health::ready; }));
  ASSERT_TRUE(world.runUntil([&] { return fieldbus::isAway(world.health(0)); }));
  ASSERT_THAT(world.shown().axes[0].words.problem.str(), HasSubstr("LSS: "));
  world.drives[0].sdo_silent = true;  // it does not boot with it
  world.bringBack(0);
  ASSERT_TRUE(world.runUntil([&] { return world.slaves[0].node_id == 1; }));
  world.run(1s);
  ASSERT_NE(world.health(0), Health::ready);
  EXPECT_THAT(world.shown().axes[0].words.problem.str(), Not(HasSubstr("LSS: ")));
}

TEST(NetworkLssLook, AScanIsRefusedAtOnceWhereAnAxisMayMoveThoughAnotherIsAtWork) {
  LssWorld world(0);
  world.boot();
  world.run(100ms);
  LssAssignCommand assign;
  assign.identity = {0xABC, 7, 0x10002, 33};
  assign.node_id = 9;
  const auto first = world.begin(LssScanCommand{}), queued = world.begin(LssScanCommand{});
  drive::ProcedureRequest enabling;
  enabling.kind = ProcedureKind::enable;
  ASSERT_TRUE(world.axis(1).start(enabling, world.now));
  ASSERT_TRUE(world.runUntil([&] { return world.drives[1].enabled(); }));
  world.run(20ms);
  ASSERT_TRUE(first->empty());
  const auto scan = world.begin(LssScanCommand{});
  const auto assigned = world.begin(assign);
  ASSERT_EQ(scan->size(), 1u);
  ASSERT_EQ(assigned->size(), 1u);
  for (const Answer& refused : {Answer(scan->front()), assigned->front()}) {
    EXPECT_EQ(refused.message, "refused: elbow (node 2) may be in motion; stop it first");
  }
  ASSERT_TRUE(first->empty());
  const Answer late = world.wait(queued);
  EXPECT_FALSE(late.success);
  EXPECT_EQ(late.message, "refused: elbow (node 2) may be in motion; stop it first");
}

TEST(NetworkLssLook, ARecoverThatWaitsForTheNodeIdEnablesNothingOnceTheAxisWasToStop) {
  LssWorld world(1);
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.takeAway(0);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == Health::lost; }));
  world.bringBack(0);
  const auto recovering = world.begin(ProcedureKind::recover, "shoulder");
  EXPECT_FALSE(world.call(ProcedureKind::disable, "shoulder").success) << "it is not there";
  const Answer recovered = world.wait(recovering);
  EXPECT_FALSE(recovered.success);
  EXPECT_EQ(recovered.message, "shoulder: not started, for disable was called");
  ASSERT_TRUE(ready(world));
  world.run(1s);
  EXPECT_FALSE(world.drives[0].enabled());
}

TEST(NetworkLssLook, AShutdownEndsAScanAndItsAnswerSaysSo) {
  LssWorld world(0);
  world.boot();
  world.run(100ms);
  const auto scan = world.begin(LssScanCommand{});
  world.run(1ms);
  ASSERT_TRUE(scan->empty());
  world.network.beginShutdown(world.now);
  ASSERT_EQ(scan->size(), 1u);
  EXPECT_FALSE(scan->front().success);
  EXPECT_EQ(scan->front().message, "ended by the shutdown of the driver");
  EXPECT_EQ(world.sentWithId(0x7E5).back().frame, can::Frame(0x7E5, {0x04, 0, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace cia402::bus
