// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Layer setting services of a robot: node-IDs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/lss_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using fieldbus::Health;
using test::byIdentity;
using test::kIdentities;
using test::kShoulder;
using test::LssWorld;
using test::ready;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

TEST(NetworkLss, GivesNodeIdsOneAfterTheOtherAndBootsTheDrivesThen) {
  LssWorld world(2);
  world.network.start(world.now);
  world.run(1ms);
  EXPECT_THAT(world.shown().axes[0].words.step.str(), HasSubstr("LSS: switching all devices"));
  EXPECT_EQ(world.shown().axes[1].words.step.str(), "LSS: waiting for its turn");
  EXPECT_THAT(world.begin(ProcedureKind::enable)->front().message,
              HasSubstr("refused: the drives are being given their node-IDs (LSS: switching all"));
  ASSERT_TRUE(world.runUntil([&] { return world.slaves[0].node_id == 1; }));
  world.run(25ms);
  EXPECT_THAT(world.shown().axes[1].words.step.str(), HasSubstr("LSS: switching all devices"));
  EXPECT_TRUE(world.sentWithId(0x000).empty()) << "all are reset afterwards";
  ASSERT_TRUE(ready(world)) << world.allEvents();
  EXPECT_EQ(world.slaves[1].node_id, 2);
  EXPECT_EQ(world.eventsWith("shoulder (node 1): LSS: the device got node-ID 1 (it had none)"), 1u);
  EXPECT_EQ(world.eventsWith("elbow (node 2): LSS: the device got node-ID 2 (it had none)"), 1u);
  EXPECT_EQ(world.sentWithId(0x000).front().frame, can::Frame(0x000, {0x82, 0x00}));
  EXPECT_EQ(world.shown().axes[0].words.problem.str(), "");
}

TEST(NetworkLss, ADriveThatIsNotThereIsToldOnceAndLookedForEveryFiveSeconds) {
  LssWorld world(1);
  world.takeAway(0);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == Health::ready; }));
  const std::string problem =
      std::string("shoulder (node 1): LSS: while selecting the device with ") + kShoulder +
      ": nobody answered";
  EXPECT_EQ(world.eventsWith(problem), 1u) << world.allEvents();
  EXPECT_EQ(world.asked(0x43, 11), 5u) << "times, at the start";
  ASSERT_TRUE(world.runUntil([&] { return fieldbus::isAway(world.health(0)); }));
  ASSERT_TRUE(world.runUntil([&] { return world.asked(0x43, 11) > 5; }));
  world.run(1s);
  world.sent.clear();
  const std::size_t told = world.events.size();
  world.run(20s);
  EXPECT_EQ(world.asked(0x43, 11), 8u) << "twice at each look";
  EXPECT_EQ(world.events.size(), told) << world.allEvents();
  EXPECT_THAT(world.shown().axes[0].words.problem.str(), HasSubstr("LSS: while selecting"));

  const Answer recovered = world.call(ProcedureKind::recover, "shoulder");
  EXPECT_FALSE(recovered.success);
  EXPECT_EQ(world.eventsWith(problem), 1u) << "the same as before";

  world.bringBack(0);
  world.sent.clear();
  ASSERT_TRUE(ready(world)) << world.allEvents();
  EXPECT_EQ(world.eventsWith("shoulder (node 1): LSS: the device got node-ID 1"), 1u);
  EXPECT_EQ(world.asked(0x43, 11), 1u);
  world.run(1s);
  EXPECT_EQ(world.shown().axes[0].words.problem.str(), "");
}

TEST(NetworkLss, ANodeIdIsStoredWhereTheConfigurationSaysSo) {
  config::RobotConfig config = byIdentity(2);
  config.devices[1].lss->store = true;
  LssWorld world(2, config);
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  EXPECT_EQ(world.slaves[0].stored, 0xFF);
  EXPECT_EQ(world.slaves[1].stored, 2);
}

TEST(NetworkLss, AnAxisThatIsNotLookedForShowsWhatItDoesItself) {
  LssWorld world(1);
  world.takeAway(0);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == Health::ready; }));
  ASSERT_TRUE(world.runUntil([&] { return fieldbus::isAway(world.health(0)); }));
  world.drives[1].deaf_to_controlword = true;
  bool enabling = false;
  ASSERT_TRUE(world.runUntil([&] {
    if (!world.axis(1).procedure().running) (void)world.begin(ProcedureKind::enable, "elbow");
    const NetworkSnapshot shot = world.shown();
    const bool looks = shot.axes[0].words.step.str().rfind("LSS: ", 0) == 0;
    enabling |= !shot.axes[1].words.step.empty();
    EXPECT_NE(shot.axes[1].words.step.str().rfind("LSS: ", 0), 0u);
    return looks && enabling;
  }));
  world.run(200ms);
  EXPECT_NE(world.shown().axes[1].words.step.str().rfind("LSS: ", 0), 0u);
}

TEST(NetworkLss, RecoverAloneBeginsWithTheNodeId) {
  LssWorld world(1);
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.takeAway(0);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == Health::lost; }));
  ASSERT_TRUE(world.runUntil([&] { return world.asked(0x43) == 3; })) << "a look";
  world.bringBack(0);
  world.run(1s);
  world.sent.clear();
  EXPECT_FALSE(world.call(ProcedureKind::disable, "shoulder").success);
  EXPECT_FALSE(world.call(ProcedureKind::enable, "shoulder").success);
  EXPECT_EQ(world.asked(0x43), 0u);
  EXPECT_TRUE(world.call(ProcedureKind::recover, "elbow").success);
  EXPECT_EQ(world.asked(0x43), 0u) << "it is there";
  const Time called = world.now;
  const auto recovering = world.begin(ProcedureKind::recover, "shoulder");
  LssBitTimingCommand timing;
  timing.kbit_per_s = 500;
  timing.activate = true;
  EXPECT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  EXPECT_THAT(world.call(timing).message, HasSubstr("refused: recover waits for its turn"));
  const Answer recovered = world.wait(recovering);
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_EQ(world.asked(0x43), 1u);
  EXPECT_LT(world.now - called, 2s) << "not by the next look";
  EXPECT_TRUE(world.drives[0].enabled());
}

TEST(NetworkLss, AScanTellsWhoseDeviceItIsAndWaitsForTheWindow) {
  LssWorld world(1);
  world.takeAway(0);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == Health::ready; }));
  ASSERT_TRUE(world.runUntil([&] { return fieldbus::isAway(world.health(0)); }));
  ASSERT_TRUE(world.runUntil([&] { return world.asked(0x43, 11) > 5; }));
  world.run(1s);
  world.bringBack(0);
  world.sent.clear();
  LssScanCommand command;
  command.window = 10ms;
  const LssScanAnswer scan = world.call(command);
  EXPECT_TRUE(scan.success) << scan.message;
  EXPECT_EQ(scan.devices, std::vector<canopen::lss::Identity>{kIdentities[0]});
  EXPECT_EQ(scan.device_axes, std::vector<std::string>{"shoulder"});
  EXPECT_THAT(scan.message, HasSubstr(std::string("1 device without a node-ID")));
  EXPECT_THAT(scan.message, HasSubstr(std::string(kShoulder) + " is that of shoulder"));
  const auto requests = world.sentWithId(0x7E5);
  const auto first = std::find_if(requests.begin(), requests.end(),
                                  [](const auto& sent) { return sent.frame.data[0] == 0x51; });
  ASSERT_NE(first, requests.end());
  EXPECT_EQ((first + 1)->time - first->time, 10ms);

  world.bringBack(0);
  world.slaves[0].identity[3] = 33;
  const LssScanAnswer other = world.call(command);
  EXPECT_TRUE(other.success) << other.message;
  EXPECT_EQ(other.device_axes, std::vector<std::string>{""});
  EXPECT_THAT(other.message, Not(HasSubstr("is that of")));
  world.bringBack(0);
  world.slaves[0].deaf_part = 3;
  EXPECT_FALSE(world.call(command).success) << "there is one that it cannot name";
}

TEST(NetworkLss, NothingIsScannedOrAssignedWhileAnAxisMayMove) {
  LssWorld world(0);
  world.enable();
  LssAssignCommand assign;
  assign.node_id = 9;
  for (const Answer& refused : {Answer(world.call(LssScanCommand{})), world.call(assign)}) {
    EXPECT_FALSE(refused.success);
    EXPECT_EQ(refused.message, "refused: shoulder (node 1) may be in motion; stop it first");
  }
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  EXPECT_EQ(world.call(LssScanCommand{}).message, "refused: the group arm is in motion");
  world.run(500ms);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  EXPECT_EQ(world.call(LssScanCommand{}).message, "refused: the group arm is in motion");
  world.run(1s);
  ASSERT_TRUE(world.call(ProcedureKind::disable).success);
  EXPECT_TRUE(world.call(LssScanCommand{}).success);
  world.drives[1].tpdo_bytes = 0;  // nobody knows any more
  world.run(500ms);
  EXPECT_EQ(world.call(LssScanCommand{}).message,
            "refused: elbow (node 2) may be in motion; stop it first");
  world.takeAway(1);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == Health::lost; }));
  EXPECT_TRUE(world.call(LssScanCommand{}).success) << "it is not there";
}

TEST(NetworkLss, AssignsNodeIdsThatNobodyHas) {
  LssWorld world(0);
  world.boot();
  LssAssignCommand assign;
  assign.identity = {0xABC, 7, 0x10002, 33};
  const std::pair<int, const char*> refused[] = {
      {-1, "node-ID -1 is not in 1..127"},   {0, "node-ID 0 is not in 1..127"},
      {128, "node-ID 128 is not in 1..127"}, {257, "node-ID 257 is not in 1..127"},
      {127, "is the master's own"},          {1, "is that of a drive in operation"},
      {2, "is that of a drive in operation"}};
  world.sent.clear();
  for (const auto& [id, why] : refused) {
    assign.node_id = id;
    const Answer answer = world.call(assign);
    EXPECT_FALSE(answer.success) << id;
    EXPECT_THAT(answer.message, AllOf(HasSubstr("refused: node-ID "), HasSubstr(why)));
  }
  EXPECT_TRUE(world.sentWithId(0x7E5).empty());
  world.takeAway(1);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == Health::lost; }));
  world.slaves[1].identity[3] = 33;  // another device in its place
  world.bringBack(1);
  for (const int id : {3, 126}) {
    assign.node_id = id;
    assign.store = id == 126;
    const Answer answer = world.call(assign);
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_THAT(answer.message,
                HasSubstr("serial 33 (0x00000021): the device got node-ID " + std::to_string(id)));
    EXPECT_EQ(world.slaves[1].pending, id);
    EXPECT_EQ(world.slaves[1].stored, id == 126 ? 126 : 0xFF);
  }
  assign.identity.serial = 44;
  const Answer absent = world.call(assign);
  EXPECT_FALSE(absent.success);
  EXPECT_THAT(absent.message, AllOf(HasSubstr("serial 44"), HasSubstr("nobody answered")));
}

TEST(NetworkLss, TheNodeIdOfADriveThatWasNeverHeardIsFree) {
  LssWorld world(0);
  world.takeAway(1);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == Health::ready; }));
  ASSERT_EQ(world.health(1), Health::booting);
  world.slaves[1].identity[3] = 33;
  world.bringBack(1);
  LssAssignCommand assign;
  assign.identity = {0xABC, 7, 0x10002, 33};
  assign.node_id = 2;
  const Answer assigned = world.call(assign);
  EXPECT_TRUE(assigned.success) << assigned.message;
  EXPECT_TRUE(ready(world)) << world.allEvents();
}

TEST(NetworkLss, ARecoveredDriveThatIsThereKeepsItsNodeIdUnasked) {
  LssWorld world(1);
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.run(100ms);
  world.sent.clear();
  EXPECT_TRUE(world.call(ProcedureKind::recover, "shoulder").success);
  EXPECT_TRUE(world.sentWithId(0x7E5).empty());
}

TEST(NetworkLss, AScanThatDidNotTakePlaceIsNoSuccess) {
  LssWorld world(0);
  world.boot();
  world.run(100ms);
  const auto first = world.begin(LssScanCommand{});
  const auto second = world.begin(LssScanCommand{});
  world.network.beginShutdown(world.now);
  ASSERT_EQ(second->size(), 1u);
  EXPECT_FALSE(second->front().success);
  EXPECT_EQ(second->front().message, "ended by the shutdown of the driver");
}

// A drive that turns has its node-ID already, whoever is asked for before.
TEST(NetworkLss, AShutdownMeanwhileStopsWhatTurns) {
  LssWorld world(1);
  world.takeAway(0);
  world.drives[1].statusword = 0x0237;  // operation enabled
  world.network.start(world.now);
  world.run(10ms);
  ASSERT_FALSE(world.sentWithId(0x7E5).empty());
  ASSERT_TRUE(world.sentWithId(0x602).empty());
  world.network.beginShutdown(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.network.shutDown(); }, 2s));
  EXPECT_EQ(world.drives[1].statusword & 0x6Fu, 0x40u) << "switch on disabled";
  EXPECT_EQ(world.sent.back().frame, can::Frame(0x000, {0x80, 0x00}));
  world.sent.clear();
  world.run(1s);
  EXPECT_TRUE(world.sent.empty());
}

TEST(NetworkLss, TheDriveOfAnotherAxisDoesNotLoseItsNodeId) {
  LssWorld world(0);
  world.boot();
  world.run(100ms);
  LssAssignCommand assign;
  assign.identity = kIdentities[0];  // shoulder, in operation as node 1
  assign.node_id = 9;
  const Answer refused = world.call(assign);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              HasSubstr("the device has node-ID 1, which is that of a drive in operation"));
  EXPECT_EQ(world.slaves[0].pending, 1);
}

TEST(NetworkLss, ALostDriveThatComesBackAsAnotherOneIsLeftAlone) {
  LssWorld world(1);
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.takeAway(0);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == Health::lost; }));
  world.bringBack(0);
  world.slaves[0].node_id = world.slaves[0].pending = 2;  // that of elbow
  world.sent.clear();
  ASSERT_TRUE(world.runUntil([&] {
    return world.eventsWith("the device has node-ID 2, which is that of a drive in operation") > 0;
  })) << world.allEvents();
  EXPECT_EQ(world.slaves[0].pending, 2);
  for (const auto& nmt : world.sentWithId(0x000)) EXPECT_NE(nmt.frame.data[1], 2);
  EXPECT_EQ(world.health(1), Health::ready);
}

TEST(NetworkLss, TheNodeIdOfADriveThatWasStoppedAndFellSilentIsFree) {
  LssWorld world(0);
  world.boot();
  world.run(100ms);
  ASSERT_TRUE(world.call(NmtServiceCommand{"elbow", "pre_operational"}).success);
  LssAssignCommand assign;
  assign.identity = {0xABC, 7, 0x10002, 33};
  assign.node_id = 2;
  EXPECT_THAT(world.call(assign).message, HasSubstr("is that of a drive in operation"));
  world.takeAway(1);
  world.run(2s);
  ASSERT_EQ(world.health(1), Health::failed);
  world.slaves[1].identity[3] = 33;
  world.bringBack(1);
  const Answer assigned = world.call(assign);
  EXPECT_TRUE(assigned.success) << assigned.message;
}

TEST(NetworkLss, ADriveThatWasFoundIsAskedHalfASecondLaterAndHasNoProblemAnyMore) {
  LssWorld world(1);
  world.takeAway(0);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return fieldbus::isAway(world.health(0)); }));
  world.run(60s);
  world.sent.clear();
  world.run(20s);
  EXPECT_LE(world.sentWithId(0x601).size(), 2u) << "no more often than every 30 s by SDO";
  world.bringBack(0);
  ASSERT_TRUE(world.runUntil([&] { return world.slaves[0].node_id == 1; }));
  world.run(50ms);
  world.sent.clear();
  world.run(400ms);
  EXPECT_TRUE(world.sentWithId(0x601).empty()) << "its boot-up message is awaited";
  EXPECT_THAT(world.shown().axes[0].words.problem.str(), Not(HasSubstr("LSS: ")));
  world.run(150ms);
  EXPECT_FALSE(world.sentWithId(0x601).empty());
}

}  // namespace
}  // namespace cia402::bus
