// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "system/scene.h"

namespace cia402 {

/// "601 40 41 60 00", a remote frame "701 R".
inline std::string wireText(const can::Frame& frame) {
  char text[8];
  std::snprintf(text, sizeof(text), "%03X", static_cast<unsigned>(frame.id));
  std::string line = text;
  if (frame.remote) return line + " R";
  for (std::size_t i = 0; i < frame.size; ++i) {
    std::snprintf(text, sizeof(text), " %02X", static_cast<unsigned>(frame.data[i]));
    line += text;
  }
  return line;
}

/// Are these lines there, in this order, whatever stands between them?
inline testing::AssertionResult inOrder(const std::vector<std::string>& lines,
                                        const std::vector<std::string>& wanted) {
  auto from = lines.begin();
  for (const std::string& line : wanted) {
    const auto found = std::find(from, lines.end(), line);
    if (found == lines.end()) {
      const bool earlier = std::find(lines.begin(), from, line) != from;
      return testing::AssertionFailure() << line << (earlier ? " comes too early" : " is missing");
    }
    from = found + 1;
  }
  return testing::AssertionSuccess();
}

/// A robot with everything that was on its bus since the first moment, or since `lines` was
/// cleared.
struct TracedScene : Scene {
  explicit TracedScene(const std::string& yaml) : TracedScene(loadText(yaml)) {}
  explicit TracedScene(LoadedRobot loaded) : Scene(std::move(loaded)) {
    world().bus().setMonitor([this](const can::Frame& frame, Time time) {
      lines.push_back(wireText(frame));
      times.push_back(time);
    });
  }
  void clear() {
    lines.clear();
    times.clear();
  }
  /// Those that begin so.
  std::vector<std::string> beginning(const std::string& begin) const {
    std::vector<std::string> found;
    for (const std::string& line : lines) {
      if (line.compare(0, begin.size(), begin) == 0) found.push_back(line);
    }
    return found;
  }
  std::size_t count(const std::string& begin) const { return beginning(begin).size(); }
  /// The writes to a node by SDO that begin a transfer, without the identifier: "2B 17 10 00 64
  /// ..".
  std::vector<std::string> writes(unsigned node = 1) const {
    std::vector<std::string> found;
    for (const std::string& line : beginning(wireText(can::Frame(0x600 + node, {})) + " 2")) {
      found.push_back(line.substr(4));
    }
    return found;
  }

  std::vector<std::string> lines;
  std::vector<Time> times;  ///< of each line, the end of its frame
};

}  // namespace cia402
