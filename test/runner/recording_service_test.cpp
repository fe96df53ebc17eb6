// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording_service.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "bus/real_clock.h"
#include "bus/recording_text.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

class EverySink : public can::Sink {
 public:
  bool send(const can::Frame&) override { return true; }
};

class Service : public testing::Test {
 protected:
  Service() {
    char name[] = "/tmp/recording_service_XXXXXX";
    root = mkdtemp(name);
    robot.recorder.directory = root;
    robot.recorder.keep = 1000;
    recorder.emplace(robot, sink);
    service.emplace(*recorder, robot, test::masterOf(robot), time);
  }
  ~Service() override {
    service.reset();
    fs::remove_all(root);
  }
  void emergency(Time stamp) {
    EmergencyEvent event;
    event.emergency.code = 0x8611;
    event.emergency.stamp = stamp;
    recorder->received(can::Frame(0x081, {0x11, 0x86, 0x21, 0, 0, 0, 0, 0}), stamp);
    recorder->onEmergency(event);
    service->wake();
  }
  RecordingService::News nextNews() {
    RecordingService::News news;
    while (!service->nextNews(news)) std::this_thread::yield();
    return news;
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(root), fs::directory_iterator()));
  }

  std::string root;
  EverySink sink;
  config::RobotConfig robot = test::testRobot();
  BusTime time;
  std::optional<FlightRecorder> recorder;
  std::optional<RecordingService> service;
};

TEST_F(Service, ARequestIsAnsweredWithTheNamesOfTheFiles) {
  recorder->received(can::Frame(0x701, {0x05}), realNow());
  const auto news = service->request();
  EXPECT_TRUE(news.written);
  EXPECT_THAT(news.text, HasSubstr("asked for"));
  EXPECT_THAT(news.text, HasSubstr("1 frames in " + news.log));
  EXPECT_THAT(news.text, HasSubstr("requested.txt"));
  EXPECT_TRUE(fs::exists(news.log));
  EXPECT_EQ(files(), 2U);
}

TEST_F(Service, AFaultIsRecordedByItselfAndToldOnce) {
  emergency(realNow());
  const auto news = nextNews();
  EXPECT_TRUE(news.written) << news.text;
  EXPECT_THAT(news.text, HasSubstr("shoulder (node 1): emergency 0x8611 following error"));
  EXPECT_EQ(news.axes, std::vector<std::uint16_t>{0});
  RecordingService::News more;
  EXPECT_FALSE(service->nextNews(more));
  EXPECT_EQ(files(), 2U);
}

TEST_F(Service, AllTriggersUpToHalfASecondAfterTheFirstAreOneRecording) {
  const Time first = realNow() - 60s;
  EmergencyEvent event;
  event.emergency.code = 0x8611;
  event.emergency.stamp = first;
  recorder->onEmergency(event);
  event.emergency.code = 0x8130;
  event.emergency.stamp = first + robot.recorder.post_trigger;
  recorder->onEmergency(event);
  recorder->onInterface(can::BusState::bus_off, first + robot.recorder.post_trigger);
  event.emergency.code = 0x2310;
  event.emergency.stamp = first + 30s;
  recorder->onEmergency(event);
  service->wake();
  const auto news = nextNews();
  EXPECT_THAT(news.text, HasSubstr("emergency 0x8611"));
  EXPECT_THAT(news.text, HasSubstr("; shoulder (node 1): emergency 0x8130"));
  EXPECT_THAT(news.text, HasSubstr("; bus-off"));
  EXPECT_THAT(news.text, testing::Not(HasSubstr("0x2310")));
  EXPECT_EQ(news.axes, std::vector<std::uint16_t>{0}) << "once";
  const auto another = nextNews();
  EXPECT_THAT(another.text, HasSubstr("(shoulder (node 1): emergency 0x2310"));
  EXPECT_EQ(files(), 4U);
}

TEST_F(Service, ABusOffIsOfNoAxis) {
  recorder->onInterface(can::BusState::bus_off, realNow() - 1s);
  service->wake();
  const auto news = nextNews();
  EXPECT_THAT(news.text, HasSubstr("bus-off"));
  EXPECT_TRUE(news.axes.empty());
}

TEST_F(Service, ItsThreadIsKnownByItsNameAndLessUrgentThanTheOthers) {
  emergency(realNow() - 1s);
  nextNews();
  int found = 0;
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::ifstream comm(task.path() / "comm");
    std::string name;
    std::getline(comm, name);
    if (name != "recorder") continue;
    ++found;
    const auto thread = static_cast<id_t>(std::stoul(task.path().filename().string()));
    EXPECT_GT(getpriority(PRIO_PROCESS, thread), getpriority(PRIO_PROCESS, 0));
  }
  EXPECT_EQ(found, 1);
}

TEST_F(Service, TheEndOfTheProgramDoesNotLoseTheFault) {
  emergency(realNow());
  service.reset();  // before the half second after the fault is over
  EXPECT_EQ(files(), 2U);
}

TEST_F(Service, WhileARecordingIsBeingWrittenAnotherOneIsRefusedInWords) {
  // The log's name is known, and a pipe there holds the writer until somebody reads. Half a
  // millisecond keeps the name clear of rounding.
  const Duration wall = wallClockDistance();
  const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(
      (realNow() - 1s).time_since_epoch() + wall);
  const Time stamp{whole + 500us - wall};
  const std::string log = root + "/" + timeStamp(whole) + "_can0_shoulder_emergency_8611.log";
  ASSERT_EQ(mkfifo(log.c_str(), 0600), 0);
  emergency(stamp);
  RecordingService::News refused = service->request();
  while (refused.written) {  // the thread has not begun yet: it gets its turn
    std::this_thread::sleep_for(1ms);
    refused = service->request();
  }
  EXPECT_THAT(refused.text, HasSubstr("refused: a recording is being written"));
  std::ifstream reader(log);
  std::string line;
  std::getline(reader, line);
  EXPECT_THAT(line, HasSubstr("can0 081#1186210000000000 R"));
  EXPECT_TRUE(nextNews().written);
  EXPECT_TRUE(service->request().written);
}

TEST_F(Service, WritesTheTimeOfTheWallClockWhereTheBusHasStoodStill) {
  Duration behind = 1h;
  BusTime late(BusTime::Kind::simulated, [&behind] { return realNow() - behind; });
  late.advance(kNever);
  behind = 0h;
  late.advance(kNever);
  service.reset();
  service.emplace(*recorder, robot, test::masterOf(robot), late);
  recorder->received(can::Frame(0x701, {0x05}), late.now());
  const auto news = service->request();
  ASSERT_TRUE(news.written) << news.text;
  std::ifstream log(news.log);
  char parenthesis = 0;
  double stamp = 0.0;
  log >> parenthesis >> stamp;
  EXPECT_NEAR(stamp, toSeconds(realNow().time_since_epoch() + wallClockDistance()), 300.0);
}

TEST_F(Service, WhatCannotBeWrittenIsTold) {
  service.reset();
  robot.recorder.directory = "/proc/recordings";
  service.emplace(*recorder, robot, test::masterOf(robot), time);
  const auto news = service->request();
  EXPECT_FALSE(news.written);
  EXPECT_THAT(news.text, HasSubstr("/proc/recordings"));
  EXPECT_THAT(news.text, HasSubstr("asked for"));
}

TEST_F(Service, DescribesItsMemoryAndWhereItWrites) {
  EXPECT_THAT(service->describe(), HasSubstr("the last 10 s in 5.9 MB (234043 frames, the most "
                                             "that 1000 kbit/s carry"));
  EXPECT_THAT(service->describe(), HasSubstr("written on faults and by dump_recording to " + root +
                                             ", at most 1000 recordings"));
}

}  // namespace
}  // namespace cia402::bus
