// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording_files.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Kind = RecordingTrigger::Kind;
using testing::HasSubstr;

constexpr std::chrono::nanoseconds kWall = 1'700'000'000s;  // 2023-11-14 22:13:20 UTC

class Files : public testing::Test {
 protected:
  Files() {
    char name[] = "/tmp/recording_files_XXXXXX";
    root = mkdtemp(name);
    robot.recorder.directory = root + "/a/b";
    robot.recorder.keep = 3;
  }
  ~Files() override { fs::remove_all(root); }

  Result<RecordingFiles> write(Time when, Kind kind = Kind::fault) {
    Recording recording;
    recording.end = when;
    recording.begin = when - 10s;
    RecordingTrigger trigger;
    trigger.kind = kind;
    trigger.code = 0x8611;
    trigger.axis = 1;
    trigger.stamp = when;
    recording.triggers = {trigger};
    recording.frames = {{can::Frame(0x182, {0x18, 0x02}), when, false}};
    return writeRecording(recording, robot, test::masterOf(robot), kWall);
  }
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(robot.recorder.directory)) {
      found.insert(entry.path().filename().string());
    }
    return found;
  }
  static std::string contents(const std::string& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::string root;
  config::RobotConfig robot = test::testRobot();
};

TEST_F(Files, AreNamedAfterTimeBusAndReasonInAFolderThatIsCreated) {
  const auto files = write(Time(1500ms));
  ASSERT_TRUE(files) << files.error().message;
  const std::string base = root + "/a/b/2023-11-14T22-13-21.500Z_can0_elbow_fault_8611";
  EXPECT_EQ(files->log, base + ".log");
  EXPECT_EQ(files->text, base + ".txt");
  EXPECT_EQ(contents(files->log), "(1700000001.500000) can0 182#1802 R\n");
  EXPECT_THAT(contents(files->text), HasSubstr("elbow (node 2): fault 0x8611 following error"));
  EXPECT_THAT(contents(files->text), HasSubstr("rx  TPDO1      elbow (2)"));
}

TEST_F(Files, AFaultNamesThemEvenIfAnEmergencyCameFirst) {
  Recording recording;
  RecordingTrigger first, second;
  first.kind = Kind::emergency;
  first.code = 0x8130;
  second.kind = Kind::fault;
  second.axis = 1;
  recording.triggers = {first, second};
  const auto files = writeRecording(recording, robot, test::masterOf(robot), kWall);
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_THAT(files->log, HasSubstr("can0_elbow_fault.log"));
}

TEST_F(Files, OnlyTheNewestAreKept) {
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(write(Time(i * 1s), Kind::request));
  EXPECT_EQ(names(), (std::set<std::string>{"2023-11-14T22-13-22.000Z_can0_requested.log",
                                            "2023-11-14T22-13-22.000Z_can0_requested.txt",
                                            "2023-11-14T22-13-23.000Z_can0_requested.log",
                                            "2023-11-14T22-13-23.000Z_can0_requested.txt",
                                            "2023-11-14T22-13-24.000Z_can0_requested.log",
                                            "2023-11-14T22-13-24.000Z_can0_requested.txt"}));
}

TEST_F(Files, OfOtherBusesAndOtherFilesAreLeftAlone) {
  fs::create_directories(robot.recorder.directory);
  const std::set<std::string> others = {"2000-01-01T00-00-00.000Z_can1_requested.log",
                                        "2000-01-01T00-00-00.000Z_can0.log", "notes.txt",
                                        "my_Z_can0_experiment_of_last_week.log"};
  for (const std::string& name : others) std::ofstream(robot.recorder.directory + "/" + name);
  robot.recorder.keep = 1;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(write(Time(i * 1s), Kind::request));
  const std::set<std::string> left = names();
  for (const std::string& name : others) EXPECT_EQ(left.count(name), 1U) << name;
  EXPECT_EQ(left.size(), others.size() + 2);
}

TEST_F(Files, WhatWasAskedForIsWrittenEvenIfNothingIsKeptOfFaults) {
  robot.recorder.keep = 0;
  ASSERT_TRUE(write(Time(1s), Kind::request));
  EXPECT_EQ(names().size(), 2U);
}

TEST_F(Files, AFolderThatCannotBeMadeIsToldWithTheReason) {
  robot.recorder.directory = "/proc/recordings";
  const auto files = write(Time(0s));
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error().message, HasSubstr("/proc/recordings"));
  EXPECT_THAT(files.error().message, HasSubstr("No such file or directory"));
}

TEST_F(Files, AFullDiskIsToldAndNothingIsLeftOver) {
  fs::create_directories(robot.recorder.directory);
  const std::string base = robot.recorder.directory + "/2023-11-14T22-13-20.000Z_can0_requested";
  fs::create_symlink("/dev/full", base + ".txt");
  const auto files = write(Time(0s), Kind::request);
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error().message, HasSubstr("No space left on device"));
  EXPECT_THAT(files.error().message, HasSubstr(base + ".txt"));
  EXPECT_TRUE(names().empty());
}

TEST(RecordingDirectory, IsWhereItWasConfiguredOrInRosHome) {
  config::RecorderConfig recorder;
  const std::string home = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
  setenv("HOME", "/home/robot", 1);
  unsetenv("ROS_HOME");
  EXPECT_EQ(recordingDirectory(recorder), "/home/robot/.ros/recordings");
  setenv("ROS_HOME", "/var/ros", 1);
  EXPECT_EQ(recordingDirectory(recorder), "/var/ros/recordings");
  recorder.directory = "~/flights";
  EXPECT_EQ(recordingDirectory(recorder), "/home/robot/flights");
  recorder.directory = "/data";
  EXPECT_EQ(recordingDirectory(recorder), "/data");
  unsetenv("ROS_HOME");
  setenv("HOME", home.c_str(), 1);
}

}  // namespace
}  // namespace cia402::bus
