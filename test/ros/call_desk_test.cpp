// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/call_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ros/callback.h"

namespace cia402::ros_node {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct CallDeskTest : testing::Test {
  /// A service whose calls begin something that ends when its reply is given.
  ros::CallbackQueueInterface* service(const std::string& name) {
    return desk.queueFor([this, name](bus::Reply<> reply) {
      begun.push_back(name);
      replies.push_back(std::move(reply));
    });
  }
  void call(ros::CallbackQueueInterface* queue) {
    queue->addCallback(
        boost::make_shared<Callback>([this] { answers.push_back(desk.current().message); }), 1);
  }

  int wakes = 0;
  CallDesk desk{[this] { ++wakes; }};
  std::vector<std::string> begun, answers;
  std::vector<bus::Reply<>> replies;
};

TEST_F(CallDeskTest, BeginsEveryCallWhenItArrivesWhoeverWaits) {
  ros::CallbackQueueInterface* const home = service("home");
  ros::CallbackQueueInterface* const stop = service("quick_stop");
  for (int i = 0; i < 3; ++i) call(home);
  call(stop);
  call(stop);
  EXPECT_THAT(begun, ElementsAre("home", "home", "home", "quick_stop", "quick_stop"));
  desk.answer();
  EXPECT_THAT(answers, IsEmpty());
  EXPECT_EQ(wakes, 0);
  for (const bus::Reply<>& reply : replies) reply(bus::answerOf(true, "ended"));
  desk.answer();
  EXPECT_EQ(answers.size(), 5U);
}

TEST_F(CallDeskTest, AnswersInTheOrderOfTheReplies) {
  ros::CallbackQueueInterface* const home = service("home");
  ros::CallbackQueueInterface* const stop = service("quick_stop");
  call(home);
  call(stop);
  call(stop);
  replies[2](bus::answerOf(true, "second stop"));
  desk.answer();
  EXPECT_THAT(answers, ElementsAre("second stop"));
  replies[1](bus::answerOf(true, "first stop"));
  replies[0](bus::answerOf(true, "home"));
  EXPECT_EQ(wakes, 3);
  desk.answer();
  EXPECT_THAT(answers, ElementsAre("second stop", "first stop", "home"));
  desk.answer();
  EXPECT_EQ(answers.size(), 3U);
}

TEST_F(CallDeskTest, AnswersACallThatIsRefusedAtOnce) {
  call(desk.queueFor([](const bus::Reply<>& reply) { bus::refuse(reply, "refused"); }));
  EXPECT_EQ(wakes, 1);
  desk.answer();
  EXPECT_THAT(answers, ElementsAre("refused"));
}

TEST_F(CallDeskTest, ForgetsCallsThatWereAnsweredTooLate) {
  const auto watch = std::make_shared<int>(0);
  std::vector<bus::Reply<>> late;
  {
    CallDesk closing([] {});
    closing.queueFor([&](bus::Reply<> reply) { late.push_back(std::move(reply)); })
        ->addCallback(boost::make_shared<Callback>([watch] {}), 1);
    late[0](bus::answerOf(true, "too late"));
  }
  EXPECT_EQ(watch.use_count(), 1);
}

// As the thread of the bus gives them while the node's thread answers.
TEST(CallDesk, TakesRepliesFromOtherThreads) {
  constexpr int kThreads = 4, kCalls = 2000;
  std::atomic<int> wakes{0};
  CallDesk desk([&] { ++wakes; });
  ros::CallbackQueueInterface* const queue =
      desk.queueFor([](const bus::Reply<>& reply) { bus::refuse(reply, "done"); });
  std::atomic<int> ended{0};
  int answers = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int n = 0; n < kCalls; ++n) {
        queue->addCallback(boost::make_shared<Callback>([&] {
                             EXPECT_EQ(desk.current().message, "done");
                             ++answers;
                           }),
                           1);
      }
      ++ended;
    });
  }
  while (ended < kThreads) desk.answer();
  for (std::thread& thread : threads) thread.join();
  desk.answer();
  EXPECT_EQ(answers, kThreads * kCalls);
  EXPECT_EQ(wakes, kThreads * kCalls);
}

}  // namespace
}  // namespace cia402::ros_node
