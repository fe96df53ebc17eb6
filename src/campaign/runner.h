// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "campaign/scene.h"

namespace cia402::campaign {

/// What an oracle has seen that must not be.
struct Finding {
  std::string oracle;  ///< its name, also that of the kind of finding
  std::string axis;    ///< empty: of the whole robot
  std::string text;    ///< a sentence
  Time at{};
};

/// What a run of a scene came to.
struct Report {
  std::string problem;  ///< why the scene could not run; empty: it did
  std::vector<Finding> findings;
  std::vector<std::string> runaways;  ///< what the driver told of motors that it took for such
  std::uint64_t fingerprint = 0;      ///< of all frames on the wire with their times
  std::uint64_t frames = 0;
  Duration simulated{};
};

/// How a scene is run.
struct RunOptions {
  std::string config_folder;  ///< with drives/ and simulated_drives/
  bool stop_at_first = true;  ///< finding
  std::string ignore;         ///< names of oracles that say nothing, to look at what is behind them
  /// Takes a line for each action, answer, event and finding.
  std::function<void(const std::string&)> trace;
  std::string watch;  ///< an axis whose motor is traced every millisecond; empty: none
};

/// Runs a scene: the robot in virtual time, its history, and all oracles.
Report run(const Scene& scene, const RunOptions& options);

}  // namespace cia402::campaign
