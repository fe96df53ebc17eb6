// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the player itself finds, what its commands permit, and that it plays a scene alike twice.
#include "campaign/player_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

// --- answers

TEST_F(PlayerTest, FindsACallThatIsNotAnsweredInTime) {
  const auto loses = [](Tapped& player, Stage&) { player.loses = true; };
  EXPECT_EQ(play({"2 halt a1", "7 end"}, playedRobot("cyclic_position"), loses),
            "late_answer a1 at 6.001 s")
      << "4 s are the time of a halt";
}

TEST_F(PlayerTest, WaitsForAnAnswerAsLongAsTheCallMayTake) {
  const auto loses = [](Tapped& player, Stage&) { player.loses = true; };
  EXPECT_EQ(play({"2 disable a1", "17.9 end"}, playedRobot("cyclic_position"), loses), "");
}

TEST_F(PlayerTest, WaitsLongerByWhatTheHostStoodStill) {
  const auto loses = [](Tapped& player, Stage&) { player.loses = true; };
  EXPECT_EQ(play({"2 halt a1", "3 stall 0.5", "7 end"}, playedRobot("cyclic_position"), loses),
            "late_answer a1 at 6.501 s");
}

TEST_F(PlayerTest, WaitsForNoAnswerOfAProcessThatWasKilled) {
  const auto loses = [](Tapped& player, Stage&) { player.loses = true; };
  EXPECT_EQ(play({"2 halt a1", "3 kill 0.1", "9 end"}, playedRobot("cyclic_position"), loses), "");
}

TEST_F(PlayerTest, FindsACallThatIsAnsweredTwice) {
  const auto twice = [](Tapped& player, Stage&) { player.doubles = true; };
  const std::string findings =
      play({"2 enable a1", "4 end"}, playedRobot("cyclic_position"), twice);
  EXPECT_EQ(findings.substr(0, findings.find(" at")), "answered_twice a1");
}

TEST_F(PlayerTest, FindsNothingInCallsThatAreAnsweredOnce) {
  EXPECT_EQ(play({"2 enable a1", "3 halt a1", "4 disable a1", "6 end"}), "");
}

TEST_F(PlayerTest, FindsAnAnswerThatIsNotTrueOfTheMotor) {
  const auto lies = [](Tapped& player, Stage&) {
    player.tap = [&player] {
      player.loses = true;
      player.reply(bus::answerOf(true, "done"));
    };
  };
  EXPECT_EQ(play({"2 enable a1", "3 end"}, playedRobot("cyclic_position"), lies),
            "untrue_answer a1 at 2 s");
}

// --- power

TEST_F(PlayerTest, ExcusesPowerThatIsLostInMotionForACause) {
  for (const char* cause :
       {"5 fault a1 overcurrent", "5 power a1 0.5", "5 foreign_nmt a1 reset_node"}) {
    EXPECT_EQ(play({"2 enable a1", "4 goal g1 2.0 0.6", cause, "7 end"}), "") << cause;
  }
}

TEST_F(PlayerTest, FindsPowerThatIsLostInMotionWithoutACause) {
  const auto cuts = [](Tapped& player, Stage& stage) {
    player.tap = [&stage] {
      if (stage.now() >= Time(5s)) stage.world().drive(0).powerOff(stage.now());
    };
  };
  const std::string findings =
      play({"2 enable a1", "4 goal g1 2.0 0.6", "5 read a1 6041:00", "5.1 end"},
           playedRobot("cyclic_position"), cuts);
  EXPECT_EQ(findings.substr(0, 28), "power_at_speed a1 at 5.001 s");
}

// --- the end of a process

TEST_F(PlayerTest, FindsAProcessThatDoesNotEndInTime) {
  // It gets the processor again 20 s after it was asked to end.
  const auto sleeps = [](Tapped&, Stage& stage) {
    stage.host().setLateness([&stage] { return stage.now() > Time(2s) ? 20s : 0s; });
  };
  EXPECT_EQ(play({"3 shutdown 0", "6 end"}, playedRobot("cyclic_position"), sleeps),
            "late_shutdown  at 5.5 s");
  EXPECT_EQ(play({"3 shutdown 1", "7 end"}, playedRobot("cyclic_position"), sleeps),
            "late_shutdown  at 5.5 s")
      << "however long it is gone";
}

TEST_F(PlayerTest, FindsNothingInAProcessThatEndsInTime) {
  EXPECT_EQ(play({"2 enable a1", "4 shutdown 0.5", "9 end"}), "");
}

TEST_F(PlayerTest, ExcusesAProcessThatHadNoProcessor) {
  EXPECT_EQ(play({"3 shutdown 0", "3.001 stall 3", "8 end"}), "");
}

// --- what may move an axis

TEST_F(PlayerTest, PermitsATargetUntilTheMotorHasStoodAtIt) {
  // 1 rad at 1 rad/s and 4 rad/s^2: 1.25 s; the motor lags by some milliseconds.
  EXPECT_EQ(play({"2 enable a1", "4 stream a1 1 0.01 100", "8 end"}), "");
  EXPECT_GT(permitAtEnd(), 4 + 1.25 + 0.4);
  EXPECT_LT(permitAtEnd(), 4 + 1.25 + 0.4 + 0.1);
}

// command_timeout 0.2 s, 4 cycles of 4 ms, 1.2 * 0.5 / 4 + 0.15 s to stop.
TEST_F(PlayerTest, PermitsAVelocityUntilItIsOutOfDateAndTheMotorStops) {
  EXPECT_EQ(
      play({"2 enable a1", "4 stream a1 0.5 0.01 100", "8 end"}, playedRobot("cyclic_velocity")),
      "");
  EXPECT_NEAR(permitAtEnd(), 4 + 0.2 + 0.016 + 0.3, 0.006);
}

// The speed is that of the limit: 1.2 * 1 / 4 + 0.15 s.
TEST_F(PlayerTest, PermitsAnEffortUntilItIsOutOfDateAndTheMotorStops) {
  play({"2 enable a1", "4 stream a1 1 0.01 100", "8 end"},
       playedRobot("cyclic_torque", ", modes: [cyclic_torque, cyclic_position]"));
  const Time until = told("the stream of efforts ended").until;
  EXPECT_NEAR(seconds(until), 4 + 0.2 + 0.016 + 0.45, 0.006);
}

TEST_F(PlayerTest, PermitsNothingBySetPointsThatAreRefused) {
  play({"4 stream a1 0.5 0.01 100", "8 end"});  // the axis is not enabled
  EXPECT_EQ(permitAtEnd(), 0.0);
}

TEST_F(PlayerTest, PermitsATrajectoryUntilAQuarterOfASecondAfterItsLastPoint) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 1.0 0.3", "8 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 4 + 1.0 + 0.25, 0.006);
}

TEST_F(PlayerTest, PermitsATrajectoryLaterByWhatTheHostStoodStill) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 1.0 0.3", "4.5 stall 0.1", "8 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 4 + 1.0 + 0.25 + 0.1, 0.006);
}

TEST_F(PlayerTest, PermitsATrajectoryThatIsRefusedNothing) {
  play({"2 enable a1", "4 goal g1 0.01 2.5", "8 end"});
  EXPECT_EQ(permitAtEnd(), 0.0);
}

TEST_F(PlayerTest, PermitsATrajectoryLaterByAsLongAsTheHostIsLateNowAndThen) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 3.0 0.3", "5 late 0 1", "5.001 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 4 + 3.0 + 0.25 + 1.0, 0.006);
}

TEST_F(PlayerTest, PermitsCommandsHalfASecondLongerWhileFramesAreLost) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 3.0 0.3", "5 loss 0 1", "5.001 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 4 + 3.0 + 0.25 + 0.5, 0.006);
}

// Halfway a cubic of 0.6 rad in 2 s has 1.5 * 0.6 / 2 = 0.45 rad/s.
TEST_F(PlayerTest, PermitsAnEmptyTrajectoryTheTimeToStop) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 2.0 0.6", "5 stop g1", "8 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 5 + 1.2 * 0.45 / 4 + 0.15, 0.02);
}

TEST_F(PlayerTest, PermitsNothingOfBeforeAfterAnAnswerThatItStands) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 3.0 0.9", "5 halt a1", "8 end"}), "");
  const Told& answer = told("< halt");
  EXPECT_NEAR(seconds(answer.until), 4 + 3.0 + 0.25, 0.006) << "till then the trajectory holds";
  EXPECT_NEAR(permitAtEnd(), seconds(answer.at), 1e-9);
}

TEST_F(PlayerTest, PermitsNothingOfBeforeAfterAnswersThatThePowerIsOff) {
  for (const char* verb : {"quick_stop", "disable"}) {
    told_.clear();
    EXPECT_EQ(play({"2 enable a1", "4 goal g1 3.0 0.9", std::string("5 ") + verb + " a1", "8 end"}),
              "");
    EXPECT_LE(permitAtEnd(), seconds(told(std::string("< ") + verb).at)) << verb;
    EXPECT_GT(permitAtEnd(), 5.0) << verb;
  }
}

// The trajectory begins at 7 s.
TEST_F(PlayerTest, PermitsNothingOfBeforeAfterAnotherMode) {
  const std::string robot =
      playedRobot("cyclic_position", ", modes: [cyclic_position, cyclic_velocity]");
  EXPECT_EQ(
      play({"2 enable a1", "4 path g1 3 1 1 0.6", "5 set_mode a1 cyclic_velocity", "6 end"}, robot),
      "");
  const Told& answer = told("< set_mode");
  EXPECT_NEAR(seconds(answer.until), 7 + 1 + 0.25, 0.006);
  EXPECT_NEAR(permitAtEnd(), seconds(answer.at), 1e-9);
}

TEST_F(PlayerTest, PermitsAsBeforeAfterTheModeThatItIsIn) {
  EXPECT_EQ(play({"2 enable a1", "4 path g1 3 1 1 0.6", "5 set_mode a1 cyclic_position", "6 end"}),
            "");
  EXPECT_NEAR(permitAtEnd(), 7 + 1 + 0.25, 0.006);
}

TEST_F(PlayerTest, PermitsTheTrajectoryThatWentOnAfterAFailure) {
  const auto fails = [](Tapped& player, Stage&) {
    player.tap = [&player] {
      player.loses = player.permits().until(0) > Time(5s);  // the halt, not the enable
      if (player.loses) player.reply(bus::answerOf(false, "no"));
    };
  };
  const std::string found = play({"2 enable a1", "4 goal g1 3.0 0.9", "5 halt a1", "8 end"},
                                 playedRobot("cyclic_position"), fails);
  EXPECT_EQ(found.rfind("slow_stop a1", 0), 0U) << found << ", as nobody stopped it";
  EXPECT_NEAR(permitAtEnd(), 4 + 3.0 + 0.25, 0.006);
}

const char* const kHomesByMoving =
    ", homing: {method: 33, search_velocity: 0.4, zero_velocity: 0.1, acceleration: 4, offset: 0}";

TEST_F(PlayerTest, PermitsAHomingUntilItsAnswer) {
  const std::string robot = playedRobot("cyclic_position", kHomesByMoving);
  EXPECT_EQ(play({"2 home a1", "8 end"}, robot), "");
  const Told& answer = told("< home");
  EXPECT_EQ(answer.until, kNever);
  EXPECT_NEAR(permitAtEnd(), seconds(answer.at), 1e-9);
}

// At most 1.2 * 0.4 / 4 + 0.15 s.
TEST_F(PlayerTest, PermitsAHomingThatFailedTheTimeToStop) {
  const std::string robot = playedRobot("cyclic_position", kHomesByMoving);
  play({"2 home a1", "2.35 fault a1 overtemperature", "8 end"}, robot);
  const Told& answer = told("< home a1 FAILED");
  EXPECT_EQ(answer.until, kNever);
  EXPECT_GE(permitAtEnd(), seconds(answer.at) + 0.15);
  EXPECT_LE(permitAtEnd(), seconds(answer.at) + 0.27);
}

TEST_F(PlayerTest, PermitsADeclaredHomingNothing) {
  const std::string robot = playedRobot("cyclic_position", ", homing: {method: 37, offset: 0.5}");
  EXPECT_EQ(play({"2 home a1", "8 end"}, robot), "");
  EXPECT_EQ(permitAtEnd(), 0.0);
}

// Half of it goes by at 0.45 rad/s: 1.2 * 0.45 / 4 + 0.15 s.
TEST_F(PlayerTest, PermitsAFaultyDriveTheTimeToStop) {
  play({"2 enable a1", "4 goal g1 2.0 0.6", "5 fault a1 overtemperature", "8 end"});
  EXPECT_GT(permitAtEnd(), 5.0);
  EXPECT_LE(permitAtEnd(), 5 + 1.2 * 0.45 / 4 + 0.15 + 0.01);
}

// The drive misses its master after three heartbeats of 0.1 s; 1.2 * 1 / 4 + 0.15 s to stop.
TEST_F(PlayerTest, PermitsADriveWithoutAMasterUntilItMissedItAndStopped) {
  for (const char* gone : {"5 kill 4", "5 cable a1 1", "5 unheard a1 all 1"}) {
    told_.clear();
    EXPECT_EQ(play({"2 enable a1", "4 goal g1 9.0 2.5", gone, "5.001 end"}), "") << gone;
    EXPECT_NEAR(permitAtEnd(), 5 + 0.3 + 0.45 + 0.1, 0.006) << gone;
  }
}

TEST_F(PlayerTest, PermitsADriveThatIsCutOffForLessThanItMissesItsMasterWhatItWasTold) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 5.0 2.5", "5 cable a1 0.05", "5.001 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 4 + 5.0 + 0.25, 0.006);
}

TEST_F(PlayerTest, PermitsADriveThatANewProcessFindsOneSecondAndTheTimeToStop) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 9.0 2.5", "5 kill 0.2", "5.201 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 5.2 + 1.0 + 0.45, 0.006);
}

TEST_F(PlayerTest, PermitsNoMoreThan2300MsFromAnOrderlyShutdown) {
  EXPECT_EQ(play({"2 enable a1", "4 goal g1 9.0 2.5", "5 shutdown 1", "5.001 end"}), "");
  EXPECT_NEAR(permitAtEnd(), 5 + 2.3, 0.001);
}

// --- the same again

TEST(Scenes, OfTheSameSeedGiveTheSameFramesAtTheSameTimes) {
  const auto play = [](std::uint64_t seed) {
    RunOptions options;
    options.config_folder = cia402::test::configFolder();
    const Report report =
        run(sceneOf({"1 enable a1", "2 loss 0.05 1", "2 stream a1 0.5 0.5 100", "3 end"},
                    playedRobot("cyclic_position"), seed),
            options);
    EXPECT_EQ(report.problem, "");
    EXPECT_GT(report.frames, 2000U);
    EXPECT_EQ(report.simulated, 5s);
    return report.fingerprint;
  };
  const std::uint64_t first = play(1);
  EXPECT_EQ(play(1), first);
  EXPECT_NE(play(2), first);
}

}  // namespace
}  // namespace cia402::campaign
