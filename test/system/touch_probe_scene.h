// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/jobs/touch_probe_job.h"
#include "system/scene.h"

namespace cia402 {

inline bus::ArmTouchProbeCommand probeOf(const std::string& axis,
                                         const std::string& edge = "rising", double timeout = 5.0,
                                         unsigned number = 1) {
  bus::ArmTouchProbeCommand command;
  command.axis = axis;
  command.probe = number;
  command.edge = edge;
  command.timeout = timeout;
  return command;
}

inline std::uint64_t objectOf(Scene& scene, const std::string& axis, std::uint16_t index) {
  return scene.drive(axis).dictionary().find({index, 0})->number;
}

/// A call that waits for its edge.
struct Waiting {
  Waiting(Scene& scene_of, const bus::ArmTouchProbeCommand& command)
      : scene(scene_of), answer(scene.ask(command)) {
    scene.run(std::chrono::milliseconds(50));
  }
  bool answered() const { return answer->has_value(); }
  bus::TouchProbeAnswer await() {
    scene.runUntil([this] { return answered(); }, std::chrono::seconds(20));
    return answer->value_or(bus::TouchProbeAnswer());
  }
  Scene& scene;
  std::shared_ptr<std::optional<bus::TouchProbeAnswer>> answer;
};

/// The input has an edge now. @return where the joint truly is
inline double touch(Scene& scene, const std::string& axis, bool active, unsigned number = 1) {
  const double at = scene.position(axis);
  scene.drive(axis).setProbe(number, active, scene.now());
  return at;
}

}  // namespace cia402
