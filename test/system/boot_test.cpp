// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Whole robots whose drives boot as real ones do: late, twice, not at all, exchanged.
#include "fieldbus/object.h"
#include "system/left_turning.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::HasSubstr;
using testing::Not;

/// What diagnostics say of the last boot of the first axis.
std::string bootWords(Scene& scene) {
  bus::NetworkSnapshot snapshot;
  scene.robot().network().fill(snapshot);
  return snapshot.axes[0].words.boot.str();
}

TEST(LateDrives, OneThatIgnoresTheResetAndIsStillEnabledIsStoppedAndConfigured) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.drive("left").device().behaviour().ignores_nmt_reset = true;
  scene.node("left").boot(scene.now(), true);
  scene.run(100ms);
  ASSERT_EQ(scene.state("left").health, Health::booting);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on) << "nobody asked for it";
  EXPECT_EQ(scene.truth("left").nmt, canopen::NmtState::operational);
}

/// A drive that another master left in profile velocity, its shaft turning, with a PDO map of its
/// own. It turns on when its master is silent (6007h = 0), and changes no PDO, and nothing of SYNC,
/// while it is enabled.
class LeftTurning : public testing::Test {
 protected:
  LeftTurning() : scene(turningOn(loadText(genericPair()))) {}
  void write(fieldbus::ObjectId object, std::uint64_t value, unsigned size) {
    writeLeft(scene, object, value, size);
  }
  void lockWhileEnabled(fieldbus::ObjectId object) {
    sim::ObjectDictionary& dictionary = scene.drive("left").dictionary();
    if (dictionary.find(object) == nullptr) return;
    dictionary.onWriteCheck(object, [this, before = dictionary.hooks(object).check](
                                        const sim::Entry& entry, std::uint64_t number) {
      const bool enabled = scene.truth("left").power_stage_on;
      refused += enabled ? 1U : 0U;
      return enabled ? 0x08000022U : before ? before(entry, number) : 0U;
    });
  }
  void leaveTurning() {
    scene.world().powerOn();
    scene.run(1s);
    write({0x1800, 1}, 0x80000181, 4);
    write({0x1A00, 0}, 0, 1);
    write({0x1A00, 1}, 0x60640020, 4);  // the position alone
    write({0x1A00, 0}, 1, 1);
    write({0x1800, 1}, 0x181, 4);
    turnLeft(scene);
    for (const fieldbus::ObjectId object :
         {fieldbus::ObjectId{0x1005, 0}, {0x1006, 0}, {0x1019, 0}, {0x1800, 1}, {0x1A00, 0}}) {
      lockWhileEnabled(object);
    }
  }
  Scene scene;
  unsigned refused = 0;
};

TEST_F(LeftTurning, IsStoppedBeforeAnythingElseIsWrittenAndBooted) {
  leaveTurning();
  ASSERT_NEAR(scene.truth("left").velocity_turns, 20.0, 0.1);
  std::vector<can::Frame> writes;
  unsigned reads = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x601 && frame.data[0] == 0x40 && writes.empty()) ++reads;
    if (frame.id == 0x601 && frame.data[0] >> 5U == 1) writes.push_back(frame);
  });
  scene.robot().startDriver();
  ASSERT_TRUE(scene.runUntil([&] { return !writes.empty(); }, 2s));
  EXPECT_EQ(writes[0], can::Frame(0x601, {0x2B, 0x40, 0x60, 0x00, 0x02, 0x00, 0, 0}));
  EXPECT_EQ(reads, 1u) << "whether it turns, and nothing else";
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_EQ(refused, 0u) << "a drive that is locked while its motor has power";
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_NEAR(scene.truth("left").velocity_turns, 0.0, 1e-3);
  EXPECT_EQ(scene.drive("left").dictionary().find({0x1A00, 1})->number >> 16U, 0x6041u);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success);
}

/// While a driver starts it is asked to end: it listens for another master, asks the drive for the
/// first time, stops it, or boots it.
class LeftTurningAtAShutdown : public LeftTurning, public testing::WithParamInterface<int> {
 protected:
  void expectStoppedBeforeTheEnd() {
    scene.robot().startDriver();
    scene.run(std::chrono::microseconds(GetParam()));
    scene.robot().network().beginShutdown(scene.now());
    const auto ended = [&] { return scene.robot().network().shutDown(); };
    ASSERT_TRUE(scene.runUntil(ended, 1810ms)) << scene.told();
    scene.run(1s);
    EXPECT_NEAR(scene.truth("left").velocity_turns, 0.0, 1e-3);
  }
};

TEST_P(LeftTurningAtAShutdown, IsStoppedBeforeTheDriverEnds) {
  leaveTurning();
  ASSERT_NEAR(scene.truth("left").velocity_turns, 20.0, 0.1);
  expectStoppedBeforeTheEnd();
  EXPECT_FALSE(scene.truth("left").power_stage_on);
}

TEST_P(LeftTurningAtAShutdown, IsWaitedForThoughItAnswersLate) {
  leaveTurning();
  scene.drive("left").device().behaviour().sdo_latency = 40ms;
  expectStoppedBeforeTheEnd();
}

INSTANTIATE_TEST_SUITE_P(Microseconds, LeftTurningAtAShutdown,
                         testing::Values(0, 1000, 75000, 149900, 150100, 150500, 151000, 152000,
                                         155000, 160000, 200000, 400000, 700000),
                         testing::PrintToStringParamName());

// NMT stop would leave it turning, out of reach of every SDO.
TEST_F(LeftTurning, IsNotStoppedByNmtWhileItBoots) {
  leaveTurning();
  scene.robot().startDriver();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::booting; }, 2s));
  ASSERT_GT(scene.truth("left").velocity_turns, 1.0);
  for (const char* command : {"stop", "pre_operational"}) {
    const bus::Answer stopped = scene.call(bus::NmtServiceCommand{"left", command});
    EXPECT_FALSE(stopped.success) << command;
    EXPECT_THAT(stopped.message, HasSubstr("its motor may still turn")) << command;
  }
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_NEAR(scene.truth("left").velocity_turns, 0.0, 1e-3);
}

TEST(LateDrives, OneThatIsSwitchedOnMinutesLaterIsTakenIn) {
  Scene scene(loadText(genericPair()));
  scene.robot().start();
  scene.drive("left").powerOff(scene.now());
  scene.port("left").setPowered(false);
  scene.run(180s);
  EXPECT_EQ(scene.state("left").health, Health::absent);
  scene.port("left").setPowered(true);
  scene.drive("left").powerOn(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 2s)) << scene.told();
}

TEST(LateDrives, OneWhoseBootUpIsLostIsFoundByTheSearch) {
  Scene scene(loadText(genericPair()));
  scene.robot().start();
  scene.drive("left").powerOff(scene.now());
  scene.port("left").setPowered(false);
  scene.run(60s);
  ASSERT_EQ(scene.state("left").health, Health::absent);
  sim::FaultRule rule;
  rule.id = 0x701;
  rule.count = 1;
  scene.world().bus().faults().add(rule);
  scene.port("left").setPowered(true);
  scene.drive("left").powerOn(scene.now());
  scene.run(1s);
  EXPECT_EQ(scene.state("left").health, Health::absent) << "it said nothing that was heard";
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 33s)) << scene.told();
}

TEST(LateDrives, OneThatSaysBootUpTwiceStartsOver) {
  Scene scene(loadText(genericPair()));
  scene.robot().start();
  scene.run(25ms);  // in the middle of its boot
  scene.drive("left").powerOff(scene.now());
  scene.drive("left").powerOn(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_GE(scene.node("left").bootUps(), 2u);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success);
}

TEST(OptionalNodes, AnAbsentOneIsLeftOutAndNoError) {
  Scene scene(loadText(genericPair(", optional: true")));
  scene.robot().start();
  scene.drive("left").powerOff(scene.now());
  scene.port("left").setPowered(false);
  scene.run(8s);
  ASSERT_EQ(scene.state("left").health, Health::absent);
  for (const bus::Event& event : scene.robot().events()) {
    EXPECT_NE(event.severity, bus::Event::Severity::error) << event.text.str();
  }
  EXPECT_THAT(scene.told(), HasSubstr("it is optional, the others go on without it"));
  const auto enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_THAT(enabled.message, HasSubstr("left is optional and not there, it was left out"));
  EXPECT_TRUE(scene.truth("right").power_stage_on);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover).success);
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable, "left").success) << "asked for by name";
  scene.port("left").setPowered(true);
  scene.drive("left").powerOn(scene.now());
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 6s)) << scene.told();
  const auto both = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(both.success) << both.message;
  EXPECT_THAT(both.message, Not(HasSubstr("left out")));
}

TEST(OptionalNodes, AMandatoryOneIsAnErrorAndKeepsTheOthersFromNothing) {
  Scene scene(loadText(genericPair()));
  scene.robot().start();
  scene.drive("left").powerOff(scene.now());
  scene.port("left").setPowered(false);
  scene.run(8s);
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable).success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "right").success);
}

/// Counts the writes to node 1 by SDO, but for those of the controlword, which stop it.
void countWrites(Scene& scene, unsigned& writes) {
  scene.world().bus().setMonitor([&writes](const can::Frame& frame, Time) {
    const bool controlword = frame.data[1] == 0x40 && frame.data[2] == 0x60;
    if (frame.id == 0x601 && frame.data[0] >> 5U == 1 && !controlword) ++writes;
  });
}

TEST(Unchanged, ADriveThatStoredItsConfigurationIsNotConfiguredAgainAfterAPowerFailure) {
  Scene scene(loadText(genericPair(", configuration_check: checksum")));
  unsigned writes = 0;
  countWrites(scene, writes);
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_GT(writes, 10u);
  const auto saved = scene.procedure(ProcedureKind::save_parameters, "left");
  ASSERT_TRUE(saved.success) << saved.message;
  writes = 0;
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_EQ(writes, 0u);
  EXPECT_THAT(bootWords(scene), HasSubstr("its configuration is unchanged (1020h)"));
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success);
}

TEST(Unchanged, ADriveThatForgotIsConfigured) {
  Scene scene(loadText(genericPair(", configuration_check: checksum")));
  unsigned writes = 0;
  countWrites(scene, writes);
  ASSERT_TRUE(scene.boot()) << scene.told();
  const unsigned first = writes;
  writes = 0;
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_EQ(writes, first);
  EXPECT_THAT(bootWords(scene),
              testing::AllOf(HasSubstr("booted in "), Not(HasSubstr("unchanged"))));
}

TEST(RestoreBeforeConfigure, WhatSomebodyStoredInTheDriveIsGone) {
  Scene scene(loadText(genericPair(", restore_before_configure: true")));
  sim::Entry& window = *scene.drive("left").dictionary().find({0x6065, 0});
  const std::uint64_t factory = window.number;
  window.number = window.initial_number = 4321;
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(window.number, factory);
  EXPECT_EQ(scene.state("left").health, Health::ready);
}

TEST(BlockTransfer, ADriveThatHasNoneGetsTheDownloadInSegments) {
  for (const bool has_block : {true, false}) {
    Scene scene(loadText(genericPair()));
    sim::Entry entry;
    entry.id = {0x1F50, 1};
    entry.type = sim::DataType::domain;
    scene.drive("left").dictionary().add(entry);
    scene.drive("left").device().behaviour().sdo_block = has_block;
    ASSERT_TRUE(scene.boot()) << scene.told();
    fieldbus::Bytes program(5000);
    for (std::size_t i = 0; i < program.size(); ++i) program[i] = static_cast<std::uint8_t>(i * 7);
    const canopen::SdoTicket ticket =
        scene.node("left").sdo().download({0x1F50, 1}, program, "program");
    ASSERT_TRUE(scene.runUntil([&] { return ticket->done(); }, 20s));
    EXPECT_TRUE(ticket->ok()) << ticket->message();
    EXPECT_EQ(scene.drive("left").dictionary().find({0x1F50, 1})->bytes, program);
    EXPECT_EQ(scene.state("right").health, Health::ready);
  }
}

TEST(SdoChannels, ADriveIsBootedAndReadOnTheChannelThatItsOtherServerHas) {
  Scene scene(loadText(genericPair(", sdo: {request: 0x641, answer: 0x5C1}")));
  for (std::uint8_t sub = 1; sub <= 2; ++sub) {
    sim::Entry entry;
    entry.id = {0x1201, sub};
    entry.number = entry.initial_number = sub == 1 ? 0x641 : 0x5C1;
    scene.drive("left").dictionary().add(entry);
  }
  unsigned predefined = 0, own = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    predefined += frame.id == 0x601 || frame.id == 0x581 ? 1U : 0U;
    own += frame.id == 0x641 || frame.id == 0x5C1 ? 1U : 0U;
  });
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(predefined, 0u);
  EXPECT_GT(own, 50u);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success);
}

TEST(ExchangedDrives, AnotherSerialNumberIsRefusedWhereOneIsConfiguredAndToldWhereNot) {
  Scene scene(loadText(genericPair(", identity: {serial: 1}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (const char* name : {"left", "right"}) {
    scene.drive(name).powerOff(scene.now());
    scene.drive(name).dictionary().find({0x1018, 4})->initial_number = 77;
    scene.drive(name).powerOn(scene.now());
  }
  scene.run(3s);
  EXPECT_EQ(scene.state("left").health, Health::failed);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): is another drive than configured: 1018:04"));
  EXPECT_EQ(scene.state("right").health, Health::ready) << scene.told();
  EXPECT_THAT(scene.told(),
              testing::ContainsRegex("right \\(node 2\\): booted in [^\n]*is another drive than "
                                     "before: its serial number \\(1018:04\\) is 77, "
                                     "it was 1"));
}

TEST(Reboot, TheOthersMissNoCycleWhileOneIsSwitchedOffAndOn) {
  Scene scene(loadText(genericPair(", homing: {method: 37}", ", homing: {method: 37}") +
                       "  alone: {joints: [right]}\n"));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::home).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({2.0}, 6s, 1).success);
  bus::NetworkSnapshot before, after;
  scene.run(500ms);
  scene.robot().network().fill(before);
  scene.inject("left", "power_cycle");
  scene.run(5s);
  scene.robot().network().fill(after);
  EXPECT_EQ(scene.state("left").health, Health::ready) << scene.told();
  EXPECT_EQ(after.axes[1].missed_feedback, before.axes[1].missed_feedback);
  EXPECT_EQ(after.axes[1].node.boot_ups, before.axes[1].node.boot_ups);
  EXPECT_GT(after.axes[0].node.boot_ups, before.axes[0].node.boot_ups);
  EXPECT_EQ(after.statistics.overruns(), before.statistics.overruns());
  scene.run(2s);
  EXPECT_NEAR(scene.position("right"), 2.0, 1e-3);
}

TEST(Unsupervised, ALostStartIsNoticedByTheMissingTpdos) {
  Scene scene(loadText(genericPair(", error_control: none")));
  sim::FaultRule rule;  // reset, then start of the first node, both never heard by it
  rule.id = 0x000;
  rule.receiver = "left";
  rule.count = 2;
  scene.world().powerOn();
  scene.run(1s);
  scene.world().bus().faults().add(rule);
  scene.robot().startDriver();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 8s)) << scene.told();
  EXPECT_EQ(scene.truth("left").nmt, canopen::NmtState::operational);
}

}  // namespace
}  // namespace cia402
