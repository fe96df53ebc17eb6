// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives without node-IDs on whole robots.
#include "system/disturbance.h"
#include "system/left_turning.h"
#include "system/lss_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

TEST(Lss, TwoUnconfiguredDrivesAreAssignedByIdentityBootedAndMoved) {
  // The serial numbers are crossed: the simulated drive beside `left` is that of `right`.
  Scene scene(
      loadText(genericPair(lssOf(222) + unconfigured(111), lssOf(111) + unconfigured(222))));
  ASSERT_TRUE(boots(scene)) << scene.told();
  EXPECT_EQ(scene.drive("left").device().node(), 2);
  EXPECT_EQ(scene.drive("right").device().node(), 1);
  EXPECT_THAT(scene.told(),
              HasSubstr("left (node 1): LSS: the device got node-ID 1 (it had none)"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({0.5, -0.3}, 1s).success);
  scene.run(3s);
  EXPECT_NEAR(scene.position("right"), 0.5, 1e-3) << "moved as `left`";
  EXPECT_NEAR(scene.position("left"), -0.3, 1e-3);
}

TEST(Lss, ADriveThatIsNotThereIsToldAndTheOtherWorks) {
  Scene scene(
      loadText(genericPair(lssOf(111) + unconfigured(999), lssOf(222) + unconfigured(222))));
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health == Health::ready; }, 10s));
  scene.run(10s);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): LSS: while selecting the device with vendor "
                                      "0x000004D2, product 0x00000402, revision 0x00010000, serial "
                                      "111"));
  EXPECT_EQ(scene.drive("left").device().node(), 255) << "never a wrong one";
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
}

TEST(Lss, StepsAndProblemsAreShown) {
  Scene scene(
      loadText(genericPair(lssOf(111) + unconfigured(999), lssOf(222) + unconfigured(222))));
  scene.robot().start();
  scene.run(180ms);
  bus::NetworkSnapshot snapshot;
  scene.robot().network().fill(snapshot);
  EXPECT_THAT(snapshot.axes[0].words.step.str(),
              HasSubstr("LSS: selecting the device with vendor"));
  EXPECT_EQ(snapshot.axes[1].words.step.str(), "LSS: waiting for its turn");
  EXPECT_THAT(scene.procedure(ProcedureKind::enable).message, HasSubstr("given their node-IDs"));
  scene.run(8s);
  scene.robot().network().fill(snapshot);
  EXPECT_THAT(snapshot.axes[0].words.problem.str(), HasSubstr("left (node 1): LSS: "));
  EXPECT_TRUE(snapshot.axes[1].words.problem.empty());
}

TEST(Lss, ADriveThatForgotItsNodeIdGetsItAgainWhileTheOtherMoves) {
  Scene scene(
      loadText(genericPair(lssOf(111) + unconfigured(111)) + "  alone: {joints: [right]}\n"));
  ASSERT_TRUE(boots(scene)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({2.0}, 12s, 1).success);
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 12s)) << scene.told();
  EXPECT_EQ(scene.drive("left").device().node(), 1);
  EXPECT_FALSE(scene.truth("left").power_stage_on) << "left disabled";
  scene.run(14s);
  EXPECT_NEAR(scene.position("right"), 2.0, 1e-3) << "the other did not notice";
}

TEST(Lss, ADriveThatHasItsNodeIdIsNeverReportedAsOneWithout) {
  Scene scene(loadText(genericPair(unconfigured(111), ", simulation: {serial: 222}")));
  scene.drive("right").device().behaviour().lss_scanned_with_node_id = true;
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health == Health::ready; }, 10s));
  const auto scan = call(scene, bus::LssScanCommand{});
  EXPECT_TRUE(scan.success) << scan.message;
  EXPECT_THAT(scan.devices, UnorderedElementsAre(device(111)));
  EXPECT_THAT(scan.message, HasSubstr("1 device without a node-ID"));
  EXPECT_THAT(scan.message, HasSubstr("serial 222 (0x000000DE) has node-ID 2"));
  EXPECT_EQ(scene.state("right").health, Health::ready);
}

TEST(Lss, ADriveThatGoesOnAnsweringAfterItWasFoundHoldsTheScanUpForNoLongerThanFiveSeconds) {
  Scene scene(loadText(genericPair(unconfigured(111))));
  scene.drive("left").device().behaviour().lss_never_found = true;
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health == Health::ready; }, 10s));
  const Time start = scene.now();
  const auto scan = call(scene, bus::LssScanCommand{});
  EXPECT_LE(scene.now() - start, 5s);
  EXPECT_THAT(scan.devices, UnorderedElementsAre(device(111)));
  EXPECT_THAT(scan.message, HasSubstr("goes on answering after it was found"));
}

TEST(Lss, RecoverBeginsWithTheNodeId) {
  Scene scene(loadText(genericPair(lssOf(111) + unconfigured(111))));
  ASSERT_TRUE(boots(scene)) << scene.told();
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 2s));
  scene.run(400ms);
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_TRUE(scene.truth("left").power_stage_on);
}

TEST(Lss, RecoverGivesItBackToADriveThatWasTakenOutOfOperationAndThenSwitchedOff) {
  Scene scene(
      loadText(genericPair(lssOf(111) + unconfigured(111), lssOf(222) + unconfigured(222))));
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s)) << scene.told();
  const auto stopped = call(scene, bus::NmtServiceCommand{"left", "stop"});
  ASSERT_TRUE(stopped.success) << stopped.message;
  scene.run(2s);
  bus::LssAssignCommand assign;
  assign.identity = device(333);
  assign.node_id = 1;
  EXPECT_THAT(call(scene, assign).message, HasSubstr("node-ID 1 is that of a drive in operation"));
  scene.inject("left", "power_cycle");
  scene.run(2s);
  ASSERT_EQ(scene.state("left").health, Health::failed) << "nobody asked for it";
  ASSERT_EQ(scene.drive("left").device().node(), 255);
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_EQ(scene.drive("left").device().node(), 1);
}

TEST(Lss, AStoredNodeIdOutlivesThePower) {
  Scene scene(loadText(genericPair(lssOf(111, ", store: true") + unconfigured(111))));
  ASSERT_TRUE(boots(scene)) << scene.told();
  scene.inject("left", "power_cycle");
  scene.run(3s);
  EXPECT_EQ(scene.drive("left").device().node(), 1);
  EXPECT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 4s)) << scene.told();
}

TEST(Lss, ScanTellsWhoseDeviceItIs) {
  // The device beside `right` has no node-ID, and the identity that `left` is to have.
  std::string yaml =
      genericPair(", joint: hip, simulation: {serial: 111}" + lssOf(111), unconfigured(111));
  yaml.replace(yaml.find("joints: [left"), 13, "joints: [hip");
  Scene scene(loadText(yaml));
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::ready; }, 10s));
  scene.drive("left").device().behaviour().lss = false;  // so that one answers, not both
  const auto scan = call(scene, bus::LssScanCommand{});
  EXPECT_EQ(scan.device_axes, std::vector<std::string>{"left"});
  EXPECT_THAT(scan.message, HasSubstr("is that of hip (axis left, node 1)"));
}

TEST(Lss, ScanFindsDevicesAssignNamesOneAndNobodyInOperationIsTouched) {
  Scene scene(loadText(genericPair(unconfigured(111))));
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health == Health::ready; }, 10s));
  const auto scan = call(scene, bus::LssScanCommand{});
  ASSERT_TRUE(scan.success) << scan.message;
  EXPECT_THAT(scan.devices, UnorderedElementsAre(device(111)));
  EXPECT_THAT(scan.message, HasSubstr("1 device without a node-ID"));
  EXPECT_THAT(scan.message, HasSubstr("serial 111"));
  EXPECT_EQ(scan.device_axes, std::vector<std::string>{""});
  EXPECT_EQ(scene.state("right").health, Health::ready);

  bus::LssAssignCommand assign;
  assign.identity = device(111);
  assign.node_id = 2;
  EXPECT_THAT(call(scene, assign).message, HasSubstr("node-ID 2 is that of a drive in operation"));
  assign.node_id = 127;
  EXPECT_THAT(call(scene, assign).message, HasSubstr("node-ID 127 is the master's own"));
  assign.node_id = 200;
  EXPECT_THAT(call(scene, assign).message, HasSubstr("node-ID 200 is not in 1..127"));
  assign.node_id = 1;
  const auto assigned = call(scene, assign);
  ASSERT_TRUE(assigned.success) << assigned.message;
  EXPECT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
}

TEST(Lss, NothingIsScannedOrAssignedInMotion) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  scene.run(500ms);
  EXPECT_THAT(call(scene, bus::LssScanCommand{}).message, HasSubstr("pair is in motion"));
  bus::LssAssignCommand assign;
  assign.node_id = 9;
  EXPECT_THAT(call(scene, assign).message, HasSubstr("is in motion"));
}

/// `left` is switched off at first, and a device without a node-ID keeps a scan busy for seconds.
class BehindAScan : public testing::Test {
 protected:
  BehindAScan()
      : scene(loadText(genericPair(", simulation: {serial: 111}", unconfigured(222)) +
                       "  alone: {joints: [left]}\n")) {}
  void begin() {
    scene.robot().start();
    power(false);
    scene.run(1s);
    ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::absent; }, 10s));
    scan = ask(scene, bus::LssScanCommand{100ms});
  }
  void power(bool on) {
    scene.port("left").setPowered(on);
    on ? scene.drive("left").powerOn(scene.now()) : scene.drive("left").powerOff(scene.now());
  }
  void switchOnAndEnable() {
    power(true);
    ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::ready; }, 5s));
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
    ASSERT_FALSE(scan->has_value()) << "the test needs a longer scan";
  }
  std::shared_ptr<std::optional<bus::Answer>> assign(std::uint32_t serial, int node) {
    bus::LssAssignCommand command;
    command.identity = device(serial);
    command.node_id = node;
    return ask(scene, command);
  }
  Scene scene;
  std::shared_ptr<std::optional<bus::LssScanAnswer>> scan;
};

TEST_F(BehindAScan, ADriveThatWasEnabledMeanwhileKeepsItsNodeIdAndIsNotReset) {
  begin();
  const auto answer = assign(111, 9);
  ASSERT_FALSE(answer->has_value()) << (*answer)->message;
  switchOnAndEnable();
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 60s));
  EXPECT_FALSE((*answer)->success);
  EXPECT_THAT((*answer)->message,
              HasSubstr("the device has node-ID 1, which is that of a drive in operation"));
  scene.run(500ms);
  EXPECT_EQ(scene.state("left").health, Health::ready);
  EXPECT_TRUE(scene.truth("left").power_stage_on);
}

TEST_F(BehindAScan, ANodeIdThatIsInOperationMeanwhileIsNotGivenToAnother) {
  begin();
  const auto answer = assign(222, 1);
  ASSERT_FALSE(answer->has_value()) << (*answer)->message;
  switchOnAndEnable();
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 60s));
  EXPECT_FALSE((*answer)->success);
  EXPECT_THAT((*answer)->message, HasSubstr("node-ID 1 is that of a drive in operation by now"));
  EXPECT_EQ(scene.drive("right").device().node(), 255);
}

TEST_F(BehindAScan, NothingIsScannedOrAssignedInMotionThatBeganMeanwhile) {
  begin();
  const auto assigned = assign(222, 9);
  const auto scanned = ask(scene, bus::LssScanCommand{});
  switchOnAndEnable();
  ASSERT_TRUE(scene.move({2.0}, 40s, 1).success);
  ASSERT_TRUE(scene.runUntil([&] { return scanned->has_value(); }, 30s));
  EXPECT_TRUE((*scan)->success) << (*scan)->message;
  EXPECT_THAT((*assigned)->message,
              HasSubstr("serial 222 (0x000000DE): refused: the group alone is in motion"));
  EXPECT_THAT((*scanned)->message, HasSubstr("refused: the group alone is in motion"));
  EXPECT_EQ(scene.drive("right").device().node(), 255);
}

// While another master is listened for, and while a node-ID is given.
TEST(Lss, AShutdownAtTheStartIsOrderly) {
  for (const Duration after : {60ms, 160ms}) {
    Scene scene(loadText(genericPair(lssOf(111) + unconfigured(111))));
    std::vector<can::Frame> nmt;
    scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
      if (frame.id == 0x000) nmt.push_back(frame);
    });
    scene.robot().start();
    scene.run(after);
    scene.robot().network().beginShutdown(scene.now());
    const auto ended = [&] { return scene.robot().network().shutDown(); };
    EXPECT_TRUE(scene.runUntil(ended, 1s)) << "before it has waited for drives that are not there";
    scene.run(5ms);  // what was sent last is on its way
    ASSERT_FALSE(nmt.empty());
    EXPECT_EQ(nmt.back(), can::Frame(0x000, {0x80, 0x00})) << "pre-operational";
  }
}

// One NMT reset to all, as LSS needs it, would reach it first.
TEST(Lss, WhatTurnsIsStoppedByAShutdownAtTheStart) {
  for (const Duration after : {60ms, 160ms, 300ms, 500ms, 700ms, 1000ms, 1200ms, 1400ms}) {
    Scene scene(turningOn(loadText(genericPair({}, lssOf(111) + unconfigured(111)))));
    scene.world().powerOn();
    scene.run(1s);
    turnLeft(scene);
    ASSERT_GT(scene.truth("left").velocity_turns, 1.0);
    scene.robot().startDriver();
    scene.run(after);
    scene.robot().network().beginShutdown(scene.now());
    const auto ended = [&] { return scene.robot().network().shutDown(); };
    EXPECT_TRUE(scene.runUntil(ended, 1810ms));
    scene.run(1s);
    EXPECT_NEAR(scene.truth("left").velocity_turns, 0.0, 1e-3) << toSeconds(after);
    EXPECT_FALSE(scene.truth("left").power_stage_on) << toSeconds(after);
  }
}

TEST(Lss, WhoWaitsForLssAtAShutdownIsAnswered) {
  Scene scene(loadText(genericPair(unconfigured(111))));
  scene.robot().start();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").health == Health::ready; }, 10s));
  std::vector<std::string> answers;
  const auto ask = [&](auto request) {
    const auto take = [&](const bus::Answer& answer) {
      EXPECT_FALSE(answer.success);
      answers.push_back(answer.message);
    };
    scene.robot().network().execute(bus::Command(std::move(request), take), scene.now());
  };
  bus::LssAssignCommand assign;
  assign.identity = device(111);
  assign.node_id = 1;
  bus::LssBitTimingCommand timing;
  timing.axis = "right";
  timing.kbit_per_s = 500;
  ask(bus::LssScanCommand{});
  ask(assign);
  ask(timing);
  scene.run(100ms);
  EXPECT_TRUE(answers.empty());
  scene.robot().network().beginShutdown(scene.now());
  ASSERT_EQ(answers.size(), 3u);
  for (const std::string& answer : answers) {
    EXPECT_THAT(answer, HasSubstr("ended by the shutdown of the driver"));
  }
}

class DisturbedLss : public testing::TestWithParam<Disturbance> {};

TEST_P(DisturbedLss, ScanTellsTrueIdentitiesOrAReason) {
  int complete = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene(loadText(genericPair(unconfigured(111), unconfigured(222))), seed);
    scene.robot().start();
    scene.run(7s);
    scene.world().bus().faults().setRates(GetParam().rates());
    const auto scan = call(scene, bus::LssScanCommand{});
    for (const auto& found : scan.devices) {
      EXPECT_TRUE(found == device(111) || found == device(222)) << toString(found);
    }
    EXPECT_TRUE(scan.devices.size() == 2 || !scan.success) << scan.message;
    EXPECT_NE(scan.message, "");
    complete += scan.devices.size() == 2;
  }
  EXPECT_GE(complete, 3);
}

TEST_P(DisturbedLss, NoDriveEverGetsTheNodeIdOfAnother) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Scene scene(
        loadText(genericPair(lssOf(111) + unconfigured(111), lssOf(222) + unconfigured(222))),
        seed);
    scene.world().bus().faults().setRates(GetParam().rates());
    scene.robot().start();
    for (int i = 0; i < 200; ++i) {
      scene.run(50ms);
      EXPECT_NE(scene.drive("left").device().node(), 2) << seed;
      EXPECT_NE(scene.drive("right").device().node(), 1) << seed;
    }
    const bool both =
        scene.drive("left").device().node() == 1 && scene.drive("right").device().node() == 2;
    EXPECT_TRUE(both || scene.told().find("LSS: ") != std::string::npos) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, DisturbedLss, testing::ValuesIn(kDisturbances));

}  // namespace
}  // namespace cia402
