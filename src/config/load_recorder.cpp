// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

constexpr double kLongest = 60.0;  // s; 31 MB of frames at 1 Mbit/s
constexpr int kMostKept = 1000;

}  // namespace

void readRecorder(const yaml::Value& value, RecorderConfig& recorder) {
  yaml::Section section(value);
  double duration = toSeconds(recorder.duration);
  if (section.read("duration", duration, yaml::Range{1.0, kLongest, false})) {
    recorder.duration = fromSeconds(duration);
  }
  double post_trigger = toSeconds(recorder.post_trigger);
  if (section.read("post_trigger", post_trigger, yaml::Range{0.0, kLongest, false})) {
    recorder.post_trigger = fromSeconds(post_trigger);
  }
  if (recorder.post_trigger >= recorder.duration) {
    section.get("post_trigger")
        .value_or(value)
        .problem("must be less than `duration` (" + std::to_string(duration) +
                 "), or nothing from before the fault is left");
  }
  section.read("directory", recorder.directory);
  section.readInteger("keep", recorder.keep, 0, kMostKept);
  section.finish();
}

}  // namespace cia402::config
