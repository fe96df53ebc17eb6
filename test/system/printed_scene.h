// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <sstream>
#include <string>

#include "sim/definition/drive_definition.h"
#include "sim/drive_fixture.h"
#include "system/traced_scene.h"

namespace cia402 {

/// "2B 17 20 02 00 00 00 00" as a frame.
inline can::Frame printedFrame(std::uint32_t id, const std::string& bytes) {
  can::Frame frame(id, {});
  std::istringstream text(bytes);
  for (unsigned byte = 0; text >> std::hex >> byte;) {
    frame.data.at(frame.size++) = static_cast<std::uint8_t>(byte);
  }
  return frame;
}

/// A simulated drive, node 1, booted, that is sent the bytes that its manual prints.
struct PrintedDrive : sim::DriveBench {
  explicit PrintedDrive(const std::string& name, const sim::AxisMechanics& mechanics = {})
      : DriveBench(name, mechanics) {
    run(std::chrono::seconds(1));
  }
  /// @param with further keys of its definition
  PrintedDrive(const std::string& name, const std::string& with)
      : DriveBench(
            sim::loadDriveDefinition(test::configFolder() + "/simulated_drives/" + name + ".yaml",
                                     YAML::Load(with)),
            {}) {
    run(std::chrono::seconds(1));
  }
  /// Sends eight bytes to its SDO server. @return those that it answers
  std::string ask(const std::string& bytes) {
    const std::size_t before = sent.size();
    drive->receive(printedFrame(0x601, bytes), now);
    for (int i = 0; i < 2000; ++i) {  // ms; it needs some time to save
      run(std::chrono::milliseconds(1));
      for (std::size_t at = before; at < sent.size(); ++at) {
        if (sent[at].id == 0x581) return wireText(sent[at]).substr(4);
      }
    }
    return "no answer";
  }
  /// Writes that it takes, one after the other.
  void take(std::initializer_list<const char*> writes) {
    for (const std::string write : writes) {
      EXPECT_EQ(ask(write), "60 " + write.substr(3, 8) + " 00 00 00 00") << write;
    }
  }
  /// How many frames with this identifier it has sent so far.
  std::size_t count(std::uint32_t id) const {
    return static_cast<std::size_t>(std::count_if(
        sent.begin(), sent.end(), [&](const can::Frame& frame) { return frame.id == id; }));
  }
  double turns() { return drive->truth(now).position_turns; }
  double speed() { return drive->truth(now).velocity_turns; }  ///< turns/s
  bool powered() { return drive->truth(now).power_stage_on; }
  sim::Entry& object(std::uint16_t index, std::uint8_t sub = 0) {
    return *drive->dictionary().find({index, sub});
  }
};

/// What was written to 6040h by SDO, the low bytes, each once in a row: so many of the last ones.
inline std::vector<std::string> printedWords(const TracedScene& scene, std::size_t last) {
  std::vector<std::string> words;
  for (const std::string& write : scene.writes()) {
    if (write.compare(0, 11, "2B 40 60 00") != 0) continue;
    const std::string word = write.substr(12, 2);
    if (words.empty() || words.back() != word) words.push_back(word);
  }
  if (words.size() > last) words.erase(words.begin(), words.end() - static_cast<int>(last));
  return words;
}

}  // namespace cia402
