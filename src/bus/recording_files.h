// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "bus/recording.h"
#include "canopen/config.h"
#include "cia402_driver/common/result.h"
#include "config/robot.h"

namespace cia402::bus {

/// Where a recording was written.
struct RecordingFiles {
  std::string log;   ///< candump format
  std::string text;  ///< in words
};

/// The folder of recordings: as configured, or `recordings` in $ROS_HOME or ~/.ros; "~/" at the
/// beginning is the home folder.
std::string recordingDirectory(const config::RecorderConfig& recorder);

/// Writes a recording as `<directory>/<time>_<bus>_<reason>.log` and `.txt`, and removes the oldest
/// of the bus beyond the number to be kept. The folder is created.
/// @return the files, or what could not be done (no rights, disk full); nothing is left over then.
Result<RecordingFiles> writeRecording(const Recording& recording, const config::RobotConfig& robot,
                                      const canopen::MasterConfig& master,
                                      std::chrono::nanoseconds wall);

}  // namespace cia402::bus
