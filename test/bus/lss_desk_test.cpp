// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/lss_desk.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

const can::Frame kWaiting(0x7E5, {0x04, 0, 0, 0, 0, 0, 0, 0});

/// Sends one frame and ends when nobody may answer it any more.
class OneFrame : public canopen::LssTask {
 public:
  explicit OneFrame(std::uint8_t number, std::string error = {}, bool confirmed = false)
      : number_(number), error_(std::move(error)), confirmed_(confirmed) {}

 private:
  Status proceed(canopen::LssMaster& master, Time now) override {
    if (asked_ && !master.ok()) return fail("nobody is there");
    if (asked_) return error_.empty() ? done("well") : fail(error_);
    asked_ = true;
    canopen::LssRequest request;
    request.frames = {can::Frame(0x7E5, {number_, 0, 0, 0, 0, 0, 0, 0})};
    request.answer = static_cast<canopen::lss::Command>(number_);
    request.confirmed = confirmed_;
    request.attempts = 1;
    return ask(master, now, "sending " + std::to_string(number_), std::move(request));
  }
  std::uint8_t number_;
  std::string error_;
  bool confirmed_, asked_ = false;
};

class LssDeskTest : public testing::Test, private can::Sink {
 protected:
  struct Result {
    std::string who, error, result;
    Time when;
  };
  void add(const std::string& who, std::uint8_t number, std::string error = {},
           LssDesk::Refusal refusal = {}, std::optional<Duration> window = {}) {
    add(who, std::make_unique<OneFrame>(number, std::move(error)), std::move(refusal), window);
  }
  void add(const std::string& who, std::unique_ptr<OneFrame> task, LssDesk::Refusal refusal = {},
           std::optional<Duration> window = {}) {
    desk.add(
        who, std::move(task),
        [this, who](const canopen::LssTask& ended, const std::string& why, Time when) {
          ended_.push_back({who, why, ended.result(), when});
        },
        std::move(refusal), window);
  }
  /// As its owner does: whenever it is due.
  void run(Duration duration) {
    for (const Time end = now + duration; now < end && desk.busy();) {
      now = std::max(now, std::min(end, desk.nextDeadline()));
      desk.tick(now);
    }
  }
  std::vector<unsigned> numbers() const {
    std::vector<unsigned> all;
    for (const can::Frame& frame : sent) all.push_back(frame.data[0]);
    return all;
  }

  Time now{1s};
  std::vector<can::Frame> sent;
  std::vector<Result> ended_;
  LssDesk desk{*this};

 private:
  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    return true;
  }
};

TEST_F(LssDeskTest, HasNothingToDoWithoutATask) {
  EXPECT_FALSE(desk.busy());
  EXPECT_EQ(desk.who(), "");
  EXPECT_EQ(desk.step(), "");
  EXPECT_EQ(desk.nextDeadline(), kNever);
  desk.tick(now);
  desk.abandon("the end", now);
  EXPECT_TRUE(sent.empty());
}

TEST_F(LssDeskTest, CarriesTasksOutOneAfterTheOther) {
  add("left", 1);
  add("right", 2);
  EXPECT_TRUE(desk.busy());
  EXPECT_LE(desk.nextDeadline(), now) << "the first waits to be begun";
  EXPECT_TRUE(sent.empty());
  desk.tick(now);
  EXPECT_EQ(desk.who(), "left");
  EXPECT_EQ(desk.step(), "LSS: sending 1");
  EXPECT_EQ(desk.nextDeadline(), Time(1020ms)) << "the usual window";
  run(15ms);
  EXPECT_EQ(numbers(), (std::vector<unsigned>{1}));
  run(10ms);
  EXPECT_EQ(numbers(), (std::vector<unsigned>{1, 2}));
  EXPECT_EQ(desk.who(), "right");
  run(1s);
  EXPECT_FALSE(desk.busy());
  ASSERT_EQ(ended_.size(), 2u);
  EXPECT_EQ(ended_[0].who, "left");
  EXPECT_EQ(ended_[0].error, "");
  EXPECT_EQ(ended_[0].result, "well");
  EXPECT_EQ(ended_[0].when, Time(1020ms));
  EXPECT_EQ(ended_[1].who, "right");
  EXPECT_EQ(ended_[1].when, Time(1040ms));
}

TEST_F(LssDeskTest, TellsTheErrorOfATaskThatFailsAndGoesOn) {
  add("left", 1, "while selecting: nobody answered");
  add("right", 2);
  run(1s);
  ASSERT_EQ(ended_.size(), 2u);
  EXPECT_EQ(ended_[0].error, "while selecting: nobody answered");
  EXPECT_EQ(ended_[1].error, "");
}

TEST_F(LssDeskTest, AWindowIsThatOfItsTaskAlone) {
  add("scan", 1, {}, {}, 50ms);
  add("next", 2);
  add("quick", 3, {}, {}, 5ms);
  run(1s);
  ASSERT_EQ(ended_.size(), 3u);
  EXPECT_EQ(ended_[0].when, Time(1050ms));
  EXPECT_EQ(ended_[1].when, Time(1070ms));
  EXPECT_EQ(ended_[2].when, Time(1075ms));
}

TEST_F(LssDeskTest, AsksWhetherATaskMayBeginOnceAndWhenItsTurnHasCome) {
  int asked = 0;
  std::string why;
  add("first", 1);
  add("second", 2, {}, [&] {
    ++asked;
    return why;
  });
  desk.tick(now);
  EXPECT_EQ(asked, 0);
  why = "refused: left moves";  // by then
  add("third", 3);
  run(1s);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(numbers(), (std::vector<unsigned>{1, 3})) << "the second did not begin";
  ASSERT_EQ(ended_.size(), 3u);
  EXPECT_EQ(ended_[1].who, "second");
  EXPECT_EQ(ended_[1].error, "refused: left moves");
  EXPECT_EQ(ended_[2].error, "");

  why.clear();
  add("fourth", 4, {}, [&] {
    ++asked;
    return why;
  });
  desk.tick(now);
  why = "refused: left moves";  // too late for this one
  run(1s);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(ended_.back().error, "");
}

TEST_F(LssDeskTest, TheEndOfATaskMayAddAnother) {
  desk.add("set", std::make_unique<OneFrame>(std::uint8_t{1}),
           [this](const canopen::LssTask&, const std::string&, Time) { add("activate", 2); });
  run(1s);
  EXPECT_EQ(numbers(), (std::vector<unsigned>{1, 2}));
  ASSERT_EQ(ended_.size(), 1u);
  EXPECT_EQ(ended_[0].who, "activate");
}

TEST_F(LssDeskTest, NobodyNeedsToBeToldOfAnEnd) {
  desk.add("set", std::make_unique<OneFrame>(std::uint8_t{1}), nullptr);
  run(1s);
  EXPECT_FALSE(desk.busy());
  desk.add("set", std::make_unique<OneFrame>(std::uint8_t{1}), nullptr);
  desk.abandon("the end", now);
  EXPECT_FALSE(desk.busy());
}

TEST_F(LssDeskTest, HandsAnswersToTheTaskAndNothingElse) {
  for (const std::uint32_t id : {0x7E4U, 0x7E5U}) {
    add("asks", std::make_unique<OneFrame>(std::uint8_t{0x5E}, "", true));
    desk.tick(now);
    desk.receive(can::Frame(id, {0x5E, 5, 0, 0, 0, 0, 0, 0}), now + 2ms);
    run(1s);
    EXPECT_EQ(ended_.back().error, id == 0x7E4 ? "" : "nobody is there");
  }
}

TEST_F(LssDeskTest, AbandonedAllAreToldWhyAndNoDeviceStaysInTheConfigurationState) {
  add("left", 1);
  add("right", 2);
  desk.tick(now);
  now += 5ms;
  desk.abandon("ended by the shutdown of the driver", now);
  EXPECT_FALSE(desk.busy());
  EXPECT_EQ(desk.nextDeadline(), kNever);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[1], kWaiting);
  ASSERT_EQ(ended_.size(), 2u);
  for (const Result& result : ended_) {
    EXPECT_EQ(result.error, "ended by the shutdown of the driver");
    EXPECT_EQ(result.when, Time(1005ms));
  }
  add("later", 3);  // finds no request of before under way
  desk.tick(now);
  EXPECT_EQ(sent.back().data[0], 3);
}

}  // namespace
}  // namespace cia402::bus
