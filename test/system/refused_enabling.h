// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "system/scene.h"

namespace cia402 {

/// Boots the robot `yaml`, whose axis is `joint`, node 1: to enable it is refused in words with
/// both texts in them, and neither power nor motion come.
inline void expectRefusedEnabling(const std::string& yaml, const std::string& told,
                                  const std::string& remedy) {
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot(std::chrono::seconds(20))) << scene.told();
  scene.forget();
  const bus::Answer enabled = scene.procedure(drive::ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message,
              testing::AllOf(testing::HasSubstr("joint (node 1): is not enabled: "),
                             testing::HasSubstr(told), testing::HasSubstr(remedy)));
  scene.run(std::chrono::milliseconds(500));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.seen("joint").travel(), 0.0);
}

}  // namespace cia402
