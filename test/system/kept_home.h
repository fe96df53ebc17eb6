// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system/scene.h"

namespace cia402 {

/// The axis keeps what the drive knows of its home.
constexpr char kKeptByDrive[] = ", kept_by_drive: true";

/// Nobody hears of the drive for a while; it keeps its power, and boots anew.
inline void loseAndRecover(Scene& scene) {
  scene.inject("joint", "silent");
  scene.run(std::chrono::seconds(1));
  ASSERT_NE(scene.state("joint").health, fieldbus::Health::ready);
  EXPECT_FALSE(scene.state("joint").homed);
  scene.inject("joint", "clear");
  (void)scene.procedure(drive::ProcedureKind::recover, "joint");  // fails where it is not homed
  ASSERT_EQ(scene.state("joint").state, drive::State::operation_enabled) << scene.told();
  scene.run(std::chrono::milliseconds(200));
}

}  // namespace cia402
