// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording_service.h"

#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "bus/real_clock.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

constexpr int kNiceness = 5;            // less urgent than all else, but the end waits for it
constexpr std::size_t kMostNews = 100;  // if nobody fetches them

}  // namespace

RecordingService::RecordingService(FlightRecorder& recorder, config::RobotConfig robot,
                                   canopen::MasterConfig master, const BusTime& time)
    : recorder_(recorder), robot_(std::move(robot)), master_(std::move(master)), time_(time) {
  sem_init(&triggered_, 0, 0);
  thread_ = std::thread([this] { run(); });
}

RecordingService::~RecordingService() {
  ending_ = true;
  wake();
  thread_.join();
  sem_destroy(&triggered_);
}

void RecordingService::run() {
  pthread_setname_np(pthread_self(), "recorder");
  setpriority(PRIO_PROCESS, 0, kNiceness);  // of this thread alone (Linux)
  while (true) {
    while (sem_wait(&triggered_) != 0) {  // interrupted by a signal
    }
    RecordingTrigger trigger;
    while (next_ || recorder_.nextTrigger(trigger)) {
      record(next_ ? *std::exchange(next_, std::nullopt) : trigger);
    }
    if (ending_) return;
  }
}

/// Waits until what follows the fault is recorded, too, and collects the triggers until then.
void RecordingService::record(const RecordingTrigger& first) {
  const Time end = first.stamp + robot_.recorder.post_trigger;
  while (!ending_ && time_.now() < end) {
    const Duration left = std::min<Duration>(end - time_.now(), std::chrono::milliseconds(50));
    if (left > Duration(0)) std::this_thread::sleep_for(left);
  }
  std::vector<RecordingTrigger> triggers = {first};
  RecordingTrigger trigger;
  while (!next_ && recorder_.nextTrigger(trigger)) {
    if (trigger.stamp <= end) {
      triggers.push_back(trigger);
    } else {
      next_ = trigger;
    }
  }
  const std::lock_guard<std::mutex> one_at_a_time(writing_);
  News news = write(std::move(triggers), std::min(end, time_.now()));
  const std::lock_guard<std::mutex> lock(news_mutex_);
  if (news_.size() == kMostNews) news_.pop_front();
  news_.push_back(std::move(news));
}

RecordingService::News RecordingService::request() {
  const std::unique_lock<std::mutex> one_at_a_time(writing_, std::try_to_lock);
  if (!one_at_a_time) {
    News news;
    news.text = "refused: a recording is being written; ask again when it is there";
    return news;
  }
  RecordingTrigger trigger;
  trigger.stamp = time_.now();
  return write({trigger}, trigger.stamp);
}

RecordingService::News RecordingService::write(std::vector<RecordingTrigger> triggers, Time end) {
  Recording recording = recorder_.copy(end);
  recording.triggers = std::move(triggers);
  const Duration wall = wallClockDistance() + (time_.toClock(end) - end);
  const Result<RecordingFiles> files = writeRecording(recording, robot_, master_, wall);
  News news;
  news.written = files.ok();
  std::string why;
  for (const RecordingTrigger& trigger : recording.triggers) {
    append(why, triggerText(trigger, robot_));
    const bool known = std::count(news.axes.begin(), news.axes.end(), trigger.axis) != 0;
    if (namesAxis(trigger.kind) && !known) news.axes.push_back(trigger.axis);
  }
  if (!files) {
    news.text = files.error().message + " (" + why + ")";
    return news;
  }
  news.log = files->log;
  news.text = "flight recording (" + why + "): " + std::to_string(recording.frames.size()) +
              " frames in " + files->log + ", in words in " + files->text;
  return news;
}

bool RecordingService::nextNews(News& news) {
  const std::lock_guard<std::mutex> lock(news_mutex_);
  if (news_.empty()) return false;
  news = std::move(news_.front());
  news_.pop_front();
  return true;
}

std::string RecordingService::describe() const {
  char text[160];
  std::snprintf(text, sizeof text,
                "flight recorder: the last %g s in %.1f MB (%zu frames, the most that %g kbit/s "
                "carry, and the axes' states); ",
                toSeconds(robot_.recorder.duration), static_cast<double>(recorder_.memory()) / 1e6,
                recorder_.frameCapacity(), robot_.bus.bitrate / 1e3);
  const unsigned keep = robot_.recorder.keep;
  return text + (keep > 0 ? "written on faults and by dump_recording to " +
                                recordingDirectory(robot_.recorder) + ", at most " +
                                std::to_string(keep) + " recordings"
                          : "written by dump_recording alone (recorder/keep is 0) to " +
                                recordingDirectory(robot_.recorder));
}

}  // namespace cia402::bus
