// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the runner tells of the bus, the time and the system it runs on.
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runner/runner_world.h"

namespace cia402::bus {
namespace {

using test::BusRunnerTest;
using testing::HasSubstr;

/// Its recordings lie in a folder of their own, and end with the trigger.
struct RecordingRunner : BusRunnerTest {
  RecordingRunner() {
    config::RobotConfig robot = test::testRobot();
    robot.recorder.directory = mkdtemp(folder);
    robot.recorder.keep = 1;
    robot.recorder.post_trigger = Duration::zero();
    runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                         std::make_unique<test::RunnerInterface>(wire), options());
  }
  ~RecordingRunner() override {
    runner.reset();
    std::filesystem::remove_all(folder);
  }
  char folder[24] = "/tmp/runner_test_XXXXXX";
};

TEST_F(BusRunnerTest, ShowsItsInterfaceInItsSnapshot) {
  wire->state = can::BusState::error_passive;
  std::atomic<std::int64_t> ahead_ms{0};
  BusRunner::Options ahead = options();
  ahead.clock = [&] { return realNow() + std::chrono::milliseconds(ahead_ms); };
  const config::RobotConfig robot = test::testRobot();
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<test::RunnerInterface>(wire), ahead);
  runner->start();
  waitFor([&] { return ready(); });
  const Time before = runner->time().now();
  ahead_ms = 2000;  // the second in which frames are counted is over
  waitFor([&] {
    const NetworkSnapshot now = runner->snapshot();
    return now.now > before + std::chrono::milliseconds(1000) && now.bus_load > 0.0;
  });
  const NetworkSnapshot snapshot = runner->snapshot();
  EXPECT_EQ(snapshot.bus_text, "can0 is error passive");
  EXPECT_EQ(snapshot.pending, 3u);
  ASSERT_TRUE(snapshot.error_counters);
  EXPECT_EQ(snapshot.error_counters->transmit, 12);
  EXPECT_EQ(snapshot.error_counters->receive, 34);
  EXPECT_GT(snapshot.bus_load, 0.0);
  EXPECT_GT(snapshot.most_bus_load, snapshot.bus_load) << "with the most stuff bits";
  EXPECT_LT(snapshot.most_bus_load, 1.0);
  EXPECT_LE(snapshot.now, runner->time().now());
  runner.reset();
}

TEST_F(BusRunnerTest, CountsTheEmergenciesThatNobodyTakes) {
  runner->start();
  waitFor([&] { return ready(); });
  wire->emergencies = 5000;
  waitFor([&] { return wire->emergencies == 0; });
  meet();
  std::uint64_t taken = 0;
  EmergencyEvent event;
  while (runner->nextEmergency(event)) ++taken;
  EXPECT_LT(taken, 5000u);
  EXPECT_EQ(taken + runner->lostEmergencies(), 5000u);
}

TEST_F(BusRunnerTest, TakesInAllThatWaitsWithoutBeingWoken) {
  runner->start();
  waitFor([&] { return ready(); });
  wire->emergencies = 1000;  // some rounds of the thread
  while (wire->emergencies > 0) std::this_thread::yield();
}

// CiA 301, 7.2.6: milliseconds since midnight and days since 1 January 1984, here in UTC.
TEST_F(BusRunnerTest, SendsTheTimeOfTheWallClock) {
  config::RobotConfig robot = test::testRobot();
  robot.bus.time_interval = std::chrono::seconds(1);
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<test::RunnerInterface>(wire), options());
  using std::chrono::milliseconds;
  const auto wall = [] {
    return std::chrono::duration_cast<milliseconds>(
        std::chrono::system_clock::now().time_since_epoch());
  };
  const milliseconds before = wall();
  runner->start();
  const std::array<std::uint8_t, 8> sent = wire->first_time.get_future().get();
  const std::int64_t of_day = sent[0] | sent[1] << 8 | sent[2] << 16 | sent[3] << 24;
  const std::int64_t days = sent[4] | sent[5] << 8;
  const milliseconds time(of_day + (days + 5113) * 86'400'000);
  EXPECT_GE(time, before - milliseconds(2)) << "to the millisecond";
  EXPECT_LE(time, wall() + milliseconds(2));
}

TEST_F(BusRunnerTest, ItsThreadIsKnownByItsName) {
  runner->start();
  std::array<char, 16> name{};
  CallCommand call;
  call.function = [&](Time) {
    pthread_getname_np(pthread_self(), name.data(), name.size());
    return Answer();
  };
  post(call).wait();
  EXPECT_STREQ(name.data(), "bus");
}

TEST_F(RecordingRunner, EventsAreInItsRecordings) {
  runner->start();
  waitFor([&] { return seen("elbow (node 2): booted in"); });
  const RecordingService::News news = runner->recordings().request();
  EXPECT_TRUE(news.written) << news.text;
  std::ifstream in(news.log.substr(0, news.log.rfind('.')) + ".txt");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("elbow (node 2): booted in"));
}

TEST_F(RecordingRunner, RecordsABusOffThatIsOverBeforeItLooks) {
  runner->start();
  wire->first_frame.get_future().wait();
  wire->bus_off_events = 1;
  RecordingService::News news;
  waitFor([&] { return runner->recordings().nextNews(news); });
  EXPECT_THAT(news.text, HasSubstr("bus-off"));
  EXPECT_TRUE(seen("can0 was bus-off for a moment"));
}

TEST_F(BusRunnerTest, TellsWhatTheOperatingSystemGranted) {
  config::RobotConfig robot = test::testRobot();
  BusRunner::Options options;
  options.priority = 1;
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<test::RunnerInterface>(wire), options);
  const Time before = realNow();
  runner->start();
  meet();
  const RealtimeReport report = runner->realtime();
  EXPECT_THAT(report.text, HasSubstr("bus thread"));
  Event event;
  do {
    ASSERT_TRUE(runner->nextEvent(event)) << report.text;
  } while (event.text.str().substr(0, 100) != report.text.substr(0, 100));
  EXPECT_EQ(event.severity, report.complete() ? Event::Severity::info : Event::Severity::warning);
  EXPECT_GE(event.stamp, before);
  EXPECT_LE(event.stamp, realNow());
  runner.reset();
  munlockall();
}

// No system grants a priority that does not exist.
TEST_F(BusRunnerTest, WarnsWhereTheOperatingSystemRefuses) {
  BusRunner::Options impossible;
  impossible.priority = 1000;
  const config::RobotConfig robot = test::testRobot();
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<test::RunnerInterface>(wire), impossible);
  runner->start();
  meet();
  Event event;
  do {
    ASSERT_TRUE(runner->nextEvent(event));
  } while (event.text.str().find("real-time priority 1000 was refused") == std::string::npos);
  EXPECT_EQ(event.severity, Event::Severity::warning);
  runner.reset();
  munlockall();
}

TEST_F(BusRunnerTest, LeavesSchedulingAloneWhereItIsToldTo) {
  runner->start();
  waitFor([&] { return ready(); });
  EXPECT_EQ(runner->realtime().text, "");
  EXPECT_FALSE(seen("the bus thread"));
}

TEST_F(RecordingRunner, RecordsAnEmergencyByItself) {
  runner->start();
  waitFor([&] { return ready(); });
  wire->emergencies = 1;
  RecordingService::News news;
  waitFor([&] { return runner->recordings().nextNews(news); });
  EXPECT_THAT(news.text, HasSubstr("shoulder (node 1): emergency 0x1000"));
}

TEST_F(BusRunnerTest, LeavesNoFileOpen) {
  runner.reset();
  const auto lowest = [] {
    const int file = dup(0);
    close(file);
    return file;
  };
  const int before = lowest();
  const config::RobotConfig robot = test::testRobot();
  for (int i = 0; i < 3; ++i) {
    BusRunner(robot, test::masterOf(robot), std::make_unique<test::RunnerInterface>(wire),
              options());
  }
  EXPECT_EQ(lowest(), before);
}

// However late the thread is: the time of a simulated bus does not pass what is due.
TEST_F(BusRunnerTest, NoCycleOfASimulatedBusIsLate) {
  BusRunner::Options simulated = options();
  simulated.time = BusTime::Kind::simulated;
  const config::RobotConfig robot = test::testRobot();
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<test::RunnerInterface>(wire), simulated);
  runner->start();
  waitFor([&] { return runner->snapshot().statistics.cycles() >= 50; });
  EXPECT_EQ(runner->snapshot().statistics.overruns(), 0u);
  EXPECT_LT(runner->snapshot().statistics.maxLateness(), 0.001);
}

}  // namespace
}  // namespace cia402::bus
