// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/network.h"

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

TEST(Network, SendsNothingBeforeItIsStarted) {
  RobotWorld world;
  world.run(1s);
  EXPECT_TRUE(world.sent.empty());
  EXPECT_EQ(world.network.nextDeadline(), kNever);
}

TEST(Network, RefusesCommandsBeforeItIsStarted) {
  RobotWorld world;
  const auto answers = world.begin(ProcedureKind::enable);
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_EQ(answers->front().message, "refused: the bus interface can0 is not there yet");
}

TEST(Network, BootsAndEnablesItsDrivesAndTellsSo) {
  RobotWorld world;
  world.enable();
  EXPECT_TRUE(world.drives[0].enabled());
  EXPECT_TRUE(world.drives[1].enabled());
  EXPECT_EQ(world.eventsWith("shoulder (node 1): "), 1u) << "one line for a boot, of all that";
  EXPECT_EQ(world.eventsWith("shoulder (node 1): booted in 0."), 1u);
}

TEST(Network, SendsSyncAtExactDeadlines) {
  RobotWorld world;
  const Time start = world.now;
  world.network.start(start);
  world.run(1s);
  const auto syncs = world.sentWithId(0x080);
  ASSERT_EQ(syncs.size(), 249u);  // the first after one period
  for (std::size_t i = 0; i < syncs.size(); ++i) {
    ASSERT_EQ(syncs[i].time, start + static_cast<int>(i + 1) * kPeriod);
  }
  EXPECT_EQ(world.network.statistics().maxLateness(), 0.0);
  EXPECT_EQ(world.network.statistics().overruns(), 0u);
}

TEST(Network, SendsRpdosHalfAPeriodAfterSync) {
  RobotWorld world;
  world.boot();
  world.sent.clear();
  world.run(100ms);
  const auto syncs = world.sentWithId(0x080), rpdos = world.sentWithId(0x201);
  ASSERT_EQ(syncs.size(), 25u);
  ASSERT_GE(rpdos.size(), 24u);
  for (std::size_t i = 0; i < 24; ++i) {
    const auto& rpdo = rpdos[i + rpdos.size() - 24];
    const Duration after = (rpdo.time - syncs.front().time) % kPeriod;
    ASSERT_EQ(after, kPeriod / 2);
  }
}

TEST(Network, NeverSendsABurstOfSyncsAfterALongPause) {
  RobotWorld world;
  const Time start = world.now;
  world.boot();
  world.run(start + 3s - world.now);
  const auto missed = world.network.statistics().overruns();
  world.sent.clear();
  world.now += 50ms;  // the SYNC of 3.000 is sent at 3.050
  world.run(10ms);
  const auto syncs = world.sentWithId(0x080);
  ASSERT_EQ(syncs.size(), 3u);
  EXPECT_EQ(syncs[0].time, start + 3050ms);
  EXPECT_EQ(syncs[1].time, start + 3052ms);  // back on the grid
  EXPECT_EQ(syncs[2].time, start + 3056ms);
  // Those of 3.004 to 3.048 are left out; the cycle of 3.050 is overtaken by the SYNC of 3.052.
  EXPECT_EQ(world.network.statistics().overruns() - missed, 12u + 1u);
  EXPECT_DOUBLE_EQ(world.network.statistics().maxLateness(), 0.050);
}

TEST(Network, CountsCyclesWithoutFeedbackOfAReadyDrive) {
  RobotWorld world;
  world.boot();
  NetworkSnapshot before, after;
  world.network.fill(before);
  world.drives[0].silent = true;
  world.run(40ms);
  world.network.fill(after);
  EXPECT_NEAR(static_cast<double>(after.axes[0].missed_feedback - before.axes[0].missed_feedback),
              10.0, 1.0);
  EXPECT_EQ(after.axes[1].missed_feedback, before.axes[1].missed_feedback);
}

TEST(Network, TellsAnEmergencyWithCodeCauseAndRemedy) {
  RobotWorld world;
  world.enable();
  world.drives[1].fault(0x8611);
  world.run(100ms);
  const auto event = std::find_if(world.events.begin(), world.events.end(), [](const Event& e) {
    return e.text.view().find("emergency:") != std::string::npos;
  });
  ASSERT_NE(event, world.events.end());
  ASSERT_EQ(world.emergencies.size(), 1u);
  EXPECT_EQ(world.emergencies[0].axis, 1u);
  EXPECT_EQ(world.emergencies[0].emergency.code, 0x8611);
  EXPECT_THAT(event->text.str(), AllOf(HasSubstr("elbow (node 2): emergency: 0x8611"),
                                       HasSubstr("blocked"), HasSubstr("check the mechanics")));
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  EXPECT_EQ(snapshot.axes[1].emergencies.total, 1u);
  EXPECT_THAT(snapshot.axes[1].words.problem.str(), HasSubstr("following error"));
  EXPECT_TRUE(snapshot.axes[0].words.problem.empty());
}

TEST(Network, ASnapshotThatIsFilledAgainShowsWhatHasChanged) {
  RobotWorld world;
  NetworkSnapshot used;
  world.network.fill(used);
  EXPECT_EQ(used.axes[1].node.identity.vendor_id, 0u);
  world.enable();
  world.network.fill(used);
  EXPECT_TRUE(used.axes[1].words.problem.empty());
  world.drives[1].fault(0x8611);
  world.run(100ms);
  world.network.fill(used);
  EXPECT_THAT(used.axes[1].words.problem.str(), HasSubstr("following error"));
  world.drives[1].silent = true;
  world.run(2s);
  world.network.fill(used);
  EXPECT_THAT(used.axes[1].words.problem.str(), HasSubstr("no heartbeat"));
  world.drives[1].silent = false;
  world.run(2s);
  world.network.fill(used);
  NetworkSnapshot fresh;
  world.network.fill(fresh);
  EXPECT_EQ(used.axes[1].node.nmt, canopen::NmtState::operational);
  EXPECT_EQ(used.axes[1].node.last_heartbeat, fresh.axes[1].node.last_heartbeat);
  EXPECT_GT(used.axes[1].node.sdo.completed, used.axes[0].node.sdo.completed) << "booted twice";
  EXPECT_EQ(used.axes[1].node.sdo.completed, fresh.axes[1].node.sdo.completed);
  EXPECT_EQ(used.axes[1].words.problem.str(), fresh.axes[1].words.problem.str());
}

TEST(Network, TellsALongProblemOnlyOnce) {
  config::RobotConfig config = test::testRobot();
  auto profile = std::make_shared<drive::DriveProfile>(*config.axes[0].profile);
  profile->errors[0x8611].cause = std::string(500, 'x');
  config.axes[0].profile = profile;
  RobotWorld world(config);
  world.boot();
  world.drives[0].fault(0x8611);
  world.run(100ms);
  const std::size_t told = world.events.size();
  world.run(2s);
  EXPECT_EQ(world.events.size(), told) << world.allEvents();
}

TEST(Network, LosesASilentDriveAndBringsItBackDisabled) {
  RobotWorld world;
  world.enable();
  world.drives[0].silent = true;
  ASSERT_TRUE(world.runUntil([&] { return world.eventsWith("no heartbeat") > 0; }, 1s));
  EXPECT_TRUE(world.drives[1].enabled());
  world.drives[0].silent = false;
  ASSERT_TRUE(
      world.runUntil([&] { return world.axis(0).state().health == fieldbus::Health::ready; }, 5s));
  world.run(200ms);
  EXPECT_FALSE(world.drives[0].enabled());
}

TEST(Network, RunsACallInTheBusThread) {
  RobotWorld world;
  CallCommand call;
  call.function = [](Time now) {
    Answer answer;
    answer.success = now == Time(1s);
    return answer;
  };
  EXPECT_TRUE(world.call(call).success);
}

config::RobotConfig shoulderAlone() {
  config::RobotConfig config = test::testRobot();
  config.axes.resize(1);
  config.devices.resize(1);
  config.groups.clear();
  return config;
}

/// Is an object that was asked for between two cycles there before the next one?
bool answersBeforeTheNextCycle(RobotWorld& world) {
  world.boot();
  EXPECT_TRUE(world.runUntil([&] { return world.network.cycle().lastCycle() == world.now; }));
  world.run(1ms);  // the next cycle is 3 ms away
  const auto read = world.begin(ReadObjectCommand{"shoulder", "6098:00"});
  world.run(1ms);
  world.network.tick(world.now);
  return read->size() == 1;
}

TEST(Network, TakesAnAnswerBySdoBeforeTheNextCycle) {
  RobotWorld world(shoulderAlone());
  EXPECT_TRUE(answersBeforeTheNextCycle(world));
}

TEST(Network, TakesAnAnswerOnAnotherChannelBeforeTheNextCycle) {
  config::RobotConfig config = shoulderAlone();
  config.devices[0].sdo = {0x641, 0x6C1};
  RobotWorld world(config);
  world.drives[0].requests = 0x640;
  world.drives[0].answers = 0x6C0;
  EXPECT_TRUE(answersBeforeTheNextCycle(world));
}

TEST(Network, ShowsTheTimeOfTheLastCommand) {
  RobotWorld world;
  world.boot();
  world.now += 1ms;
  CallCommand call;
  call.function = [](Time) { return Answer(); };
  (void)world.call(call);
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  EXPECT_EQ(snapshot.now, world.now);
}

TEST(Network, ShowsItsAxesNodesAndGroups) {
  RobotWorld world;
  for (std::uint8_t part = 1; part <= 4; ++part) {
    world.drives[1].objects[{0x1018, part}] = {part, 0, 0, 0};
  }
  world.enable();
  ASSERT_TRUE(world.move({1.0, -1.0}, 1.0).success);
  world.run(500ms);
  world.drives[0].silent = true;
  world.run(60ms);
  NetworkSnapshot shot;
  world.network.fill(shot);
  drive::Axis& elbow = world.axis(1);
  EXPECT_GT(shot.statistics.cycles(), 100u);
  EXPECT_FALSE(shot.shut_down);
  EXPECT_EQ(shot.axes[1].state.state, drive::State::operation_enabled);
  EXPECT_LT(shot.axes[1].state.position, -0.4);
  EXPECT_EQ(shot.axes[1].target, elbow.target());
  EXPECT_LT(shot.axes[1].target, -0.4);
  EXPECT_EQ(shot.axes[1].procedure, ProcedureKind::enable);
  EXPECT_FALSE(shot.axes[1].procedure_running);
  EXPECT_EQ(shot.axes[1].node.changes, elbow.device().changes());
  EXPECT_EQ(shot.axes[1].node.nmt, canopen::NmtState::operational);
  EXPECT_GT(shot.axes[1].node.last_heartbeat, world.now - 200ms);
  EXPECT_EQ(shot.axes[1].node.boot_ups, 1u);
  EXPECT_EQ(shot.axes[1].node.identity.vendor_id, 1u);
  EXPECT_EQ(shot.axes[1].node.identity.serial, 4u);
  EXPECT_TRUE(shot.axes[1].node.supervision.watched);
  EXPECT_FALSE(shot.axes[1].node.may_be_absent);
  EXPECT_EQ(shot.axes[0].stale_feedback, 1u);
  EXPECT_EQ(shot.axes[1].stale_feedback, 0u);
  ASSERT_EQ(shot.groups.size(), 1u);
  EXPECT_TRUE(shot.groups[0].stopping);
  EXPECT_FALSE(shot.groups[0].executing);
  world.drives[1].deaf_to_controlword = true;
  const auto disabling = world.begin(ProcedureKind::disable, "elbow");
  world.run(20ms);
  world.network.fill(shot);
  EXPECT_EQ(shot.axes[1].procedure, ProcedureKind::disable);
  EXPECT_TRUE(shot.axes[1].procedure_running);
  world.network.beginShutdown(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.network.shutDown(); }, 2s));
  world.network.fill(shot);
  EXPECT_TRUE(shot.shut_down);
}

TEST(Network, ShowsThatAnOptionalDriveIsNotThere) {
  config::RobotConfig config = test::testRobot();
  config.devices[1].boot.optional = true;
  RobotWorld world(config);
  world.drives[1].silent = true;
  world.network.start(world.now);
  world.run(5s);
  NetworkSnapshot shot;
  world.network.fill(shot);
  EXPECT_FALSE(shot.axes[0].node.may_be_absent);
  EXPECT_TRUE(shot.axes[1].node.may_be_absent);
}

TEST(Network, RefusesToAskAStoppedDriveAndSaysSo) {
  RobotWorld world;
  world.boot();
  const auto stopped = world.begin(NmtServiceCommand{"shoulder", "stop"});
  world.run(20ms);
  world.network.receive(can::Frame(0x701, {0x04}), world.now, world.now);
  ASSERT_EQ(world.node(0).nmtState(), canopen::NmtState::stopped);
  SaveDcfCommand save;
  save.axis = "shoulder";
  const auto history = world.begin(ErrorHistoryCommand{"shoulder"});
  const auto dcf = world.begin(save);
  ASSERT_EQ(history->size(), 1u);
  EXPECT_THAT(history->front().message,
              HasSubstr("shoulder (node 1): its error history (1003h) cannot be asked for"));
  ASSERT_EQ(dcf->size(), 1u);
  EXPECT_THAT(dcf->front().message,
              HasSubstr("shoulder (node 1): its objects for a DCF cannot be asked for"));
}

TEST(Network, ShowsADriveThatInsistsOnACobIdWhichNobodyForesaw) {
  RobotWorld world;
  world.boot();
  const auto insists = [&](std::size_t axis) {
    NetworkSnapshot snapshot;
    world.network.fill(snapshot);
    return snapshot.axes[axis].node.own_cob_ids;
  };
  EXPECT_FALSE(insists(0));
  EXPECT_FALSE(insists(1));
  world.network.master().nodes()[1].image().setCobId(canopen::PdoDirection::tpdo, 1, 0x1E5);
  EXPECT_FALSE(insists(0));
  EXPECT_TRUE(insists(1));
}

TEST(Network, ShowsTheTimeThatItWasGivenLast) {
  RobotWorld world;
  for (test::FakeDrive& drive : world.drives) drive.silent = true;
  world.network.start(world.now);
  world.run(100ms);
  world.network.tick(world.now);
  EXPECT_EQ(world.network.now(), world.now) << "though nothing is received";
  const Time later = world.now + 50ms;
  world.network.produceSync(later);
  EXPECT_EQ(world.network.now(), later);
  world.network.receive(can::Frame(0x701, {0x05}), later, later + 1ms);
  EXPECT_EQ(world.network.now(), later + 1ms);
  world.network.busLost("can0 is bus-off", later + 2ms);
  EXPECT_EQ(world.network.now(), later + 2ms);
}

TEST(Network, ASetPointThatIsNotTakenIsAnsweredWithTheReason) {
  RobotWorld world;
  world.boot();
  const auto answers = world.begin(SetpointCommand{0, 0.5});
  ASSERT_EQ(answers->size(), 1u);
  EXPECT_FALSE(answers->front().success);
  EXPECT_EQ(answers->front().message, world.axis(0).motionRefusal());
  EXPECT_EQ(world.call(world.trajectory("leg", {})).message, "there is no group \"leg\"");
}

TEST(Network, AProcedureGoesOnWithAnAnswerBySdoBeforeTheNextCycle) {
  config::RobotConfig config = test::testRobot();
  auto profile = std::make_shared<drive::DriveProfile>(*config.axes[0].profile);
  ASSERT_EQ(profile->homing.writes.size(), 1u);
  profile->homing.writes.push_back(profile->homing.writes.front());
  config.axes[0].profile = profile;
  config.axes[0].homing = test::homingOfOrder(0);
  RobotWorld world(config);
  world.enable();
  ASSERT_TRUE(world.runUntil([&] { return world.network.cycle().lastCycle() == world.now; }));
  drive::ProcedureRequest home;
  home.kind = ProcedureKind::home;
  ASSERT_TRUE(world.axis(0).start(home, world.now));
  world.drives[0].written.clear();
  ASSERT_TRUE(world.runUntil([&] { return !world.drives[0].written.empty(); }));
  const Time cycle = world.network.cycle().lastCycle();
  world.run(1ms);
  world.network.tick(world.now);
  EXPECT_EQ(world.network.cycle().lastCycle(), cycle);
  EXPECT_EQ(world.drives[0].written.size(), 2u) << "the second follows the first";
}

}  // namespace
}  // namespace cia402::bus
