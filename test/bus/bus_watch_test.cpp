// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/bus_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using can::BusState;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct FakeInterface final : can::Interface {
  bool send(const can::Frame&) override { return true; }
  std::optional<can::ReceivedFrame> receive(Time) override { return std::nullopt; }
  void maintain(Time) override {}
  int fd() const override { return -1; }
  BusState state() const override { return now; }
  const can::BusCounters& counters() const override { return counted; }
  std::string describe() const override { return words; }
  std::string recovery() const override { return remedy; }
  BusState now = BusState::missing;
  can::BusCounters counted;
  std::string words = "can0 is missing", remedy;
};

struct BusWatchTest : testing::Test, EventSink {
  void onEvent(const Event& event) override {
    texts.push_back(event.text.str());
    severities.push_back(event.severity);
  }
  void update(Duration later = 0ms) {
    now += later;
    watch.update(interface, world.robot, now);
  }
  void become(BusState state, const std::string& words, Duration later = 1ms) {
    interface.now = state;
    interface.words = words;
    update(later);
  }
  test::RobotWorld world;
  FakeInterface interface;
  std::vector<std::string> texts;
  std::vector<Event::Severity> severities;
  BusWatch watch{*this};
  Time now{10s};
};

TEST_F(BusWatchTest, StartsTheRobotOnceTheBusIsThere) {
  update();
  EXPECT_FALSE(world.robot.started());
  become(BusState::down, "can0 is down");
  become(BusState::bus_off, "can0 is off");
  EXPECT_FALSE(world.robot.started());
  become(BusState::error_active, "can0 is up");
  EXPECT_TRUE(world.robot.started());
  EXPECT_THAT(texts, ElementsAre("can0 is missing", "can0 is down", "can0 is off", "can0 is up"));
  EXPECT_EQ(severities.front(), Event::Severity::error);
  EXPECT_EQ(severities.back(), Event::Severity::info);
}

TEST_F(BusWatchTest, TellsAChangeOnlyOnceAndKeepsTheTextFresh) {
  become(BusState::error_passive, "can0 is passive");
  EXPECT_EQ(severities.back(), Event::Severity::warning);
  texts.clear();
  interface.words = "can0 is passive (transmit errors 130)";
  update(199ms);
  EXPECT_EQ(watch.text(), "can0 is passive");
  update(1ms);
  EXPECT_EQ(watch.text(), "can0 is passive (transmit errors 130)");
  EXPECT_THAT(texts, IsEmpty());
}

TEST_F(BusWatchTest, TellsWhatIsDoneAboutBusOffOnce) {
  become(BusState::bus_off, "can0 is off");
  texts.clear();
  interface.remedy = "may not restart it";
  update(200ms);
  update(200ms);
  EXPECT_THAT(texts, ElementsAre("may not restart it"));
}

TEST_F(BusWatchTest, SumsUpAStateThatFlutters) {
  for (int i = 0; i < 100; ++i) {
    become(BusState::error_warning, "can0 warns");
    become(BusState::error_active, "can0 is up");
  }
  EXPECT_EQ(texts.size(), 6u);
  texts.clear();
  update(5s);
  EXPECT_THAT(texts,
              ElementsAre(HasSubstr("can0 became error warning 97 times in the last 5 s, now "
                                    "it is error active"),
                          HasSubstr("can0 became error active 97 times")));
}

TEST_F(BusWatchTest, LetsTheRobotRefuseCommandsWhileTheBusIsLost) {
  become(BusState::error_active, "can0 is up");
  become(BusState::down, "can0 is down");
  EXPECT_THAT(world.call(drive::ProcedureKind::enable).message,
              HasSubstr("refused: can0 is down, nothing reaches the drive"));
}

}  // namespace
}  // namespace cia402::bus
