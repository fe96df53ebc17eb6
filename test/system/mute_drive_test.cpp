// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that leaves the state operational in motion, and answers no SDO: it turns on as it was
// told last, and hears nothing but NMT and, once started, PDOs. Judged by the motor.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtState;

class MuteDrive : public testing::TestWithParam<FamilyMode>, private sim::Listener {
 protected:
  void onFrame(const can::Frame&, Time) override {}
  /// Another master takes it out of operational.
  void leave(Scene& scene) {
    sim::Port& stranger = scene.world().bus().attach(*this, "stranger", 16);
    scene.inject("joint", "sdo_silent");
    ASSERT_TRUE(stranger.send(can::Frame(0x000, {0x80, 0x01}), scene.now()));
    scene.run(1ms);
    ASSERT_EQ(scene.truth("joint").nmt, NmtState::pre_operational);
  }
};

TEST_P(MuteDrive, ThatLeavesOperationalInMotionIsStoppedWithinTwoHeartbeats) {
  FamilyScene scene(familyJoint(GetParam()));
  scene.sendOff();
  ASSERT_NO_FATAL_FAILURE(leave(scene));
  scene.run(250ms);  // two heartbeats, and the first SYNC after the second
  scene.run(400ms);  // 0.8 rad/s by the ramp of 4 rad/s^2, half of it, and the lag of the motor
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << scene.told();
  scene.expectStands(3s);
  scene.inject("joint", "clear");
  scene.mustSucceed(drive::ProcedureKind::recover);
  scene.expectStands(500ms, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(All, MuteDrive,
                         testing::ValuesIn(familyModesThat([](const FamilyMode& tested) {
                           return !isTorqueMode(tested);
                         })),
                         familyModeName);

class MuteDriveInTorque : public MuteDrive {};

TEST_P(MuteDriveInTorque, IsBrakedByAModeOfVelocitiesAndStops) {
  FamilyScene scene(familyJoint(GetParam()));
  scene.sendOff();
  ASSERT_NO_FATAL_FAILURE(leave(scene));
  scene.run(500ms);  // as above, and a heartbeat for the mode
  scene.run(600ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << scene.told();
  scene.expectStands(3s);
  scene.inject("joint", "clear");
  scene.mustSucceed(drive::ProcedureKind::recover);
  scene.expectStands(500ms, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(All, MuteDriveInTorque, testing::ValuesIn(familyModesThat(isTorqueMode)),
                         familyModeName);

}  // namespace
}  // namespace cia402
