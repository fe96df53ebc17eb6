// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The flight recorder of a whole robot: what the bus saw is what the files hold.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "bus/recording_files.h"
#include "bus/recording_text.h"
#include "can/candump_log.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using bus::RecordingTrigger;
using drive::ProcedureKind;
using drive::State;
using testing::HasSubstr;

struct Seen {
  can::Frame frame;
  Time stamp;
};

std::vector<RecordingTrigger> triggersOf(Scene& scene) {
  std::vector<RecordingTrigger> triggers;
  RecordingTrigger trigger;
  while (scene.robot().recorder().nextTrigger(trigger)) triggers.push_back(trigger);
  return triggers;
}

std::string textOf(Scene& scene, const bus::Recording& recording) {
  std::ostringstream out;
  bus::writeText(out, recording, scene.loaded().robot, scene.loaded().master, 0ns);
  return out.str();
}

/// The first line that holds all the words; the test fails if there is none after `from`.
std::size_t lineWith(const std::vector<std::string>& lines, const std::vector<std::string>& words,
                     std::size_t from = 0) {
  for (std::size_t i = from; i < lines.size(); ++i) {
    const bool all = std::all_of(words.begin(), words.end(), [&](const std::string& word) {
      return lines[i].find(word) != std::string::npos;
    });
    if (all) return i;
  }
  ADD_FAILURE() << "no line with " << testing::PrintToString(words) << " after line " << from;
  return lines.size();
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class FlightRecorder : public testing::Test {
 protected:
  void begin(const std::string& more = {}) {
    scene.emplace(loadText(genericPair() + more));
    ASSERT_TRUE(scene->boot());
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
  }
  void moveAndFault() {
    ASSERT_TRUE(scene->move({2.0, 2.0}, 4s).success);
    scene->run(2s);
    scene->inject("left", "blocked_rotor");
    ASSERT_TRUE(scene->runUntil([&] { return scene->state("left").state == State::fault; }, 2s));
    scene->run(500ms);
  }
  bus::Recording recordingOfTheFault() {
    bus::Recording recording;
    const auto triggers = triggersOf(*scene);
    EXPECT_FALSE(triggers.empty());
    if (triggers.empty()) return recording;
    recording = scene->robot().recorder().copy(triggers.front().stamp + 500ms);
    recording.triggers = triggers;
    return recording;
  }
  std::optional<Scene> scene;
};

TEST_F(FlightRecorder, AFaultIsToldInTheOrderOfEvents) {
  begin();
  triggersOf(*scene);
  moveAndFault();
  const bus::Recording recording = recordingOfTheFault();
  const std::string text = textOf(*scene, recording);
  const auto lines = linesOf(text);
  if (const char* path = std::getenv("CIA402_SHOW_RECORDING")) std::ofstream(path) << text;
  std::size_t at = lineWith(lines, {"procedure", "left (1)", "succeeded"});
  at = lineWith(lines, {"group", "pair: follows a trajectory"}, at);
  at = lineWith(lines, {"rx", "EMCY", "left (1)", "0x8611 following error"}, at);
  at = lineWith(lines, {"axis", "left (1)", "operation enabled -> fault"}, at);
  at = lineWith(lines, {"rx", "TPDO1", "left (1)", "statusword", "fault"});
  lineWith(lines, {"group", "pair: at rest"}, at);
}

TEST_F(FlightRecorder, TheLogHoldsTheFramesThatWereOnTheBus) {
  begin();
  std::vector<Seen> seen;
  scene->world().bus().setMonitor([&](const can::Frame& frame, Time stamp) {
    seen.push_back({frame, stamp});
  });
  scene->run(1s);
  moveAndFault();
  scene->run(8s);
  const Time end = scene->now();
  bus::Recording recording = scene->robot().recorder().copy(end);
  recording.triggers.resize(1);
  std::stringstream log;
  bus::writeFrames(log, recording, "sim", 0ns);

  // By identifier: what is sent by the master is stamped when it is handed over.
  std::map<std::uint32_t, std::vector<can::Frame>> logged, expected;
  can::LogReader reader(log);
  Time before = Time::min();
  while (const auto entry = reader.next()) {
    ASSERT_TRUE(*entry) << entry->error().message;
    const Time stamp{(*entry)->stamp};
    EXPECT_GE(stamp, before) << "line " << reader.line();
    before = stamp;
    if (stamp > recording.begin + 1ms && stamp < end - 1ms) {
      logged[(*entry)->frame.id].push_back((*entry)->frame);
    }
  }
  for (const Seen& one : seen) {
    if (one.stamp > recording.begin + 1ms && one.stamp < end - 1ms) {
      expected[one.frame.id].push_back(one.frame);
    }
  }
  ASSERT_GT(expected.size(), 8U);
  EXPECT_EQ(logged.size(), expected.size());
  for (const auto& [id, frames] : expected) {
    // A frame within the border's millisecond may be on either side.
    const auto& got = logged[id];
    ASSERT_GE(got.size() + 1, frames.size()) << std::hex << id;
    ASSERT_LE(got.size(), frames.size() + 1) << std::hex << id;
  }
  EXPECT_GT(logged[0x181].size(), 2400U) << "10 s of a TPDO every 4 ms";
  EXPECT_EQ(logged[0x181], expected[0x181]);
}

}  // namespace
}  // namespace cia402
