// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/player.h"
#include "campaign/runner.h"

namespace cia402::campaign {

Report run(const Scene& scene, const RunOptions& options) {
  Report report;
  Result<Loaded> loaded = loadRobot(scene.robot, options.config_folder);
  if (!loaded) {
    report.problem = loaded.error().message;
    return report;
  }
  Stage stage(std::move(loaded).value(), scene.seed);
  Player player(stage, scene, options);
  try {
    player.play();
  } catch (const std::exception& exception) {
    report.problem = exception.what();
  }
  report.findings = player.findings();
  report.runaways = player.runaways();
  report.fingerprint = player.fingerprint();
  report.frames = player.frames();
  report.simulated = stage.now().time_since_epoch();
  return report;
}

}  // namespace cia402::campaign
