// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bus/bus_time.h"
#include "bus/flight_recorder.h"
#include "bus/recording_files.h"
#include "canopen/config.h"
#include "config/robot.h"

namespace cia402::bus {

/// Writes recordings beside the thread of the bus: on faults, in a thread of its own, and when
/// somebody asks. One at a time.
class RecordingService {
 public:
  /// What became of a recording.
  struct News {
    bool written = false;
    std::string text;                 ///< a sentence with the names of the files, or why not
    std::vector<std::uint16_t> axes;  ///< whose faults it shows
    std::string log;                  ///< the candump log, if written
  };

  /// @param recorder, @param time must outlive the service.
  RecordingService(FlightRecorder& recorder, config::RobotConfig robot,
                   canopen::MasterConfig master, const BusTime& time);
  /// Writes what a fault has asked for, then ends the thread.
  ~RecordingService();

  /// The thread of the bus: there may be triggers. Never blocks.
  void wake() { sem_post(&triggered_); }
  /// Any thread but that of the bus: writes what there is now.
  News request();
  /// Any thread: what the thread has written or failed to write. @return false if nothing is new.
  bool nextNews(News& news);
  /// Any thread: failures that were not recorded because there were too many.
  std::uint64_t suppressed() const { return recorder_.suppressed(); }
  /// Any thread: what the recorder keeps in how much memory, and where recordings go.
  std::string describe() const;

 private:
  void run();
  void record(const RecordingTrigger& first);
  News write(std::vector<RecordingTrigger> triggers, Time end);

  FlightRecorder& recorder_;
  config::RobotConfig robot_;
  canopen::MasterConfig master_;
  const BusTime& time_;
  sem_t triggered_;
  std::atomic<bool> ending_{false};
  std::mutex writing_;  // one recording at a time
  std::mutex news_mutex_;
  std::deque<News> news_;
  std::optional<RecordingTrigger> next_;  // taken, but belongs to the next recording
  std::thread thread_;
};

}  // namespace cia402::bus
