// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"

namespace cia402::campaign {

/// One thing that happens at its time: a word for what (docs/campaign.md lists them), then to whom
/// and how: "halt a1", "stream a2 0.5 1.2 100", "stall 0.06".
struct Action {
  Duration at{};
  std::vector<std::string> words;

  const std::string& verb() const { return words.front(); }
};

/// A robot and its history: all that a run depends on.
struct Scene {
  std::string about;       ///< for people
  std::uint64_t seed = 1;  ///< of what happens by chance: lost frames, lateness
  std::string robot;       ///< YAML as the driver reads it
  std::vector<Action> actions;
};

/// "3.204 halt a1". @return an error for what is no such line.
Result<Action> parseAction(const std::string& line);
std::string toString(const Action& action);

/// A scene as a YAML file and back.
Result<Scene> readScene(const std::string& yaml);
std::string writeScene(const Scene& scene);

}  // namespace cia402::campaign
