// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
    EXPECT_EQ(event.stamp, now);
  }
  void update(Duration later = 0ms) {
    now += later;
    unseen = watch.update(interface, world.network, now);
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
  std::optional<BusState> unseen;  // what the last update returned
  BusWatch watch{*this};
  Time now{10s};
};

TEST_F(BusWatchTest, StartsTheRobotOnceTheBusIsThere) {
  update();
  EXPECT_FALSE(world.network.started());
  become(BusState::down, "can0 is down");
  become(BusState::bus_off, "can0 is off");
  EXPECT_FALSE(world.network.started());
  become(BusState::error_active, "can0 is up");
  EXPECT_TRUE(world.network.started());
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
  interface.words = "can0 is passive (transmit errors 131)";
  update(199ms);
  EXPECT_EQ(watch.text(), "can0 is passive (transmit errors 130)") << "five times a second";
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

TEST_F(BusWatchTest, TellsWhatIsDoneAnewOnlyIfTheBusWasWellInBetween) {
  become(BusState::bus_off, "can0 is off");
  interface.remedy = "may not restart it";
  update(200ms);
  become(BusState::down, "can0 is down");
  become(BusState::bus_off, "can0 is off");
  update(200ms);
  EXPECT_EQ(std::count(texts.begin(), texts.end(), "may not restart it"), 1);
  become(BusState::error_active, "can0 is up");
  become(BusState::bus_off, "can0 is off");
  update(200ms);
  EXPECT_EQ(std::count(texts.begin(), texts.end(), "may not restart it"), 2);
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

/// The arm moves on a bus that is well.
struct BusWatchOfAMove : BusWatchTest {
  BusWatchOfAMove() {
    world.enable();
    become(BusState::error_active, "can0 is up");
    EXPECT_TRUE(world.move({1.0, -1.0}, 4.0).success);
    world.run(500ms);
    EXPECT_TRUE(world.group().executing());
    now = world.now;
    texts.clear();
    severities.clear();
  }
  void expectStoppedFor(const std::string& reason) {
    EXPECT_FALSE(world.group().executing());
    world.run(1s);
    EXPECT_NE(world.axis(0).state().state, drive::State::operation_enabled);
    EXPECT_EQ(world.eventsWith("stopped: " + reason), 1u) << world.allEvents();
    EXPECT_TRUE(world.call(drive::ProcedureKind::recover).success) << "the bus is there";
  }
};

TEST_F(BusWatchOfAMove, TakesABusOffBetweenTwoLooksForALoss) {
  ++interface.counted.bus_off_events;
  update();
  EXPECT_EQ(unseen, BusState::bus_off);
  EXPECT_THAT(texts, ElementsAre("can0 was bus-off for a moment: check wiring, termination and bit "
                                 "rate; now: can0 is up"));
  EXPECT_THAT(severities, ElementsAre(Event::Severity::error));
  EXPECT_EQ(world.eventsWith("can0 is back"), 1u);
  expectStoppedFor("can0 was bus-off for a moment");
  update();
  EXPECT_FALSE(unseen) << "taken once";
  EXPECT_EQ(texts.size(), 1u);
}

TEST_F(BusWatchOfAMove, TakesAnInterfaceThatWentDownBetweenTwoLooksForALoss) {
  ++interface.counted.interface_losses;
  update();
  EXPECT_EQ(unseen, BusState::down);
  EXPECT_THAT(texts, ElementsAre(HasSubstr("can0 was down for a moment: look who takes it down")));
  expectStoppedFor("can0 was down for a moment");
  update();
  EXPECT_FALSE(unseen) << "taken once";
  EXPECT_EQ(texts.size(), 1u);
}

TEST_F(BusWatchOfAMove, TakesABusOffThatLeftAWarningBehindForALoss) {
  ++interface.counted.bus_off_events;
  become(BusState::error_warning, "can0 warns");
  EXPECT_EQ(unseen, BusState::bus_off);
  EXPECT_EQ(texts.back(), "can0 warns");
  expectStoppedFor("can0 was bus-off for a moment");
}

TEST_F(BusWatchOfAMove, TellsALossThatItSeesOnlyOnce) {
  ++interface.counted.bus_off_events;
  become(BusState::bus_off, "can0 is off");
  EXPECT_FALSE(unseen);
  ++interface.counted.bus_off_events;  // and again, before it was seen to be back
  become(BusState::error_active, "can0 is up");
  EXPECT_FALSE(unseen);
  EXPECT_THAT(texts, ElementsAre("can0 is off", "can0 is up"));
  EXPECT_EQ(world.eventsWith("can0 is back"), 1u);
}

TEST_F(BusWatchTest, SumsUpLossesThatItDoesNotSee) {
  become(BusState::error_active, "can0 is up");
  for (int i = 0; i < 100; ++i) {
    ++interface.counted.bus_off_events;
    update(1ms);
  }
  EXPECT_EQ(texts.size(), 4u);
  texts.clear();
  update(5s);
  EXPECT_THAT(texts, ElementsAre(HasSubstr("can0 became bus-off 97 times in the last 5 s, now it "
                                           "is error active")));
}

}  // namespace
}  // namespace cia402::bus
