// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SYNC of other devices: one too many, or the one that leads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::kPeriod;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

NetworkSnapshot shown(const RobotWorld& world) {
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  return snapshot;
}

/// A drive takes no RPDO without SYNC, so it is stopped by SDO.
void takeControlwordsBySdo(RobotWorld& world) {
  for (test::FakeDrive& drive : world.drives) drive.objects[{0x6040, 0}] = {0, 0};
}

// --- The driver produces SYNC, and another device does so, too --------------------------------

struct SecondProducer : testing::Test {
  SecondProducer() {
    takeControlwordsBySdo(world);
    world.enable();
    world.run(1500ms);  // with the first SYNC there is patience
    // To the middle between two looks, which come every 100 ms.
    (void)world.runUntil([&] { return world.now - Time() >= 4s; });
  }
  void hear() { world.network.receive(can::Frame(0x080, {}), world.now, world.now); }
  /// So many SYNCs, one in every 100 ms.
  void hear(int times) {
    for (int i = 0; i < times; ++i) {
      hear();
      world.run(100ms);
    }
  }
  bool moves() const { return world.group().executing() && !world.group().stopping(); }
  RobotWorld world;
};

TEST_F(SecondProducer, IsCountedToldOnceAndNothingIsEnabledBesideIt) {
  EXPECT_EQ(shown(world).foreign_syncs, 0u);
  EXPECT_EQ(shown(world).sync_problem.str(), "");
  hear(12);
  EXPECT_EQ(shown(world).foreign_syncs, 12u);
  EXPECT_THAT(shown(world).sync_problem.str(), HasSubstr("another device produces SYNC"));
  EXPECT_EQ(world.eventsWith("another device produces SYNC (COB-ID 0x080), too: drives would move "
                             "at both paces"),
            1u + 2u)
      << "once, and once of each axis that is stopped: " << world.allEvents();
  const Answer refused = world.call(ProcedureKind::enable);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("enable is refused: another device produces SYNC"),
                                     HasSubstr("`bus: {sync: external}`")));
}

TEST_F(SecondProducer, ThatIsHeardAtThreeLooksInARowStopsWhatMoves) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 4.0).success);
  hear(2);
  world.run(100ms);  // none this time
  hear(2);
  EXPECT_TRUE(moves()) << world.allEvents();
  EXPECT_TRUE(world.drives[0].enabled());
  hear(2);
  EXPECT_FALSE(moves());
  EXPECT_EQ(std::count_if(world.events.begin(), world.events.end(),
                          [](const Event& event) {
                            return event.text.str().rfind("stopped: another device produces SYNC",
                                                          0) == 0;
                          }),
            1)
      << "why the trajectory has ended";
  world.run(1s);
  EXPECT_FALSE(world.drives[0].enabled());
  EXPECT_FALSE(world.drives[1].enabled());
  EXPECT_EQ(world.eventsWith("elbow (node 2): stopped: another device produces SYNC"), 1u)
      << world.allEvents();
}

TEST_F(SecondProducer, AStraySyncIsToldAndNoReasonToStop) {
  ASSERT_TRUE(world.move({1.0, -1.0}, 4.0).success);
  for (int i = 0; i < 20; ++i) hear();  // a burst, seen at one look
  world.run(4500ms);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_TRUE(world.drives[0].enabled());
  EXPECT_EQ(world.eventsWith("another device produces SYNC"), 1u);
  EXPECT_EQ(world.eventsWith("SYNC is as it should be"), 1u);
}

TEST_F(SecondProducer, ForbidsToEnableFromItsFirstSyncOn) {
  hear();
  EXPECT_THAT(world.call(ProcedureKind::enable).message, HasSubstr("another device produces SYNC"));
}

// It counts as heard for a second, and its trouble must be away for another.
TEST_F(SecondProducer, IsOverOnceItWasAwayForASecondLongerThanOneIsHeard) {
  hear();
  world.run(950ms);
  EXPECT_THAT(world.call(ProcedureKind::enable).message, HasSubstr("lead with"));
  world.run(200ms);
  EXPECT_THAT(world.call(ProcedureKind::enable).message,
              AllOf(HasSubstr("another device produces SYNC"), HasSubstr("(a moment ago; wait")));
  world.run(750ms);
  EXPECT_EQ(world.eventsWith("SYNC is as it should be"), 0u);
  EXPECT_FALSE(world.call(ProcedureKind::enable).success);
  world.run(350ms);
  EXPECT_EQ(world.eventsWith("SYNC is as it should be"), 1u);
  EXPECT_EQ(shown(world).sync_problem.str(), "");
  EXPECT_TRUE(world.call(ProcedureKind::enable).success);
}

TEST_F(SecondProducer, ThatComesAndGoesIsToldOnce) {
  for (int i = 0; i < 5; ++i) {
    hear();
    world.run(1600ms);  // away for half a second of it
  }
  EXPECT_EQ(world.eventsWith("another device produces SYNC"), 1u) << world.allEvents();
  EXPECT_EQ(world.eventsWith("SYNC is as it should be"), 0u);
}

TEST(NoSecondProducer, IsHeardBeforeTheStart) {
  RobotWorld world;
  world.network.receive(can::Frame(0x080, {}), world.now, world.now);
  EXPECT_EQ(shown(world).foreign_syncs, 0u);
}

// --- Another device leads -----------------------------------------------------------------------

config::RobotConfig led() {
  config::RobotConfig robot = test::testRobot();
  robot.bus.external_sync = true;
  return robot;
}

struct ExternalSyncTest : testing::Test {
  ExternalSyncTest() { takeControlwordsBySdo(world); }
  /// A SYNC of the other device, seen `late` after it was on the wire.
  void sync(Duration late = 0ms) {
    const can::Frame frame = counted ? can::Frame(0x080, {1}) : can::Frame(0x080, {});
    for (test::FakeDrive& drive : world.drives) drive.receive(frame, world.now);
    world.now += late;
    world.network.receive(frame, world.now - late, world.now);
  }
  /// SYNCs for so long. They come a little after the robot's own deadlines.
  void lead(Duration duration, Duration period = kPeriod) {
    for (const Time end = world.now + duration; world.now < end;) {
      sync();
      world.run(period);
    }
  }
  void enable() {
    world.network.start(world.now);
    lead(3s);
    const auto answers = world.begin(ProcedureKind::enable);
    lead(1s);
    ASSERT_EQ(answers->size(), 1u);
    ASSERT_TRUE(answers->front().success) << answers->front().message;
  }
  std::string problem() const { return shown(world).sync_problem.str(); }

  RobotWorld world{led()};
  bool counted = false;
};

TEST_F(ExternalSyncTest, TheCycleFollowsHalfAPeriodAfterEachAndTheDriverProducesNone) {
  enable();
  world.sent.clear();
  for (int i = 0; i < 20; ++i) {
    sync(500us);  // read late
    const Time stamp = world.now - 500us;
    world.run(3500us);
    EXPECT_EQ(world.network.cycle().lastCycle(), stamp + kPeriod / 2);
  }
  EXPECT_TRUE(world.sentWithId(0x080).empty());
  EXPECT_EQ(world.sentWithId(0x201).size(), 20u) << "one RPDO for each";
  EXPECT_EQ(shown(world).missed_syncs, 0u);
  EXPECT_EQ(problem(), "");
  EXPECT_EQ(world.eventsWith("SYNC"), 0u) << world.allEvents();
}

TEST_F(ExternalSyncTest, ASyncThatOvertakesTheCycleBeforeBringsItAtOnce) {
  enable();
  sync();
  world.run(1ms);
  const auto overruns = world.network.statistics().overruns();
  sync();
  EXPECT_EQ(world.network.nextDeadline(), world.now);
  world.run(100us);
  EXPECT_EQ(world.network.cycle().lastCycle(), world.now - 100us);
  EXPECT_EQ(world.network.statistics().overruns(), overruns + 1);
}

TEST_F(ExternalSyncTest, IsRegularWithinHalfAMillisecond) {
  enable();
  sync();
  world.run(kPeriod);
  sync();
  EXPECT_NEAR(world.network.statistics().lastLateness(), 0.0, 1e-9);
  world.run(kPeriod + 500us);
  sync();
  EXPECT_NEAR(world.network.statistics().lastLateness(), 500e-6, 1e-9);
  world.run(kPeriod - 300us);
  sync();
  EXPECT_NEAR(world.network.statistics().lastLateness(), 300e-6, 1e-9);
}

TEST_F(ExternalSyncTest, MissingOnesAreCountedAndThreeInARowStopWhatMoves) {
  enable();
  ASSERT_TRUE(world.move({2.0, -2.0}, 4.0).success);
  lead(1s);
  const auto overruns = world.network.statistics().overruns();
  world.run(2 * kPeriod);  // two are missing
  lead(40ms);
  EXPECT_EQ(shown(world).missed_syncs, 2u);
  EXPECT_EQ(world.network.statistics().overruns(), overruns + 2);
  EXPECT_TRUE(world.group().executing());
  EXPECT_EQ(world.eventsWith("stopped"), 0u) << world.allEvents();
  // The last came one period ago: 3.5 periods after it three are missing.
  world.run(2 * kPeriod + kPeriod / 2 - 1us);
  EXPECT_EQ(world.eventsWith("stopped"), 0u);
  const Time lost = world.now + 1us;
  world.run(100ms);
  EXPECT_EQ(world.eventsWith("shoulder (node 1): stopped: no SYNC (COB-ID 0x080) came from the "
                             "other device for 3 periods (12 ms)"),
            1u)
      << world.allEvents();
  EXPECT_FALSE(world.group().executing());
  EXPECT_EQ((world.network.cycle().lastCycle() - lost) % kPeriod, Duration(0))
      << "on its own clock";
  EXPECT_GT(world.network.cycle().lastCycle(), world.now - 2 * kPeriod);
  world.run(1s);
  EXPECT_THAT(problem(), HasSubstr("no SYNC (COB-ID 0x080) comes; another device must send it "
                                   "every 4 ms"));
  EXPECT_THAT(world.call(ProcedureKind::enable).message,
              HasSubstr("enable is refused: no SYNC (COB-ID 0x080) comes"));
  lead(500ms);
  EXPECT_EQ(world.eventsWith("SYNC is as it should be"), 0u);
  lead(1s);
  EXPECT_EQ(world.eventsWith("SYNC is as it should be"), 1u);
  EXPECT_EQ(problem(), "");
}

TEST_F(ExternalSyncTest, WhatDoesNotComeForTenOfThemIsStale) {
  enable();
  world.drives[1].tpdo_bytes = 0;
  lead(9 * kPeriod);
  EXPECT_TRUE(world.axis(1).state().feedback_valid);
  lead(3 * kPeriod);
  EXPECT_FALSE(world.axis(1).state().feedback_valid);
  EXPECT_TRUE(world.axis(0).state().feedback_valid);
  world.run(200ms);  // without SYNC nothing comes from the other either
  EXPECT_FALSE(world.axis(0).state().feedback_valid);
}

TEST_F(ExternalSyncTest, WhatWaitsToEnableAnAxisIsWithdrawnWhenItIsLost) {
  config::RobotConfig config = led();
  config.axes[0].homing = test::homingOfOrder(1);
  config.axes[1].homing = test::homingOfOrder(0);
  RobotWorld homing(config);
  takeControlwordsBySdo(homing);
  homing.network.start(homing.now);
  const auto lead = [&](Duration duration) {
    for (const Time end = homing.now + duration; homing.now < end;) {
      const can::Frame frame(0x080, {});
      for (test::FakeDrive& drive : homing.drives) drive.receive(frame, homing.now);
      homing.network.receive(frame, homing.now, homing.now);
      homing.run(kPeriod);
    }
  };
  lead(3s);
  const auto enabled = homing.begin(ProcedureKind::enable);
  lead(1s);
  ASSERT_TRUE(enabled->size() == 1 && enabled->front().success);
  const auto homed = homing.begin(ProcedureKind::home);
  lead(50ms);
  homing.run(20ms);
  lead(3s);
  ASSERT_EQ(homed->size(), 1u);
  EXPECT_FALSE(homed->front().success);
  EXPECT_THAT(homed->front().message,
              AllOf(HasSubstr("shoulder: not started, for "), HasSubstr("no SYNC")));
  EXPECT_FALSE(homing.drives[0].homing_began);
}

TEST_F(ExternalSyncTest, OfAnotherPeriodStopsWhatMovesAndIsToldWithIt) {
  enable();
  ASSERT_TRUE(world.move({2.0, -2.0}, 4.0).success);
  lead(1s);
  lead(1s, 5ms);
  EXPECT_EQ(world.eventsWith("elbow (node 2): stopped: SYNC comes every "), 1u)
      << world.allEvents();
  EXPECT_EQ(problem(),
            "SYNC comes every 5 ms, not every 4 ms as `bus: {sync_period}` says: correct one of "
            "them");
  EXPECT_FALSE(world.group().executing());
}

TEST_F(ExternalSyncTest, OfAWrongFormIsToldWithWhatToWrite) {
  counted = true;
  world.network.start(world.now);
  lead(4s);
  EXPECT_EQ(problem(),
            "SYNC comes with a counter, write its overflow value as `bus: {sync_counter}`");
}

TEST(ExternalSyncWithACounter, OfAWrongFormIsToldWithWhatToWrite) {
  config::RobotConfig config = led();
  config.bus.sync_counter = 10;
  RobotWorld world(config);
  world.network.start(world.now);
  for (int i = 0; i < 1000; ++i) {
    world.network.receive(can::Frame(0x080, {}), world.now, world.now);
    world.run(kPeriod);
  }
  EXPECT_EQ(shown(world).sync_problem.str(),
            "SYNC comes without the counter of `bus: {sync_counter}`");
}

TEST_F(ExternalSyncTest, ThatDoesNotComeAtTheStartIsToldAfterASecond) {
  world.network.start(world.now);
  world.run(900ms);
  EXPECT_EQ(problem(), "");
  world.run(1s);
  EXPECT_THAT(problem(), HasSubstr("no SYNC (COB-ID 0x080) comes"));
  EXPECT_EQ(world.eventsWith("no SYNC (COB-ID 0x080) comes"), 1u);
  EXPECT_EQ(world.eventsWith("stopped"), 0u) << "nothing was moved";
}

// --- SYNC of the driver is late ------------------------------------------------------------------

config::RobotConfig minding() {
  config::RobotConfig robot = test::testRobot();
  auto profile = std::make_shared<drive::DriveProfile>(*robot.axes[0].profile);
  profile->errors[0x8201].text = "SYNC time-out";
  profile->errors[0x8201].missing = drive::ErrorText::Missing::cycle;
  for (drive::AxisConfig& axis : robot.axes) axis.profile = profile;
  return robot;
}

struct LateSync : testing::Test {
  LateSync() { world.enable(); }
  /// The next SYNC leaves so late; an emergency of the shoulder comes `after` it.
  void emergencyAfter(Duration late, Duration after, std::uint16_t code = 0x8201) {
    const Time due = world.sentWithId(0x080).back().time + kPeriod;
    world.now = due + late;
    world.run(after);
    world.network.receive(
        can::Frame(0x081, {static_cast<std::uint8_t>(code & 0xFF),
                           static_cast<std::uint8_t>(code >> 8), 1, 0, 0, 0, 0, 0}),
        world.now, world.now);
    world.run(20ms);
  }
  RobotWorld world{minding()};
};

TEST_F(LateSync, IsTheReasonForWhatADriveMissesMeanwhile) {
  emergencyAfter(5ms, 1ms);
  EXPECT_EQ(world.eventsWith("0x8201 SYNC time-out: the cause is that this program sent SYNC 5 ms "
                             "late"),
            1u)
      << world.allEvents();
}

TEST_F(LateSync, IsNoReasonForOtherErrorsNorLongAgoNorByALittle) {
  emergencyAfter(5ms, 1ms, 0x8611);
  EXPECT_EQ(world.eventsWith("emergency: 0x8611"), 1u) << world.allEvents();
  emergencyAfter(5ms, 60ms);   // it may come 50 ms late itself
  emergencyAfter(900us, 1ms);  // less than a quarter of a period
  EXPECT_GE(world.eventsWith("0x8201"), 1u) << world.allEvents();
  EXPECT_EQ(world.eventsWith("this program sent SYNC"), 0u) << world.allEvents();
}

TEST_F(LateSync, IsNoReasonForWhatWasMissedBeforeItWasDue) {
  const Time due = world.sentWithId(0x080).back().time + kPeriod;
  world.now = due + 5ms;
  world.run(1ms);
  world.network.receive(can::Frame(0x081, {0x01, 0x82, 1, 0, 0, 0, 0, 0}), due - 1ms, world.now);
  world.run(20ms);
  EXPECT_EQ(world.eventsWith("emergency: 0x8201"), 1u);
  EXPECT_EQ(world.eventsWith("this program sent SYNC"), 0u) << world.allEvents();
}

TEST_F(LateSync, ByAQuarterOfAPeriodIsOne) {
  emergencyAfter(kPeriod / 4, 1ms);
  EXPECT_EQ(world.eventsWith("this program sent SYNC 1 ms late"), 1u) << world.allEvents();
}

}  // namespace
}  // namespace cia402::bus
