// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SYNC that another device produces: followed, lost, irregular, or not wanted.
#include <random>

#include "system/synced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;
using testing::Not;

sim::SyncSchedule every(Duration period) {
  sim::SyncSchedule schedule;
  schedule.period = period;
  return schedule;
}

class ExternalSync : public testing::Test {
 protected:
  void boot(const std::string& yaml = syncExternal(), const sim::SyncSchedule& schedule = {}) {
    scene = std::make_unique<SyncedScene>(yaml, schedule);
    scene->world().bus().setMonitor([this](const can::Frame& frame, Time now) {
      if (frame.id == 0x080) last_sync = now;
      if (frame.id == 0x201) rpdo_after_sync = now - last_sync;
    });
    ASSERT_TRUE(scene->boot()) << scene->told();
  }
  /// The other producer is silent; both axes are on their way.
  void moveWithOwnSync() {
    scene = std::make_unique<SyncedScene>(genericPair());
    scene->cease();
    ASSERT_TRUE(scene->boot()) << scene->told();
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success) << scene->told();
    ASSERT_TRUE(scene->move({1.5, -1.5}, 4s).success);
    scene->run(1s);
    ASSERT_GT(std::fabs(scene->velocity("left")), 0.2);
  }
  bus::NetworkSnapshot snapshot() {
    bus::NetworkSnapshot shot;
    scene->robot().network().fill(shot);
    return shot;
  }

  std::unique_ptr<SyncedScene> scene;
  Time last_sync{};
  Duration rpdo_after_sync{};
};

TEST_F(ExternalSync, ATrajectoryFollowsThePaceOfAnotherDevice) {
  boot();
  ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success) << scene->told();
  const auto moved = scene->move({0.6, -0.4}, 2s);
  EXPECT_TRUE(moved.success) << moved.message;
  scene->run(2500ms);
  EXPECT_NEAR(scene->position("left"), 0.6, 1e-3);
  EXPECT_NEAR(scene->position("right"), -0.4, 1e-3);
  // Half a period after SYNC, and the frames before it.
  EXPECT_GT(rpdo_after_sync, 2ms);
  EXPECT_LT(rpdo_after_sync, 2500us);
  EXPECT_EQ(snapshot().missed_syncs, 0u);
  EXPECT_THAT(scene->told(), Not(HasSubstr("SYNC")));
}

TEST_F(ExternalSync, TheDriverItselfProducesNone) {
  boot();
  scene->cease();
  scene->run(100ms);
  const Time last = last_sync;
  scene->run(1s);
  EXPECT_EQ(last_sync, last);
}

TEST_F(ExternalSync, WhenItIsLostEverythingThatMovesIsStoppedInWords) {
  boot();
  ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene->move({1.5, -1.5}, 4s).success);
  scene->run(1s);
  ASSERT_GT(std::fabs(scene->velocity("left")), 0.2);
  scene->cease();
  scene->run(600ms);
  EXPECT_NEAR(scene->velocity("left"), 0.0, 1e-3);
  EXPECT_NEAR(scene->velocity("right"), 0.0, 1e-3);
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_FALSE(scene->truth("right").power_stage_on);
  EXPECT_THAT(scene->told(),
              HasSubstr("left (node 1): stopped: no SYNC (COB-ID 0x080) came from the "
                        "other device for 3 periods (12 ms)"));
  EXPECT_TRUE(std::isnan(scene->state("left").position)) << "it is not known any more";
  const auto refused = scene->procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("enable is refused: no SYNC (COB-ID 0x080) comes"));
}

TEST_F(ExternalSync, WhenItIsBackNothingMovesUntilSomebodyEnables) {
  boot();
  ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene->move({1.5, -1.5}, 4s).success);
  scene->run(1s);
  scene->cease();
  scene->run(600ms);
  scene->forget();
  scene->produce();
  scene->run(1s);
  EXPECT_LT(scene->seen("left").travel(), 2e-4);
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_FALSE(std::isnan(scene->state("left").position));
  EXPECT_THAT(scene->procedure(ProcedureKind::enable).message, HasSubstr("a moment ago"));
  scene->run(500ms);
  EXPECT_THAT(scene->told(), HasSubstr("SYNC is as it should be"));
  const auto enabled = scene->procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_LT(scene->seen("left").travel(), 2e-4);
}

TEST_F(ExternalSync, ASingleMissingSyncIsCountedAndNoReasonToStop) {
  boot();
  ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
  sim::FaultRule rule;
  rule.id = 0x080;
  scene->world().bus().faults().add(rule);
  scene->run(100ms);
  EXPECT_EQ(snapshot().missed_syncs, 1u);
  EXPECT_TRUE(scene->state("left").ready_for_motion);
}

TEST_F(ExternalSync, AnotherPeriodThanConfiguredIsSaidAndNothingIsEnabled) {
  boot(syncExternal(), every(5ms));
  scene->run(1500ms);
  EXPECT_THAT(scene->told(), HasSubstr("SYNC comes every 5 ms, not every 4 ms as"));
  const auto refused = scene->procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("SYNC comes every 5 ms"));
  EXPECT_TRUE(snapshot().sync_problem.view().find("5 ms") != std::string::npos);
}

TEST_F(ExternalSync, APeriodThatChangesStopsWhatMoves) {
  boot();
  ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene->move({1.5, -1.5}, 4s).success);
  scene->run(1s);
  scene->produce(every(6ms));
  scene->run(1s);
  EXPECT_NEAR(scene->velocity("left"), 0.0, 1e-3);
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_FALSE(scene->truth("right").power_stage_on);
  EXPECT_THAT(scene->told(), HasSubstr("right (node 2): stopped: SYNC comes every "));
  EXPECT_THAT(snapshot().sync_problem.str(), HasSubstr("SYNC comes every 6 ms, not every 4 ms"));
}

TEST_F(ExternalSync, ACounterThatNobodyConfiguredIsSaid) {
  sim::SyncSchedule counted;
  counted.counter_overflow = 240;
  boot(syncExternal(), counted);
  scene->run(1500ms);
  EXPECT_THAT(scene->told(), HasSubstr("SYNC comes with a counter"));
}

TEST(ExternalSyncWithoutAProducer, LetsTheNodesBootAndTheReasonIsSaid) {
  Scene scene(loadText(syncExternal()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(1500ms);
  EXPECT_THAT(scene.told(), HasSubstr("no SYNC (COB-ID 0x080) comes; another device must send it "
                                      "every 4 ms"));
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable).success);
}

TEST_F(ExternalSync, ASecondProducerBesideOurOwnSyncIsSaid) {
  boot(withBus("listen: 0"), every(40ms));
  scene->run(1500ms);
  EXPECT_THAT(scene->told(), HasSubstr("another device produces SYNC (COB-ID 0x080), too"));
  EXPECT_GT(snapshot().foreign_syncs, 30u);
  EXPECT_FALSE(scene->procedure(ProcedureKind::enable).success);
  scene->cease();
  scene->run(2500ms);
  const auto enabled = scene->procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST_F(ExternalSync, ASecondProducerThatAppearsStopsWhatMoves) {
  moveWithOwnSync();
  scene->produce(every(40ms));
  scene->run(1s);
  EXPECT_NEAR(scene->velocity("left"), 0.0, 1e-3);
  EXPECT_NEAR(scene->velocity("right"), 0.0, 1e-3);
  EXPECT_FALSE(scene->truth("left").power_stage_on);
  EXPECT_FALSE(scene->truth("right").power_stage_on);
  EXPECT_THAT(scene->told(), HasSubstr("right (node 2): stopped: another device produces SYNC"));
}

TEST_F(ExternalSync, AStraySyncIsToldAndNoReasonToStop) {
  moveWithOwnSync();
  scene->produce(every(40ms));
  scene->run(150ms);
  scene->cease();
  scene->run(4s);
  EXPECT_THAT(scene->told(), HasSubstr("another device produces SYNC"));
  EXPECT_NEAR(scene->position("left"), 1.5, 1e-3);
  EXPECT_TRUE(scene->state("right").ready_for_motion);
}

/// Loses frames of SYNC by chance.
class Lossy {
 public:
  explicit Lossy(Scene& scene, unsigned one_in) : scene_(scene), one_in_(one_in) {}
  void everyMillisecond() {
    if (random_() % (4 * one_in_) != 0) return;
    sim::FaultRule rule;
    rule.id = 0x080;
    scene_.world().bus().faults().add(rule);
    ++lost;
  }
  unsigned lost = 0;

 private:
  Scene& scene_;
  unsigned one_in_;
  std::mt19937 random_{7};
};

/// Parameter: each SYNC is late by up to so many microseconds.
class ExternalSyncJitter : public testing::TestWithParam<int> {};

TEST_P(ExternalSyncJitter, AndLossDisturbNeitherMotionNorPeople) {
  sim::SyncSchedule schedule;
  schedule.jitter = std::chrono::microseconds(GetParam());
  SyncedScene scene(syncExternal(), schedule);
  Lossy lossy(scene, 50);
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.watch([&] { lossy.everyMillisecond(); });
  ASSERT_TRUE(scene.move({1.0, -1.0}, 4s).success);
  scene.run(5s);
  EXPECT_NEAR(scene.position("left"), 1.0, 1e-3);
  EXPECT_NEAR(scene.position("right"), -1.0, 1e-3);
  EXPECT_GT(lossy.lost, 15u);
  bus::NetworkSnapshot shot;
  scene.robot().network().fill(shot);
  EXPECT_NEAR(static_cast<double>(shot.missed_syncs), lossy.lost, 1.0);
  EXPECT_TRUE(scene.state("left").ready_for_motion);
  EXPECT_THAT(scene.told(), Not(HasSubstr("SYNC")));
}

/// Parameter: the producer's period, microseconds; 4 ms are configured.
class ExternalSyncOfAWrongPeriod : public testing::TestWithParam<int> {
 protected:
  static std::size_t linesWith(const std::string& words, const std::string& told) {
    std::size_t count = 0;
    for (std::size_t at = told.find(words); at != std::string::npos;) {
      ++count;
      at = told.find(words, at + 1);
    }
    return count;
  }
};

TEST_P(ExternalSyncOfAWrongPeriod, ThatJittersIsToldOnceAndNothingIsEnabled) {
  sim::SyncSchedule schedule = every(std::chrono::microseconds(GetParam()));
  schedule.jitter = 800us;
  SyncedScene scene(syncExternal(), schedule);
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(20s);
  EXPECT_LE(linesWith("SYNC", scene.told()), 2u) << scene.told();
  EXPECT_EQ(linesWith("SYNC is as it should be", scene.told()), 0u);
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(scene.procedure(ProcedureKind::enable, "left").success) << i;
    scene.run(17ms);
  }
}

// At the edge of what is tolerated, plainly wrong, and so long that it seems absent in between.
INSTANTIATE_TEST_SUITE_P(Microseconds, ExternalSyncOfAWrongPeriod,
                         testing::Values(4200, 5000, 20000));

TEST_F(ExternalSync, AMeasuredPeriodIsToldInThreeDigits) {
  boot(syncExternal(), every(5123456ns));
  scene->run(1500ms);
  EXPECT_THAT(scene->told(), HasSubstr("SYNC comes every 5.12 ms, not every 4 ms as"));
}

INSTANTIATE_TEST_SUITE_P(Microseconds, ExternalSyncJitter, testing::Values(0, 200, 1000, 1500));

/// Bit 30 of 1005h makes the left drive the producer.
std::string leftProduces() {
  const std::string bit = ", write: [{object: \"1005:00\", type: uint32, raw: 0x40000080}]";
  return syncExternal(genericPair(bit));
}

TEST(SyncOfADrive, LeadsTheDriverAndTheOtherDrives) {
  Scene scene(loadText(leftProduces()));
  unsigned syncs = 0;
  scene.world().bus().setMonitor(
      [&](const can::Frame& frame, Time) { syncs += frame.id == 0x080; });
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(200ms);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  syncs = 0;
  ASSERT_TRUE(scene.move({0.6, -0.4}, 2s).success);
  scene.run(2s);
  EXPECT_NEAR(syncs, 500.0, 1.0) << "one producer only";
  scene.run(500ms);
  EXPECT_NEAR(scene.position("left"), 0.6, 1e-3);
  EXPECT_NEAR(scene.position("right"), -0.4, 1e-3);
}

TEST(SyncOfADrive, IsLostWithTheDriveAndTheOthersStop) {
  Scene scene(loadText(leftProduces()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(200ms);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  ASSERT_TRUE(scene.move({1.5, -1.5}, 4s).success);
  scene.run(1s);
  ASSERT_GT(std::fabs(scene.velocity("right")), 0.2);
  scene.drive("left").powerOff(scene.now());
  scene.run(700ms);
  EXPECT_NEAR(scene.velocity("right"), 0.0, 1e-3);
  EXPECT_FALSE(scene.truth("right").power_stage_on);
  EXPECT_THAT(scene.told(), HasSubstr("right (node 2): stopped: no SYNC (COB-ID 0x080) came"));
  scene.drive("left").powerOn(scene.now());
  scene.run(3s);
  EXPECT_THAT(scene.told(), HasSubstr("SYNC is as it should be"));
  const auto enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST(TimeMessage, IsSentAtItsIntervalOnceTheWallClockIsKnown) {
  Scene scene(loadText(withBus("time_interval: 0.5")));
  std::vector<can::Frame> seen;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x100) seen.push_back(frame);
  });
  ASSERT_TRUE(scene.boot());
  scene.run(1s);
  EXPECT_TRUE(seen.empty());
  scene.robot().network().setWallTime(441763200s + 24h, scene.now());  // 1984-01-02 00:00
  scene.run(2s);
  ASSERT_EQ(seen.size(), 4u);
  EXPECT_EQ(seen[0].size, 6);
  EXPECT_EQ(seen[0].data[4], 1);  // a day after 1984-01-01
  EXPECT_EQ(seen[0].data[5], 0);
}

}  // namespace
}  // namespace cia402
