// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracle that compares the driver's answers with what is true finds what it is for.
#include <gtest/gtest.h>

#include <functional>

#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr const char* kStandVerbs[] = {"halt",         "disable", "quick_stop", "set_mode",
                                       "set_position", "save",    "restore",    "home"};
constexpr const char* kOffVerbs[] = {"disable", "save", "restore"};
constexpr const char* kOnVerbs[] = {"enable", "recover"};

class AnswerTest : public OracleTest {
 protected:
  explicit AnswerTest(const std::string& robot = kJudgedRobot) : OracleTest(makeAnswers, robot) {}

  void state(bool power, double speed) {
    truths_[0].power = power;
    truths_[0].velocity = speed;
    look();
  }
  /// It was in this state last so long before the answer, and with power, or in motion, since.
  std::string answerAfter(const std::string& verb, Duration ago, bool power, double speed,
                          bool power_since, double speed_since) {
    findings_.clear();
    state(power, speed);
    mark();
    for (const Time end = now() + ago; now() < end;) state(power_since, speed_since);
    answer(verb, "a1");
    return found();
  }
};

// It stands below 2 % of 1 rad/s, or did in the last 25 ms.
TEST_F(AnswerTest, ThatItStandsIsUntrueOfAMotorThatTurns) {
  for (const std::string verb : kStandVerbs) {
    const bool off = verb == "disable" || verb == "save" || verb == "restore";
    EXPECT_EQ(answerAfter(verb, 26ms, !off, 0.0, !off, 0.025), "untrue_answer a1 +26 ms") << verb;
    EXPECT_EQ(answerAfter(verb, 25ms, !off, 0.0, !off, -0.025), "") << verb;
    EXPECT_EQ(answerAfter(verb, 100ms, !off, 0.0, !off, 0.019), "") << verb;
  }
}

TEST_F(AnswerTest, ThatThePowerIsOffIsUntrueOfADriveWithPower) {
  for (const std::string verb : kOffVerbs) {
    EXPECT_EQ(answerAfter(verb, 26ms, false, 0.0, true, 0.0), "untrue_answer a1 +26 ms") << verb;
    EXPECT_EQ(answerAfter(verb, 25ms, false, 0.0, true, 0.0), "") << verb;
  }
}

TEST_F(AnswerTest, ThatThePowerIsOnIsUntrueOfADriveWithout) {
  for (const std::string verb : kOnVerbs) {
    EXPECT_EQ(answerAfter(verb, 26ms, true, 0.0, false, 0.0), "untrue_answer a1 +26 ms") << verb;
    EXPECT_EQ(answerAfter(verb, 25ms, true, 0.0, false, 0.0), "") << verb;
  }
}

TEST_F(AnswerTest, SaysNoMoreThanItsCallDoes) {
  for (const std::string verb : {"halt", "quick_stop", "set_mode", "set_position"}) {
    EXPECT_EQ(answerAfter(verb, 100ms, true, 0.0, true, 0.0), "") << verb << " with power";
    EXPECT_EQ(answerAfter(verb, 100ms, false, 0.0, false, 0.0), "") << verb << " without";
  }
  for (const std::string verb : kOnVerbs) {
    EXPECT_EQ(answerAfter(verb, 100ms, true, 1.0, true, 1.0), "") << verb << " in motion";
  }
  for (const std::string verb : {"clear_faults", "read", "write"}) {
    EXPECT_EQ(answerAfter(verb, 100ms, true, 1.0, true, 1.0), "") << verb;
  }
}

TEST_F(AnswerTest, ThatFaultsAreClearedIsUntrueOfADriveWithOne) {
  look();
  mark();
  truths_[0].statusword = 0x0008;
  lookFor(25ms);
  answer("clear_faults", "a1");
  EXPECT_EQ(found(), "") << "it may have come since";
  look();
  answer("clear_faults", "a1");
  EXPECT_EQ(found(), "untrue_answer a1 +26 ms");
}

TEST_F(AnswerTest, OfNmtIsUntrueOfADriveInAnotherState) {
  const auto answered = [&](const char* command, canopen::NmtState state,
                            const std::string& message = "done") {
    findings_.clear();
    truths_[0].nmt = state;
    lookFor(26ms);
    mark();
    oracle_->onAnswer(callOf("nmt", "a1", command), bus::answerOf(true, message), view());
    return found();
  };
  using canopen::NmtState;
  const std::string untrue = "untrue_answer a1 +0 ms";
  EXPECT_EQ(answered("stop", NmtState::stopped), "");
  EXPECT_EQ(answered("stop", NmtState::operational), untrue);
  EXPECT_EQ(answered("pre_operational", NmtState::pre_operational), "");
  EXPECT_EQ(answered("pre_operational", NmtState::stopped), untrue);
  for (const char* const command : {"start", "reset_node", "reset_communication"}) {
    EXPECT_EQ(answered(command, NmtState::operational), "") << command;
    EXPECT_EQ(answered(command, NmtState::pre_operational), untrue) << command;
  }
  EXPECT_EQ(answered("stop", NmtState::operational, "the drive has no heartbeat to tell whether"),
            "");
  conditions_.foreign = now() + 1s;
  EXPECT_EQ(answered("stop", NmtState::operational), "") << "another master may have started it";
}

TEST_F(AnswerTest, OfAFailureSaysNothing) {
  truths_[0].velocity = 1.0;
  lookFor(100ms);
  for (const char* verb : kStandVerbs) answer(verb, "a1", false);
  truths_[0].power = false;
  lookFor(100ms);
  for (const char* verb : kOnVerbs) answer(verb, "a1", false);
  EXPECT_EQ(found(), "");
}

TEST_F(AnswerTest, ThatSaysThatTheMotorStillMovesIsTrue) {
  truths_[0].velocity = 1.0;
  lookFor(100ms);
  answer("halt", "a1", true, "done; it still moves");
  EXPECT_EQ(found(), "");
}

TEST_F(AnswerTest, OfAModeWithoutPowerIsNoMatterWhatTurnsTheMotor) {
  EXPECT_EQ(answerAfter("set_mode", 100ms, false, 1.0, false, 1.0), "");
  EXPECT_EQ(answerAfter("halt", 100ms, false, 1.0, false, 1.0), "untrue_answer a1 +100 ms");
}

TEST_F(AnswerTest, IsJudgedOfEachAxisThatItConcerns) {
  truths_[1].velocity = 1.0;
  lookFor(100ms);
  answer("halt", "a1");
  EXPECT_EQ(found(), "");
  answer("halt", "all");
  EXPECT_EQ(allFound(), "untrue_answer a2 +100 ms");
}

// Each takes commands again as soon as it is homed itself.
TEST_F(AnswerTest, ThatAllAreHomedIsTrueWhereOneWasGivenMoreToDo) {
  const Call home = callOf("home", "all");
  truths_[0].velocity = truths_[1].velocity = 1.0;
  lookFor(100ms);
  permits_.allow(0, Permits::Source::stream, now() + 1s);
  oracle_->onAnswer(home, bus::answerOf(true, "done"), view());
  EXPECT_EQ(allFound(), "untrue_answer a2 +100 ms");
}

TEST_F(AnswerTest, ThatThePowerIsOnIsTrueWhereTheStatuswordToldSo) {
  truths_[0].power = false;
  lookFor(100ms);
  frame(0x181, {0x37, 0x06, 0, 0, 0, 0, 0, 0});  // operation enabled
  lookFor(25ms);
  answer("enable", "a1");
  EXPECT_EQ(found(), "");
  look();
  answer("enable", "a1");
  EXPECT_EQ(found(), "untrue_answer a1 +126 ms");
}

TEST_F(AnswerTest, ThatThePowerIsOnIsUntrueWhereTheStatuswordToldSomethingElse) {
  truths_[0].power = false;
  lookFor(100ms);
  frame(0x181, {0x33, 0x06, 0, 0, 0, 0, 0, 0});  // switched on
  frame(0x182, {0x37, 0x06, 0, 0, 0, 0, 0, 0});  // another drive
  answer("enable", "a1");
  EXPECT_EQ(found(), "untrue_answer a1 +100 ms");
}

class SlowCycleAnswerTest : public AnswerTest {
 protected:
  SlowCycleAnswerTest()
      : AnswerTest(
            "bus: {interface: can0, bitrate: 1000000, sync_period: 0.01}\naxes:\n"
            "  a1: {node_id: 1, drive: generic_cia402, counts_per_turn: 4096, gear_ratio: 50.0,\n"
            "    limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4}}\n") {}
};

// Three cycles of 10 ms and 5 ms.
TEST_F(SlowCycleAnswerTest, MaySpeakOfThreeCyclesAgo) {
  EXPECT_EQ(answerAfter("halt", 35ms, true, 0.0, true, 0.1), "");
  EXPECT_EQ(answerAfter("halt", 36ms, true, 0.0, true, 0.1), "untrue_answer a1 +36 ms");
}

}  // namespace
}  // namespace cia402::campaign
