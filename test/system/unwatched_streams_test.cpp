// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Velocities and efforts for drives that do not notice a dead driver.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr char kKey[] = ", unwatched_streams: true";

std::string without(std::string yaml) {
  const std::size_t at = yaml.find(kKey);
  return at == std::string::npos ? yaml : yaml.erase(at, sizeof(kKey) - 1);
}

class UnwatchedStreams : public testing::TestWithParam<FamilyMode> {};

TEST_P(UnwatchedStreams, AreRefusedAndTheMotorStands) {
  Scene scene(loadText(without(familyJoint(GetParam()))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.forget();
  EXPECT_THAT(scene.setpoint("joint", 0.3),
              AllOf(HasSubstr("joint (node 1)"), HasSubstr("does not notice when this driver dies"),
                    HasSubstr("unwatched_streams: true")));
  const bool trajectories = std::string(GetParam().mode) == "position_by_velocity";
  if (trajectories) {
    const auto reply = scene.move({0.3}, 1s);
    EXPECT_FALSE(reply.success);
    EXPECT_THAT(reply.message, HasSubstr("unwatched_streams: true"));
  }
  scene.run(1s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(All, UnwatchedStreams,
                         testing::Values(FamilyMode{kNimotionStepper, "4000", "pv"},
                                         FamilyMode{kNimotionStepper, "4000", "csv"},
                                         FamilyMode{kNimotionStepper, "4000", "vl"},
                                         FamilyMode{kId286Cnfa, "10000", "pv"},
                                         FamilyMode{kId286Cnfa, "10000", "pt"},
                                         FamilyMode{kId286Cnfa, "10000", "position_by_velocity"}),
                         familyModeName);

/// A position is gone to, and the motor stands there whoever dies.
TEST(WatchedByNobody, PositionsNeedNoKey) {
  for (const FamilyMode tested :
       {FamilyMode{kNimotionStepper, "4000", "csp"}, FamilyMode{kNimotionStepper, "4000", "pp"},
        FamilyMode{kId286Cnfa, "10000", "pp"},
        FamilyMode{kId286Cnfa, "10000", "position_by_set_points"}}) {
    Scene scene(loadText(without(familyJoint(tested))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    EXPECT_EQ(scene.setpoint("joint", 0.2), "") << tested.family << " " << tested.mode;
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.2, 2e-3) << tested.family << " " << tested.mode;
  }
}

/// Nobody asks a drive to look where `heartbeat: 0` says so.
TEST(WatchedByNobody, AnyDriveIsWithoutAHeartbeat) {
  std::string yaml = genericPair(", mode: csv");
  yaml.replace(yaml.find("heartbeat: 0.1"), 14, "heartbeat: 0");
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_THAT(scene.setpoint("left", 0.3), HasSubstr("unwatched_streams: true"));
  scene.run(500ms);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-9);
}

}  // namespace
}  // namespace cia402
