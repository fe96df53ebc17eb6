// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A NiMotion on a limit switch: its warning comes once, however long the axis stays there.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;

TEST(NimotionLimitSwitch, IsToldOnceWhileTheSetPointsStayThere) {
  FamilyScene scene(familyJoint(nimotionIn("csp"), ", simulation: {upper_limit_switch: 0.2}" +
                                                       std::string(kNimotionSwitches)));
  int told = 0;
  scene.world().bus().setMonitor([&told](const can::Frame& frame, Time) {
    const bool emergency = frame.id == 0x081 && frame.size == 8 && !frame.error;
    if (emergency && frame.data[0] == 0x0F && frame.data[1] == 0xFF) ++told;  // 0xFF0F
  });
  for (int i = 1; i <= 60; ++i) {
    (void)scene.setpoint("joint", 0.01 * i);
    scene.run(20ms);
  }
  scene.run(1s);
  EXPECT_NEAR(scene.position("joint"), 0.2, 0.03);
  EXPECT_EQ(told, 1) << scene.told();
}

}  // namespace
}  // namespace cia402
