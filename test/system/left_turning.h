// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "fieldbus/object.h"
#include "sim/definition/drive_definition.h"
#include "system/scene.h"

namespace cia402 {

/// Its first drive turns on when its master is gone, and outside of the NMT state operational.
inline LoadedRobot turningOn(LoadedRobot loaded) {
  sim::DriveDefinition turns_on = *loaded.drives[0].definition;
  turns_on.stops_outside_operational = false;
  loaded.drives[0].definition = std::make_shared<const sim::DriveDefinition>(std::move(turns_on));
  return loaded;
}

inline void writeLeft(Scene& scene, fieldbus::ObjectId object, std::uint64_t value, unsigned size) {
  EXPECT_EQ(scene.drive("left").dictionary().write(object, fieldbus::toBytes(value, size)), 0u)
      << fieldbus::toString(object);
}

/// Another master has it turn in profile velocity, at 20 turns/s, and is gone.
inline void turnLeft(Scene& scene) {
  writeLeft(scene, {0x6007, 0}, 0, 2);
  writeLeft(scene, {0x6060, 0}, 3, 1);
  writeLeft(scene, {0x6085, 0}, 6553600, 4);  // 50 turns/s^2
  writeLeft(scene, {0x60FF, 0}, 2621440, 4);  // 20 turns/s
  for (const std::uint64_t controlword : {0x06U, 0x07U, 0x0FU}) {
    writeLeft(scene, {0x6040, 0}, controlword, 2);
    scene.run(std::chrono::milliseconds(50));
  }
  scene.run(std::chrono::seconds(3));
}

}  // namespace cia402
