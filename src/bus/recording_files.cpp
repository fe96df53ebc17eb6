// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "bus/recording_text.h"

namespace cia402::bus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kStampLength = 24;  // of timeStamp()

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// A trigger names the files: a fault if there is one, else the first.
const RecordingTrigger& namingTrigger(const Recording& recording) {
  const auto fault = std::find_if(recording.triggers.begin(), recording.triggers.end(),
                                  [](const RecordingTrigger& trigger) {
                                    return trigger.kind == RecordingTrigger::Kind::fault;
                                  });
  return fault != recording.triggers.end() ? *fault : recording.triggers.front();
}

template <typename Write>
Result<void> writeFile(const std::string& path, Write write) {
  errno = 0;
  std::ofstream out(path);
  if (out) write(out);
  out.close();
  if (out) return {};
  const std::string why = errno != 0 ? std::strerror(errno) : "the file cannot be written";
  std::error_code ignored;
  fs::remove(path, ignored);
  return Error{path + ": " + why};
}

/// Is it a recording of this bus? `<time>_<bus>_<reason>.log`
bool isRecording(const std::string& name, const std::string& bus) {
  const std::string middle = "Z_" + bus + "_";
  const bool log = name.size() > 4 && (name.compare(name.size() - 4, 4, ".log") == 0 ||
                                       name.compare(name.size() - 4, 4, ".txt") == 0);
  return log && name.size() > kStampLength && name[4] == '-' && name[10] == 'T' &&
         name.compare(kStampLength - 1, middle.size(), middle) == 0;
}

/// Removes the oldest recordings; their names sort by time.
void removeOldest(const fs::path& directory, const std::string& bus, unsigned keep) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (isRecording(name, bus)) names.push_back(entry->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (std::size_t i = 0; i + keep < names.size(); ++i) {
    for (const char* extension : {".log", ".txt"}) {
      fs::remove(directory / (names[i] + extension), error);
    }
  }
}

}  // namespace

std::string recordingDirectory(const config::RecorderConfig& recorder) {
  const std::string home = environment("HOME");
  const std::string& given = recorder.directory;
  if (given.compare(0, 2, "~/") == 0 && !home.empty()) return home + given.substr(1);
  if (!given.empty()) return given;
  const std::string ros_home = environment("ROS_HOME");
  if (!ros_home.empty()) return ros_home + "/recordings";
  return home.empty() ? "/tmp/recordings" : home + "/.ros/recordings";
}

Result<RecordingFiles> writeRecording(const Recording& recording, const config::RobotConfig& robot,
                                      const canopen::MasterConfig& master,
                                      std::chrono::nanoseconds wall) {
  const std::string directory = recordingDirectory(robot.recorder);
  const std::string failed = "the flight recording could not be written: ";
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) return Error{failed + "folder " + directory + ": " + error.message()};
  const RecordingTrigger& trigger = namingTrigger(recording);
  const std::string base = directory + "/" + timeStamp(trigger.stamp.time_since_epoch() + wall) +
                           "_" + robot.bus.interface + "_" + triggerName(trigger, robot);
  const RecordingFiles files{base + ".log", base + ".txt"};
  const Result<void> frames = writeFile(files.log, [&](std::ostream& out) {
    writeFrames(out, recording, robot.bus.interface, wall);
  });
  if (!frames) return Error{failed + frames.error().message};
  const Result<void> text = writeFile(
      files.text, [&](std::ostream& out) { writeText(out, recording, robot, master, wall); });
  if (!text) {
    fs::remove(files.log, error);
    return Error{failed + text.error().message};
  }
  removeOldest(directory, robot.bus.interface, std::max(robot.recorder.keep, 1U));
  return files;
}

}  // namespace cia402::bus
