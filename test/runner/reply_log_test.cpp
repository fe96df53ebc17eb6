// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/reply_log.h"

#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> texts(ReplyLog& log, ReplyLog::Level level) {
  std::vector<std::string> found;
  ReplyLog::Entry entry;
  while (log.next(entry)) {
    EXPECT_EQ(entry.level, level);
    found.push_back(entry.text.str());
  }
  return found;
}

TrajectoryAnswer trajectoryAnswer(bool success, const std::string& message) {
  TrajectoryAnswer answer;
  answer.success = success;
  answer.message = message;
  return answer;
}

TEST(Throttle, PermitsOnceInAnInterval) {
  Throttle throttle(1s);
  EXPECT_TRUE(throttle.permit(Time(0s)));
  EXPECT_FALSE(throttle.permit(Time(999ms)));
  EXPECT_TRUE(throttle.permit(Time(1s)));
  EXPECT_FALSE(throttle.permit(Time(1s)));
  EXPECT_TRUE(throttle.permit(Time(1h)));
}

TEST(ReplyLog, HoldsBackTheRefusedStreamOfOneAxisAndNotThatOfAnother) {
  ReplyLog log(2);
  const Reply<> left = log.toSetpoint(0), right = log.toSetpoint(1);
  for (int i = 0; i < 5; ++i) left(answerOf(false, "left: refused"));
  for (int i = 0; i < 5; ++i) log.toSetpoint(1)(answerOf(false, "right: refused"));
  EXPECT_THAT(texts(log, ReplyLog::Level::warning), ElementsAre("left: refused", "right: refused"));
  EXPECT_EQ(log.lost(), 0u) << "what is held back is not lost";
}

TEST(ReplyLog, HoldsBackTheRefusedStreamOfOneGroupAndNotThatOfItsAxis) {
  ReplyLog log(1, 2);
  for (int i = 0; i < 5; ++i) {
    log.toGroupSetpoints(0)(answerOf(false, "arm: refused"));
    log.toGroupSetpoints(1)(answerOf(false, "head: refused"));
    log.toSetpoint(0)(answerOf(false, "left: refused"));
  }
  EXPECT_THAT(texts(log, ReplyLog::Level::warning),
              ElementsAre("arm: refused", "head: refused", "left: refused"));
}

TEST(ReplyLog, SaysNothingOfASetpointThatIsTaken) {
  ReplyLog log(1);
  log.toSetpoint(0)(answerOf(true, "taken"));
  EXPECT_THAT(texts(log, ReplyLog::Level::warning), IsEmpty());
}

TEST(ReplyLog, TellsEveryRefusedTrajectoryAsAnError) {
  ReplyLog log(0);
  for (int i = 0; i < 3; ++i) log.toTrajectory()(trajectoryAnswer(false, "arm: refused"));
  EXPECT_THAT(texts(log, ReplyLog::Level::error),
              ElementsAre("arm: refused", "arm: refused", "arm: refused"));
  log.toTrajectory()(trajectoryAnswer(true, "arm: accepted"));
  EXPECT_THAT(texts(log, ReplyLog::Level::debug), ElementsAre("arm: accepted"));
}

TEST(ReplyLog, WarnsOfATrajectoryThatBeginsLate) {
  ReplyLog log(0);
  TrajectoryAnswer late = trajectoryAnswer(true, "arm: accepted without the first point");
  late.passed_points = 1;
  log.toTrajectory()(late);
  EXPECT_THAT(texts(log, ReplyLog::Level::warning),
              ElementsAre("arm: accepted without the first point"));
}

TEST(ReplyLog, CountsWhatNobodyTakesInsteadOfWaiting) {
  ReplyLog log(0);
  const auto reply = log.toTrajectory();
  for (int i = 0; i < 300; ++i) reply(trajectoryAnswer(false, std::to_string(i)));
  const auto kept = texts(log, ReplyLog::Level::error);
  EXPECT_EQ(kept.size() + log.lost(), 300u);
  EXPECT_GT(log.lost(), 0u);
  EXPECT_EQ(kept.front(), "0") << "the first are the ones to know";
}

TEST(ReplyLog, TakesRepliesOfTwoThreadsAtOnce) {
  ReplyLog log(0);
  const auto refuse_often = [&log] {
    for (int i = 0; i < 1000; ++i) log.toTrajectory()(trajectoryAnswer(false, "arm: refused"));
  };
  std::thread bus(refuse_often), ros(refuse_often);
  std::size_t taken = 0;
  for (bool ended = false; !ended;) {
    ended = taken + log.lost() == 2000;
    for (const std::string& text : texts(log, ReplyLog::Level::error)) {
      EXPECT_EQ(text, "arm: refused");
      ++taken;
    }
  }
  bus.join();
  ros.join();
  EXPECT_EQ(taken + log.lost(), 2000u);
}

}  // namespace
}  // namespace cia402::bus
